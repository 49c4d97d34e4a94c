"""Same or different: the differencing model, Weber fractions, d′ and criteria.

The difference of two percepts decides: P("different" | Δ) = λ/2 + (1 − λ) [Φ((Δ/σ − k)/√2) +
Φ((−Δ/σ − k)/√2)], with Δ the difference of the logarithms, σ the deviation of one percept, k the
person's criterion and λ their lapse rate (Macmillan and Creelman 2005, chapter 9). Each person's
σ, k and λ are integrated on a grid. The Weber fraction is that of two intervals: the difference
with d′ = 0.954, told in 75 % of them.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.special import ndtr

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.senses import D_PRIME_OF_75
from squeezefilm.study.psychometric.discrimination import differencing_sensitivity
from squeezefilm.study.psychometric.estimate import Estimate
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.tasks.findings import ConditionFinding
from squeezefilm.study.tasks.population import LAPSES, lapse_weights
from squeezefilm.study.tasks.two_interval import (
    PeopleOnGrid,
    answers_anyhow,
    condition_finding,
    differences,
    in_eighths,
    mean_sensitivity,
    spread_edges,
    t_interval,
)

_SPREADS, _CRITERIA = 121, 81
_LARGEST_CRITERION = 8.0


def same_different_on_grid(main: Answers) -> PeopleOnGrid:
    """What each person's answers say of their Weber fraction; `bias` is their criterion, in
    standard deviations of one percept."""
    apart = np.abs(differences(main))
    every = np.unique(apart)
    edges = spread_edges(main, _SPREADS)
    spread = np.exp(0.5 * (edges[1:] + edges[:-1]))[:, None]
    limits = _LARGEST_CRITERION * (np.arange(_CRITERIA) + 0.5) / _CRITERIA
    log_p, log_q = [], []
    for one in every:
        z = one / spread
        rise = ndtr((z - limits) / math.sqrt(2)) + ndtr((-z - limits) / math.sqrt(2))
        p = 0.5 * LAPSES + (1 - LAPSES) * rise[..., None]
        log_p.append(np.log(p))
        log_q.append(np.log1p(-p))
    prior = lapse_weights()
    weber = np.log(np.expm1(D_PRIME_OF_75 * np.exp(edges)))
    people = PeopleOnGrid([], weber, np.diff(edges), [], [], [], [], [])
    for person in np.unique(main.participant):
        mine = main.participant == person
        total = np.zeros((_SPREADS, _CRITERIA, LAPSES.size))
        for number, one in enumerate(every):
            said = main.choice[mine & (apart == one)]
            different = int(np.count_nonzero(said == 1))
            total += different * log_p[number] + (said.size - different) * log_q[number]
        whole = np.exp(total - total.max())
        people.names.append(main.people[person])
        people.likelihood.append(prior @ whole.mean(axis=1).T)
        said = float(np.count_nonzero(main.choice[mine] == 1))
        people.otherwise.append(answers_anyhow(said, float(mine.sum()), float(total.max())))
        people.bias.append(float(whole.sum(axis=(0, 2)) @ limits / whole.sum()))
        people.lapse.append(float(whole.sum(axis=(0, 1)) @ LAPSES / whole.sum()))
        people.trials.append(int(mine.sum()))
    return people


def same_different_conditions(
    main: Answers, level: si.Dimensionless, seed: int
) -> tuple[ConditionFinding, ...]:
    """Each difference: how often it was called different, and its d′; the first is none at all."""
    apart = np.abs(differences(main))
    design = main.design
    here = design.judged_value(design.stimulus(design.reference))
    if design.adaptive:
        return _eighths(main, apart, here, level)
    found = []
    for one in np.unique(apart):
        mine = apart == one
        others = {
            main.surfaces[k].name
            for pair in (main.first[mine], main.second[mine])
            for k in pair
            if main.values[k] != here
        }
        name = "the same" if one == 0.0 else " / ".join(sorted(others))
        d = None if one == 0.0 else _mean_d_prime(main, apart, float(one), level, seed)
        value = here * math.exp(float(one))
        found.append(condition_finding(main, name, value, mine, main.choice == 1, level, d))
    return tuple(found)


def _eighths(
    main: Answers, apart: si.FloatArray, here: float, level: si.Dimensionless
) -> tuple[ConditionFinding, ...]:
    """Pairs that were the same, and those that a series chose in eighths by their difference."""
    order = np.argsort(apart, kind="stable")
    same = int(np.count_nonzero(apart == 0.0))
    parts = {"the same": order[:same]} if same else {}
    parts |= in_eighths(order[same:])
    values = {name: here * math.exp(float(apart[part].mean())) for name, part in parts.items()}
    return tuple(
        condition_finding(main, name, values[name], part, main.choice == 1, level)
        for name, part in parts.items()
    )


def _mean_d_prime(
    main: Answers, apart: si.FloatArray, one: float, level: float, seed: int
) -> Estimate | None:
    counts = []
    for person in np.unique(main.participant):
        mine = main.participant == person
        signal, noise = (main.choice[mine & (apart == value)] == 1 for value in (one, 0.0))
        if signal.size and noise.size:
            counts.append((int(signal.sum()), signal.size, int(noise.sum()), noise.size))
    return mean_sensitivity(counts, "differencing", differencing_sensitivity, level, seed)


def same_different_numbers(
    main: Answers, criteria: list[float], level: si.Dimensionless
) -> dict[str, Estimate]:
    """False alarms and criterion, over people."""
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
        np.mean(main.choice[alike & (main.participant == one)] == 1)
        for one in np.unique(main.participant[alike])
    ]
    if not shares:
        return {}
    found = t_interval(np.array(shares), level)
    # NumPy's keep the NaN of one person.
    low, high = float(np.maximum(found.low, 0.0)), float(np.minimum(found.high, 1.0))
    return {"false alarms (same called different)": replace(found, low=low, high=high)}
