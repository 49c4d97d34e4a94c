"""Marching to the periodic state: the mean load a vibrating film settles to.

The slowest mode of a film of large squeeze number takes some σ/10 periods to settle, so the map
of one period onto the next is accelerated (Anderson mixing); its fixed point is the same.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import announce
from squeezefilm.core.errors import ConvergenceError
from squeezefilm.physics.film.gas import ISOTHERMAL, FilmGas, require_film
from squeezefilm.physics.film.line_grid import Gap, Shape, gap_table, line_grid, mean_over
from squeezefilm.physics.film.transient.kernel import Gaps, Line, Pace, Track, march
from squeezefilm.physics.film.transient.march import (
    NEWTON,
    SCHEMES,
    MovedFilm,
    Scheme,
    stage_times,
)

_MEMORY = 8
"""Periods the acceleration remembers."""
_LEAST_CHANGE = 1e-14
"""Less than rounding leaves no march reaches."""


@dataclass(frozen=True)
class FilmSettled(MovedFilm):
    """The periodic state a march settles into.

    `mean_load` W is the period's mean, `over_pressure` W − 1, `over_pressure_error` its estimated
    absolute error (infinite where one resolution was asked for). `load` W(T) at `time` (steps,)
    and the period's mean `pressure` at `position` (cells,) are those of the finest grid;
    `mean_load` is extrapolated from the two finest. `residual` is the largest relative change of
    the gas in a cell over the last period, `mass_residual` the gas lost over it, relative to the
    gas held.
    """

    mean_load: si.Dimensionless
    over_pressure: si.Dimensionless
    over_pressure_error: si.Dimensionless
    time: si.DimensionlessArray
    load: si.DimensionlessArray
    position: si.DimensionlessArray
    pressure: si.DimensionlessArray
    residual: si.Dimensionless
    mass_residual: si.Dimensionless
    periods: int
    iterations: int
    cells: int
    steps: int
    status: str


class _Mixer:
    """Anderson mixing of a map's iterates: from x and G(x), the next x to try."""

    def __init__(self) -> None:
        self._x: list[si.FloatArray] = []
        self._f: list[si.FloatArray] = []

    def next(self, x: si.FloatArray, image: si.FloatArray) -> si.FloatArray:
        self._x.append(x)
        self._f.append((image - x).ravel())
        del self._x[: -_MEMORY - 1], self._f[: -_MEMORY - 1]
        if len(self._x) == 1:
            return image
        dX = np.diff(np.array([row.ravel() for row in self._x]), axis=0).T
        dF = np.diff(np.array(self._f), axis=0).T
        weights = np.linalg.lstsq(dF, self._f[-1], rcond=1e-12)[0]
        mixed = image - ((dX + dF) @ weights).reshape(x.shape)
        # A mixture far off the map's own answer comes from a memory that no longer fits.
        if np.all((mixed > 0.5 * image) & (mixed < 2.0 * image)):
            return np.asarray(mixed)
        self._x.clear()
        self._f.clear()
        return image


@si.checked_numbers
def settle_to_periodic(
    gap: Gap,
    squeeze_number: si.Dimensionless,
    *,
    shape: Shape = "strip",
    tolerance: Annotated[si.Dimensionless, si.AtLeast(1e-9)] | None = 1e-3,
    cells: Annotated[int, si.AtLeast(4)] = 24,
    steps: Annotated[int, si.AtLeast(4)] = 32,
    gas: FilmGas = ISOTHERMAL,
    scheme: Scheme = "bdf2",
    accelerate: bool = True,
    settled: Annotated[si.Dimensionless, si.AtLeast(_LEAST_CHANGE)] = 1e-10,
    max_periods: Annotated[int, si.AtLeast(1)] = 2000,
    max_cells: int = 1600,
) -> FilmSettled:
    """The periodic state of the film under a gap H(X, T) of period 2π, by marching in time.

    `squeeze_number` σ is on the full length of the strip (X from −½ to ½) or the disc's radius.
    Starts with `cells` and `steps` a period and doubles both until the over-pressure, Richardson
    extrapolated, is known to `tolerance` (relative to the over-pressure); `tolerance=None` takes
    the one resolution as it is. A period counts as settled when it changes the gas in no cell by
    more than `settled` (relative). Second order in time and space (`backward_euler`: first in
    time, and no extrapolation).

    Raises `InputError`, `GeometryError` (a gap that closes), and `ConvergenceError` with the
    best state had where the march does not settle or `max_cells` do not reach the tolerance.
    Holds for isothermal (1) to adiabatic (1.4) viscous flow at any σ and excursion below 1.
    """
    require_film(squeeze_number, gas.polytropic_exponent, gas.knudsen_number)
    announce(march, "film solver in time", 4)
    asked = _Settling(gap, squeeze_number, shape, gas, scheme, accelerate, settled, max_periods)
    history: list[FilmSettled] = []
    guess: tuple[si.FloatArray, si.FloatArray] | None = None
    while True:
        result, guess = _settle(asked, cells, steps, guess)
        history.append(result)
        if tolerance is None:
            return result
        if len(history) > 1:
            best = _extrapolated(history)
            if best.over_pressure_error <= tolerance * abs(best.over_pressure):
                return best
        if 2 * cells > max_cells:
            best = _extrapolated(history) if len(history) > 1 else result
            raise ConvergenceError(
                f"{cells} cells give the over-pressure {best.over_pressure:.4g} to "
                f"{best.over_pressure_error:.2g}, not to the {tolerance:.2g} of it asked for; "
                "raise max_cells or tolerance",
                partial=best,
                residual=best.over_pressure_error,
                iterations=best.periods,
            )
        cells, steps = 2 * cells, 2 * steps


def _extrapolated(history: list[FilmSettled]) -> FilmSettled:
    coarse, fine = history[-2].mean_load, history[-1].mean_load
    if history[-1].scheme == "backward_euler":
        return replace(history[-1], over_pressure_error=2.0 * abs(fine - coarse))
    W = fine + (fine - coarse) / 3.0
    # Two grids cannot tell whether the order is reached; three can.
    error = abs(W - fine)
    if len(history) > 2:
        before = coarse + (coarse - history[-3].mean_load) / 3.0
        error = min(error, max(abs(W - before) / 2, abs(W - fine) / 16))
    error += 1e-12
    return replace(history[-1], mean_load=W, over_pressure=W - 1.0, over_pressure_error=error)


@dataclass(frozen=True)
class _Settling(MovedFilm):
    """What is to settle, and how."""

    accelerate: bool
    settled: float
    max_periods: int


@dataclass(frozen=True)
class _Settled:
    """Where a march ended: the gas held now and, for `bdf2`, a step before (rows × cells), the
    largest relative change of the last period, the gas lost over it, and the effort."""

    gas: si.FloatArray
    change: float
    lost: float
    periods: int
    iterations: int


def _settle(
    asked: _Settling, cells: int, steps: int, guess: tuple[si.FloatArray, si.FloatArray] | None
) -> tuple[FilmSettled, tuple[si.FloatArray, si.FloatArray]]:
    """The film on one grid, and its gas there as a guess for the next; raises `ConvergenceError`
    with that film where it does not settle."""
    sigma, gas = asked.squeeze_number, asked.gas
    grid = line_grid(asked.shape, cells, sigma, mean_over(asked.gap, np.pi / 4 * np.arange(8.0)))
    stages = stage_times(asked.scheme)
    dt = 2 * np.pi / steps
    at = ((np.arange(steps)[:, None] + stages) * dt).ravel()
    gaps = Gaps(gap_table(asked.gap, grid.centre, at), gap_table(asked.gap, grid.face, at))
    if guess is None:
        x = _rough(gaps.cell, stages.size, gas.polytropic_exponent, min(1.0, sigma / 30.0))
    else:
        x = np.stack([np.interp(grid.centre, guess[0], row) for row in guess[1]])
    track = Track(np.empty(steps), np.empty((steps, cells)), np.arange(steps))
    line = Line(grid.volume, grid.conductance)
    ended = _marched(asked, x if asked.scheme == "bdf2" else x[:1], gaps, line, track)
    W = float(track.load.mean())
    good = ended.change <= asked.settled
    result = FilmSettled(
        mean_load=W,
        over_pressure=W - 1.0,
        over_pressure_error=float("inf"),
        time=dt * np.arange(1.0, steps + 1),
        load=track.load,
        position=grid.centre,
        pressure=track.field.mean(axis=0),
        residual=ended.change,
        mass_residual=abs(ended.lost) / float(grid.volume @ ended.gas[0]),
        periods=ended.periods,
        iterations=ended.iterations,
        cells=cells,
        steps=steps,
        status=(
            f"settled in {ended.periods} periods of {steps} steps on {cells} cells"
            if good
            else f"did not settle in {ended.periods} periods (change {ended.change:.2g} a period)"
        ),
        **asked.given,
    )
    if result.residual > asked.settled:
        raise ConvergenceError(
            f"the film {result.status}; allow more periods (now {asked.max_periods})",
            partial=result,
            residual=result.residual,
            iterations=result.periods,
        )
    return result, (grid.centre, ended.gas[:2])


def _rough(H: si.FloatArray, stages: int, n: float, part: float) -> si.FloatArray:
    """The gas to start from, now and a step before: `part` of the way from gas at rest to gas that
    cannot follow, whose m is constant in time, so that ⟨H³ P^{1/n} ∂P⟩ = 0 gives its value."""
    mean = (np.mean(H**3, axis=0) / np.mean(H ** (2 - n), axis=0)) ** (1 / (n + 1))
    still = H[-1]
    return np.stack([still + (mean - still) * part, H[-1 - stages] * (1 - part) + mean * part])


def _marched(asked: _Settling, x: si.FloatArray, gaps: Gaps, line: Line, track: Track) -> _Settled:
    """March period after period from the gas `x` until it repeats, or the periods are spent."""
    steps = track.load.size
    pace = Pace(2 * np.pi / steps, float(asked.squeeze_number), SCHEMES[asked.scheme])
    gas, mixer = asked.gas.compiled(), _Mixer()
    change, lost, iterations, periods = np.inf, 0.0, 0, 0
    while periods < asked.max_periods:
        periods += 1
        m, before = x[0].copy(), x[-1].copy()
        lost, _, made, done = march(m, before, gaps, line, pace, gas, NEWTON, track)
        iterations += made
        if done < steps:
            change = float("inf")
            break
        image = np.stack([m, before])[: x.shape[0]]
        change = float(np.max(np.abs(image / x - 1.0)))
        if change <= asked.settled:
            x = image
            break
        x = mixer.next(x, image) if asked.accelerate else image
    return _Settled(x, change, lost, periods, iterations)
