"""The course of a session: drift over the session, and whether they attended."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

from squeezefilm.core import quantities as si
from squeezefilm.study.psychometric.estimate import t_interval
from squeezefilm.study.record.answers import Answers

ATTENDS: si.Dimensionless = 0.95
"""Share of catch trials that a person who attends gets right; assumed."""
_DOUBTFUL = 0.05


@dataclass(frozen=True, slots=True)
class Drift:
    """Change of a quantity from a person's first trial to their last, over people.

    Attributes:
        quantity: what changed, in words.
        change: mean over people of each one's slope by least squares, over the whole session, in
            the quantity's unit.
        low, high: its t interval over people at `level`; NaN for one person.
        p_value: of no change, two-sided; NaN for one person.
        participants: with ten trials or more.
    """

    quantity: str
    change: float
    low: float
    high: float
    level: si.Dimensionless
    p_value: si.Dimensionless
    participants: int


@dataclass(frozen=True, slots=True)
class Attention:
    """A person's catch trials.

    `p_value` is the probability of no more right ones from a person who gets 95 % of them right;
    `attended` says that it is 5 % or more.
    """

    person: str
    right: int
    asked: int
    p_value: si.Dimensionless
    attended: bool


@dataclass(frozen=True, slots=True)
class Course:
    """The course of a session on one display: what drifted, and who attended; empty where nothing
    was recorded."""

    drift: tuple[Drift, ...]
    attention: tuple[Attention, ...]


def course_of(answers: Answers, display: int) -> Course:
    """The course of the main trials on a display (number in the design's order), and its catch
    trials."""
    main, drifts = answers.main(display), []
    if not np.isnan(main.correct).all() and not (main.series >= 0).any():
        drifts.append(drift(main, main.correct, "share of right answers"))
    times = main.response_time
    if np.isfinite(times).any():
        drifts.append(drift(main, np.log(np.where(times > 0, times, np.nan)), "ln response time"))
    caught = answers.take((answers.display == display) & (answers.phase == "catch"))
    return Course(tuple(value for value in drifts if value is not None), attention(caught))


def drift(
    main: Answers, values: si.FloatArray, quantity: str, level: si.Dimensionless = 0.95
) -> Drift | None:
    """The change of a quantity over each person's trials; None where nobody has ten.

    Place in the session runs from 0 at a person's first main trial to 1 at the last.
    """
    slopes = []
    for person in np.unique(main.participant):
        mine = main.participant == person
        mine &= np.isfinite(values)
        if np.count_nonzero(mine) < 10:
            continue
        # Not their numbers: what was asked again has a late one, and a foreign file any.
        place = np.linspace(0.0, 1.0, np.count_nonzero(mine))
        slopes.append(float(np.polyfit(place, values[mine], 1)[0]))
    if not slopes:
        return None
    mean, count, p = t_interval(np.array(slopes), level), len(slopes), math.nan
    if count > 1 and (error := float(np.std(slopes, ddof=1)) / math.sqrt(count)) > 0:
        p = float(2 * stats.t.sf(abs(mean.value) / error, count - 1))
    return Drift(quantity, mean.value, mean.low, mean.high, level, p, count)


def attention(caught: Answers) -> tuple[Attention, ...]:
    """Each person's catch trials, judged."""
    people = []
    for person in np.unique(caught.participant):
        right = caught.correct[caught.participant == person]
        right = right[np.isfinite(right)]
        if not right.size:
            continue
        people.append(judged(caught.people[person], int(right.sum()), right.size))
    return tuple(people)


def judged(person: str, right: int, asked: int) -> Attention:
    """Verdict on whether somebody who attends would miss so many catch trials."""
    p = float(stats.binom.cdf(right, asked, ATTENDS))
    return Attention(person, right, asked, p, p >= _DOUBTFUL)
