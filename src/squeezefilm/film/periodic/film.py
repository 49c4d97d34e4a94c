"""The periodic steady state of a 1-D gas film: strip, disc, or any profile of the gap.

Solves, for one period of the motion, the compressible Reynolds equation

    ∂/∂X (H³ φ P^{1/n} ∂P/∂X) = σ ∂(P^{1/n} H)/∂T,   P = 1 at the edges,

by Fourier collocation in time and finite volumes in space; see `kernel` for the method.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from squeezefilm import quantities as si
from squeezefilm.compiled import announce
from squeezefilm.errors import InputError
from squeezefilm.film.gas import Aim, Gas, slip_law
from squeezefilm.film.periodic.batch import (
    MOST_NEWTON,
    ROUNDS,
    check_film,
    compiled,
    solve_all,
)
from squeezefilm.film.periodic.profile import GapProfile, profile_from_function, sampled_grid
from squeezefilm.film.periodic.records import Resolution
from squeezefilm.film.periodic.resolution import (
    CELLS,
    TIMES,
    collocation_times,
    first_guess,
    refined,
    resolution_of,
)
from squeezefilm.film.periodic.solution import Asked, FilmSolution, Found, assembled


@si.checked_numbers
def solve_uniform(
    squeeze_number: si.Dimensionless,
    excursion_ratio: si.Dimensionless,
    *,
    shape: str = "strip",
    polytropic_exponent: si.Dimensionless = 1.0,
    knudsen_number: si.Dimensionless = 0.0,
    slip: str = "first",
    tolerance: float = 5e-3,
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
    asked = Asked(shape, sigma, excursion_ratio, n, kn, slip, tolerance, None)
    check_film(sigma, excursion_ratio, n, kn, tolerance)
    law = slip_law(slip, kn)
    u, strip = compiled(), shape == "strip"
    kind = u.STRIP if strip else u.DISC
    # ε and −ε are half a period apart; zero is solved as nearly zero, which gives the limits of
    # stiffness and damping.
    eps = max(abs(excursion_ratio), 1e-6)
    keep = np.empty(3 * int(CELLS[-1]) // 2 * 200)
    one = np.array([[sigma], [eps], [n], [kn]], dtype=float)
    films = u.Films(*one, law, kind)
    out, c, t, met = solve_all(films, tolerance, 1, least_cells=16, least_times=11, keep=keep)
    row, cells, times = out[0], int(CELLS[c[0]]), int(TIMES[t[0]])
    over, error = float(row[u.OVER]), float(row[u.ERROR])
    ntp = collocation_times(times).row
    a = u.edge_grading(sigma * (1.0 if strip else 2.25), eps)
    levels = []
    start = 0
    for m in (cells // 2, cells):
        g, vol, share = np.zeros(m + 1), np.zeros(m + 1), np.zeros(m + 1)
        u.grid(m, kind, 1.0, a, g, vol, share)
        p = keep[start : start + m * ntp].reshape(m, ntp)[:, :times]
        levels.append((np.vstack([p, np.zeros(times)]), share))
        start += m * ntp
    xi = np.linspace(0.0, 1.0, cells + 1)
    x = (0.5 if strip else 1.0) * xi * (1.0 + a * (1.0 - xi * xi))
    shift = np.pi if excursion_ratio < 0.0 else 0.0
    harmonics = np.zeros((2, len(x)), dtype=complex)
    harmonics[0], harmonics[1] = 1.0, eps
    if excursion_ratio == 0.0:
        over, error = 0.0, 0.0
        met[0] = True
    steps, residual = int(row[u.ITERATIONS]), float(row[u.RESIDUAL])
    found = Found(over, error, bool(met[0]), steps, residual, cells, times)
    return assembled(asked, found, levels, harmonics, x, shift, strip, eps)


@si.checked_numbers
def solve_profile(
    squeeze_number: si.Dimensionless,
    profile: GapProfile | Callable[[si.FloatArray, si.FloatArray], ArrayLike],
    *,
    polytropic_exponent: si.Dimensionless = 1.0,
    knudsen_number: si.Dimensionless = 0.0,
    slip: str = "first",
    tolerance: float = 5e-3,
    field: bool = True,
) -> FilmSolution:
    """The film of a strip whose gap H(X, T) varies along it, −1/2 ≤ X ≤ 1/2, open at both edges.

    `profile` comes from `flexural_profile`, `profile_from_samples` or `profile_from_function`, or
    is a function H(X, T) that broadcasts. σ is on the full length l0 and the reference gap H0
    that H is relative to. The other inputs, range and errors are those of `solve_uniform`; a gap
    that closes raises `GeometryError`, one that is not periodic `InputError`. Stiffness and
    damping are relative to the largest amplitude of the first harmonic of H (NaN for a gap
    that does not move). Without `field`, the pressure, its mean and the gap are left empty (and
    stiffness, damping and harmonics beyond the mean NaN): for sweeps that want the load alone.
    """
    if not isinstance(profile, GapProfile):
        if not callable(profile):
            raise InputError(
                f"profile of type {type(profile).__name__} cannot be used: give a GapProfile or a "
                f"function H(X, T); for arrays use profile_from_samples"
            )
        profile = profile_from_function(profile)
    check_film(squeeze_number, 0.0, polytropic_exponent, knudsen_number, tolerance)
    sigma = float(squeeze_number)
    gas = Gas(float(polytropic_exponent), float(knudsen_number), slip_law(slip, knudsen_number))
    grid, found = _refined_profile(profile, sigma, gas, tolerance)
    closed, excursion = profile.symmetric, profile.excursion
    n, kn = gas.polytropic_exponent, gas.knudsen_number
    asked = Asked("profile", sigma, excursion, n, kn, slip, tolerance, profile)
    levels = grid.levels(closed) if field else []
    return assembled(
        asked, found, levels, grid.harmonics[:, ::2], grid.x[::2], 0.0, closed, excursion
    )


class _ProfileGrid(NamedTuple):
    """A profile on one grid and what was solved there: X, dX/dξ and the gap's harmonics at nodes
    and faces, the result row, and p on the two finer grids, one after the other."""

    resolution: Resolution
    x: si.FloatArray
    slope: si.FloatArray
    harmonics: si.ComplexArray
    row: si.FloatArray
    keep: si.FloatArray

    def levels(self, closed: bool) -> list[tuple[si.FloatArray, si.FloatArray]]:
        """p at the nodes of the two finer grids, edges included, and their shares of the area."""
        cells, times = self.resolution.cells, self.resolution.times
        levels: list[tuple[si.FloatArray, si.FloatArray]] = []
        start = 0
        for m in (cells // 2, cells):
            unknowns = m if closed else m - 1
            p = self.keep[start : start + unknowns * times.row].reshape(unknowns, times.row)
            p = p[:, : times.number]
            start = (cells // 2 + 1) * times.row
            edge = np.zeros((1, times.number))
            p = np.vstack([p, edge]) if closed else np.vstack([edge, p, edge])
            share = self.slope[:: 2 * cells // m] * ((2.0 if closed else 1.0) / m)
            share *= 1.0 if closed else 2.0
            share[[0, -1]] *= 0.5
            levels.append((p, share))
        return levels


def _refined_profile(
    profile: GapProfile, sigma: float, gas: Gas, tolerance: float
) -> tuple[_ProfileGrid, Found]:
    """Solve and refine until the tolerance is met, or nothing more is to be gained."""
    from squeezefilm.film.periodic import uniform as u
    from squeezefilm.film.periodic.varying import solve_varying

    announce(solve_varying, "solver of film profiles", 20)
    c, t = first_guess(
        np.array([sigma]),
        np.array([max(profile.mean_depth, 1e-3)]),
        np.array([gas.knudsen_number]),
        tolerance,
        least_cells=8,
        least_times=2 * profile.orders + 1,
    )
    waves = profile.features / (2.0 if profile.symmetric else 1.0)
    cells = max(int(CELLS[c[0]]), 4 * round(4.0 * waves * (0.01 / tolerance) ** 0.25))
    if not profile.symmetric:
        cells = 2 * cells
    # Rounded, so that a sweep over σ finds its grids again.
    grading = round(float(u.edge_grading(sigma / (1.0 + profile.features) ** 2, profile.depth)), 2)
    iterations = 0
    for turn in range(1, ROUNDS + 1):
        grid = _on_grid(profile, sigma, gas, resolution_of(cells, int(t[0])), grading, tolerance)
        out = grid.row
        iterations += int(out[u.ITERATIONS])
        allowed = tolerance * abs(out[u.OVER])
        met = bool(out[u.ERROR] <= allowed) or bool(abs(out[u.OVER]) < 1e-15)
        if met or cells > 6000 or turn == ROUNDS:
            break  # what is given back is of the grid that was solved
        some = np.zeros(1, dtype=np.int64)
        more, t2 = refined(
            some,
            t,
            out[u.SPACE : u.SPACE + 1],
            out[u.TIME : u.TIME + 1],
            np.array([max(allowed, 1e-300) if np.isfinite(allowed) else 1e-300]),
        )
        if more[0] > 0:
            ratio = max(out[u.SPACE] / allowed / 0.5, 1.0) ** 0.25
            cells = 4 * round(cells * min(max(1.3, ratio), 4.0) / 4)
        elif t2[0] == t[0]:
            break
        t = t2
    over, error, residual = (float(out[column]) for column in (u.OVER, u.ERROR, u.RESIDUAL))
    times = grid.resolution.times.number
    return grid, Found(over, error, met, iterations, residual, grid.resolution.cells, times)


def _on_grid(
    profile: GapProfile,
    sigma: float,
    gas: Gas,
    resolution: Resolution,
    grading: float,
    tolerance: float,
) -> _ProfileGrid:
    """The film over a profile on one grid."""
    from squeezefilm.film.periodic.uniform import COLUMNS
    from squeezefilm.film.periodic.varying import Profile, solve_varying

    closed, depth, cells = profile.symmetric, profile.depth, resolution.cells
    x, slope, harmonics = sampled_grid(profile, cells, closed, grading)
    even, odd = np.ascontiguousarray(harmonics.real), np.ascontiguousarray(-harmonics.imag)
    row = np.full(COLUMNS, np.nan)
    keep = np.empty((cells + 1 + cells // 2 + 1) * resolution.times.row)
    solve_varying(
        sigma,
        gas,
        Profile(slope, even, odd, depth, closed),
        resolution,
        (load_times(resolution.times.number, depth), load_times(resolution.check.number, depth)),
        Aim(tolerance, MOST_NEWTON),
        row,
        keep,
    )
    return _ProfileGrid(resolution, x, slope, harmonics, row, keep)


def load_times(times: int, depth: float) -> int:
    """How many times the load integral over 1/H needs for a relative error below 1e-10.

    The harmonics of 1/H fall like r^k with r = ε/(1 + √(1 − ε²)).
    """
    ratio = depth / (1.0 + np.sqrt(1.0 - min(depth, 0.999) ** 2))
    decades = np.log(1e-10) / np.log(max(ratio, 1e-3))
    return int(times // 2 + 8 + decades)
