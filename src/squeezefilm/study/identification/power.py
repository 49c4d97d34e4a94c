"""Numbers of people that a study needs, by the share of simulated ones that find a difference.

The question "8 against 10 mm" is answered by a test over people of how well they tell the two
stimuli apart (`distinction_scores`). Studies are simulated with a seed of their own for each number
of people, so that a curve gives the same numbers in pieces.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import STUDIES, require_within
from squeezefilm.study.identification.confusion import proportion_interval, whole_counts

ParticipantSimulator = Callable[[int, np.random.Generator], NDArray[Any]]
"""Draws so many participants: of each their counts or whatever else the test takes, in an array
whose first axis is theirs; all randomness from the generator."""


def above_0(scores: si.FloatArray) -> si.Dimensionless:
    """p of Student's one-sided test that people's mean score is above 0; 1 where all have 0, and 0
    where all have the same above it."""
    people, mean, spread = scores.size, float(scores.mean()), float(scores.std(ddof=1))
    if spread == 0.0:
        return 0.0 if mean > 0 else 1.0
    return float(stats.t.sf(mean / spread * np.sqrt(people), people - 1))


def distinction_scores(counts: ArrayLike, first: int, second: int) -> si.DimensionlessArray:
    """Each person's score of telling two stimuli apart, by counts (participants, answers, stimuli):
    [p(a|A) − p(a|B)] + [p(b|B) − p(b|A)], p(x|Y) the share of answers x to stimulus Y.

    0 if the two are felt alike whatever the preference for an answer, 2 if never confused and
    always named. People without trials of both are left out. Raises `InputError` for numbers out
    of range or equal.
    """
    whole = whole_counts(counts)
    k = min(whole.shape[1:]) if whole.ndim == 3 else 0
    if not (0 <= first < k and 0 <= second < k and first != second):
        raise InputError(f"stimuli {first} and {second} must be two different ones of 0 to {k - 1}")
    totals = whole.sum(axis=1)
    there = (totals[:, first] > 0) & (totals[:, second] > 0)
    n, totals = whole[there].astype(float), totals[there]
    one, other = n[:, :, first] / totals[:, [first]], n[:, :, second] / totals[:, [second]]
    return np.asarray(one[:, first] - other[:, first] + other[:, second] - one[:, second])


@dataclass(frozen=True, slots=True, eq=False)
class PowerCurve:
    """Power against the number of people, or the share of studies that are precise enough; arrays
    of shape (numbers,).

    Attributes:
        participants: numbers of people simulated, rising.
        power: share of simulated studies with p below `alpha`, or that are precise enough.
        low, high: 95 % Clopper–Pearson bounds of it, from the finite number of studies.
        studies: simulated per number.
        alpha: of the test, or what the intervals leave out.
        target: power asked for.
        needed: fewest people from which on every number simulated reaches the target; None if the
            greatest does not.
        needed_surely: the same for the lower bounds.
    """

    participants: si.IntArray
    power: si.DimensionlessArray
    low: si.DimensionlessArray
    high: si.DimensionlessArray
    studies: int
    alpha: si.Dimensionless
    target: si.Dimensionless
    needed: int | None
    needed_surely: int | None


def power_curve(
    simulate: ParticipantSimulator,
    test: Callable[[NDArray[Any]], float],
    participants: tuple[int, ...] = (4, 6, 8, 12, 16, 24, 32, 48),
    *,
    studies: int = 1000,
    alpha: si.Dimensionless = 0.05,
    target: si.Dimensionless = 0.8,
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
) -> PowerCurve:
    """Simulate studies of several sizes and count those whose test is significant.

    Args:
        simulate: draws people.
        test: what was drawn of a study's people → p value.
        participants: numbers of people, each at least 2.
        studies: per number; at least 10.
        alpha: significance of a study.
        target: power asked for.
        seed: each number of people n draws from (seed, n), whatever else is simulated.
        progress: called with the sizes done and their number.

    Raises:
        InputError: no sizes or one below 2, fewer than 10 studies, a share not between 0 and 1, or
            a p value that is not one.
    """
    sizes = sizes_of(participants, studies)
    require_within(STUDIES, studies, "studies")
    si.require("alpha", alpha, above=0.0, below=1.0)
    si.require("target", target, above=0.0, below=1.0)
    counts = []
    for done, people in enumerate(sizes, 1):
        random = np.random.default_rng([seed, people])
        p = np.array([test(simulate(people, random)) for _ in range(studies)])
        if (wrong := p[~((p >= 0.0) & (p <= 1.0))]).size:
            raise InputError(
                f"the test returned p = {wrong[0]}; it must return a p value of 0 to 1"
            )
        counts.append(int(np.count_nonzero(p < alpha)))
        if progress is not None:
            progress(done, len(sizes))
    return curve_of(sizes, counts, studies, alpha, target)


def curve_of(
    sizes: tuple[int, ...],
    counts: list[int],
    studies: int,
    alpha: si.Dimensionless,
    target: si.Dimensionless,
) -> PowerCurve:
    """The curve of so many studies of each size, out of `studies`."""
    bounds = [proportion_interval(count, studies, method="Clopper–Pearson") for count in counts]
    power = np.array(counts) / studies
    low, high = np.array([b.low for b in bounds]), np.array([b.high for b in bounds])
    return PowerCurve(
        np.array(sizes),
        power,
        low,
        high,
        studies,
        alpha,
        target,
        first_lasting(sizes, power >= target),
        first_lasting(sizes, low >= target),
    )


def sizes_of(participants: tuple[int, ...], studies: int) -> tuple[int, ...]:
    """Numbers of people, rising; refused where they or the studies are too few to simulate."""
    sizes = tuple(sorted(set(participants)))
    if not sizes or sizes[0] < 2 or studies < 10:
        raise InputError(
            f"participants = {sizes} with {studies} studies cannot be simulated; at least one size "
            "of at least 2, and at least 10 studies, are wanted"
        )
    return sizes


def first_lasting(sizes: tuple[int, ...], reached: NDArray[np.bool_]) -> int | None:
    """The least size at which, and at every larger one, it is reached; None of none."""
    lasting = np.flip(np.logical_and.accumulate(np.flip(reached)))
    return sizes[int(np.argmax(lasting))] if lasting.any() else None
