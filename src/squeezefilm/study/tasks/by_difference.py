"""Tasks answered by the size of a difference: Weber fractions, d′, criteria and false alarms.

The task's model says how often a difference of d′ = Δ/σ is told, Δ the difference of the logarithms
and σ the deviation of one percept (`design.tasks`): the differencing model of same or different,
the triangular one of odd one out. Each person's σ, criterion and lapse rate are integrated on a
grid. The Weber fraction is that of two intervals: the difference with d′ = 0.954, told in 75 % of
them. Between surfaces that have no amount to compare (shapes, maps, directions) there is no such
fraction: each pair has its d′, and each person one over all pairs, from the same "same" trials.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.senses import D_PRIME_OF_75
from squeezefilm.study.design.tasks.task import DifferenceModel
from squeezefilm.study.identification.proportions import proportion_interval
from squeezefilm.study.psychometric.discrimination import (
    corrected_proportion,
    differencing_sensitivity,
    sensitivity,
)
from squeezefilm.study.psychometric.estimate import Estimate
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.tasks.findings import ConditionFinding, PersonEstimate, through
from squeezefilm.study.tasks.population import LAPSES, lapse_weights
from squeezefilm.study.tasks.two_interval import (
    PeopleOnGrid,
    answers_anyhow,
    condition_finding,
    in_eighths,
    mean_sensitivity,
    spread_edges,
    t_interval,
)

_SPREADS = 121


def model_of(main: Answers) -> DifferenceModel:
    """The model of the answers' task, which must have one."""
    model = main.design.described.model
    assert model is not None
    return model


def told(main: Answers) -> NDArray[np.bool_]:
    """True for each trial whose answer is what the model counts: "different", or what is right."""
    counts = model_of(main).counts
    return np.asarray(main.choice == (main.right if counts < 0 else counts))


def apart(main: Answers) -> si.FloatArray:
    """Greatest difference of the logarithms between a trial's surfaces (1), of each trial."""
    logs = np.log(main.values)[main.presented]
    return np.asarray(np.round(logs.max(axis=0) - logs.min(axis=0), 12))


def on_grid_of_differences(main: Answers) -> PeopleOnGrid:
    """Likelihoods of each person's Weber fraction; `bias` is their criterion, in
    standard deviations of one percept (0 where the task has none)."""
    model, hit, distance = model_of(main), told(main), apart(main)
    every = np.unique(distance)
    edges = spread_edges(main, _SPREADS)
    spread = np.exp(0.5 * (edges[1:] + edges[:-1]))[:, None]
    log_p, log_q = [], []
    for one in every:
        rise = model.rate(one / spread, model.criteria)
        p = model.lapses * LAPSES + (1 - LAPSES) * np.minimum(rise, 1.0)[..., None]
        log_p.append(np.log(p))
        log_q.append(np.log1p(-p))
    prior = lapse_weights()
    weber = np.log(np.expm1(D_PRIME_OF_75 * np.exp(edges)))
    people = PeopleOnGrid([], weber, np.diff(edges), [], [], [], [], [])
    for person in np.unique(main.participant):
        mine = main.participant == person
        total = np.zeros((_SPREADS, model.criteria.size, LAPSES.size))
        for number, one in enumerate(every):
            said = hit[mine & (distance == one)]
            hits = int(np.count_nonzero(said))
            total += hits * log_p[number] + (said.size - hits) * log_q[number]
        greatest = float(total.max())
        whole = np.exp(total - greatest)
        people.names.append(main.people[person])
        people.likelihood.append(prior @ whole.mean(axis=1).T)
        trials = float(mine.sum())
        people.otherwise.append(_otherwise(model, float(hit[mine].sum()), trials, greatest))
        people.bias.append(float(whole.sum(axis=(0, 2)) @ model.criteria / whole.sum()))
        people.lapse.append(float(whole.sum(axis=(0, 1)) @ LAPSES / whole.sum()))
        people.trials.append(int(trials))
    return people


def _otherwise(model: DifferenceModel, hits: float, trials: float, greatest: float) -> float:
    """Likelihood of the answers from somebody who does not do the task, over one whose logarithm
    is `greatest`: what is right is met by chance, one of two answers is given at any rate."""
    if model.counts >= 0:
        return answers_anyhow(hits, trials, greatest)
    logs = hits * math.log(model.lapses) + (trials - hits) * math.log1p(-model.lapses)
    return math.exp(logs - greatest)


def difference_conditions(
    main: Answers, level: si.Dimensionless, seed: int
) -> tuple[ConditionFinding, ...]:
    """Each difference: how often it was told, and its d′; the first may be none at all."""
    distance, hit, design = apart(main), told(main), main.design
    here = design.judged_value(design.stimulus(design.reference))
    if design.adaptive:
        return _eighths(main, distance, here, level)
    findings = []
    for step in np.unique(distance):
        mine = distance == step
        others = {
            main.surfaces[k].name
            for k in np.unique(main.presented[:, mine])
            if main.values[k] != here
        }
        name = "the same" if step == 0.0 else " / ".join(sorted(others))
        d = None if step == 0.0 else _mean_d_prime(main, distance, float(step), level, seed)
        value = here * math.exp(float(step))
        findings.append(condition_finding(main, name, value, mine, hit, level, d))
    return tuple(findings)


def _eighths(
    main: Answers, distance: si.FloatArray, here: float, level: si.Dimensionless
) -> tuple[ConditionFinding, ...]:
    """Pairs that were the same, and those that a series chose in eighths by their difference."""
    order = np.argsort(distance, kind="stable")
    same = int(np.count_nonzero(distance == 0.0))
    parts = {"the same": order[:same]} if same else {}
    parts |= in_eighths(order[same:])
    values = {name: here * math.exp(float(distance[part].mean())) for name, part in parts.items()}
    return tuple(
        condition_finding(main, name, values[name], part, told(main), level)
        for name, part in parts.items()
    )


def _mean_d_prime(
    main: Answers, distance: si.FloatArray, one: float, level: float, seed: int
) -> Estimate | None:
    model, hit, counts = model_of(main), told(main), []
    if model.d_prime is not None:
        return _mean_of_right(main, distance == one, level)
    for person in np.unique(main.participant):
        mine = main.participant == person
        signal, noise = (hit[mine & (distance == value)] for value in (one, 0.0))
        if signal.size and noise.size:
            counts.append((int(signal.sum()), signal.size, int(noise.sum()), noise.size))
    return mean_sensitivity(counts, "differencing", differencing_sensitivity, level, seed)


def _mean_of_right(main: Answers, here: NDArray[np.bool_], level: float) -> Estimate:
    """d′ by the share of right answers alone: mean over people, or of one person's trials."""
    d_prime, hit = model_of(main).d_prime, told(main)
    assert d_prime is not None
    mine = [hit[here & (main.participant == one)] for one in np.unique(main.participant[here])]
    if len(mine) == 1:
        hits, trials = int(mine[0].sum()), mine[0].size
        bounds = proportion_interval(hits, trials, level, "Jeffreys")
        share = Estimate(hits / trials, bounds.low, bounds.high, level, "Jeffreys, over trials")
        return through(share, d_prime)
    shares = [corrected_proportion(int(answers.sum()), answers.size) for answers in mine]
    return t_interval(np.array([d_prime(one) for one in shares]), level)


def difference_numbers(
    main: Answers, criteria: list[float], level: si.Dimensionless
) -> dict[str, Estimate]:
    """False alarms and criterion, over people; none where the task has no criterion."""
    if model_of(main).criteria.size == 1:
        return {}
    criterion = t_interval(np.array(criteria), level)
    return {
        **false_alarms(main, level),
        "criterion (standard deviations of a percept)": criterion,
    }


def false_alarms(main: Answers, level: si.Dimensionless) -> dict[str, Estimate]:
    """The share of "different" where both were the same, over the people who had such a trial.

    Student's interval knows nothing of shares: of few people it would reach beyond 0 and 1, where
    no share can be, and is cut there.
    """
    alike = main.first == main.second
    shares = [
        np.mean(main.choice[alike & (main.participant == person)] == 1)
        for person in np.unique(main.participant[alike])
    ]
    if not shares:
        return {}
    found = t_interval(np.array(shares), level)
    # NumPy's keep the NaN of one person.
    low, high = float(np.maximum(found.low, 0.0)), float(np.minimum(found.high, 1.0))
    return {"false alarms (same called different)": replace(found, low=low, high=high)}


MEASURE = "sensitivity d′"
_MODEL = "differencing"


def unlike_conditions(
    main: Answers, level: si.Dimensionless, seed: int
) -> tuple[ConditionFinding, ...]:
    """Each pair: how often it was called different, and its d′; the first is the same twice."""
    alike, other = _pairs(main)
    findings = []
    for pair in (-1, *np.unique(other[~alike]).tolist()):
        mine = alike if pair < 0 else ~alike & (other == pair)
        if not mine.any():
            continue
        name = "the same" if pair < 0 else main.surfaces[pair].name
        counts = [] if pair < 0 else _counts(main, mine, alike)
        d = mean_sensitivity(counts, _MODEL, differencing_sensitivity, level, seed)
        findings.append(condition_finding(main, name, math.nan, mine, main.choice == 1, level, d))
    return tuple(findings)


def unlike_persons(
    main: Answers, level: si.Dimensionless, seed: int
) -> tuple[list[PersonEstimate], Estimate | None]:
    """Each person's d′ over all pairs with the interval of their own trials, and the mean over
    people with Student's."""
    alike, _ = _pairs(main)
    persons = []
    for person in np.unique(main.participant):
        mine = main.participant == person
        for counts in _counts(main, mine & ~alike, mine & alike):
            one = sensitivity(*counts, _MODEL, level=level, seed=seed)
            value = Estimate(one.sensitivity.d_prime, *one.interval, level, "Jeffreys, over trials")
            persons.append(PersonEstimate(main.people[person], value, int(mine.sum()), False))
    if len(persons) < 2:
        return persons, persons[0].estimate if persons else None
    means = np.array([one.estimate.value for one in persons])
    return persons, t_interval(means, level)


def _pairs(main: Answers) -> tuple[NDArray[np.bool_], si.IntArray]:
    """True for the same surface twice, and the number of the one that is not the reference."""
    names = [surface.name for surface in main.surfaces]
    here = names.index(main.design.reference) if main.design.reference in names else -1
    return main.first == main.second, np.where(main.first != here, main.first, main.second)


def _counts(
    main: Answers, signal: NDArray[np.bool_], noise: NDArray[np.bool_]
) -> list[tuple[int, int, int, int]]:
    """Hits, signals, false alarms and noises of each person who had both kinds of trial."""
    counts = []
    for person in np.unique(main.participant[signal]):
        mine = main.participant == person
        hits, alarms = main.choice[signal & mine] == 1, main.choice[noise & mine] == 1
        if hits.size and alarms.size:
            counts.append((int(hits.sum()), hits.size, int(alarms.sum()), alarms.size))
    return counts
