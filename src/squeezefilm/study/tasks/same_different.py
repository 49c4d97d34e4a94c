"""Same or different: the differencing model, Weber fractions, d′ and criteria.

The difference of two percepts decides: P("different" | Δ) = λ/2 + (1 − λ) [Φ((Δ/σ − k)/√2) +
Φ((−Δ/σ − k)/√2)], with Δ the difference of the logarithms, σ the deviation of one percept, k the
person's criterion and λ their lapse rate (Macmillan and Creelman 2005, chapter 9). Each person's
σ, k and λ are integrated on a grid. The Weber fraction is that of two intervals: the difference
with d′ = 0.954, told in 75 % of them.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.special import ndtr

from squeezefilm import quantities as si
from squeezefilm.perception.senses import D_PRIME_OF_75
from squeezefilm.study.identification.proportions import proportion_interval
from squeezefilm.study.psychometric.discrimination import differencing_sensitivity
from squeezefilm.study.psychometric.prior import PsychometricPrior
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.tasks.findings import ConditionFinding, Estimate, PersonEstimate
from squeezefilm.study.tasks.population import PersonLikelihood
from squeezefilm.study.tasks.two_interval import mean_sensitivity, t_interval

_SPREADS, _CRITERIA, _LAPSES = 161, 81, 8
_LARGEST_CRITERION = 8.0


def differences(main: Answers) -> si.FloatArray:
    """|ln of the ratio| of what is judged of the two surfaces of each trial (1)."""
    logs = np.log(main.values)
    return np.asarray(np.round(np.abs(logs[main.first] - logs[main.second]), 12))


def same_different_fractions(
    main: Answers, level: si.Dimensionless
) -> tuple[list[PersonEstimate], list[PersonLikelihood], dict[str, float]]:
    """Each person's Weber fraction, what their answers say of its logarithm, and their criterion
    (in standard deviations of one percept)."""
    apart, every = differences(main), np.unique(differences(main))
    largest, least = float(every.max()), float(every[every > 0].min())
    edges = np.linspace(math.log(least / 8), math.log(8 * largest), _SPREADS + 1)
    middle = 0.5 * (edges[1:] + edges[:-1])
    limits = _LARGEST_CRITERION * (np.arange(_CRITERIA) + 0.5) / _CRITERIA
    prior = PsychometricPrior((0.0, 1.0), (0.1, 1.0))
    lapses = prior.quantile(2, (np.arange(_LAPSES) + 0.5) / _LAPSES, "linear")
    log_p, log_q = [], []
    for one in every:
        z = one / np.exp(middle)[:, None]
        rise = ndtr((z - limits) / math.sqrt(2)) + ndtr((-z - limits) / math.sqrt(2))
        p = 0.5 * lapses + (1 - lapses) * rise[..., None]
        log_p.append(np.log(p))
        log_q.append(np.log1p(-p))
    persons, likelihoods, criteria = [], [], {}
    for person in np.unique(main.participant):
        mine = main.participant == person
        total = np.zeros((_SPREADS, _CRITERIA, _LAPSES))
        for number, one in enumerate(every):
            said = main.choice[mine & (apart == one)]
            different = int(np.count_nonzero(said == 1))
            total += different * log_p[number] + (said.size - different) * log_q[number]
        weight = np.exp(total - total.max())
        marginal = weight.sum(axis=(1, 2))
        heights = np.concatenate([[0.0], np.cumsum(marginal)]) / marginal.sum()
        shares = 0.5, 0.5 * (1 - level), 0.5 * (1 + level)
        found = np.expm1(D_PRIME_OF_75 * np.exp(np.interp(shares, heights, edges)))
        value, low, high = (float(one) for one in found)
        name = main.people[person]
        bounded = max(marginal[0], marginal[-1]) > 0.05 * marginal.max()
        estimate = Estimate(value, low, high, level, "posterior")
        persons.append(PersonEstimate(name, estimate, int(mine.sum()), bool(bounded)))
        x = np.log(np.expm1(D_PRIME_OF_75 * np.exp(edges)))
        likelihoods.append(
            PersonLikelihood(0.5 * (x[1:] + x[:-1]), np.diff(x), marginal / np.diff(edges))
        )
        over_limits = weight.sum(axis=(0, 2))
        criteria[name] = float(limits @ over_limits / over_limits.sum())
    return persons, likelihoods, criteria


def same_different_conditions(
    main: Answers, level: si.Dimensionless, seed: int
) -> tuple[ConditionFinding, ...]:
    """Each difference: how often it was called different, and its d′; the first is none at all."""
    apart = differences(main)
    design = main.design
    here = design.judged_value(design.stimulus(design.reference))
    found = []
    for one in np.unique(apart):
        mine = apart == one
        hits, trials = int((main.choice[mine] == 1).sum()), int(mine.sum())
        bounds = proportion_interval(hits, trials, level)
        others = {
            main.surfaces[k].name
            for pair in (main.first[mine], main.second[mine])
            for k in pair
            if main.values[k] != here
        }
        name = "the same" if one == 0.0 else " / ".join(sorted(others))
        d = None if one == 0.0 else _mean_d_prime(main, apart, float(one), level, seed)
        found.append(
            ConditionFinding(
                name,
                here * math.exp(float(one)),
                trials,
                int(np.unique(main.participant[mine]).size),
                Estimate(hits / trials, bounds.low, bounds.high, level, "Wilson, over trials"),
                d,
            )
        )
    return tuple(found)


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
    main: Answers, criteria: dict[str, float], level: si.Dimensionless
) -> dict[str, Estimate]:
    """False alarms and criterion, over people."""
    apart, people = differences(main), np.unique(main.participant)
    alarms = [np.mean(main.choice[(main.participant == one) & (apart == 0)] == 1) for one in people]
    return {
        "false alarms (same called different)": t_interval(np.array(alarms), level),
        "criterion (standard deviations of a percept)": t_interval(
            np.array(list(criteria.values())), level
        ),
    }
