"""Many uniform films at once: a load balance, a friction curve or a map is thousands of solves.

The cases are grouped by the resolution they need and each group is one compiled loop, spread
over threads (the compiled code releases the interpreter). Cases whose error estimate misses the
tolerance come back in the next round with more cells or more times.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import announce
from squeezefilm.core.errors import ConvergenceError, InputError
from squeezefilm.core.progress import CountProgress
from squeezefilm.physics.film.gas import (
    EXCURSION_RATIO,
    KNUDSEN_NUMBER,
    POLYTROPIC_EXPONENT,
    SQUEEZE_NUMBER,
    TOLERANCE,
    slip_law,
)
from squeezefilm.physics.film.periodic.resolution import (
    CELLS,
    DISC,
    STRIP,
    TIMES,
    FilmResolution,
    Films,
    first_guess,
    refined,
    resolution_of,
)
from squeezefilm.physics.film.periodic.small import fill_small

ROUNDS = 12
_CHUNK = 4096


@dataclass(frozen=True)
class FilmBatch:
    """Results of many uniform films; arrays of the broadcast shape of the inputs.

    `over_pressure_error` is an estimate of the absolute error of `over_pressure`. Stiffness and
    damping are those of the first force harmonic, −(stiffness + i damping)·p0·A·ε; `force_error`
    estimates the absolute error of stiffness + i damping, and so of either. `iterations`, `cells`
    and `times` are 0 where the vibration is so small that its closed form was taken.
    """

    mean_load: si.DimensionlessArray
    over_pressure: si.DimensionlessArray
    over_pressure_error: si.DimensionlessArray
    stiffness_relative: si.DimensionlessArray
    damping_relative: si.DimensionlessArray
    force_error: si.DimensionlessArray
    iterations: si.IntArray
    residual: si.DimensionlessArray
    cells: si.IntArray
    times: si.IntArray
    model: str
    status: str


@lru_cache(maxsize=1)
def compiled() -> Any:
    """The compiled solver; says on the log when this processor has to compile it first."""
    from squeezefilm.physics.film.periodic import uniform

    announce(uniform.solve_rows, "film solver", 20)
    return uniform


@si.checked_numbers
def solve_films(
    squeeze_number: Annotated[si.DimensionlessLike, *SQUEEZE_NUMBER],
    excursion_ratio: Annotated[si.DimensionlessLike, *EXCURSION_RATIO],
    *,
    shape: str = "strip",
    polytropic_exponent: Annotated[si.DimensionlessLike, *POLYTROPIC_EXPONENT] = 1.0,
    knudsen_number: Annotated[si.DimensionlessLike, *KNUDSEN_NUMBER] = 0.0,
    slip: str = "first",
    tolerance: Annotated[float, *TOLERANCE] = 5e-3,
    workers: Annotated[int, si.AtLeast(1)] | None = None,
    progress: CountProgress | None = None,
    force: bool = False,
) -> FilmBatch:
    """Mean load and first force harmonic of many films, H = 1 + ε cos T; inputs broadcast.

    The equation, inputs, ranges and errors are those of `solve_uniform`; the squeeze
    number is on a strip's full length or on a disc's radius. `tolerance` is relative, on the
    over-pressure, and with `force` on the first harmonic too (relative to its size). `workers`
    threads share the work (None: one per core). `progress(done, total)` is called after each
    portion. A case that does not reach the tolerance raises `ConvergenceError` carrying the batch
    as `partial`, where its error estimate shows it (NaN where nothing converged).
    """
    si.require_one_of("shape", shape, ("strip", "disc"))
    law = slip_law(slip, float(np.max(knudsen_number)))
    inputs = _broadcast(squeeze_number, excursion_ratio, polytropic_exponent, knudsen_number)
    sigma, signed, n, kn = (np.ascontiguousarray(a.ravel()) for a in inputs)
    # ε and −ε are the same film half a period apart.
    eps = np.abs(signed)
    u = compiled()
    films = Films(sigma, eps, n, kn, law, STRIP if shape == "strip" else DISC)
    solved = solve_all(films, tolerance, workers or os.cpu_count() or 1, progress, force=force)
    batch = _as_batch(films, solved, inputs[0].shape, slip, tolerance)
    if not solved.met.all():
        at = int(np.flatnonzero(~solved.met)[0])
        raise ConvergenceError(
            f"{batch.status}; the first has squeeze_number {sigma[at]:.4g}, excursion_ratio "
            f"{signed[at]:.4g}. Ask a larger tolerance; the others are in the error's `partial`",
            partial=batch,
            residual=float(solved.rows[at, u.RESIDUAL]),
            iterations=int(solved.rows[at, u.ITERATIONS]),
        )
    return batch


def _broadcast(*values: si.DimensionlessLike) -> Sequence[si.FloatArray]:
    """The inputs in one shape; raises `InputError` where they have none in common."""
    try:
        return np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in values))
    except ValueError as error:
        raise InputError(f"the inputs do not broadcast together: {error}") from error


def _as_batch(
    films: Films, solved: _Work, form: tuple[int, ...], slip: str, tolerance: float
) -> FilmBatch:
    """Batch that is given back, in the shape of the inputs."""
    u, out, total = compiled(), solved.rows, len(films.squeeze_number)
    law = f"slip {slip} at local Kn" if films.law else "no slip"
    missed = int(np.count_nonzero(~solved.met))
    columns = {
        "mean_load": 1.0 + out[:, u.OVER],
        "over_pressure": out[:, u.OVER],
        "over_pressure_error": out[:, u.ERROR],
        "stiffness_relative": out[:, u.STIFFNESS],
        "damping_relative": out[:, u.DAMPING],
        "force_error": out[:, u.FORCE_ERROR],
        "iterations": out[:, u.ITERATIONS].astype(np.int64),
        "residual": out[:, u.RESIDUAL],
        "cells": np.where(out[:, u.ITERATIONS] > 0, CELLS[solved.cells], 0),
        "times": np.where(out[:, u.ITERATIONS] > 0, TIMES[solved.times], 0),
    }
    return FilmBatch(
        **{name: np.array(column.reshape(form)) for name, column in columns.items()},
        model=f"periodic compressible Reynolds film, {films.planform}, {law}",
        status=(
            f"all {total} films within {tolerance:g} of their over-pressure"
            if missed == 0
            else f"{missed} of {total} films not within {tolerance:g} of their over-pressure"
        ),
    )


def solve_all(
    films: Films,
    tolerance: float,
    workers: int,
    progress: CountProgress | None = None,
    *,
    force: bool = False,
) -> _Work:
    """Solve films, refining those that miss the tolerance; with `force` also in the first harmonic.

    Inputs are checked 1-D arrays with 0 ≤ ε < 1.
    """
    u = compiled()
    work = _Work(films, tolerance, workers, progress, force)
    cells, times, total = work.cells, work.times, len(work.met)
    pending: si.IntArray = np.arange(total)
    work.met[fill_small(films, tolerance, work.rows, pending, better=True)] = True
    pending = np.flatnonzero(~work.met)
    pool = ThreadPoolExecutor(workers) if workers > 1 and total > 64 else None
    with pool or nullcontext():
        for turn in range(1, ROUNDS + 1):
            if len(pending) == 0:
                break
            key = cells[pending] * len(TIMES) + times[pending]
            order = np.argsort(key, kind="stable")
            bounds = np.flatnonzero(np.diff(key[order])) + 1
            for group in np.split(pending[order], bounds):
                first = group[0]
                work.solve(group, resolution_of(int(CELLS[cells[first]]), int(times[first])), pool)
            work.tell()
            pending = np.flatnonzero(~work.met)
            if turn == ROUNDS:
                break  # what is given back is of the grids that were solved
            pending = work.refined(pending)
    closed = fill_small(films, tolerance, work.rows, np.flatnonzero(~work.met), better=False)
    work.met[closed], work.spent[closed] = True, 0.0
    work.rows[:, u.ITERATIONS] = work.spent
    return work


@dataclass
class _Work:
    """Films under way: the indices of their cells and times, their result rows (columns in
    `uniform`), the iterations spent on each, and which met the tolerance."""

    films: Films
    tolerance: float
    workers: int
    progress: CountProgress | None
    force: bool

    def __post_init__(self) -> None:
        sigma, eps, _, kn, _, shape = self.films
        wide = sigma if shape == STRIP else 2.25 * sigma
        self.cells, self.times = first_guess(wide, eps, kn, self.tolerance)
        self.rows = np.full((len(sigma), compiled().COLUMNS), np.nan)
        self.spent, self.met = np.zeros(len(sigma)), np.zeros(len(sigma), dtype=bool)

    def tell(self) -> None:
        """Say how many are done."""
        if self.progress is not None:
            self.progress(int(np.count_nonzero(self.met)), len(self.met))

    def solve(
        self, group: si.IntArray, resolution: FilmResolution, pool: ThreadPoolExecutor | None
    ) -> None:
        """Solve the films of the indices `group` on one resolution, in portions."""
        u, films = compiled(), self.films.at(group)
        rows = np.full((len(group), u.COLUMNS), np.nan)
        portion = min(_CHUNK, -(-len(group) // self.workers))
        spans = [(a, min(a + portion, len(group))) for a in range(0, len(group), portion)]

        def part(span: tuple[int, int]) -> None:
            u.solve_rows(*span, films, resolution, self.tolerance, rows, np.empty(0))

        for _ in map(part, spans) if pool is None else pool.map(part, spans):
            self.tell()
        self.rows[group] = rows
        self.spent[group] += rows[:, u.ITERATIONS]
        self.met[group] = rows[:, u.ERROR] <= self.tolerance * np.abs(rows[:, u.OVER])
        if self.force:
            size = np.hypot(rows[:, u.STIFFNESS], rows[:, u.DAMPING])
            self.met[group] &= rows[:, u.FORCE_ERROR] <= self.tolerance * size

    def refined(self, pending: si.IntArray) -> si.IntArray:
        """Give pending films the cells and times that they lack, in place; those to solve again."""
        u, tolerance, rows = compiled(), self.tolerance, self.rows[pending]
        allowed = tolerance * np.abs(rows[:, u.OVER])
        space, time = rows[:, u.SPACE], rows[:, u.TIME]
        if self.force:
            # What the first harmonic lacks, in the unit of the over-pressure.
            unit = allowed / (tolerance * np.hypot(rows[:, u.STIFFNESS], rows[:, u.DAMPING]))
            space = np.maximum(space, rows[:, u.FORCE_SPACE] * unit)
            time = np.maximum(time, rows[:, u.FORCE_TIME] * unit)
        allowed = np.where(allowed > 0.0, allowed, 1e-300)
        cells, times = self.cells[pending], self.times[pending]
        more_cells, more_times = refined(cells, times, space, time, allowed)
        stuck = (more_cells == cells) & (more_times == times)
        # Where rounding alone is more than what is allowed, nothing is to be gained.
        films = self.films.at(pending)
        sigma, n = films.squeeze_number, films.polytropic_exponent
        for at in np.flatnonzero(np.isfinite(rows[:, u.OVER])):
            stuck[at] |= u.rounding(sigma[at], n[at], rows[at, u.OVER]) > allowed[at]
        self.cells[pending], self.times[pending] = more_cells, more_times
        return np.asarray(pending[~stuck])
