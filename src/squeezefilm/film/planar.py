"""The periodic film in the plane: rectangle, disc, ellipse, with waves, ridges, open grooves.

Solves ∇·(H³ φ P^{1/n} ∇P) = σ ∂(P^{1/n}H)/∂T with P = 1 on the boundary, periodic in T, by
harmonic balance on boundary-fitted grids. The over-pressure is extrapolated from a ladder of
grids (second order, Richardson) and corrected for the number of harmonics on the coarsest; both
give the error estimate. P = p/p0, H = h/H0, lengths over the reference length l0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from squeezefilm.errors import ConvergenceError, InputError
from squeezefilm.film.mobility import SlipModel, slip_code
from squeezefilm.film.planar_balance import Balance, Balancer, Film, resampled
from squeezefilm.film.planar_gap import GapFunction, PlanarGap, gap_values, require_periodic
from squeezefilm.film.planar_grid import (
    PlanarGrid,
    disc_grid,
    ellipse_grid,
    graded_line,
    rectangle_grid,
    refined_line,
)
from squeezefilm.quantities import (
    ComplexArray,
    Dimensionless,
    DimensionlessArray,
    FloatArray,
    require,
)

PlanarShape = Literal["rectangle", "disc", "ellipse"]

_LADDER = (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64)
_MOST_HARMONICS = 24
_MEMORY = 2.0e9
"""Bytes the eliminated rows may take."""


@dataclass(frozen=True)
class FilmPlanar:
    """The periodic state of a film in the plane.

    `mean_load` W = ⟨P⟩ over surface and period, `over_pressure` W − 1 and its estimated absolute
    error; `stiffness_relative` fk and `damping_relative` fd: the first harmonic of the force is
    −(fk + i fd) p0 A ε, ε being the largest first harmonic of the gap; `force_harmonics` (8,) the
    complex amplitudes F_k of W(T) = W + Re Σ F_k e^{ikT}. `mean_pressure` is the period's mean at
    the nodes `X`, `Y` of the finest grid, with their `area`, all (nodes,) = rows × columns; on a
    `quarter` they cover X ≥ 0, Y ≥ 0 of a symmetric film. `residual` is the last relative change
    of the gas in Newton's method.
    """

    mean_load: Dimensionless
    over_pressure: Dimensionless
    over_pressure_error: Dimensionless
    stiffness_relative: Dimensionless
    damping_relative: Dimensionless
    force_harmonics: ComplexArray
    X: DimensionlessArray
    Y: DimensionlessArray
    area: DimensionlessArray
    mean_pressure: DimensionlessArray
    rows: int
    columns: int
    quarter: bool
    time_points: int
    iterations: int
    residual: Dimensionless
    status: str
    shape: PlanarShape
    aspect_ratio: Dimensionless
    gap: GapFunction
    squeeze_number: Dimensionless
    polytropic_exponent: Dimensionless
    knudsen_number: Dimensionless
    slip_model: SlipModel
    tolerance: Dimensionless


def solve_rectangle(
    squeeze_number: Dimensionless,
    excursion_ratio: Dimensionless,
    aspect_ratio: Dimensionless = 1.0,
    *,
    wave_number: Dimensionless = 0.0,
    ridge_height: Dimensionless = 0.0,
    ridge_wave_number: Dimensionless = 0.0,
    polytropic_exponent: Dimensionless = 1.0,
    knudsen_number: Dimensionless = 0.0,
    slip_model: SlipModel = "first_order",
    tolerance: Dimensionless = 5e-3,
) -> FilmPlanar:
    """The periodic film under X ∈ [−½, ½], Y ∈ [−aspect/2, aspect/2], all sides open.

    `squeeze_number` σ = 12 η ω l0²/(p0 H0²) is on the side along X (length l0). The gap is
    H = 1 + ε cos(k1 X) cos T + δ cos(k2 X) (see `PlanarGap`); grooves run along Y and are open at
    its ends. For the rest see `solve_planar`.
    """
    gap = PlanarGap(excursion_ratio, wave_number, ridge_height, ridge_wave_number)
    return solve_planar(
        "rectangle", gap, squeeze_number, aspect_ratio=aspect_ratio,
        polytropic_exponent=polytropic_exponent, knudsen_number=knudsen_number,
        slip_model=slip_model, tolerance=tolerance,
    )  # fmt: skip


def solve_ellipse(
    squeeze_number: Dimensionless,
    excursion_ratio: Dimensionless,
    aspect_ratio: Dimensionless = 1.0,
    *,
    wave_number: Dimensionless = 0.0,
    ridge_height: Dimensionless = 0.0,
    ridge_wave_number: Dimensionless = 0.0,
    polytropic_exponent: Dimensionless = 1.0,
    knudsen_number: Dimensionless = 0.0,
    slip_model: SlipModel = "first_order",
    tolerance: Dimensionless = 5e-3,
) -> FilmPlanar:
    """The periodic film under the ellipse X² + (Y/aspect)² ≤ 1, such as a finger pad.

    `squeeze_number` is on the semi-axis along X; `aspect_ratio` is the semi-axis along Y over it.
    The gap is H = 1 + ε cos(k1 X) cos T + δ cos(k2 X). For the rest see `solve_planar`.
    """
    gap = PlanarGap(excursion_ratio, wave_number, ridge_height, ridge_wave_number)
    return solve_planar(
        "ellipse", gap, squeeze_number, aspect_ratio=aspect_ratio,
        polytropic_exponent=polytropic_exponent, knudsen_number=knudsen_number,
        slip_model=slip_model, tolerance=tolerance,
    )  # fmt: skip


def solve_planar(
    shape: PlanarShape,
    gap: GapFunction,
    squeeze_number: Dimensionless,
    *,
    aspect_ratio: Dimensionless = 1.0,
    symmetric: bool | None = None,
    cells: tuple[int, int] | None = None,
    polytropic_exponent: Dimensionless = 1.0,
    knudsen_number: Dimensionless = 0.0,
    slip_model: SlipModel = "first_order",
    tolerance: Dimensionless = 5e-3,
) -> FilmPlanar:
    """The periodic film under any gap H(X, Y, T) of period 2π, to `tolerance` of W − 1.

    `shape`: "rectangle" (X ∈ [−½, ½], Y ∈ [−aspect/2, aspect/2]), "disc" (R ≤ 1) or "ellipse"
    (X² + (Y/aspect)² ≤ 1); `squeeze_number` on the length that is 1 there. `gap(X, Y, T)` takes
    arrays (places, 1) and (1, times). `symmetric` says that the gap is even in X and in Y, so
    that a quarter is enough (a `PlanarGap` always is). `cells` are those of the coarsest grid
    along X and Y (radius and angle), for gaps with features that the solver cannot know of.

    Raises `InputError` for values out of range, `GeometryError` where the gap closes,
    `ConvergenceError` (with the best state had) where Newton's method does not converge or the
    tolerance would take more memory than 2 GB. Holds for isothermal (1) to adiabatic (1.4)
    viscous flow; slip by the local Knudsen number Kn/(PH). The tolerance is on the over-pressure,
    down to 1e-5 of it. Sources: Gross (1962); Blech, 10.1115/1.3254692 for the linear limit.
    """
    require("squeeze_number", squeeze_number, above=0.0)
    require("aspect_ratio", aspect_ratio, above=0.0)
    require("polytropic_exponent", polytropic_exponent, at_least=1.0, at_most=2.0)
    require("knudsen_number", knudsen_number, at_least=0.0)
    require("tolerance", tolerance, at_least=1e-5, at_most=0.5)
    if shape not in ("rectangle", "disc", "ellipse"):
        raise InputError(f"shape = '{shape}' is not known; allowed: rectangle, disc, ellipse")
    if shape == "disc" and aspect_ratio != 1.0:
        raise InputError(f"a disc has aspect_ratio 1, not {aspect_ratio}; ask for an ellipse")
    quarter = isinstance(gap, PlanarGap) if symmetric is None else symmetric
    film = Film(
        gap, float(squeeze_number), float(polytropic_exponent), float(knudsen_number),
        slip_code(knudsen_number, slip_model),
    )  # fmt: skip
    ladder = _Ladder(shape, float(aspect_ratio), film, quarter, cells)
    require_periodic(gap, ladder.grid(_LADDER[0]).X, ladder.grid(_LADDER[0]).Y)
    climb = _climb(ladder, float(tolerance))
    best, fine = climb.best, climb.fine
    first = best.harmonics[0] / ladder.excursion
    result = FilmPlanar(
        mean_load=1.0 + best.over_pressure,
        over_pressure=best.over_pressure,
        over_pressure_error=best.error,
        stiffness_relative=-float(first.real),
        damping_relative=-float(first.imag),
        force_harmonics=best.harmonics,
        X=fine.grid.X,
        Y=fine.grid.Y,
        area=fine.grid.area,
        mean_pressure=fine.mean_pressure,
        rows=fine.grid.rows,
        columns=fine.grid.columns,
        quarter=quarter,
        time_points=fine.gas.shape[1],
        iterations=climb.iterations,
        residual=fine.residual,
        status=climb.status,
        shape=shape,
        aspect_ratio=aspect_ratio,
        gap=gap,
        squeeze_number=squeeze_number,
        polytropic_exponent=polytropic_exponent,
        knudsen_number=knudsen_number,
        slip_model=slip_model,
        tolerance=tolerance,
    )
    if not climb.reached:
        raise ConvergenceError(
            f"the film in the plane was {climb.status}",
            partial=result,
            residual=fine.residual,
            iterations=climb.iterations,
        )
    return result


class _Ladder:
    """The grids of one shape, finer and finer, all images of one smooth map."""

    def __init__(
        self,
        shape: PlanarShape,
        aspect: float,
        film: Film,
        quarter: bool,
        cells: tuple[int, int] | None,
    ) -> None:
        self.shape, self.aspect, self.film, self.quarter = shape, aspect, film, quarter
        self._grids: dict[int, PlanarGrid] = {}
        gap = film.gap
        waves = 0.0
        if isinstance(gap, PlanarGap):
            ridges = gap.ridge_wave_number if gap.ridge_height > 0.0 else 0.0
            waves = max(2.0 * gap.wave_number, 1.5 * ridges) / (2 * np.pi)
        if cells is not None:
            require("cells", np.array(cells), at_least=2)
            # Even, because the full ellipse joins opposite columns.
            self._base = (cells[0] / 2, 2 * round(cells[1] / 4) or 1)
        elif shape == "rectangle":
            # `waves` periods over the whole length, three cells each and rung.
            along = max(2, int(np.ceil(waves)))
            self._base = (along, 2) if quarter else (2 * along, 4)
        else:
            out = max(2, int(np.ceil(2 * waves)))
            around = max(1, int(np.ceil(2 * waves)))
            self._base = (out, around) if quarter else (out, 4 * around)
        self.excursion = self._excursion()

    def _excursion(self) -> float:
        if isinstance(self.film.gap, PlanarGap):
            return self.film.gap.excursion_ratio
        grid = self.grid(_LADDER[0])
        T = 2 * np.pi * np.arange(16) / 16
        H = gap_values(self.film.gap, grid.X, grid.Y, T)
        first = float(np.abs(np.fft.rfft(H, axis=1)[:, 1]).max() / 8)
        if first == 0.0:
            raise InputError("the gap has no first harmonic in T, so nothing drives the film")
        return first

    def relative_excursion(self) -> float:
        """The largest swing of the gap over its mean at the same place."""
        grid = self.grid(_LADDER[0])
        H = gap_values(self.film.gap, grid.X, grid.Y, 2 * np.pi * np.arange(16) / 16)
        mean = H.mean(axis=1, keepdims=True)
        return float((np.abs(H - mean) / mean).max())

    def grid(self, rung: int) -> PlanarGrid:
        if rung not in self._grids:
            self._grids[rung] = self._make(rung)
        return self._grids[rung]

    def _make(self, rung: int) -> PlanarGrid:
        counts = (round(self._base[0] * rung), round(self._base[1] * rung))
        sigma = self.film.squeeze_number
        if self.shape == "disc":
            return disc_grid(sigma, counts, quarter=self.quarter)
        if self.shape == "ellipse":
            return ellipse_grid(self.aspect, sigma, counts, quarter=self.quarter)
        x = graded_line(counts[0], 0.5, sigma, mirror=not self.quarter)
        x = refined_line(x, lambda X: self._mean_gap(X, 0.0 * X))
        y = graded_line(counts[1], self.aspect / 2, sigma, mirror=not self.quarter)
        y = refined_line(y, lambda Y: self._mean_gap(0.0 * Y, Y))
        return rectangle_grid(x, y, quarter=self.quarter)

    def _mean_gap(self, X: FloatArray, Y: FloatArray) -> FloatArray:
        T = 2 * np.pi * np.arange(4) / 4
        return np.asarray(gap_values(self.film.gap, X, Y, T).mean(axis=1))


@dataclass(frozen=True)
class _Best:
    over_pressure: float
    error: float
    harmonics: ComplexArray


@dataclass(frozen=True)
class _Climb:
    best: _Best
    fine: Balance
    iterations: int
    reached: bool
    status: str


def _climb(ladder: _Ladder, tolerance: float) -> _Climb:
    # Newton's error must stay well below what the extrapolation looks at.
    accuracy = min(1e-6, 1e-3 * tolerance)
    iterations = 0

    def solved(rung: int, count: int, start: FloatArray | None) -> Balance:
        nonlocal iterations
        state = _solve_or_continue(ladder.film, ladder.grid(rung), count, start, accuracy)
        iterations += state.iterations
        return state

    excursion = ladder.relative_excursion()
    count = 2 * int(np.ceil(1.5 + 2.5 * excursion + 3.0 * excursion**6)) + 1
    low = solved(_LADDER[0], count, None)
    correction = 0.0
    while True:
        guess = resampled(low.gas, count + 4) if low.converged else None
        high = solved(_LADDER[0], count + 4, guess)
        before, correction = correction, high.over_pressure - low.over_pressure
        # Harmonics converge geometrically, but with changes of sign: one small step may be chance.
        doubt = max(abs(correction), 0.3 * abs(before))
        if high.converged and doubt <= 0.5 * tolerance * abs(high.over_pressure):
            break
        if count + 4 > 2 * _MOST_HARMONICS:
            status = f"stopped: {count // 2} harmonics in time are too few or Newton's method failed"
            best = _Best(high.over_pressure, abs(correction), high.harmonics)
            return _Climb(best, high, iterations, False, status)
        count, low = count + 4, high
    shift = high.harmonics - low.harmonics

    states = [low]
    best = _Best(high.over_pressure, float("inf"), high.harmonics)
    for place, rung in enumerate(_LADDER[1:], start=1):
        grid = ladder.grid(rung)
        if grid.rows * (8.0 * grid.columns * count) * (grid.columns * count) > _MEMORY:
            return _Climb(
                best, states[-1], iterations, False,
                f"known to {best.error / abs(best.over_pressure):.2g} of the over-pressure; "
                f"{tolerance:.2g} would take more memory than allowed",
            )  # fmt: skip
        states.append(solved(rung, count, _moved(ladder.film, states[-1], grid)))
        if not states[-1].converged:
            status = f"stopped: Newton's method failed on {grid.rows} × {grid.columns} nodes"
            return _Climb(best, states[-1], iterations, False, status)
        if place < 2:
            continue
        now, last = _richardson(states, place), _richardson(states, place - 1)
        value = now[0] + correction
        # Extrapolants of fourth order on grids 1.3 to 1.5 times finer differ by a factor of
        # 0.5 to 4 of the error left; the last term is for those that agree by chance.
        error = (
            0.7 * abs(now[0] - last[0])
            + 0.05 * abs(now[0] - states[-1].over_pressure)
            + doubt
            + 1e-12
        )
        best = _Best(value, error, now[1] + shift)
        if error <= tolerance * abs(value):
            status = (
                f"solved to {error / abs(value):.1g} of the over-pressure on "
                f"{grid.rows} × {grid.columns} nodes at {count} times"
            )
            return _Climb(best, states[-1], iterations, True, status)
    status = f"known to {best.error / abs(best.over_pressure):.2g} of the over-pressure only"
    return _Climb(best, states[-1], iterations, False, status)


def _richardson(states: list[Balance], place: int) -> tuple[float, ComplexArray]:
    gain = (_LADDER[place] / _LADDER[place - 1]) ** 2 - 1.0
    fine, coarse = states[place], states[place - 1]
    return (
        fine.over_pressure + (fine.over_pressure - coarse.over_pressure) / gain,
        fine.harmonics + (fine.harmonics - coarse.harmonics) / gain,
    )


def _moved(film: Film, state: Balance, grid: PlanarGrid) -> FloatArray:
    """The gas of `state` on another grid of the same map: P^{1/n} = m/H is smooth in space."""
    count = state.gas.shape[1]
    T = 2 * np.pi * np.arange(count) / count
    old = state.grid
    ratio = state.gas / gap_values(film.gap, old.X, old.Y, T)
    field = ratio.reshape(old.rows, old.columns, count)
    field = _stretched(_stretched(field, 0, grid.rows), 1, grid.columns)
    return field.reshape(-1, count) * gap_values(film.gap, grid.X, grid.Y, T)


def _stretched(field: FloatArray, axis: int, size: int) -> FloatArray:
    have = field.shape[axis]
    at = np.clip((np.arange(size) + 0.5) * have / size - 0.5, 0.0, have - 1.0)
    left = np.minimum(at.astype(np.int64), max(have - 2, 0))
    part = (at - left).reshape([-1 if a == axis else 1 for a in range(field.ndim)])
    right = np.minimum(left + 1, have - 1)
    return np.asarray(
        (1.0 - part) * np.take(field, left, axis) + part * np.take(field, right, axis)
    )


def _solve_or_continue(
    film: Film, grid: PlanarGrid, count: int, start: FloatArray | None, accuracy: float
) -> Balance:
    """Newton's method; where it fails, by way of smaller motions about the same mean gap."""
    state = Balancer(film, grid, count).solve(start, accuracy)
    if state.converged:
        return state
    gap = film.gap
    T = 2 * np.pi * np.arange(16) / 16
    spent, gas = state.iterations, None
    for part in (0.25, 0.5, 0.7, 0.85, 0.95, 1.0):

        def smaller(
            X: FloatArray, Y: FloatArray, t: FloatArray, part: float = part
        ) -> FloatArray:
            mean = np.mean([gap(X, Y, np.full((1, 1), s)) for s in T], axis=0)
            return np.asarray(mean + part * (gap(X, Y, t) - mean))

        eased = Film(
            smaller if part < 1.0 else gap, film.squeeze_number, film.polytropic_exponent,
            film.knudsen_number, film.slip,
        )  # fmt: skip
        state = Balancer(eased, grid, count).solve(gas, accuracy if part == 1.0 else 1e-3)
        spent += state.iterations
        gas = state.gas if state.converged else None
    from dataclasses import replace

    return replace(state, iterations=spent)
