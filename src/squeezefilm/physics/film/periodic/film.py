"""The periodic steady state of a 1-D gas film: strip, disc, or any profile of the gap.

Solves, for one period of the motion, the compressible Reynolds equation

    ∂/∂X (H³ φ P^{1/n} ∂P/∂X) = σ ∂(P^{1/n} H)/∂T,   P = 1 at the edges,

by Fourier collocation in time and finite volumes in space; see `kernel` for the method.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import announce
from squeezefilm.core.errors import InputError
from squeezefilm.physics.film.gas import (
    EXCURSION_RATIO,
    KNUDSEN_NUMBER,
    POLYTROPIC_EXPONENT,
    SQUEEZE_NUMBER,
    TOLERANCE,
    CompiledGas,
    FilmGas,
    slip_law,
)
from squeezefilm.physics.film.periodic.batch import compiled
from squeezefilm.physics.film.periodic.nested import (
    NEWTON_SHARE,
    PROFILE_MARGINS,
    UNIFORM_MARGINS,
    Kind,
    Nested,
    levels_of,
    load_times,
    refine,
)
from squeezefilm.physics.film.periodic.profile import (
    GapProfile,
    profile_from_function,
    sampled_grid,
)
from squeezefilm.physics.film.periodic.resolution import (
    CELLS,
    DISC,
    STRIP,
    FilmResolution,
    Films,
    first_guess,
)
from squeezefilm.physics.film.periodic.small import LARGEST, enlarged, reduced, small_film
from squeezefilm.physics.film.periodic.solution import (
    NO_FIELD,
    FilmQuestion,
    FilmSolution,
    Found,
    assembled,
    extrapolated_field,
)


@si.checked_numbers
def solve_uniform(
    squeeze_number: Annotated[si.Dimensionless, *SQUEEZE_NUMBER],
    excursion_ratio: Annotated[si.Dimensionless, *EXCURSION_RATIO],
    *,
    shape: str = "strip",
    polytropic_exponent: Annotated[si.Dimensionless, *POLYTROPIC_EXPONENT] = 1.0,
    knudsen_number: Annotated[si.Dimensionless, *KNUDSEN_NUMBER] = 0.0,
    slip: str = "first",
    tolerance: Annotated[float, *TOLERANCE] = 5e-3,
) -> FilmSolution:
    """The film under H = 1 + ε cos T of an infinitely long strip, open at both edges, or of a disc.

    `squeeze_number` σ = 12 η ω l0²/(p0 H0²) is on the strip's full width l0 or on the disc's
    radius; `excursion_ratio` is ε. `polytropic_exponent` runs from 1 (isothermal) to 5/3;
    `knudsen_number` is the free path at ambient pressure over H0, used locally as Kn/(P H) in the
    law `slip` (see `gas.SLIP_LAWS`). `tolerance` is relative, on the over-pressure W − 1; the
    resolution follows it.

    Checked for σ from 0.01 to 1e4, |ε| to 0.95, n to 1.4, Kn to 0.3. Raises `InputError` for a
    value that no film has (σ ≤ 0, |ε| ≥ 1, NaN …) and `ConvergenceError`, with the partial
    result, where the tolerance is not reached.
    """
    si.require_one_of("shape", shape, ("strip", "disc"))
    sigma, n, kn = squeeze_number, polytropic_exponent, knudsen_number
    asked = FilmQuestion(shape, sigma, excursion_ratio, n, kn, slip, tolerance, None)
    one = np.array([sigma]), np.array([excursion_ratio]), np.array([n]), np.array([kn])
    film = Films(*one, slip_law(slip, kn), STRIP if shape == "strip" else DISC)
    small = small_film(film, tolerance) if abs(excursion_ratio) < LARGEST else None
    # The closed form where it is nearer than rounding lets a solve come, or where that fails.
    if small and small[0].met and small[0].error <= compiled().rounding(sigma, n, small[0].over):
        return assembled(asked, *small)
    grid, found = _refined_uniform(film, tolerance)
    if small and small[0].met and not found.met:
        return assembled(asked, *small)
    mirrored = shape == "strip"
    field = extrapolated_field(grid.levels, grid.x, grid.harmonics, n, mirrored=mirrored)
    if excursion_ratio < 0.0:
        found, field = found.later(), field.later()
    return assembled(asked, found, field)


def _refined_uniform(film: Films, tolerance: float) -> tuple[Nested, Found]:
    """One film under a uniform gap of |ε|: on half a strip, or on a disc's radius."""
    u, strip = compiled(), film.shape == STRIP
    film = film._replace(excursion_ratio=np.abs(film.excursion_ratio))
    sigma, eps, n, kn = (float(column[0]) for column in film[:4])
    # A disc of radius R films like a strip about 1.5 R wide.
    wide = sigma * (1.0 if strip else 2.25)
    a = u.edge_grading(wide, eps)

    def solve(resolution: FilmResolution) -> Nested:
        out = np.full((1, u.COLUMNS), np.nan)
        keep = np.empty(u.kept_size(resolution))
        u.solve_rows(0, 1, film, resolution, NEWTON_SHARE * tolerance, out, keep)
        xi = np.linspace(0.0, 1.0, resolution.cells + 1)
        x = (0.5 if strip else 1.0) * xi * (1.0 + a * (1.0 - xi * xi))
        gap = np.repeat(np.array([[1.0], [eps]], dtype=complex), len(x), axis=1)
        return Nested(resolution, x, gap, out[0], levels_of(keep, resolution, True))

    row = (np.array([wide]), film.excursion_ratio, film.knudsen_number)
    c, t = first_guess(*row, tolerance, least_cells=16, least_times=11)
    kind = Kind(wide / (n * (1.0 + 6.0 * kn)), eps, 1, film.shape, UNIFORM_MARGINS, n, sigma)
    return refine(solve, kind, (int(CELLS[c[0]]), int(t[0])), tolerance, int(CELLS[-1]))


@si.checked_numbers
def solve_profile(
    squeeze_number: Annotated[si.Dimensionless, *SQUEEZE_NUMBER],
    profile: GapProfile | Callable[[si.FloatArray, si.FloatArray], ArrayLike],
    *,
    polytropic_exponent: Annotated[si.Dimensionless, *POLYTROPIC_EXPONENT] = 1.0,
    knudsen_number: Annotated[si.Dimensionless, *KNUDSEN_NUMBER] = 0.0,
    slip: str = "first",
    tolerance: Annotated[float, *TOLERANCE] = 5e-3,
    field: bool = True,
) -> FilmSolution:
    """The film of a strip whose gap H(X, T) varies along it, −1/2 ≤ X ≤ 1/2, open at both edges.

    `profile` comes from `flexural_profile` or `profile_from_function`, or is a function H(X, T)
    that broadcasts. σ is on the full length l0 and the reference gap H0 that H is relative to. The
    other inputs, range and errors are those of `solve_uniform`; a gap that closes raises
    `GeometryError`, one that is not periodic `InputError`. Stiffness and damping are relative to
    the largest amplitude of the first harmonic of H (NaN for a gap that does not move). Without
    `field`, the pressure, its mean and the gap are left empty (and stiffness, damping and harmonics
    beyond the mean NaN): for sweeps that want the load alone.
    """
    if not isinstance(profile, GapProfile):
        if not callable(profile):
            raise InputError(
                f"profile of type {type(profile).__name__} cannot be used: give a GapProfile or a "
                f"function H(X, T); of arrays give an interpolator"
            )
        profile = profile_from_function(profile)
    sigma, gas = squeeze_number, FilmGas(polytropic_exponent, knudsen_number, slip).compiled()
    n, kn, _ = gas
    asked = FilmQuestion("profile", sigma, profile.excursion, n, kn, slip, tolerance, profile)
    solvable, factor = enlarged(profile)
    grid, found = _refined_profile(solvable, sigma, gas, tolerance, field)
    shown, mirrored = NO_FIELD, profile.symmetric
    if field:
        shown = extrapolated_field(grid.levels, grid.x, grid.harmonics, n, mirrored=mirrored)
    return assembled(asked, *reduced(found, shown, factor, tolerance))


def _refined_profile(
    profile: GapProfile, sigma: float, gas: CompiledGas, tolerance: float, field: bool
) -> tuple[Nested, Found]:
    """A profile's film: on half of it where it is symmetric, otherwise from edge to edge."""
    from squeezefilm.physics.film.periodic import grids
    from squeezefilm.physics.film.periodic import uniform as u

    announce(grids.solve_nested, "solver of film profiles", 20)
    (n, kn, _), closed, depth = gas, profile.symmetric, profile.depth
    sides, local = 1 if closed else 2, sigma / (n * (1.0 + 6.0 * kn))
    # Rounded, so that a sweep over σ finds its grids again.
    grading = round(float(u.edge_grading(sigma / (1.0 + profile.features) ** 2, depth)), 2)
    aim = tolerance * (NEWTON_SHARE if field else 1.0)

    def solve(resolution: FilmResolution) -> Nested:
        cells, *times = resolution
        x, slope, harmonics = sampled_grid(profile, cells, closed, grading)
        row, over = np.full(u.COLUMNS, np.nan), np.empty(4)
        keep = np.empty(grids.kept_size(resolution) if field else 0)
        mesh = grids.Mesh(slope, np.ones_like(slope), closed)
        at_times, at_checks = (
            grids.gap_rows(harmonics, n, part, load_times(part.number, depth)) for part in times
        )
        room = grids.room_for(resolution)
        row[u.ITERATIONS], row[u.RESIDUAL] = grids.solve_nested(
            sigma, gas, mesh, at_times, at_checks, resolution, aim, room, over, keep
        )
        # Where the gap varies, the coarsest grid sees less of the time error: 3, where a uniform
        # gap takes 2.
        u.judge(over, sigma, local, n, depth, cells // sides, STRIP, 3.0, row)
        levels = levels_of(keep, resolution, closed) if field else []
        return Nested(resolution, x[::2], harmonics[:, ::2], row, levels)

    case = np.array([sigma]), np.array([max(profile.mean_depth, 1e-3)]), np.array([kn])
    c, t = first_guess(
        *case,
        tolerance,
        least_cells=16 if field else 8,
        least_times=2 * profile.orders + 1,
    )
    waves = profile.features * sides / 2.0
    cells = max(int(CELLS[c[0]]), 4 * round(4.0 * waves * (0.01 / tolerance) ** 0.25))
    cells *= sides
    kind = Kind(local, depth, sides, STRIP, PROFILE_MARGINS, n, sigma)
    return refine(solve, kind, (cells, int(t[0])), tolerance, 6000)
