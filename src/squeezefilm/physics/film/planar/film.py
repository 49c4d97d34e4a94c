"""The periodic film in the plane: rectangle, disc, ellipse, with waves, ridges, open grooves.

Solves ∇·(H³ φ P^{1/n} ∇P) = σ ∂(P^{1/n}H)/∂T with P = 1 on the boundary, periodic in T, by
harmonic balance on boundary-fitted grids. P = p/p0, H = h/H0, lengths over the reference length l0.

A film is solved on a ladder of grids. Space is second order, so two rungs extrapolate to fourth
(Richardson), and two extrapolants bound the error. Time converges geometrically; four more points
on the coarsest rung give the correction for the harmonics left out.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import announce
from squeezefilm.core.errors import ConvergenceError, InputError
from squeezefilm.core.hard_limits import PLANAR_MEMORY, require_within
from squeezefilm.physics.film.gas import ISOTHERMAL, SQUEEZE_NUMBER, FilmGas
from squeezefilm.physics.film.periodic.nested import steadied
from squeezefilm.physics.film.periodic.solution import SolvedFilm
from squeezefilm.physics.film.planar.balance import Balance, Balancer, Film, resampled, row_block
from squeezefilm.physics.film.planar.grid import (
    PlanarGap,
    PlanarGrid,
    disc_grid,
    ellipse_grid,
    gap_values,
    graded_line,
    rectangle_grid,
    refined_line,
)

PlanarShape = Literal["rectangle", "disc", "ellipse"]
RUNGS = (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)
_MOST_HARMONICS = 24
_LEAST_TIMES = 9  # of the two counts that a climb begins with, the larger


class Ladder:
    """The grids of one shape, finer and finer, all images of one smooth map."""

    def __init__(self, shape: PlanarShape, aspect: float, film: Film) -> None:
        self.shape, self.aspect, self.film = shape, aspect, film
        self._grids: dict[int, PlanarGrid] = {}
        gap = film.gap
        ridges = gap.ridge_wave_number if gap.ridge_height > 0.0 else 0.0
        waves = max(2.0 * gap.wave_number, 1.5 * ridges) / (2 * np.pi)
        if shape == "rectangle":
            # `waves` periods over the whole length, three cells each and rung.
            self._base = (max(2, int(np.ceil(waves))), 2)
        else:
            around = max(1, int(np.ceil(2 * waves)))
            self._base = (max(2, around), around)
        rows, columns = sorted((part * RUNGS[0] for part in self._base), reverse=True)
        require_within(
            PLANAR_MEMORY, _memory(rows, columns, _LEAST_TIMES), enough="take fewer waves or ridges"
        )

    def relative_excursion(self) -> float:
        """The largest swing of the gap over its mean at the same place."""
        grid = self.grid(RUNGS[0])
        H = gap_values(self.film.gap, grid.X, 2 * np.pi * np.arange(16) / 16)
        mean = H.mean(axis=1, keepdims=True)
        return float((np.abs(H - mean) / mean).max())

    def grid(self, rung: int) -> PlanarGrid:
        """The grid of one rung, made once."""
        if rung not in self._grids:
            self._grids[rung] = self._make(rung)
        return self._grids[rung]

    def _make(self, rung: int) -> PlanarGrid:
        counts = self._base[0] * rung, self._base[1] * rung
        sigma, gap = self.film.squeeze_number, self.film.gap
        # Under a gap that varies the pressure has shape inside too, and the edge must not take
        # all the cells.
        least = 0.15 if gap.wave_number > 0.0 or gap.ridge_height > 0.0 else 2e-3
        if self.shape == "disc":
            return disc_grid(sigma, counts, least=least)
        if self.shape == "ellipse":
            return ellipse_grid(self.aspect, sigma, counts, least=least)
        x = refined_line(graded_line(counts[0], 0.5, sigma, least), gap.mean)
        # Along a long side the share is one of the short side.
        y = graded_line(counts[1], self.aspect / 2, sigma, least / max(1.0, self.aspect))
        return rectangle_grid(x, y)


@dataclass(frozen=True)
class Extrapolated:
    """Estimate by two or three rungs together of the over-pressure and the harmonics of the force,
    `amplitudes` (9,), and how far each may be off."""

    amplitudes: si.ComplexArray
    errors: si.FloatArray

    @property
    def over_pressure(self) -> float:
        """W − 1."""
        return float(self.amplitudes[0].real)

    def lacking(self) -> float:
        """The larger of the mean's error relative to it and that of the worst harmonic relative to
        the largest."""
        size = np.abs(self.amplitudes)
        size[1:] = size[1:].max()
        return float((self.errors / size).max())


@dataclass(frozen=True)
class Climb:
    """The end of a climb over the rungs: the best value and the state on the finest grid."""

    best: Extrapolated
    fine: Balance
    iterations: int
    reached: bool
    status: str


def _memory(rows: float, columns: float, count: int) -> float:
    """Bytes of the eliminated rows: a dense block each."""
    return rows * 8.0 * (columns * count) ** 2


def climb_to(ladder: Ladder, tolerance: float) -> Climb:
    """Climb until the over-pressure is known to `tolerance` of itself, or to the last rung."""
    climber = _Climber(ladder, tolerance)
    times = climber.in_time()
    if times.enough:
        return climber.in_space(times)
    high, count = times.high, times.low.gas.shape[1]
    status = f"stopped: {count // 2} harmonics in time are too few or Newton's method failed"
    best = Extrapolated(high.amplitudes, np.abs(times.correction))
    return Climb(best, high, climber.iterations, False, status)


@dataclass(frozen=True)
class _Times:
    """The coarsest rung with some times and with four more, and the doubt (in over-pressure and
    harmonics) that their difference leaves; whether that is `enough`."""

    low: Balance
    high: Balance
    doubt: si.FloatArray
    enough: bool

    @property
    def correction(self) -> si.ComplexArray:
        """Correction by the harmonics of the gas that are left out."""
        return self.high.amplitudes - self.low.amplitudes


@dataclass
class _Climber:
    """A climb under way: how far Newton's method is driven, and the steps it took so far."""

    ladder: Ladder
    tolerance: float
    accuracy: float = 1e-7
    iterations: int = 0

    def solved(self, rung: int, count: int, start: si.FloatArray | None) -> Balance:
        """Solve a rung at `count` times, from a start."""
        grid = self.ladder.grid(rung)
        state = _solve_or_continue(self.ladder.film, grid, count, start, self.accuracy)
        self.iterations += state.iterations
        return state

    def in_time(self) -> _Times:
        """Add times on the coarsest rung until four more change little enough."""
        excursion = self.ladder.relative_excursion()
        count = 2 * int(np.ceil(1.5 + 2.5 * excursion + 3.0 * excursion**6)) + 1
        coarsest = self.ladder.grid(RUNGS[0])
        require_within(
            PLANAR_MEMORY,
            _memory(coarsest.rows, coarsest.columns, count + 4),
            enough="take fewer waves or ridges",
        )
        low = self.solved(RUNGS[0], count, None)
        if low.converged:
            # Newton's error must stay well below what the extrapolation looks at.
            least = 1e-3 * self.tolerance * abs(low.over_pressure)
            self.accuracy = float(np.clip(least, 1e-13, 1e-7))
            low = self.solved(RUNGS[0], count, low.gas)
        before = np.zeros(len(low.amplitudes))
        while True:
            guess = resampled(low.gas, count + 4) if low.converged else None
            high = self.solved(RUNGS[0], count + 4, guess)
            correction = np.abs(high.amplitudes - low.amplitudes)
            # Harmonics converge geometrically, but with changes of sign: one small step may be
            # chance.
            doubt = np.maximum(correction, 0.3 * before)
            known = Extrapolated(high.amplitudes, doubt).lacking() <= 0.5 * self.tolerance
            enough = high.converged and known
            if enough or count + 4 > 2 * _MOST_HARMONICS:
                return _Times(low, high, doubt, enough)
            count, low, before = count + 4, high, correction

    def in_space(self, times: _Times) -> Climb:
        """Climb the rungs above the coarsest with the times that were enough there."""
        tolerance, count = self.tolerance, times.low.gas.shape[1]
        states = [times.low]
        best = Extrapolated(times.high.amplitudes, np.full(len(times.doubt), np.inf))
        for place, rung in enumerate(RUNGS[1:], start=1):
            grid = self.ladder.grid(rung)
            nodes = f"{grid.rows} × {grid.columns} nodes"
            if _memory(grid.rows, grid.columns, count) > PLANAR_MEMORY.most:
                known = f"known to {best.lacking():.2g} of the over-pressure and the force"
                status = f"{known}; {tolerance:.2g} would take more memory than allowed"
                return Climb(best, states[-1], self.iterations, False, status)
            states.append(self.solved(rung, count, _moved(self.ladder.film, states[-1], grid)))
            if not states[-1].converged:
                status = f"stopped: Newton's method failed on {nodes}"
                return Climb(best, states[-1], self.iterations, False, status)
            if place < 2:
                continue
            value, error = _richardson([state.amplitudes for state in states])
            value, error = value + times.correction, error + times.doubt + 1e-13
            error[1:] = steadied(error, np.abs(value))[1:]
            best = Extrapolated(value, error)
            mean = float(error[0] / abs(value[0]))
            if best.lacking() <= tolerance:
                reached = f"{mean:.1g} of the over-pressure"
                known = f"solved to {reached}, the force to {best.lacking():.1g},"
                status = f"{known} on {nodes} at {count} times"
                return Climb(best, states[-1], self.iterations, True, status)
        status = f"known to {best.lacking():.2g} of the over-pressure and the force only"
        return Climb(best, states[-1], self.iterations, False, status)


def _richardson(rungs: list[si.ComplexArray]) -> tuple[si.ComplexArray, si.FloatArray]:
    """Extrapolation from the last two rungs of over-pressure and harmonics, with errors in
    space."""

    def extrapolated(place: int) -> si.ComplexArray:
        gain = (RUNGS[place] / RUNGS[place - 1]) ** 2 - 1.0
        return np.asarray(rungs[place] + (rungs[place] - rungs[place - 1]) / gain)

    place = len(rungs) - 1
    value, before = extrapolated(place), extrapolated(place - 1)
    earlier = extrapolated(place - 2) if place > 2 else before
    # Extrapolants of fourth order on grids 1.3 to 1.5 times finer differ by 0.5 to 4 times the
    # error left; the other terms are for those that agree by chance.
    trend = np.maximum(0.8 * np.abs(value - before), 0.2 * np.abs(before - earlier))
    chance = 0.06 if place == 2 else 0.03
    return value, np.asarray(trend + chance * np.abs(value - rungs[-1]))


def _moved(film: Film, state: Balance, grid: PlanarGrid) -> si.FloatArray:
    """The gas of `state` on another grid of the same map: P^{1/n} = m/H is smooth in space."""
    from scipy.ndimage import zoom

    count = state.gas.shape[1]
    T = 2 * np.pi * np.arange(count) / count
    old = state.grid
    ratio = state.gas / gap_values(film.gap, old.X, T)
    field = ratio.reshape(old.rows, old.columns, count)
    finer = (grid.rows / old.rows, grid.columns / old.columns, 1)
    field = zoom(field, finer, order=1, mode="nearest", grid_mode=True)
    return field.reshape(-1, count) * gap_values(film.gap, grid.X, T)


def _solve_or_continue(
    film: Film, grid: PlanarGrid, count: int, start: si.FloatArray | None, accuracy: float
) -> Balance:
    """Newton's method; where it fails, by way of smaller motions about the same mean gap."""
    state = Balancer(film, grid, count).solve(start, accuracy)
    if state.converged:
        return state
    gap = film.gap
    spent, gas = state.iterations, None
    for part in (0.25, 0.5, 0.7, 0.85, 0.95, 1.0):
        smaller = replace(gap, excursion_ratio=part * gap.excursion_ratio)
        eased = replace(film, gap=smaller)
        state = Balancer(eased, grid, count).solve(gas, accuracy if part == 1.0 else 1e-3)
        spent += state.iterations
        gas = state.gas if state.converged else None
    return replace(state, iterations=spent)


@dataclass(frozen=True)
class FilmPlanar(SolvedFilm):
    """The periodic state of a film in the plane.

    `force_harmonics` (8,) begin with k = 1. `mean_pressure` is the period's mean at the nodes `X`,
    `Y` of the finest grid, with their `area`, all (nodes,) = rows × columns, of the quarter X ≥ 0,
    Y ≥ 0 of a symmetric film. `residual` is the last relative change of the gas.
    """

    X: si.DimensionlessArray
    Y: si.DimensionlessArray
    area: si.DimensionlessArray
    mean_pressure: si.DimensionlessArray
    rows: int
    columns: int
    time_points: int
    shape: PlanarShape
    aspect_ratio: si.Dimensionless
    gap: PlanarGap
    squeeze_number: si.Dimensionless
    polytropic_exponent: si.Dimensionless
    knudsen_number: si.Dimensionless
    slip: str
    tolerance: si.Dimensionless


@si.checked_numbers
def solve_planar(
    shape: PlanarShape,
    gap: PlanarGap,
    squeeze_number: Annotated[si.Dimensionless, *SQUEEZE_NUMBER],
    *,
    aspect_ratio: Annotated[si.Dimensionless, si.Above(0.0)] = 1.0,
    gas: FilmGas = ISOTHERMAL,
    tolerance: Annotated[si.Dimensionless, si.AtLeast(1e-5), si.AtMost(0.5)] = 5e-3,
) -> FilmPlanar:
    """The periodic film under a gap, to `tolerance` of W − 1.

    `shape`: "rectangle" (X ∈ [−½, ½], Y ∈ [−aspect/2, aspect/2]), "disc" (R ≤ 1) or "ellipse"
    (X² + (Y/aspect)² ≤ 1); `squeeze_number` on the length that is 1 there.

    Raises `InputError` for values out of range, `GeometryError` where the gap closes,
    `ConvergenceError` (with the best state had) where Newton's method does not converge or the
    tolerance would take more memory than 2 GB. Holds for isothermal (1) to adiabatic (1.4)
    viscous flow; slip by the local Knudsen number Kn/(PH). The tolerance is on the over-pressure,
    down to 1e-5 of it, and on every harmonic of the force, relative to the largest of them.
    Sources: Gross (1962); Blech, 10.1115/1.3254692 for the linear limit.
    """
    if shape == "disc" and aspect_ratio != 1.0:
        raise InputError(f"a disc has aspect_ratio 1, not {aspect_ratio}; ask for an ellipse")
    announce(row_block, "film solver in the plane", 3)
    film = Film(gap, float(squeeze_number), gas.compiled())
    ladder = Ladder(shape, float(aspect_ratio), film)
    climb = climb_to(ladder, float(tolerance))
    result = _assembled(ladder, climb, gas, tolerance)
    if not climb.reached:
        raise ConvergenceError(
            f"the film in the plane was {climb.status}",
            partial=result,
            residual=climb.fine.residual,
            iterations=climb.iterations,
        )
    return result


def _assembled(ladder: Ladder, climb: Climb, gas: FilmGas, tolerance: float) -> FilmPlanar:
    """The result, from where a climb of the ladder ended."""
    best, fine = climb.best, climb.fine
    gap = ladder.film.gap
    first = best.amplitudes[1] / gap.excursion_ratio
    return FilmPlanar(
        mean_load=1.0 + best.over_pressure,
        over_pressure=best.over_pressure,
        over_pressure_error=float(best.errors[0]),
        stiffness_relative=-float(first.real),
        damping_relative=-float(first.imag),
        force_error=float(best.errors[1]) / gap.excursion_ratio,
        force_harmonics=best.amplitudes[1:],
        force_harmonics_error=best.errors[1:],
        X=fine.grid.X,
        Y=fine.grid.Y,
        area=fine.grid.area,
        mean_pressure=fine.mean_pressure,
        rows=fine.grid.rows,
        columns=fine.grid.columns,
        time_points=fine.gas.shape[1],
        iterations=climb.iterations,
        residual=fine.residual,
        status=climb.status,
        shape=ladder.shape,
        aspect_ratio=ladder.aspect,
        gap=gap,
        squeeze_number=ladder.film.squeeze_number,
        polytropic_exponent=gas.polytropic_exponent,
        knudsen_number=gas.knudsen_number,
        slip=gas.slip,
        tolerance=tolerance,
    )
