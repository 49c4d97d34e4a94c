"""What `squeezefilm film` computes: one film of a plain shape, or a map of many."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from squeezefilm.errors import InputError
from squeezefilm.hard_limits import ASPECT, require_within
from squeezefilm.quantities import (
    Dimensionless,
    DimensionlessArray,
    did_you_mean,
)
from squeezefilm.results import stamp, to_json

SHAPES = ("strip", "disc", "rectangle", "ellipse")
_LINES = ("strip", "disc")


@dataclass(frozen=True)
class FilmRequest:
    """A film of plain shape and uniform gap H = 1 + ε cos T; `tolerance` is relative, on W − 1."""

    shape: str = "strip"
    aspect_ratio: Dimensionless = 1.0
    polytropic_exponent: Dimensionless = 1.0
    knudsen_number: Dimensionless = 0.0
    slip: str = "first"
    tolerance: Dimensionless = 1e-3

    def __post_init__(self) -> None:
        if self.shape not in SHAPES:
            raise InputError(
                f"shape = '{self.shape}' is not known.{did_you_mean(self.shape, SHAPES)} "
                f"Allowed: {', '.join(SHAPES)}"
            )
        require_within(ASPECT, self.aspect_ratio, "aspect_ratio")


@dataclass(frozen=True)
class FilmAnswer:
    """The mean load W over p0 A of one film, its over-pressure W − 1 with the estimated absolute
    error, and the first harmonic of its force: stiffness and damping over p0 A ε."""

    squeeze_number: Dimensionless
    excursion_ratio: Dimensionless
    request: FilmRequest
    mean_load: Dimensionless
    over_pressure: Dimensionless
    over_pressure_error: Dimensionless
    stiffness_relative: Dimensionless
    damping_relative: Dimensionless
    iterations: int
    residual: float
    status: str
    model: str

    def summary(self) -> dict[str, Any]:
        """What ``--json`` prints."""
        return {**to_json(self), "provenance": stamp(self.request)}


@dataclass(frozen=True, eq=False)
class FilmMap:
    """Over-pressure, its error and the force's first harmonic over σ (rows) and ε (columns)."""

    request: FilmRequest
    squeeze_number: DimensionlessArray
    excursion_ratio: DimensionlessArray
    over_pressure: DimensionlessArray
    over_pressure_error: DimensionlessArray
    stiffness_relative: DimensionlessArray
    damping_relative: DimensionlessArray
    model: str

    def summary(self) -> dict[str, Any]:
        """What ``--json`` prints."""
        return {**to_json(self), "provenance": stamp(self.request)}


def solve_film(
    squeeze_number: Dimensionless, excursion_ratio: Dimensionless, request: FilmRequest
) -> FilmAnswer:
    """One film. σ is on the width of a strip, the radius of a disc, the X side of a rectangle or
    the X semi-axis of an ellipse. Raises what the film solvers raise."""
    from squeezefilm.film.periodic.film import solve_disc, solve_strip
    from squeezefilm.film.planar.film import solve_ellipse, solve_rectangle

    gas = {
        "polytropic_exponent": request.polytropic_exponent,
        "knudsen_number": request.knudsen_number,
    }
    if request.shape in _LINES:
        solve = solve_strip if request.shape == "strip" else solve_disc
        line = solve(
            squeeze_number, excursion_ratio, slip=request.slip, tolerance=request.tolerance, **gas
        )
        return _answer(squeeze_number, excursion_ratio, request, line)
    planar = solve_rectangle if request.shape == "rectangle" else solve_ellipse
    plane = planar(
        squeeze_number,
        excursion_ratio,
        request.aspect_ratio,
        slip=request.slip,
        tolerance=request.tolerance,
        **gas,
    )
    return _answer(squeeze_number, excursion_ratio, request, plane)


def _answer(sigma: float, excursion: float, request: FilmRequest, film: Any) -> FilmAnswer:
    return FilmAnswer(
        squeeze_number=sigma,
        excursion_ratio=excursion,
        request=request,
        mean_load=film.mean_load,
        over_pressure=film.over_pressure,
        over_pressure_error=film.over_pressure_error,
        stiffness_relative=film.stiffness_relative,
        damping_relative=film.damping_relative,
        iterations=film.iterations,
        residual=film.residual,
        status=film.status,
        model=f"periodic compressible Reynolds, {request.shape}",
    )


def sweep_film(
    request: FilmRequest,
    *,
    points: tuple[int, int] = (61, 40),
    progress: Callable[[str], None] | None = None,
) -> FilmMap:
    """The map of a strip or a disc over σ from 0.01 to 10⁴ and ε from 0.02 to 0.95.

    Raises `InputError` for shapes in the plane, which are too slow for a map of thousands.
    """
    from squeezefilm.film.periodic.batch import solve_discs, solve_strips

    if request.shape not in _LINES:
        raise InputError(
            f"a map of shape '{request.shape}' would take minutes; --sweep knows strip and disc"
        )
    sigma, excursion = np.geomspace(0.01, 1e4, points[0]), np.linspace(0.02, 0.95, points[1])

    tenths = -1

    def told(done: int, total: int) -> None:
        nonlocal tenths
        if progress is not None and 10 * done // total > tenths:
            tenths = 10 * done // total
            progress(f"{done} of {total} films")

    films = (solve_strips if request.shape == "strip" else solve_discs)(
        sigma[:, None],
        excursion[None, :],
        polytropic_exponent=request.polytropic_exponent,
        knudsen_number=request.knudsen_number,
        slip=request.slip,
        tolerance=request.tolerance,
        progress=told,
    )
    return FilmMap(
        request=request,
        squeeze_number=sigma,
        excursion_ratio=excursion,
        over_pressure=films.over_pressure,
        over_pressure_error=films.over_pressure_error,
        stiffness_relative=films.stiffness_relative,
        damping_relative=films.damping_relative,
        model=films.model,
    )
