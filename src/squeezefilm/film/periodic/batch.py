"""Many uniform films at once: a load balance, a friction curve or a map is thousands of solves.

The cases are grouped by the resolution they need and each group is one compiled loop, spread
over threads (the compiled code releases the interpreter). Cases whose error estimate misses the
tolerance come back in the next round with more cells or more times.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from squeezefilm.errors import ConvergenceError, InputError
from squeezefilm.film.compiled import announce
from squeezefilm.film.periodic.records import Resolution
from squeezefilm.film.periodic.resolution import CELLS, TIMES, first_guess, refined, resolution_of
from squeezefilm.film.records import Aim
from squeezefilm.film.slip import slip_law
from squeezefilm.film.solved_range import require_film
from squeezefilm.progress import CountProgress
from squeezefilm.quantities import (
    DimensionlessArray,
    DimensionlessLike,
    FloatArray,
    IntArray,
    checked_numbers,
    require,
    require_one_of,
)

MAX_EXCURSION = 0.99
"""Above this excursion the gap all but closes, and the error is no longer measured."""

MOST_NEWTON = 60
ROUNDS = 12
_CHUNK = 4096


@dataclass(frozen=True)
class FilmBatch:
    """Results of many uniform films; arrays of the broadcast shape of the inputs.

    `over_pressure_error` is an estimate of the absolute error of `over_pressure`. Stiffness and
    damping are those of the first force harmonic, −(stiffness + i damping)·p0·A·ε.
    """

    mean_load: DimensionlessArray
    over_pressure: DimensionlessArray
    over_pressure_error: DimensionlessArray
    stiffness_relative: DimensionlessArray
    damping_relative: DimensionlessArray
    iterations: IntArray
    residual: DimensionlessArray
    cells: IntArray
    times: IntArray
    squeeze_number: DimensionlessArray
    excursion_ratio: DimensionlessArray
    polytropic_exponent: DimensionlessArray
    knudsen_number: DimensionlessArray
    slip: str
    shape: str
    tolerance: float
    model: str
    status: str


@lru_cache(maxsize=1)
def compiled() -> Any:
    """The compiled solver; says on the log when this processor has to compile it first."""
    from squeezefilm.film.periodic import uniform

    announce(uniform.solve_rows, "film solver", 20)
    return uniform


def check_film(
    squeeze_number: DimensionlessLike,
    excursion_ratio: DimensionlessLike,
    polytropic_exponent: DimensionlessLike,
    knudsen_number: DimensionlessLike,
    tolerance: float,
) -> None:
    """Refuse inputs that no film has; raises `InputError` with the offending value."""
    require_film(squeeze_number, polytropic_exponent, knudsen_number)
    require("excursion_ratio", excursion_ratio, above=-1.0, below=1.0)
    require("tolerance", tolerance, at_least=1e-9, at_most=0.05)


@checked_numbers
def solve_films(
    squeeze_number: DimensionlessLike,
    excursion_ratio: DimensionlessLike,
    *,
    shape: str = "strip",
    polytropic_exponent: DimensionlessLike = 1.0,
    knudsen_number: DimensionlessLike = 0.0,
    slip: str = "first",
    tolerance: float = 5e-3,
    workers: int | None = None,
    progress: CountProgress | None = None,
    strict: bool = True,
) -> FilmBatch:
    """Mean load and first force harmonic of many films, H = 1 + ε cos T; inputs broadcast.

    The equation, inputs, ranges and errors are those of `solve_strip` and `solve_disc`; the squeeze
    number is on a strip's full length or on a disc's radius. `tolerance` is relative, on the
    over-pressure. `workers` threads share the work (None: one per core). `progress(done, total)` is
    called after each portion. With `strict`, a case that does not reach the tolerance raises
    `ConvergenceError` carrying the batch as `partial`; without, its error estimate shows it (NaN
    where nothing converged).
    """
    require_one_of("shape", shape, ("strip", "disc"))
    check_film(squeeze_number, excursion_ratio, polytropic_exponent, knudsen_number, tolerance)
    law = slip_law(slip, float(np.max(knudsen_number)))
    if workers is not None and workers < 1:
        raise InputError(f"workers = {workers} cannot be used: at least 1, or None for all cores")
    try:
        inputs = np.broadcast_arrays(
            np.asarray(squeeze_number, dtype=float),
            np.asarray(excursion_ratio, dtype=float),
            np.asarray(polytropic_exponent, dtype=float),
            np.asarray(knudsen_number, dtype=float),
        )
    except ValueError as error:
        raise InputError(f"the inputs do not broadcast together: {error}") from error
    form = inputs[0].shape
    sigma, signed, n, kn = (np.ascontiguousarray(a.ravel()) for a in inputs)
    # ε and −ε are the same film half a period apart; ε = 0 is solved as nearly 0 and set to 1.
    eps = np.maximum(np.abs(signed), 1e-6)
    out, cells, times, met = solve_all(
        shape, sigma, eps, n, kn, law, tolerance, workers or os.cpu_count() or 1, progress
    )
    u = compiled()
    still = signed == 0.0
    out[still, u.OVER], out[still, u.ERROR] = 0.0, 0.0
    missed = int(np.count_nonzero(~(met | still)))
    batch = FilmBatch(
        mean_load=1.0 + out[:, u.OVER].reshape(form),
        over_pressure=out[:, u.OVER].reshape(form).copy(),
        over_pressure_error=out[:, u.ERROR].reshape(form).copy(),
        stiffness_relative=out[:, u.STIFFNESS].reshape(form).copy(),
        damping_relative=out[:, u.DAMPING].reshape(form).copy(),
        iterations=out[:, u.ITERATIONS].astype(np.int64).reshape(form),
        residual=out[:, u.RESIDUAL].reshape(form).copy(),
        cells=CELLS[cells].reshape(form),
        times=TIMES[times].reshape(form),
        squeeze_number=sigma.reshape(form),
        excursion_ratio=signed.reshape(form),
        polytropic_exponent=n.reshape(form),
        knudsen_number=kn.reshape(form),
        slip=slip,
        shape=shape,
        tolerance=tolerance,
        model=(
            f"periodic compressible Reynolds film, {shape}, "
            + (f"slip {slip} at local Kn" if law else "no slip")
        ),
        status=(
            f"all {len(sigma)} films within {tolerance:g} of their over-pressure"
            if missed == 0
            else f"{missed} of {len(sigma)} films not within {tolerance:g} of their over-pressure"
        ),
    )
    if missed and strict:
        at = int(np.flatnonzero(~(met | still))[0])
        raise ConvergenceError(
            f"{batch.status}; the first has squeeze_number {sigma[at]:.4g}, excursion_ratio "
            f"{signed[at]:.4g}. Ask a larger tolerance, or pass strict=False to keep the others",
            partial=batch,
            residual=float(out[at, u.RESIDUAL]),
            iterations=int(out[at, u.ITERATIONS]),
        )
    return batch


def solve_all(
    shape: str,
    sigma: FloatArray,
    eps: FloatArray,
    n: FloatArray,
    kn: FloatArray,
    law: int,
    tolerance: float,
    workers: int,
    progress: CountProgress | None = None,
    least_cells: int = 4,
    least_times: int = 5,
    keep: FloatArray | None = None,
) -> tuple[FloatArray, IntArray, IntArray, Any]:
    """Result rows (columns in `uniform`), indices of cells and times, and which met the tolerance.

    Inputs are checked 1-D arrays with 0 < ε < 1. `keep` is passed to the compiled loop and makes
    sense for one case only.
    """
    u = compiled()
    total = len(sigma)
    form = u.STRIP if shape == "strip" else u.DISC
    keep = np.empty(0) if keep is None else keep
    aim = Aim(tolerance, MOST_NEWTON)
    out = np.full((total, u.COLUMNS), np.nan)
    spent = np.zeros(total)
    met = np.zeros(total, dtype=bool)
    wide_sigma = sigma if form == u.STRIP else 2.25 * sigma
    cells, times = first_guess(wide_sigma, eps, kn, tolerance, least_cells, least_times)
    pending: IntArray = np.arange(total)
    pool = ThreadPoolExecutor(workers) if workers > 1 and total > 64 else None
    try:
        for turn in range(1, ROUNDS + 1):
            key = cells[pending] * len(TIMES) + times[pending]
            order = np.argsort(key, kind="stable")
            bounds = np.flatnonzero(np.diff(key[order])) + 1
            for group in np.split(pending[order], bounds):
                c, t = int(cells[group[0]]), int(times[group[0]])
                rows = np.full((len(group), u.COLUMNS), np.nan)
                resolution = resolution_of(int(CELLS[c]), t)
                films = u.Films(sigma[group], eps[group], n[group], kn[group], law, form)
                portion = min(_CHUNK, -(-len(group) // workers))
                spans = [(a, min(a + portion, len(group))) for a in range(0, len(group), portion)]

                def part(
                    span: tuple[int, int],
                    films: Any = films,
                    resolution: Resolution = resolution,
                    rows: FloatArray = rows,
                ) -> int:
                    u.solve_rows(*span, films, resolution, aim, rows, keep)
                    return span[1] - span[0]

                done = map(part, spans) if pool is None else pool.map(part, spans)
                for _number in done:
                    if progress is not None:
                        progress(int(np.count_nonzero(met)), total)
                out[group] = rows
                spent[group] += rows[:, u.ITERATIONS]
                met[group] = rows[:, u.ERROR] <= tolerance * np.abs(rows[:, u.OVER])
            if progress is not None:
                progress(int(np.count_nonzero(met)), total)
            pending = np.flatnonzero(~met)
            if len(pending) == 0 or turn == ROUNDS:
                break  # what is given back is of the grids that were solved
            allowed = tolerance * np.abs(out[pending, u.OVER])
            more_cells, more_times = refined(
                cells[pending],
                times[pending],
                out[pending, u.SPACE],
                out[pending, u.TIME],
                np.where(allowed > 0.0, allowed, 1e-300),
            )
            stuck = (more_cells == cells[pending]) & (more_times == times[pending])
            cells[pending], times[pending] = more_cells, more_times
            pending = pending[~stuck]
            if len(pending) == 0:
                break
    finally:
        if pool is not None:
            pool.shutdown()
    out[:, u.ITERATIONS] = spent
    return out, cells, times, met
