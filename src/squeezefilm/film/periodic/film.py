"""The periodic steady state of a 1-D gas film: strip, disc, or any profile of the gap.

Solves, for one period of the motion, the compressible Reynolds equation

    ∂/∂X (H³ φ P^{1/n} ∂P/∂X) = σ ∂(P^{1/n} H)/∂T,   P = 1 at the edges,

by Fourier collocation in time and finite volumes in space; see `kernel` for the method.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from squeezefilm.errors import ConvergenceError, InputError
from squeezefilm.film.compiled import announce
from squeezefilm.film.periodic.batch import check_film, compiled, solve_all
from squeezefilm.film.periodic.profile import (
    GapProfile,
    evaluate,
    profile_from_function,
    sampled_grid,
)
from squeezefilm.film.periodic.resolution import CELLS, CHECKS, TIMES, first_guess, refined, tables
from squeezefilm.film.slip import slip_law
from squeezefilm.quantities import (
    ComplexArray,
    Dimensionless,
    DimensionlessArray,
    FloatArray,
    checked_numbers,
)

_FIELD_TIMES = 64
_HARMONICS = 8
_MOST_NEWTON = 60
_ROUNDS = 12


@dataclass(frozen=True)
class FilmSolution:
    """One period of a gas film, with the inputs and the model that made it.

    Pressures are relative to ambient, gaps to the reference gap, T = ωt in radians. `position`
    is X = x/l0 from −1/2 to 1/2 for a strip or a profile, r/R from 0 to 1 for a disc.
    `pressure[i, j]` and `gap[i, j]` are at position i and time j; `mean_pressure[i]` is the mean
    over the period. `force_harmonics[k]` are complex: the area mean of P − 1 is
    Re Σ F_k e^{ikT}. F_1 = −(stiffness_relative + i damping_relative)·excursion, so that the
    film pushes back with stiffness and damping of that many p0·A per unit of H0.
    `profile` is None where H = 1 + ε cos T.
    `over_pressure_error` estimates the absolute error of `over_pressure` = W − 1.
    """

    mean_load: Dimensionless
    over_pressure: Dimensionless
    over_pressure_error: Dimensionless
    stiffness_relative: Dimensionless
    damping_relative: Dimensionless
    force_harmonics: ComplexArray
    position: DimensionlessArray
    time: DimensionlessArray
    gap: DimensionlessArray
    pressure: DimensionlessArray
    mean_pressure: DimensionlessArray
    iterations: int
    residual: float
    cells: int
    times: int
    status: str
    model: str
    shape: str
    squeeze_number: Dimensionless
    excursion_ratio: Dimensionless
    polytropic_exponent: Dimensionless
    knudsen_number: Dimensionless
    slip: str
    tolerance: float
    profile: GapProfile | None


@checked_numbers
def solve_strip(
    squeeze_number: Dimensionless,
    excursion_ratio: Dimensionless,
    *,
    polytropic_exponent: Dimensionless = 1.0,
    knudsen_number: Dimensionless = 0.0,
    slip: str = "first",
    tolerance: float = 5e-3,
) -> FilmSolution:
    """The film of an infinitely long strip under H = 1 + ε cos T, open at both edges.

    `squeeze_number` σ = 12 η ω l0²/(p0 H0²) is on the full width l0; `excursion_ratio` is ε.
    `polytropic_exponent` runs from 1 (isothermal) to 5/3; `knudsen_number` is the free path at
    ambient pressure over H0, used locally as Kn/(P H) in the law `slip` (see `flow_factor`).
    `tolerance` is relative, on the over-pressure W − 1; the resolution follows it.

    Checked for σ from 0.01 to 1e4, |ε| to 0.95, n to 1.4, Kn to 0.3. Raises `InputError` for a
    value that no film has (σ ≤ 0, |ε| ≥ 1, NaN …) and `ConvergenceError`, with the partial
    result, where the tolerance is not reached.
    """
    return _solve_uniform(
        "strip", squeeze_number, excursion_ratio, polytropic_exponent, knudsen_number, slip,
        tolerance,
    )  # fmt: skip


@checked_numbers
def solve_disc(
    squeeze_number: Dimensionless,
    excursion_ratio: Dimensionless,
    *,
    polytropic_exponent: Dimensionless = 1.0,
    knudsen_number: Dimensionless = 0.0,
    slip: str = "first",
    tolerance: float = 5e-3,
) -> FilmSolution:
    """The axisymmetric film under a disc, H = 1 + ε cos T, open at the rim.

    As `solve_strip`, with σ = 12 η ω R²/(p0 H0²) on the radius R.
    """
    return _solve_uniform(
        "disc", squeeze_number, excursion_ratio, polytropic_exponent, knudsen_number, slip,
        tolerance,
    )  # fmt: skip


def _solve_uniform(
    shape: str, squeeze_number: float, excursion_ratio: float, polytropic_exponent: float,
    knudsen_number: float, slip: str, tolerance: float,
) -> FilmSolution:  # fmt: skip
    check_film(squeeze_number, excursion_ratio, polytropic_exponent, knudsen_number, tolerance)
    law = slip_law(slip, knudsen_number)
    u = compiled()
    # ε and −ε are half a period apart; zero is solved as nearly zero, which gives the limits of
    # stiffness and damping.
    eps = max(abs(float(excursion_ratio)), 1e-6)
    keep = np.empty(3 * int(CELLS[-1]) // 2 * 200)
    sigma, excursion, n, kn = (
        np.array([float(value)])
        for value in (squeeze_number, eps, polytropic_exponent, knudsen_number)
    )
    out, c, t, met = solve_all(
        shape, sigma, excursion, n, kn, law, tolerance, 1,
        least_cells=16, least_times=11, keep=keep,
    )  # fmt: skip
    row, cells, times = out[0], int(CELLS[c[0]]), int(TIMES[t[0]])
    over, error = float(row[u.OVER]), float(row[u.ERROR])
    ntp = tables(times)[0]
    a = u.edge_grading(float(squeeze_number) * (1.0 if shape == "strip" else 2.25), eps)
    levels = []
    start = 0
    for m in (cells // 2, cells):
        g, vol, share = np.zeros(m + 1), np.zeros(m + 1), np.zeros(m + 1)
        u.grid(m, u.STRIP if shape == "strip" else u.DISC, 1.0, a, g, vol, share)
        p = keep[start : start + m * ntp].reshape(m, ntp)[:, :times]
        levels.append((np.vstack([p, np.zeros(times)]), share))
        start += m * ntp
    xi = np.linspace(0.0, 1.0, cells + 1)
    x = (0.5 if shape == "strip" else 1.0) * xi * (1.0 + a * (1.0 - xi * xi))
    shift = np.pi if excursion_ratio < 0.0 else 0.0
    harmonics = np.zeros((2, len(x)), dtype=complex)
    harmonics[0], harmonics[1] = 1.0, eps
    if excursion_ratio == 0.0:
        over, error = 0.0, 0.0
        met[0] = True
    return _solution(
        levels, harmonics, x, shift, shape == "strip", polytropic_exponent, eps, over, error,
        bool(met[0]), int(row[u.ITERATIONS]), float(row[u.RESIDUAL]), cells, times, shape,
        squeeze_number, excursion_ratio, knudsen_number, slip, tolerance, None,
    )  # fmt: skip


@checked_numbers
def solve_profile(
    squeeze_number: Dimensionless,
    profile: GapProfile | Callable[[FloatArray, FloatArray], ArrayLike],
    *,
    polytropic_exponent: Dimensionless = 1.0,
    knudsen_number: Dimensionless = 0.0,
    slip: str = "first",
    tolerance: float = 5e-3,
    field: bool = True,
) -> FilmSolution:
    """The film of a strip whose gap H(X, T) varies along it, −1/2 ≤ X ≤ 1/2, open at both edges.

    `profile` comes from `flexural_profile`, `profile_from_samples` or `profile_from_function`, or
    is a function H(X, T) that broadcasts. σ is on the full length l0 and the reference gap H0
    that H is relative to. The other inputs, range and errors are those of `solve_strip`; a gap
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
    law = slip_law(slip, knudsen_number)
    from squeezefilm.film.periodic import uniform as u
    from squeezefilm.film.periodic.varying import solve_varying

    announce(solve_varying, "solver of film profiles", 20)
    closed = profile.symmetric
    sigma, n, kn = float(squeeze_number), float(polytropic_exponent), float(knudsen_number)
    c, t = first_guess(
        np.array([sigma]), np.array([max(profile.mean_depth, 1e-3)]), np.array([kn]), tolerance,
        least_cells=8, least_times=2 * profile.orders + 1,
    )  # fmt: skip
    waves = profile.features / (2.0 if closed else 1.0)
    cells = max(int(CELLS[c[0]]), 4 * round(4.0 * waves * (0.01 / tolerance) ** 0.25))
    if not closed:
        cells = 2 * cells
    # Rounded, so that a sweep over σ finds its grids again.
    grading = round(float(u.edge_grading(sigma / (1.0 + profile.features) ** 2, profile.depth)), 2)
    out = np.full(u.COLUMNS, np.nan)
    iterations = 0
    met = False
    for _ in range(_ROUNDS):
        times = int(TIMES[t[0]])
        check = int(CHECKS[t[0]])
        x, slope, harmonics = sampled_grid(profile, cells, closed, grading)
        even, odd = np.ascontiguousarray(harmonics.real), np.ascontiguousarray(-harmonics.imag)
        ntp = tables(times)[0]
        keep = np.empty((cells + 1 + cells // 2 + 1) * ntp)
        solve_varying(
            sigma, profile.depth, n, kn, law, closed, cells, slope, even, odd, tolerance,
            times, *tables(times), load_times(times, profile.depth),
            check, *tables(check), load_times(check, profile.depth),
            _MOST_NEWTON, out, keep,
        )  # fmt: skip
        iterations += int(out[u.ITERATIONS])
        allowed = tolerance * abs(out[u.OVER])
        met = bool(out[u.ERROR] <= allowed) or bool(abs(out[u.OVER]) < 1e-15)
        if met or cells > 6000:
            break
        some = np.zeros(1, dtype=np.int64)
        more, t2 = refined(
            some, t, out[u.SPACE : u.SPACE + 1], out[u.TIME : u.TIME + 1],
            np.array([max(allowed, 1e-300) if np.isfinite(allowed) else 1e-300]),
        )  # fmt: skip
        if more[0] > 0:
            ratio = max(out[u.SPACE] / allowed / 0.5, 1.0) ** 0.25
            cells = 4 * round(cells * min(max(1.3, ratio), 4.0) / 4)
        elif t2[0] == t[0]:
            break
        t = t2
    levels: list[tuple[FloatArray, FloatArray]] = []
    start = 0
    for m in (cells // 2, cells) if field else ():
        unknowns = m if closed else m - 1
        p = keep[start : start + unknowns * ntp].reshape(unknowns, ntp)[:, :times]
        start = (cells // 2 + 1) * ntp
        edge = np.zeros((1, times))
        p = np.vstack([p, edge]) if closed else np.vstack([edge, p, edge])
        share = slope[:: 2 * cells // m] * ((2.0 if closed else 1.0) / m)
        share *= 1.0 if closed else 2.0
        share[[0, -1]] *= 0.5
        levels.append((p, share))
    return _solution(
        levels, harmonics[:, ::2], x[::2], 0.0, closed, n, profile.excursion, float(out[u.OVER]),
        float(out[u.ERROR]), met, iterations, float(out[u.RESIDUAL]), cells, times, "profile",
        squeeze_number, profile.excursion, knudsen_number, slip, tolerance, profile,
    )  # fmt: skip


def load_times(times: int, depth: float) -> int:
    """How many times the load integral over 1/H needs for a relative error below 1e-10.

    The harmonics of 1/H fall like r^k with r = ε/(1 + √(1 − ε²)).
    """
    ratio = depth / (1.0 + np.sqrt(1.0 - min(depth, 0.999) ** 2))
    decades = np.log(1e-10) / np.log(max(ratio, 1e-3))
    return int(times // 2 + 8 + decades)


def _solution(
    levels: list[tuple[FloatArray, FloatArray]], harmonics: ComplexArray, x: FloatArray,
    shift: float, mirrored: bool, n: float, excursion: float, over: float, error: float,
    met: bool, iterations: int, residual: float, cells: int, times: int, shape: str,
    squeeze_number: float, excursion_ratio: float, knudsen_number: float, slip: str,
    tolerance: float, profile: GapProfile | None,
) -> FilmSolution:  # fmt: skip
    """Assemble the result from p on the two finer grids, extrapolated like the load."""
    if levels:
        T, gap, fine, spectrum = _field(levels, harmonics, times, n)
    else:
        x, T, gap, fine = np.empty(0), np.empty(0), np.empty((0, 0)), np.empty((0, 0))
        spectrum = np.full(_HARMONICS + 1, complex(np.nan, np.nan))
        mirrored = False
    count = len(T)
    turn = np.exp(1j * np.arange(_HARMONICS + 1) * shift)
    force_harmonics = np.zeros(_HARMONICS + 1, dtype=complex)
    available = min(_HARMONICS + 1, len(spectrum))
    force_harmonics[:available] = spectrum[:available]
    force_harmonics *= turn
    force_harmonics[0] = over
    if shift:
        fine = np.roll(fine, -count // 2, axis=1)
        gap = np.roll(gap, -count // 2, axis=1)
    if mirrored:
        x = np.concatenate([-x[:0:-1], x])
        fine = np.concatenate([fine[:0:-1], fine])
        gap = np.concatenate([gap[:0:-1], gap])
    first = spectrum[1] / excursion if excursion > 0.0 else complex(np.nan, np.nan)
    if excursion_ratio == 0.0 and shape != "profile":
        force_harmonics[:] = 0.0
        fine[:] = 0.0
        gap[:] = 1.0
    name = "isothermal" if n == 1.0 else f"polytropic (n = {n:g})"
    law = f"slip {slip} at local Kn" if knudsen_number > 0.0 else "no slip"
    if met:
        status = (
            f"converged: over-pressure {over:.4g} within {error:.1g} with {cells} cells and "
            f"{times} times in {iterations} Newton steps"
        )
    else:
        status = (
            f"not converged: over-pressure {over:.4g} is only known within {error:.1g}, asked was "
            f"{tolerance:g} of it; {cells} cells, {times} times, {iterations} Newton steps"
        )
    solution = FilmSolution(
        mean_load=1.0 + over,
        over_pressure=over,
        over_pressure_error=error,
        stiffness_relative=float(-first.real),
        damping_relative=float(-first.imag),
        force_harmonics=force_harmonics,
        position=x,
        time=T,
        gap=gap,
        pressure=1.0 + fine,
        mean_pressure=1.0 + (fine.mean(axis=1) if levels else x),
        iterations=iterations,
        residual=residual,
        cells=cells,
        times=times,
        status=status,
        model=f"periodic compressible Reynolds film, {name}, {law}",
        shape=shape,
        squeeze_number=float(squeeze_number),
        excursion_ratio=float(excursion_ratio),
        polytropic_exponent=float(n),
        knudsen_number=float(knudsen_number),
        slip=slip,
        tolerance=tolerance,
        profile=profile,
    )
    if not met:
        raise ConvergenceError(
            f"the film with squeeze_number {squeeze_number:.4g} and excursion_ratio "
            f"{excursion_ratio:.4g} did not converge: {status}. Ask a larger tolerance",
            partial=solution,
            residual=residual,
            iterations=iterations,
        )
    return solution


def _field(
    levels: list[tuple[FloatArray, FloatArray]], harmonics: ComplexArray, times: int, n: float
) -> tuple[FloatArray, FloatArray, FloatArray, ComplexArray]:
    """Times, gap, P − 1 on the finest grid, and the harmonics of the area mean of P − 1."""
    count = max(_FIELD_TIMES, 2 * times)
    T = 2.0 * np.pi * np.arange(count) / count
    nodes = 2.0 * np.pi * np.arange(times) / times
    gap_nodes, gap = evaluate(harmonics, nodes), evaluate(harmonics, T)
    coarse, share_coarse = levels[0]
    p, share = levels[1]
    powered = gap**n

    def resampled(values: FloatArray, every: int) -> FloatArray:
        psi = values * gap_nodes[::every] ** n
        spectrum = np.zeros((len(psi), count // 2 + 1), dtype=complex)
        spectrum[:, : times // 2 + 1] = np.fft.rfft(psi, axis=1) * (count / times)
        return np.asarray(np.fft.irfft(spectrum, count, axis=1)) / powered[::every]

    fine, rough = resampled(p, 1), resampled(coarse, 2)
    force = share @ fine
    force += (force - share_coarse @ rough) / 3.0
    spectrum = np.fft.rfft(force) / count
    spectrum[1:] *= 2.0
    correction = (fine[::2] - rough) / 3.0
    index = np.arange(len(fine)) / 2.0
    lower = np.floor(index).astype(int)
    upper = np.minimum(lower + 1, len(correction) - 1)
    fine = fine + 0.5 * (correction[lower] + correction[np.where(index > lower, upper, lower)])
    return T, gap, fine, spectrum
