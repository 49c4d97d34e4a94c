"""How people explored: way, speed and force of each trial, and by condition over participants."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.study.identification.confusion import one_per_trial

# Slower than this the finger rests rather than explores; assumed.
RESTING_SPEED: si.MetrePerSecond = 5e-3
"""Speed (m/s) below which a finger counts as resting; assumed."""


@dataclass(frozen=True, slots=True)
class Exploration:
    """What a finger did in one trial.

    Attributes:
        duration: from the first sample to the last (s).
        path_length: of the finger's way over the surface (m).
        mean_speed: path over duration (m/s).
        moving_speed: path over the time spent above `RESTING_SPEED` (m/s); NaN if it never moved.
        moving_share: share of the time spent above `RESTING_SPEED`.
        reversals: of the motion along x, rests left out.
        mean_force, force_spread: normal force, weighted by time, and its standard deviation (N);
            NaN where no force was taken.
    """

    duration: si.Second
    path_length: si.Metre
    mean_speed: si.MetrePerSecond
    moving_speed: si.MetrePerSecond
    moving_share: si.Dimensionless
    reversals: int
    mean_force: si.Newton
    force_spread: si.Newton


def exploration(
    time: ArrayLike, x: ArrayLike, y: ArrayLike | None = None, force: ArrayLike | None = None
) -> Exploration:
    """Way, speed and force of a finger's trace.

    A sensor's noise lengthens the path: give positions that are filtered, or no denser than the
    noise allows.

    Args:
        time: of the samples (s), shape (n,), rising.
        x, y: positions (m), shape (n,); y is 0 if not given.
        force: normal force (N), shape (n,), at least 0.

    Raises:
        InputError: fewer than two samples, unequal lengths, times that do not rise, values that
            are not finite, or a force below 0.
    """
    t, along = np.asarray(time, dtype=float), np.asarray(x, dtype=float)
    across = np.zeros_like(along) if y is None else np.asarray(y, dtype=float)
    pressed = None if force is None else np.asarray(force, dtype=float)
    shapes = {t.shape, along.shape, across.shape} | (
        {pressed.shape} if pressed is not None else set()
    )
    if len(shapes) != 1 or t.ndim != 1 or t.size < 2:
        raise InputError(
            "time, x, y and force must be rows of the same length with at least 2 samples; their "
            f"shapes are {sorted(shapes)}"
        )
    si.require("time", t, si.Unit("s"))
    steps = np.diff(t)
    if np.any(steps <= 0):
        raise InputError("time must rise from sample to sample; sort the trace, drop repeats")
    si.require("x", along, si.Unit("m"))
    si.require("y", across, si.Unit("m"))
    way = np.hypot(np.diff(along), np.diff(across))
    moving = way / steps > RESTING_SPEED
    heading = np.sign(np.diff(along))[moving]
    heading = heading[heading != 0]
    duration, moved = float(t[-1] - t[0]), float(steps[moving].sum())
    mean_force = spread = float("nan")
    if pressed is not None:
        si.require("force", pressed, si.Unit("N"), at_least=0.0)
        middle = 0.5 * (pressed[1:] + pressed[:-1])
        mean_force = float((middle * steps).sum() / duration)
        spread = float(np.sqrt(((middle - mean_force) ** 2 * steps).sum() / duration))
    return Exploration(
        duration,
        float(way.sum()),
        float(way.sum()) / duration,
        float(way[moving].sum()) / moved if moved > 0 else float("nan"),
        moved / duration,
        int(np.count_nonzero(np.diff(heading))),
        mean_force,
        spread,
    )


@dataclass(frozen=True, slots=True)
class ConditionMean:
    """A quantity of trials by condition: the mean of participants' means, with its t interval.

    `low` and `high` are NaN with one participant.
    """

    name: str
    trials: int
    participants: int
    mean: float
    low: float
    high: float
    level: si.Dimensionless


def condition_means(
    participant: ArrayLike,
    condition: ArrayLike,
    values: ArrayLike,
    names: tuple[str, ...],
    level: si.Dimensionless = 0.95,
) -> tuple[ConditionMean, ...]:
    """Means by condition with participants as the random unit; conditions without a value are
    left out.

    Args:
        participant, condition: numbers from 0 up, shape (trials,).
        values: of the trials, shape (trials,), in any unit; NaN for none.
        names: of the conditions.
        level: of the intervals.

    Raises:
        InputError: arrays of unequal length, or a level not between 0 and 1.
    """
    si.require("level", level, above=0.0, below=1.0)
    person = np.asarray(participant, dtype=np.int64)
    kind, given = np.asarray(condition, dtype=np.int64), np.asarray(values, dtype=float)
    one_per_trial(participant=person, condition=kind, values=given)
    there = np.isfinite(given)
    person, kind, given = person[there], kind[there], given[there]
    people = int(person.max()) + 1 if person.size else 0
    group, size = person * len(names) + kind, people * len(names)
    count = np.bincount(group, minlength=size).reshape(people, len(names))
    total = np.bincount(group, given, size).reshape(people, len(names))
    found = []
    for column, name in enumerate(names):
        some = count[:, column] > 0
        if not np.any(some):
            continue
        means = total[some, column] / count[some, column]
        half = float("nan")
        if means.size > 1:
            t = float(stats.t.isf((1 - level) / 2, means.size - 1))
            half = t * float(means.std(ddof=1)) / np.sqrt(means.size)
        centre = float(means.mean())
        trials = int(count[:, column].sum())
        low, high = centre - half, centre + half
        found.append(ConditionMean(name, trials, means.size, centre, low, high, level))
    return tuple(found)
