"""The film in time: any gap motion on a strip or a disc, and the march to its periodic state.

Solves ∂/∂X (H³ φ P^{1/n} ∂P/∂X) = σ ∂(P^{1/n}H)/∂T (on the disc with the factor R and its
inverse), conservatively: it is the independent check of the harmonic balance in `periodic` and
`planar`, with which it shares no line of discretisation in time, and the path for motions that
have no period. P = p/p0, H = h/H0, T = ωt.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Annotated, Any, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import announce
from squeezefilm.core.errors import ConvergenceError, InputError
from squeezefilm.physics.film.gas import ISOTHERMAL, Aim, FilmGas, Gas, require_film
from squeezefilm.physics.film.line_grid import Gap, LineGrid, Shape, gap_table, line_grid, mean_over
from squeezefilm.physics.film.transient.kernel import (
    BACKWARD_EULER,
    BDF2,
    SDIRK2,
    Gaps,
    Line,
    Pace,
    Track,
    march,
)

Scheme = Literal["bdf2", "sdirk2", "backward_euler"]
SCHEMES: dict[str, int] = {"bdf2": BDF2, "sdirk2": SDIRK2, "backward_euler": BACKWARD_EULER}
NEWTON = Aim(1e-13, 40)
_CHUNK = 1 << 21
"""Gap values tabulated at once (16 MB)."""


@dataclass(frozen=True)
class MovedFilm:
    """A film whose gap moves, and the scheme that follows it."""

    gap: Gap
    squeeze_number: si.Dimensionless
    shape: Shape
    gas: FilmGas
    scheme: Scheme

    @property
    def given(self) -> dict[str, Any]:
        """These fields alone, for the record of what came of them."""
        return {field.name: getattr(self, field.name) for field in fields(MovedFilm)}


@dataclass(frozen=True)
class FilmTransient(MovedFilm):
    """A gas film followed in time.

    `time` (steps+1,), `load` W(T) = ⟨P⟩ over the surface (steps+1,), `position` X or R of
    the cells (cells,), `snapshot_time` (k,) and `pressure` (k, cells) there. `mass_residual` is
    |gas at the end − gas at the start + gas lost through the edges| over the gas at the start, each
    as the scheme counts it (BDF2 balances (3 m − m one step before)/2).
    """

    time: si.DimensionlessArray
    load: si.DimensionlessArray
    position: si.DimensionlessArray
    snapshot_time: si.DimensionlessArray
    pressure: si.DimensionlessArray
    mass_residual: si.Dimensionless
    residual: si.Dimensionless
    iterations: int
    status: str


def stage_times(scheme: str) -> si.FloatArray:
    """Where in a step (0 to 1) a scheme asks for the gap."""
    si.require_one_of("scheme", scheme, SCHEMES)
    return np.array([1.0 - np.sqrt(0.5), 1.0] if scheme == "sdirk2" else [1.0])


def _gas_balanced(
    volume: si.FloatArray, m: si.FloatArray, before: si.FloatArray, scheme: Scheme
) -> float:
    """The gas whose change over a step is exactly what the scheme lets flow in."""
    return float(volume @ (1.5 * m - 0.5 * before if scheme == "bdf2" else m))


@si.checked_numbers
def solve_transient(
    gap: Gap,
    squeeze_number: si.Dimensionless,
    end: si.Dimensionless,
    *,
    start: si.Dimensionless = 0.0,
    steps: Annotated[int, si.AtLeast(1)] = 1000,
    cells: Annotated[int, si.AtLeast(4)] = 64,
    shape: Shape = "strip",
    gas: FilmGas = ISOTHERMAL,
    initial_pressure: Annotated[si.DimensionlessLike, si.Above(0.0)] = 1.0,
    snapshots: int = 11,
    scheme: Scheme = "bdf2",
) -> FilmTransient:
    """The film from T = `start` to `end` under any gap motion H(X, T): a lift-off, a step.

    `squeeze_number` σ = 12 η ω l0²/(p0 H0²) is on the full length of the strip (X from −½ to ½)
    or on the radius of the disc (R from 0 to 1); both edges are at ambient pressure P = 1.
    `gap(X, T)` takes arrays of shape (1, cells) and (times, 1). The film starts at
    `initial_pressure`, a number or (cells,). Second order in time and space
    (`bdf2`). `sdirk2` is second order in the gas held, but in the pressure it falls to first
    order where σ is small; `backward_euler` is first order. A jump of H between two times is
    followed as fast as a step allows: place `steps` accordingly. `snapshots` pressure fields
    are kept.

    Raises `InputError` for values out of range, `GeometryError` where the gap closes,
    `ConvergenceError` (with the part done) where a step does not converge.
    Holds for 0 < P, isothermal (n = 1) to adiabatic (1.4), viscous flow (h ≲ 10 µm at 40 kHz).
    Source: Gross, Gas Film Lubrication (1962); SDIRK2: Alexander, 10.1137/0714068.
    """
    require_film(squeeze_number, gas.polytropic_exponent, gas.knudsen_number)
    announce(march, "film solver in time", 4)
    si.require("end", end, above=start)
    si.require("snapshots", snapshots, at_least=0, at_most=steps + 1)
    if np.shape(initial_pressure) not in ((), (cells,)):
        raise InputError(
            f"initial_pressure has the shape {np.shape(initial_pressure)}; give one number, or one "
            f"for each of {cells} cells",
            quantity="initial_pressure",
        )
    pressure = np.broadcast_to(np.asarray(initial_pressure, dtype=float), (cells,))
    kept = np.unique(np.linspace(0, steps, snapshots).round().astype(np.int64))
    asked = _Asked(gap, squeeze_number, shape, gas, scheme, start, end, steps)
    return _followed(asked, pressure, kept)


@dataclass(frozen=True)
class _Asked(MovedFilm):
    """What is to be followed, and in which steps."""

    start: float
    end: float
    steps: int

    @property
    def time_step(self) -> float:
        """One step (rad)."""
        return (self.end - self.start) / self.steps

    @property
    def time(self) -> si.FloatArray:
        """The ends of the steps (rad), the start before them (steps + 1,)."""
        return self.start + self.time_step * np.arange(self.steps + 1, dtype=np.float64)


@dataclass(frozen=True)
class _Marched:
    """How far a march came: the steps `done`, the last and the `worst` change that Newton's method
    left in a step, the gas that its balances miss, and the iterations."""

    done: int
    change: float
    worst: float
    closure: float
    iterations: int


def _followed(asked: _Asked, pressure: si.FloatArray, kept: si.IntArray) -> FilmTransient:
    """The film from a `pressure` in each cell, its field after the steps `kept`."""
    gas, time = asked.gas.compiled(), asked.time
    over = np.linspace(asked.start, asked.end, 9)
    grid = line_grid(asked.shape, pressure.size, asked.squeeze_number, mean_over(asked.gap, over))
    H_start = gap_table(asked.gap, grid.centre, time[:1])[0]
    m = pressure ** (1.0 / gas.polytropic_exponent) * H_start
    held = float(grid.volume @ m)
    load, field = np.empty(time.size), np.empty((kept.size, pressure.size))
    load[0] = grid.volume @ pressure / grid.volume.sum()
    keep = np.full(time.size, -1, dtype=np.int64)
    keep[kept] = np.arange(kept.size)
    if kept.size:
        field[0] = pressure
    ended = _marched(asked, gas, grid, m, Track(load, field, keep))
    done, finished = ended.done, ended.done == asked.steps
    status = (
        f"followed over {asked.steps} steps to T = {asked.end:.4g}"
        if finished
        else f"stopped at T = {time[done]:.4g}: a step did not converge (change {ended.change:.2g})"
    )
    inside = kept <= done
    result = FilmTransient(
        time=time[: done + 1],
        load=load[: done + 1],
        position=grid.centre,
        snapshot_time=time[kept[inside]],
        pressure=field[inside],
        mass_residual=ended.closure / held,
        residual=ended.worst,
        iterations=ended.iterations,
        status=status,
        **asked.given,
    )
    if not finished:
        raise ConvergenceError(
            f"the transient {status}; take more steps (now {asked.steps})",
            partial=result,
            residual=ended.worst,
            iterations=ended.iterations,
        )
    return result


def _marched(asked: _Asked, gas: Gas, grid: LineGrid, m: si.FloatArray, track: Track) -> _Marched:
    """March on from the gas `m`, which is changed, to the end or to a step that fails."""
    dt, time, scheme = asked.time_step, asked.time, asked.scheme
    line = Line(grid.volume, grid.conductance)
    worst, iterations, done, closure = 0.0, 0, 0, 0.0
    before = m.copy()
    chunk = max(1, _CHUNK // (2 * len(stage_times(scheme)) * m.size))
    while done < asked.steps:
        # BDF2 needs one step to start from; the one-step SDIRK2 of the same order makes it.
        how: Scheme = "sdirk2" if scheme == "bdf2" and done == 0 else scheme
        count = 1 if how != scheme else min(chunk, asked.steps - done)
        at: si.FloatArray = (time[done : done + count, None] + dt * stage_times(how)).ravel()
        held = _gas_balanced(grid.volume, m, before, how)
        now = slice(done + 1, done + count + 1)
        lost, change, made, reached = march(
            m,
            before,
            Gaps(gap_table(asked.gap, grid.centre, at), gap_table(asked.gap, grid.face, at)),
            line,
            Pace(dt, float(asked.squeeze_number), SCHEMES[how]),
            gas,
            NEWTON,
            Track(track.load[now], track.field, track.keep[now]),
        )
        closure += abs(_gas_balanced(grid.volume, m, before, how) - held + lost)
        worst = max(worst, change) if np.isfinite(change) else float("nan")
        iterations += made
        done += reached
        if reached < count:
            break
    return _Marched(done, change, worst, closure, iterations)
