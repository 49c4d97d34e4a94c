"""Results of `squeezefilm film`: one film of a plain shape, or a map of many."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import ASPECT
from squeezefilm.core.results import Result, stamp, to_json
from squeezefilm.physics.film.gas import FilmGas
from squeezefilm.physics.film.periodic.film import solve_profile, solve_uniform
from squeezefilm.physics.film.periodic.profile import GapFunction, GapProfile
from squeezefilm.physics.film.periodic.solution import FilmSolution, SolvedFilm
from squeezefilm.physics.film.planar.film import FilmPlanar, solve_planar
from squeezefilm.physics.film.planar.grid import PlanarGap

SHAPES = ("strip", "disc", "rectangle", "ellipse")
_LINES = ("strip", "disc")
_SOLVED = tuple(field.name for field in dataclasses.fields(SolvedFilm))


@si.checked_numbers
@dataclass(frozen=True)
class FilmRequest:
    """A film of plain shape and uniform gap H = 1 + ε cos T; `tolerance` is relative, on W − 1 and
    on the harmonics of the force."""

    shape: str = "strip"
    aspect_ratio: Annotated[si.Dimensionless, ASPECT] = 1.0
    polytropic_exponent: si.Dimensionless = 1.0
    knudsen_number: si.Dimensionless = 0.0
    slip: str = "first"
    tolerance: si.Dimensionless = 1e-3

    def __post_init__(self) -> None:
        si.require_one_of("shape", self.shape, SHAPES)


@dataclass(frozen=True, eq=False, repr=False)
class FilmAnswer(Result, SolvedFilm):
    """The load of one film and the harmonics of its force, (8,), which begin with k = 1.

    `film` has its pressure at every place and time."""

    squeeze_number: si.Dimensionless
    excursion_ratio: si.Dimensionless
    request: FilmRequest
    model: str
    film: FilmSolution | FilmPlanar
    _shown: ClassVar[str] = (
        "request.shape squeeze_number excursion_ratio over_pressure over_pressure_error status"
    )

    def summary(self) -> dict[str, Any]:
        """Mapping of plain JSON values."""
        names = ("squeeze_number", "excursion_ratio", "request", *_SOLVED, "model")
        values = {name: to_json(getattr(self, name)) for name in names}
        return {**values, "provenance": stamp(self.request)}

    def _table(self) -> Any:
        film = self.film
        if isinstance(film, FilmSolution):
            return {"position": film.position, "mean_pressure": film.mean_pressure}
        return {"X": film.X, "Y": film.Y, "mean_pressure": film.mean_pressure}


@dataclass(frozen=True, eq=False)
class FilmMap:
    """Map of over-pressure and the force's first harmonic, with their errors, over σ (rows) and ε
    (columns)."""

    request: FilmRequest
    squeeze_number: si.DimensionlessArray
    excursion_ratio: si.DimensionlessArray
    over_pressure: si.DimensionlessArray
    over_pressure_error: si.DimensionlessArray
    stiffness_relative: si.DimensionlessArray
    damping_relative: si.DimensionlessArray
    force_error: si.DimensionlessArray
    model: str

    def summary(self) -> dict[str, Any]:
        """Mapping of plain JSON values."""
        return {**to_json(self), "provenance": stamp(self.request)}


@reads_text
def solve_film(
    squeeze_number: si.Dimensionless,
    gap: si.Dimensionless | GapProfile | GapFunction,
    *,
    shape: str = "strip",
    aspect_ratio: si.Dimensionless = 1.0,
    polytropic_exponent: si.Dimensionless = 1.0,
    knudsen_number: si.Dimensionless = 0.0,
    slip: str = "first",
    tolerance: si.Dimensionless = 1e-3,
) -> FilmAnswer:
    """Solve a film. σ is on the width of a strip, the radius of a disc, the X side of a rectangle
    or the X semi-axis of an ellipse.

    `gap` is the excursion ratio ε of H = 1 + ε cos T, or one's own gap under a strip: a function
    H(X, T) that broadcasts over −1/2 ≤ X ≤ 1/2 and a period of 2π, or a `GapProfile`. The rest as
    `FilmRequest`. Raises what the film solvers raise, and `InputError` for a gap of one's own under
    another shape.
    """
    request = FilmRequest(shape, aspect_ratio, polytropic_exponent, knudsen_number, slip, tolerance)
    gas: dict[str, Any] = {
        "polytropic_exponent": polytropic_exponent,
        "knudsen_number": knudsen_number,
        "slip": slip,
        "tolerance": tolerance,
    }
    film: FilmSolution | FilmPlanar
    if not isinstance(gap, float | int):
        if shape != "strip":
            raise InputError(
                f"a gap of one's own is solved under a strip, not under a {shape}; leave the shape "
                "out, or give an excursion ratio"
            )
        solved = solve_profile(squeeze_number, gap, **gas)
        # The gap is in the answer by its values; a function could not be pickled.
        film = dataclasses.replace(solved, profile=None)
        return _answer(film, solved.excursion_ratio, request, ", a gap of one's own")
    if shape in _LINES:
        film = solve_uniform(squeeze_number, gap, shape=shape, **gas)
    else:
        film = solve_planar(
            "rectangle" if shape == "rectangle" else "ellipse",
            PlanarGap(gap),
            squeeze_number,
            aspect_ratio=aspect_ratio,
            gas=FilmGas(polytropic_exponent, knudsen_number, slip),
            tolerance=tolerance,
        )
    return _answer(film, gap, request)


def _answer(
    film: FilmSolution | FilmPlanar,
    excursion: si.Dimensionless,
    request: FilmRequest,
    own: str = "",
) -> FilmAnswer:
    solved = {name: getattr(film, name) for name in _SOLVED}
    if isinstance(film, FilmSolution):
        for name in ("force_harmonics", "force_harmonics_error"):
            solved[name] = solved[name][1:]
    model = f"periodic compressible Reynolds, {request.shape}{own}"
    return FilmAnswer(
        **solved,
        squeeze_number=film.squeeze_number,
        excursion_ratio=excursion,
        request=request,
        model=model,
        film=film,
    )


def sweep_film(request: FilmRequest, *, progress: Callable[[str], None] | None = None) -> FilmMap:
    """The map of a strip or a disc over σ from 0.01 to 10⁴ and ε from 0.02 to 0.95.

    Raises `InputError` for shapes in the plane, which are too slow for a map of thousands.
    """
    from squeezefilm.physics.film.periodic.batch import solve_films

    if request.shape not in _LINES:
        raise InputError(
            f"a map of shape '{request.shape}' would take minutes; sweep knows strip and disc"
        )
    sigma, excursion = np.geomspace(0.01, 1e4, 61), np.linspace(0.02, 0.95, 40)

    tenths = -1

    def told(done: int, total: int) -> None:
        nonlocal tenths
        if progress is not None and 10 * done // total > tenths:
            tenths = 10 * done // total
            progress(f"{done} of {total} films")

    films = solve_films(
        sigma[:, None],
        excursion[None, :],
        shape=request.shape,
        polytropic_exponent=request.polytropic_exponent,
        knudsen_number=request.knudsen_number,
        slip=request.slip,
        tolerance=request.tolerance,
        progress=told,
        force=True,
    )
    return FilmMap(
        request=request,
        squeeze_number=sigma,
        excursion_ratio=excursion,
        over_pressure=films.over_pressure,
        over_pressure_error=films.over_pressure_error,
        stiffness_relative=films.stiffness_relative,
        damping_relative=films.damping_relative,
        force_error=films.force_error,
        model=films.model,
    )
