"""Each person's threshold: by answers to differences, on a grid; by settings and turning points.

A task's model says how often an answer is given to a difference Δ of levels (logarithms of what is
judged, or amounts) by a person who attends (`design.tasks`). Each person's deviation σ, criterion
(or bias) and lapse rate are integrated; how differences were chosen does not matter to that. The
threshold is what is told in 75 % of two intervals by somebody without a bias: of logarithms the
Weber fraction, of amounts an amount.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import betaln, ndtr

from squeezefilm.core import quantities as si
from squeezefilm.study.adaptive.series import adaptive_method
from squeezefilm.study.adaptive.staircase import Ending, Runs
from squeezefilm.study.design.tasks.surfaces import QUARTILE
from squeezefilm.study.design.tasks.task import DifferenceModel
from squeezefilm.study.psychometric.estimate import Estimate, student, t_interval
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.tasks.findings import (
    EQUALITY,
    ConditionFinding,
    Measured,
    PersonEstimate,
    PersonFunction,
    through,
)
from squeezefilm.study.tasks.population import LAPSES, Population, lapse_weights

_SPREADS = 101
_MOST = 600.0


@dataclass(frozen=True, eq=False)
class PeopleOnGrid:
    """Likelihoods of each person's answers.

    Attributes:
        names: of the people.
        edges: of the cells of ln(threshold), shape (cells + 1,).
        flat: prior probability of each cell, up to a factor, shape (cells,).
        likelihood: of a person's answers under each mean lapse rate, shape (lapses, cells).
        bias: mean of the person's bias or criterion.
        lapse: mean of the person's lapse rate (1).
        trials: of each person.
        otherwise: likelihood of each one's answers from somebody who does not do the task.
    """

    names: list[str]
    edges: si.FloatArray
    flat: si.FloatArray
    likelihood: list[si.FloatArray]
    bias: list[float]
    lapse: list[float]
    trials: list[int]
    otherwise: list[float]

    @cached_property
    def population(self) -> Population:
        """All of them, put together once."""
        middle, width = 0.5 * (self.edges[1:] + self.edges[:-1]), np.diff(self.edges)
        return Population(middle, width, self.likelihood, self.otherwise)

    def estimates(self, level: si.Dimensionless) -> list[PersonEstimate]:
        """Each person's threshold: the posterior's median and central interval, with the lapse
        rates that all people's answers speak for."""
        lapses = self.population.lapses()
        people = []
        tails = 0.5, 0.5 * (1 - level), 0.5 * (1 + level)
        for name, likelihood, trials in zip(self.names, self.likelihood, self.trials, strict=True):
            density = lapses @ (likelihood / likelihood.max())
            heights = np.concatenate([[0.0], np.cumsum(density * self.flat)])
            value, low, high = np.exp(np.interp(tails, heights / heights[-1], self.edges)).tolist()
            unbounded = max(density[0], density[-1]) > 0.05 * density.max()
            estimate = Estimate(value, low, high, level, "posterior")
            people.append(PersonEstimate(name, estimate, trials, bool(unbounded)))
        return people

    def functions(self, persons: list[PersonEstimate]) -> dict[str, PersonFunction]:
        """Each person's threshold, bias and lapse rate, to be drawn; `persons` are `estimates`."""
        return {
            person.person: PersonFunction(person.estimate.value, bias, lapse)
            for person, bias, lapse in zip(persons, self.bias, self.lapse, strict=True)
        }


def on_grid(main: Answers, tell: Callable[[str], None] = lambda _: None) -> PeopleOnGrid:
    """Likelihoods of each person's threshold, of any task with a model; `tell` hears of each."""
    model, apart, hit = main.model, main.differences, main.told
    # From an eighth of the least difference that the design has to eight times the greatest.
    ends = main.design.differences
    edges = np.linspace(math.log(min(ends) / 8), math.log(8 * max(ends)), _SPREADS + 1)
    deviations = np.exp(0.5 * (edges[1:] + edges[:-1]))
    scale = float(np.abs(apart).max()) if model.rate is None else 1.0
    criteria = model.criteria * scale
    logs = _logs(model, criteria, deviations)
    prior = lapse_weights()
    thresholds = model.threshold * np.exp(edges)
    thresholds = np.log(thresholds if main.design.in_amounts else np.expm1(thresholds))
    people = PeopleOnGrid([], thresholds, np.diff(edges), [], [], [], [], [])
    for person in np.unique(main.participant):
        tell(f"psychometric function {len(people.names) + 1} of {len(main.people)}")
        mine = main.participant == person
        places, where = np.unique(apart[mine], return_inverse=True)
        k = np.bincount(where, hit[mine].astype(float)).astype(np.float64)
        n = np.bincount(where).astype(np.float64)
        found = logs(places, k, n)
        greatest = float(found.max())
        whole = np.exp(found - greatest)
        likely = whole * prior.mean(axis=0)[:, None, None]
        likely /= likely.sum()
        people.names.append(main.people[person])
        people.likelihood.append(prior @ whole.mean(axis=1))
        anyhow = _anyhow(model, float(k.sum()), float(n.sum()), greatest)
        if model.rate is None:
            mixed_up = np.exp(np.minimum(logs(places, n - k, n) - greatest, _MOST))
            anyhow = 0.5 * anyhow + 0.5 * float((prior[1] @ mixed_up.mean(axis=1)).mean())
        people.otherwise.append(anyhow)
        people.bias.append(float(likely.sum(axis=(0, 2)) @ criteria))
        people.lapse.append(float(likely.sum(axis=(1, 2)) @ LAPSES))
        people.trials.append(int(mine.sum()))
    return people


_Logs = Callable[[si.FloatArray, si.FloatArray, si.FloatArray], si.FloatArray]
"""ln likelihood of k counted answers of n at places, shape (lapses, criteria, deviations)."""


def _logs(model: DifferenceModel, criteria: si.FloatArray, deviations: si.FloatArray) -> _Logs:
    """P = g λ + (1 − λ) rate(Δ/σ, k), with g the share of such answers among lapses; without a
    rate Φ((Δ − k)/σ) in its place."""
    lapses, criterion = LAPSES[:, None, None], criteria[:, None]

    # Answers to hundreds of differences would fill the memory.
    @functools.lru_cache(maxsize=256)
    def both(place: float) -> tuple[si.FloatArray, si.FloatArray]:
        if model.rate is None:
            rise = ndtr((place - criterion) / deviations)
        else:
            rise = np.minimum(model.rate(place / deviations, criterion), 1.0)
        p = model.lapses * lapses + (1 - lapses) * rise
        return np.log(p), np.log1p(-p)

    def logs(places: si.FloatArray, k: si.FloatArray, n: si.FloatArray) -> si.FloatArray:
        total = np.zeros((LAPSES.size, criteria.size, deviations.size))
        for place, hits, trials in zip(places.tolist(), k, n, strict=True):
            said, not_said = both(place)
            total += hits * said + (trials - hits) * not_said
        return total

    return logs


def _anyhow(model: DifferenceModel, hits: float, trials: float, greatest: float) -> float:
    """Likelihood of answers that do not go by the surfaces, over one whose logarithm is `greatest`:
    by chance, or one of two with a probability that may be anything (Jeffreys' prior)."""
    logs = float(betaln(hits + 0.5, trials - hits + 0.5) - betaln(0.5, 0.5))
    if model.counts < 0:
        logs = hits * math.log(model.lapses) + (trials - hits) * math.log1p(-model.lapses)
    return math.exp(min(logs - greatest, _MOST))


def endings(main: Answers, person: int) -> list[Ending]:
    """Where the runs of a person ended, of all series, in their order."""
    found: list[Ending] = []
    names = main.design.answers
    for number, series in enumerate(main.design.adaptive):
        mine = (main.participant == person) & (main.series == number)
        said = [names[k] for k in main.choice[mine]]
        given = zip(main.intensity[mine].tolist(), said, strict=True)
        method = adaptive_method(series, given, main.design.task)
        assert isinstance(method, Runs)
        found += method.endings
    return found


def settings_of(
    main: Answers, level: si.Dimensionless, _seed: int, tell: Callable[[str], None]
) -> Measured:
    """Results of runs: each person's mean with Student's interval over their runs; the mean over
    people of runs from above and from below; and the difference that is just told, by the scatter
    of runs.

    Against a flat surface it is the threshold, an amount; else the point of equality, a difference
    from the reference in its parts. Means are of what the design takes differences of: amounts, or
    their logarithms. Nobody with fewer than two runs has a value.
    """
    tell("runs of each person")
    in_amounts = main.design.in_amounts
    measure = "threshold" if main.design.described.reference == "flat" else EQUALITY
    # Of logarithms half and twice the reference are as far from it.
    back: Callable[[float], float] = float if in_amounts else math.expm1
    persons, spreads = [], []
    halves: dict[bool, list[si.FloatArray]] = {True: [], False: []}
    people = np.unique(main.participant)
    for person in people:
        runs = endings(main, person)
        if len(runs) < 2:
            continue
        levels = np.array([run.level for run in runs])
        levels, is_down = levels if in_amounts else np.log1p(levels), [run.is_down for run in runs]
        sides = [levels[np.equal(is_down, begins_above)] for begins_above in halves]
        for each, some in zip(halves.values(), sides, strict=True):
            each += [some] if some.size else []
        own, deviation = _own([some for some in sides if some.size], level)
        persons.append(PersonEstimate(main.people[person], through(own, back), len(runs), False))
        spreads.append(QUARTILE * deviation)
    conditions = tuple(
        ConditionFinding(
            "from above" if is_down else "from below",
            math.nan,
            sum(ends.size for ends in each),
            len(each),
            magnitude=through(t_interval(np.array([ends.mean() for ends in each]), level), back),
        )
        for is_down, each in halves.items()
        if each
    )
    more = {}
    if spreads:
        just_told = through(t_interval(np.array(spreads), level), back)
        more["difference just told, by the scatter"] = just_told
    lacking = people.size - len(persons)
    notes = [f"{lacking} of {people.size} people ended fewer than two runs"] if lacking else []
    if len(persons) == 1:
        notes.append("one participant: the interval is over their runs, and says nothing of others")
    pooled = of_settings(measure, in_amounts, persons, level)
    return Measured(measure, tuple(persons), pooled, None, conditions, tuple(notes), more)


def _own(sides: list[si.FloatArray], level: float) -> tuple[Estimate, float]:
    """The mean of the means from above and from below, so that neither weighs more by ending more
    runs, and the deviation of runs within a side; with one run from each the deviation of both."""
    free = sum(some.size - 1 for some in sides)
    if free < 1:
        ends = np.concatenate(sides)
        return t_interval(ends, level, "t, over runs"), float(ends.std(ddof=1))
    value = float(np.mean([some.mean() for some in sides]))
    variance = sum(float(((some - some.mean()) ** 2).sum()) for some in sides) / free
    error = math.sqrt(variance * sum(1 / some.size for some in sides)) / len(sides)
    return student(value, error, free, level, "t, over runs"), math.sqrt(variance)


def of_settings(
    measure: str, in_amounts: bool, persons: list[PersonEstimate], level: si.Dimensionless
) -> Estimate | None:
    """The mean over people with Student's interval: of logarithms, but for a point of equality
    where differences are of amounts; of one person their own."""
    if len(persons) < 2:
        return persons[0].estimate if persons else None
    values = np.array([person.estimate.value for person in persons])
    if measure == EQUALITY and in_amounts:
        return t_interval(values, level)
    if measure == EQUALITY:
        return through(t_interval(np.log1p(values), level), math.expm1)
    return through(t_interval(np.log(values), level), math.exp)
