"""Load balance: the gap at which a vibrating film carries a load, and the most it can carry."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, OutOfRangeError, UnreachableError
from squeezefilm.physics.film.line_grid import Shape
from squeezefilm.physics.film.periodic.batch import FilmBatch, solve_films

MAX_EXCURSION = 0.95
"""The deepest excursion the balance uses; the least gap is then 5 % of the mean gap."""

_MIN_EXCURSION = 1e-3
_SEARCHED = 24
"""Excursion ratios at which the load is looked for first."""
_STEPS = 30


@si.checked_numbers
@dataclass(frozen=True)
class VibratedFilm:
    """A film of fixed size and motion, whatever its mean gap h0: amplitude a (m, zero to peak),
    frequency (Hz), full width of a strip or radius of a disc (m), the gas, and its free path at
    ambient pressure (m; 0: no slip).

    Raises `InputError` for what no film has.
    """

    amplitude: Annotated[si.Metre, si.Above(0.0)]
    frequency: Annotated[si.Hertz, si.Above(0.0)]
    length: Annotated[si.Metre, si.Above(0.0)]
    viscosity: Annotated[si.PascalSecond, si.Above(0.0)] = 1.81e-5
    ambient_pressure: Annotated[si.Pascal, si.Above(0.0)] = 101325.0
    polytropic_exponent: si.Dimensionless = 1.0
    mean_free_path: Annotated[si.Metre, si.AtLeast(0.0)] = 0.0
    slip: str = "first"
    shape: Shape = "strip"


@dataclass(frozen=True)
class LoadBalance:
    """The mean gap at which a film carries a load, and the film there.

    `mean_load_pressure` is the mean over-pressure of the film over area and period, in Pa, with
    its estimated error; `static_stiffness` is −d(load)/d(mean gap), in Pa/m.
    """

    mean_gap: si.Metre
    mean_gap_error: si.Metre
    least_gap: si.Metre
    mean_load_pressure: si.Pascal
    mean_load_pressure_error: si.Pascal
    static_stiffness: float
    squeeze_number: si.Dimensionless
    excursion_ratio: si.Dimensionless
    knudsen_number: si.Dimensionless
    load: si.Pascal
    film: VibratedFilm
    model: str
    iterations: int
    status: str


def _squeeze_number(film: VibratedFilm, excursion_ratio: si.FloatArray) -> si.FloatArray:
    """σ = 12 η ω l²/(p0 h0²) at ε = a/h0."""
    scale = 12.0 * film.viscosity * 2.0 * math.pi * film.frequency * film.length**2
    scale = scale / (film.ambient_pressure * film.amplitude**2)
    return np.asarray(scale * excursion_ratio**2)


def _solved(
    film: VibratedFilm, excursion_ratio: si.FloatArray, tolerance: float, *, strict: bool = True
) -> FilmBatch:
    return solve_films(
        _squeeze_number(film, excursion_ratio),
        excursion_ratio,
        shape=film.shape,
        polytropic_exponent=film.polytropic_exponent,
        knudsen_number=film.mean_free_path * excursion_ratio / film.amplitude,
        slip=film.slip,
        tolerance=tolerance,
        workers=1,
        strict=strict,
    )


@si.checked_numbers
def mean_gap_for_load(
    film: VibratedFilm,
    load: Annotated[si.Pascal, si.Above(0.0)],
    *,
    tolerance: Annotated[float, si.AtLeast(1e-6), si.AtMost(0.1)] = 1e-3,
) -> LoadBalance:
    """The mean gap h0 at which a vibrated film carries a mean pressure load.

    Solves p0 (W(σ, ε) − 1) = load for h0, with ε = a/h0; the over-pressure falls steadily with h0.
    `tolerance` is relative, on the load. Searched for 0.001 ≤ ε ≤ 0.95.

    Raises `InputError` for values that no film has and `UnreachableError` for a load above what
    the film carries at ε = 0.95 or below that at ε = 0.001. As ε → 1 the load grows without bound;
    what ends levitation is contact of the asperities.
    """
    grid, rough = _searched(film, load, tolerance)
    found = _balanced(film, load, grid, rough, tolerance)
    eps, slope = float(found.excursion_ratio[1]), found.slope
    gap, solves = film.amplitude / eps, _SEARCHED + found.solves
    pressure = float(found.films.over_pressure[1]) * film.ambient_pressure
    error = float(found.films.over_pressure_error[1]) * film.ambient_pressure
    return LoadBalance(
        mean_gap=gap,
        mean_gap_error=gap * (abs(found.miss) + error / pressure) / slope,
        least_gap=gap - film.amplitude,
        mean_load_pressure=pressure,
        mean_load_pressure_error=error,
        static_stiffness=pressure * slope / gap,
        squeeze_number=float(_squeeze_number(film, found.excursion_ratio[1])),
        excursion_ratio=eps,
        knudsen_number=film.mean_free_path / gap,
        load=load,
        film=film,
        model=found.films.model,
        iterations=solves,
        status=(
            f"balanced: {si.format_quantity(pressure, si.Unit('Pa'))} at a mean gap of "
            f"{si.format_quantity(gap, si.Unit('m'))} after {solves} film solves"
        ),
    )


def _searched(
    film: VibratedFilm, load: float, tolerance: float
) -> tuple[si.FloatArray, si.FloatArray]:
    """Rising excursion ratios between which the load (Pa) is carried, and rough over-pressures
    there; raises `UnreachableError` for none."""
    wanted = load / film.ambient_pressure
    grid = np.geomspace(_MIN_EXCURSION, MAX_EXCURSION, _SEARCHED)
    # At the faint end of the grid the over-pressure can drown in round-off: leave that out.
    first = _solved(film, grid, 0.02, strict=False)
    usable = first.over_pressure_error <= 0.05 * first.over_pressure
    if np.count_nonzero(usable) < 2:
        raise OutOfRangeError(
            "the film carries so little that its load is lost in rounding; take a larger "
            "amplitude, frequency or length, or a shorter mean free path"
        )
    grid, rough = grid[usable], first.over_pressure[usable]
    ends = rough[[0, -1]].copy()
    ends[1] = _solved(film, grid[-1:], 0.5 * tolerance).over_pressure[0]
    if not ends[0] <= wanted <= ends[1]:
        which, at = ("more", 1) if wanted > ends[1] else ("less", 0)
        gap = film.amplitude / grid[[0, -1]][at]
        raise UnreachableError(
            f"load = {si.format_quantity(load, si.Unit('Pa'))} is {which} than the film carries at "
            f"excursion_ratio {grid[[0, -1]][at]:g} (mean gap "
            f"{si.format_quantity(gap, si.Unit('m'))}): "
            f"{si.format_quantity(ends[at] * film.ambient_pressure, si.Unit('Pa'))}. Change the "
            "amplitude, the frequency or the length"
        )
    return grid, rough


@dataclass(frozen=True)
class _Balanced:
    """Films at three excursion ratios, the middle one of which carries the load but for `miss` (in
    its logarithm), and d ln(over-pressure)/d ln ε between them."""

    excursion_ratio: si.FloatArray
    films: FilmBatch
    slope: float
    miss: float
    solves: int


def _balanced(
    film: VibratedFilm, load: float, grid: si.FloatArray, rough: si.FloatArray, tolerance: float
) -> _Balanced:
    """The secant in logarithms inside a bracket: the over-pressure is nearly a power of ε there."""
    aim = math.log(load / film.ambient_pressure)
    k = int(np.clip(np.searchsorted(rough, load / film.ambient_pressure) - 1, 0, len(grid) - 2))
    low, high = math.log(grid[max(k - 1, 0)]), math.log(grid[min(k + 2, len(grid) - 1)])
    points = np.log(grid[[k, k + 1]])
    values = np.log(rough[[k, k + 1]])
    guess = float(points[0] + (aim - values[0]) * np.diff(points)[0] / np.diff(values)[0])
    step = 0.02
    for turn in range(1, _STEPS + 1):
        guess = min(max(guess, low), high)
        near = np.minimum(np.exp([guess - 0.5 * step, guess, guess + 0.5 * step]), MAX_EXCURSION)
        batch = _solved(film, near, 0.3 * tolerance)
        logs = np.log(batch.over_pressure)
        slope = float((logs[2] - logs[0]) / np.log(near[2] / near[0]))
        miss = aim - float(logs[1])
        if abs(miss) <= 0.3 * tolerance:
            return _Balanced(near, batch, slope, miss, 3 * turn)
        if miss > 0.0:
            low = max(low, guess)
        else:
            high = min(high, guess)
        ahead = guess + miss / slope
        guess = ahead if low <= ahead <= high else 0.5 * (low + high)
        step = min(step, max(abs(ahead - guess), 2e-3))
    raise ConvergenceError(
        f"the load balance missed {si.format_quantity(load, si.Unit('Pa'))} by a factor "
        f"{math.exp(miss):.6g} after {_STEPS} steps; ask a larger tolerance",
        partial=batch,
        residual=abs(miss),
        iterations=_STEPS,
    )
