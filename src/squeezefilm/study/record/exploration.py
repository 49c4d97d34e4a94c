"""Exploration by a finger: way, speed, passes, coverage; of a trace, or of an answer."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.formats.traces import Table, table_from_csv
from squeezefilm.physics.display import load_display
from squeezefilm.physics.perception.path_percepts import straight_runs
from squeezefilm.physics.plate.layout import AnnularStator
from squeezefilm.physics.render.motion.stroke import FingerPath
from squeezefilm.study.record.store import StudyStore

CELL: si.Metre = 5e-3
"""Side of the cells that a face is divided into for `coverage`: half a contact; assumed."""
PATH_PERIOD: si.Second = 10e-3
"""Time between samples of a study's paths: slow against a sensor's noise, fast against a hand."""
_PER_CELL = 50
"""Places looked at along the way of a cell: a corner that is cut more finely is not seen."""
_FARTHEST: si.Metre = 10.0


@dataclass(frozen=True, slots=True)
class Exploration:
    """Exploration of one trial by a finger.

    Attributes:
        duration: from the first sample to the last (s).
        touched: of it, in which the finger touched (s).
        path_length: of the finger's way over the surface (m).
        mean_speed: path over the time in touch (m/s); NaN if it never touched.
        peak_speed: the largest between two samples (m/s); NaN likewise.
        passes: straight stretches one way, of 4 mm or more (`physics.perception.path_percepts`).
        along_x_share: share of the passes' way that goes along x more than along y; NaN without.
        coverage: share of the face's cells of 5 mm that the finger's middle came over; NaN where
            the face is not known.
    """

    duration: si.Second
    touched: si.Second
    path_length: si.Metre
    mean_speed: si.MetrePerSecond
    peak_speed: si.MetrePerSecond
    passes: int
    along_x_share: si.Dimensionless
    coverage: si.Dimensionless


_Place = Annotated[si.MetreArray, si.AtLeast(-_FARTHEST), si.AtMost(_FARTHEST)]


@si.checked_numbers
def exploration(
    time: Annotated[si.SecondArray, si.Rising(2)],
    x: _Place,
    y: _Place | None = None,
    *,
    face: tuple[si.Metre, si.Metre] | None = None,
    longest_step: si.Second = math.inf,
) -> Exploration:
    """Way, speed, passes and coverage of a finger's trace.

    A sensor's noise lengthens the path: give positions that are filtered, or no denser than the
    noise allows.

    Args:
        time: of the samples (s), shape (n,), rising.
        x, y: positions (m), shape (n,); y is 0 if not given.
        face: length and width of what there is to explore (m).
        longest_step: between samples in touch (s): a longer one is a lifted finger, and what it
            did meanwhile is left out.

    Raises:
        InputError: fewer than two samples, unequal lengths, times that do not rise, or values
            that are not finite.
    """
    y = np.zeros_like(x) if y is None else y
    si.require_alike(time=time, x=x, y=y)
    steps = np.diff(time)
    down = steps <= longest_step
    way, steps = np.hypot(np.diff(x), np.diff(y))[down], steps[down]
    touched = float(steps.sum())
    paths = touches(time, x, y, longest_step)
    runs = [run for path in paths for run in straight_runs(path)]
    length = sum(run.length for run in runs)
    return Exploration(
        duration=float(time[-1] - time[0]),
        touched=touched,
        path_length=float(way.sum()),
        mean_speed=float(way.sum()) / touched if touched else math.nan,
        peak_speed=float((way / steps).max()) if touched else math.nan,
        passes=len(runs),
        along_x_share=sum(r.length for r in runs if r.along_x) / length if runs else math.nan,
        coverage=math.nan if face is None else coverage(paths, face),
    )


def touches(
    time: si.SecondArray, x: si.MetreArray, y: si.MetreArray, longest_step: si.Second = math.inf
) -> tuple[FingerPath, ...]:
    """The paths (s, m) of a trace between lifts: a step longer than `longest_step` (s) is a lift.
    A touch without any motion is left out."""
    cuts = np.flatnonzero(np.diff(time) > longest_step) + 1
    runs = []
    for rows in np.split(np.arange(time.size), cuts):
        if rows.size > 1 and (np.any(np.diff(x[rows])) or np.any(np.diff(y[rows]))):
            runs.append(FingerPath(time[rows], x[rows], y[rows]))
    return tuple(runs)


@si.checked_numbers
def coverage(
    paths: Sequence[FingerPath],
    face: tuple[Annotated[si.Metre, si.Above(0.0)], Annotated[si.Metre, si.Above(0.0)]],
    cell: Annotated[si.Metre, si.Above(0.0)] = CELL,
) -> si.Dimensionless:
    """Share (1) of a face's cells that the finger's middle came over; at most 1.

    The cells are squares of a grid through the origin of the path's places; the face is as many of
    them as its area holds, wherever it lies. Raises `InputError` for a length that is not above 0.
    """
    seen: set[tuple[int, int]] = set()
    for path in paths:
        count = int(_PER_CELL * path.length / cell) + 2
        way = np.linspace(0.0, path.length, min(count, 2_000_000))
        places = np.floor(np.stack(path.place_after(way), axis=1) / cell).astype(np.int64)
        is_entered = np.any(np.diff(places, axis=0) != 0, axis=1)
        seen.update(map(tuple, places[np.append(True, is_entered)].tolist()))
    return min(len(seen) * cell**2 / (face[0] * face[1]), 1.0)


LONGEST_STEP: si.Second = 1.5 * PATH_PERIOD
"""Longest time between two samples of a path; a longer one is a lifted finger."""
MEASURES = ("peak_speed_m_per_s", "time_in_touch_s", "passes", "along_x_share", "coverage")
"""Keys of `measures`, units in the names."""


def measures(store: StudyStore, display: str, traces: list[str]) -> dict[str, float | None]:
    """Measures of an answer by its traces: peak speed (m/s), time in touch (s), passes, their share
    along x (1), coverage of the face (1); of two surfaces the greater peak, sums and mean shares.

    None for what is not known: without a path all of them, without the display's file coverage. A
    path that is not there or cannot be read is left out: traces may be kept elsewhere.
    """
    found = []
    for name in traces:
        if name.endswith(".csv"):
            try:
                found.append(explored_table(table_from_csv(store.traces / name), face_of(display)))
            except (ConfigError, InputError):
                continue
    if not found:
        return dict.fromkeys(MEASURES)
    values = (
        max(motion.peak_speed for motion in found),
        sum(motion.touched for motion in found),
        float(sum(motion.passes for motion in found)),
        _mean([motion.along_x_share for motion in found]),
        _mean([motion.coverage for motion in found]),
    )
    return {
        name: value if math.isfinite(value) else None
        for name, value in zip(MEASURES, values, strict=True)
    }


def explored_table(table: Table, face: tuple[si.Metre, si.Metre] | None = None) -> Exploration:
    """Exploration by a finger, from the table of its path. Raises what `exploration` raises."""
    time, x, y = (table.column(name) for name in ("time_s", "x_m", "y_m"))
    return exploration(time, x, y, face=face, longest_step=LONGEST_STEP)


def _mean(values: list[float]) -> float:
    known = [value for value in values if math.isfinite(value)]
    return float(np.mean(known)) if known else math.nan


@functools.lru_cache(maxsize=32)
def face_of(display: str) -> tuple[si.Metre, si.Metre] | None:
    """Length and width (m) of what a display has to touch; None of a ring, or where its description
    cannot be read."""
    try:
        actuator = load_display(display).actuator
    except (ConfigError, InputError):
        return None
    return None if isinstance(actuator, AnnularStator) else actuator.extent
