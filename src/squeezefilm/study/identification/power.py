"""How many people a study needs, by simulating it: the share of studies that find the difference.

The question "8 against 10 mm" is answered by a test over people of how well they tell the two
stimuli apart (`distinction`). Studies are simulated with a seed of their own for each number of
people, so a curve can be cut short, resumed and refined, and gives the same numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats
from scipy.special import ndtr

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import STUDIES, require_within
from squeezefilm.study.identification.confusion import whole_counts
from squeezefilm.study.identification.proportions import proportion_interval


class ParticipantSimulator(Protocol):
    """Draws participants: of each their counts or whatever else the test takes, in an array whose
    first axis is theirs."""

    def __call__(self, participants: int, random: np.random.Generator) -> NDArray[Any]:
        """So many people; all randomness from `random`."""
        ...


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class DirichletParticipants:
    """People whose answer probabilities vary about a common matrix (Dirichlet-multinomial).

    Args:
        probabilities: the common matrix, shape (answers, stimuli), columns sum to 1.
        trials_per_stimulus: of each person; at least 1.
        concentration: how alike people are: a column's probabilities are Dirichlet with
            `concentration` times the common ones; above 0. The proportion correct of a stimulus
            is then beta-binomial with overdispersion 1/(1 + concentration).

    Raises:
        InputError: columns that do not sum to 1, or values out of range.
    """

    probabilities: Annotated[si.FloatArray, si.AtLeast(0.0), si.AtMost(1.0)]
    trials_per_stimulus: Annotated[int, si.AtLeast(1)]
    concentration: Annotated[si.Dimensionless, si.Above(0.0)]

    def __post_init__(self) -> None:
        p = self.probabilities
        if p.ndim != 2 or not np.allclose(p.sum(axis=0), 1.0):
            raise InputError("every column of the answer probabilities must sum to 1")

    def __call__(self, participants: int, random: np.random.Generator) -> si.IntArray:
        """Counts of so many people, shape (participants, answers, stimuli)."""
        answers, stimuli = self.probabilities.shape
        counts = np.zeros((participants, answers, stimuli), dtype=np.int64)
        for j, column in enumerate(self.probabilities.T):
            some = column > 0
            own = np.zeros((participants, answers))
            own[:, some] = random.dirichlet(self.concentration * column[some], participants)
            # Draws underflow to 0 everywhere only at concentrations of no use.
            own /= own.sum(axis=1, keepdims=True)
            counts[:, :, j] = random.multinomial(self.trials_per_stimulus, own)
        return counts


def ordered_observer(spacing: float, stimuli: int = 5) -> si.FloatArray:
    """Answer probabilities of an unbiased observer of ordered stimuli, shape (answers, stimuli).

    Stimulus j is felt as a normal deviate about j·`spacing` of unit spread, criteria lie midway
    (Thurstone's model with equal variances); `spacing` is d′ of neighbours, above 0.
    """
    si.require("spacing", spacing, above=0.0)
    place = spacing * np.arange(stimuli)
    criteria = np.concatenate([[-np.inf], 0.5 * (place[1:] + place[:-1]), [np.inf]])
    return np.asarray(np.diff(ndtr(criteria[:, None] - place[None, :]), axis=0))


@dataclass(frozen=True, slots=True)
class Distinction:
    """How well people tell two stimuli apart.

    Attributes:
        score: mean over people of [p(a|A) − p(a|B)] + [p(b|B) − p(b|A)], p(x|Y) the share of
            answers x to stimulus Y; 0 if the two are felt alike whatever the preference for an
            answer, 2 if never confused and always named.
        t: its mean over its standard error (Student's t, people − 1 degrees of freedom).
        p_value: one-sided; 1 where all people have the same score 0, 0 where the same above 0.
        participants: with trials of both.
    """

    score: si.Dimensionless
    t: si.Dimensionless
    p_value: si.Dimensionless
    participants: int


def distinction(counts: ArrayLike, first: int, second: int) -> Distinction:
    """Test over people whether stimuli `first` and `second` are told apart.

    Args:
        counts: every participant's matrix, shape (participants, k, k).
        first, second: numbers of the stimuli, and of their answers.

    Raises:
        InputError: numbers out of range or equal, or fewer than two people with trials of both.
    """
    score = distinction_scores(counts, first, second)
    if score.size < 2:
        raise InputError("a test over people needs at least 2 with trials of both stimuli")
    t, p = above_0(score)
    return Distinction(float(score.mean()), t, p, score.size)


def above_0(scores: si.FloatArray) -> tuple[si.Dimensionless, si.Dimensionless]:
    """t and p of Student's one-sided test that people's mean score is above 0; p is 1 where all
    have 0, and 0 where all have the same above it, with t NaN."""
    people, mean, spread = scores.size, float(scores.mean()), float(scores.std(ddof=1))
    if spread == 0.0:
        return float("nan"), 0.0 if mean > 0 else 1.0
    t = float(mean / spread * np.sqrt(people))
    return t, float(stats.t.sf(t, people - 1))


def distinction_scores(counts: ArrayLike, first: int, second: int) -> si.DimensionlessArray:
    """Each person's score, as `Distinction` has its mean; people without trials of both are left
    out. Raises `InputError` for numbers out of range or equal."""
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
    """Power against the number of people; arrays of shape (numbers,).

    Attributes:
        participants: numbers of people simulated, rising.
        power: share of simulated studies with p below `alpha`.
        low, high: 95 % Clopper–Pearson bounds of it, from the finite number of studies.
        studies: simulated per number.
        alpha: of the test.
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
        simulate: draws people (`DirichletParticipants`, or anything like it).
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
    sizes = _sizes(participants, studies)
    require_within(STUDIES, studies, "studies")
    si.require("alpha", alpha, above=0.0, below=1.0)
    si.require("target", target, above=0.0, below=1.0)
    found = []
    for done, people in enumerate(sizes):
        found.append(_significant(simulate, test, people, studies, alpha, seed))
        if progress is not None:
            progress(done + 1, len(sizes))
    bounds = [proportion_interval(number, studies, method="Clopper–Pearson") for number in found]
    power = np.array(found) / studies
    low, high = np.array([b.low for b in bounds]), np.array([b.high for b in bounds])
    return PowerCurve(
        np.array(sizes),
        power,
        low,
        high,
        studies,
        alpha,
        target,
        _first_lasting(sizes, power >= target),
        _first_lasting(sizes, low >= target),
    )


def _sizes(participants: tuple[int, ...], studies: int) -> tuple[int, ...]:
    """Numbers of people, rising; refused where they or the studies are too few to simulate."""
    sizes = tuple(sorted(set(participants)))
    if not sizes or sizes[0] < 2 or studies < 10:
        raise InputError(
            f"participants = {sizes} with {studies} studies cannot be simulated; at least one size "
            "of at least 2, and at least 10 studies, are wanted"
        )
    return sizes


def _significant(
    simulate: ParticipantSimulator,
    test: Callable[[NDArray[Any]], float],
    people: int,
    studies: int,
    alpha: float,
    seed: int,
) -> int:
    """Studies of so many people, out of `studies` simulated, with p below `alpha`."""
    random = np.random.default_rng([seed, people])
    number = 0
    for _ in range(studies):
        p = float(test(simulate(people, random)))
        if not 0.0 <= p <= 1.0:
            raise InputError(f"the test returned p = {p}; it must return a p value of 0 to 1")
        number += p < alpha
    return number


def _first_lasting(sizes: tuple[int, ...], reached: NDArray[np.bool_]) -> int | None:
    # Reached here and at every larger size.
    lasting = np.flip(np.logical_and.accumulate(np.flip(reached)))
    return sizes[int(np.argmax(lasting))] if lasting.any() else None
