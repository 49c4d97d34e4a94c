"""Strengths of surfaces by which of them were put before others: Bradley–Terry and Plackett–Luce.

Of the surfaces that are left the one with the strength wᵢ is put next with the probability wᵢ/Σw
(pairs: Bradley and Terry 1952, 10.1093/biomet/39.3-4.324; orders: Plackett 1975, 10.2307/2346567;
Luce 1959). ln w has the largest likelihood, which is concave, and finite where no group of surfaces
was always put before all others (Ford 1957, 10.2307/2308513). Intervals are over people: the
covariance is made of each one's sum of scores (Liang and Zeger 1986, 10.1093/biomet/73.1.13), with
Student's t.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from scipy import stats
from scipy.optimize import minimize
from scipy.sparse.csgraph import connected_components
from scipy.special import softmax

from squeezefilm.core import quantities as si
from squeezefilm.study.identification.proportions import proportion_interval
from squeezefilm.study.psychometric.estimate import Estimate
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.tasks.findings import ConditionFinding, PersonEstimate, through

_HELD = 4.0
"""Deviation of ln w about its mean that is held possible where answers do not bound it. Assumed."""
_POLISHED = 3


def likelihood(
    order: si.IntArray, logs: si.FloatArray
) -> tuple[float, si.FloatArray, si.FloatArray]:
    """ln likelihood of orders under ln strengths (surfaces,); its derivative by each, of each
    trial, shape (trials, surfaces); and the information, shape (surfaces, surfaces).

    `order` has the numbers of a trial's surfaces, the one put first first; (places, trials).
    """
    trials = np.arange(order.shape[1])
    total, scores = 0.0, np.zeros((trials.size, logs.size))
    information = np.zeros((logs.size, logs.size))
    for place in range(order.shape[0] - 1):
        left = order[place:]
        chances = softmax(logs[left], axis=0)
        total += float(np.log(chances[0]).sum())
        expected = np.zeros_like(scores)
        for surface, chance in zip(left, chances, strict=True):
            expected[trials, surface] = chance
        scores[trials, left[0]] += 1.0
        scores -= expected
        information += np.diag(expected.sum(axis=0)) - expected.T @ expected
    return total, scores, information


def fitted(
    order: si.IntArray, terms: si.FloatArray, held: bool
) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray]:
    """Coefficients of ln w = terms · coefficients that fit orders best; each trial's derivatives
    and the information, by coefficient. Where they are `held`, ln w is normal about 0.

    `terms` has the shape (surfaces, coefficients).
    """
    pull = terms.T @ terms / _HELD**2 if held else np.zeros((terms.shape[1],) * 2)

    def loss(values: si.FloatArray) -> tuple[float, si.FloatArray]:
        total, scores, _ = likelihood(order, terms @ values)
        slope = scores.sum(axis=0) @ terms - pull @ values
        return 0.5 * float(values @ pull @ values) - total, -slope

    start = np.zeros(terms.shape[1])
    values = minimize(loss, start, jac=True, method="BFGS").x
    # Newton's steps: robust intervals ask that the derivatives of all trials end in nothing.
    for _ in range(_POLISHED):
        _, scores, information = likelihood(order, terms @ values)
        bend = terms.T @ information @ terms + pull
        values = values - np.linalg.pinv(bend, hermitian=True) @ loss(values)[1]
    _, scores, information = likelihood(order, terms @ values)
    return values, scores @ terms, terms.T @ information @ terms + pull


def strengths(
    main: Answers, level: si.Dimensionless
) -> tuple[tuple[ConditionFinding, ...], list[str]]:
    """Strength of each surface, whose geometric mean is 1, with its interval; and what needs
    care."""
    shown, order = np.unique(main.in_order, return_inverse=True)
    order = order.reshape(main.presented.shape)
    size, people = shown.size, np.unique(main.participant, return_inverse=True)[1]
    before = np.zeros((size, size), dtype=np.int64)
    for first, then in itertools.combinations(order, 2):
        np.add.at(before, (first, then), 1)
    linked = connected_components(before, connection="strong")[0] == 1
    logs, scores, information = fitted(order, np.eye(size), not linked)
    covariance, free, how = np.linalg.pinv(information), math.inf, "Fisher information, over trials"
    if linked and people.max() > 0:
        sums = np.zeros((people.max() + 1, size))
        np.add.at(sums, people, scores)
        free, how = float(people.max()), "t, over people, robust"
        covariance = covariance @ (sums.T @ sums) @ covariance * (free + 1) / free
    from_mean = np.eye(size) - 1 / size
    logs, covariance = from_mean @ logs, from_mean @ covariance @ from_mean
    reach = float(stats.t.isf((1 - level) / 2, free)) * np.sqrt(np.diag(covariance))
    findings = []
    for k, surface in enumerate(shown.tolist()):
        here = (order == k).any(axis=0)
        wins, pairs = int(before[k].sum()), int(before[k].sum() + before[:, k].sum())
        share = proportion_interval(wins, pairs, level)
        ln_strength = Estimate(logs[k], logs[k] - reach[k], logs[k] + reach[k], level, how)
        findings.append(
            ConditionFinding(
                main.surfaces[surface].name,
                float(main.values[surface]),
                int(here.sum()),
                int(np.unique(main.participant[here]).size),
                share,
                magnitude=through(ln_strength, math.exp),
            )
        )
    notes = []
    if not linked:
        notes.append(
            "some surfaces were always put before all others, so that the answers do not bound how "
            f"much stronger they are: ln strengths are held within a deviation of {_HELD:g}, and "
            "intervals are over trials"
        )
    key = main.values[shown] if np.isfinite(main.values[shown]).all() else -logs
    return tuple(findings[k] for k in np.argsort(key, kind="stable")), notes


def rank_exponents(main: Answers, level: si.Dimensionless) -> list[PersonEstimate]:
    """Each person's exponent: the power of what is judged with which strengths grow, by their own
    orders, with the interval of their own Fisher information.

    Somebody whose orders are all those of the amounts, or all turned, does not bound it.
    """
    levels = np.array([main.design.level(surface) for surface in main.surfaces])
    levels -= levels.mean()
    persons = []
    for person in np.unique(main.participant):
        order = main.in_order[:, main.participant == person]
        steps = np.diff(levels[order], axis=0)
        sure = bool((steps <= 0).all() or (steps >= 0).all())
        (value,), _, information = fitted(order, levels[:, None], sure)
        reach = float(stats.norm.isf((1 - level) / 2)) / math.sqrt(float(information[0, 0]))
        estimate = Estimate(value, value - reach, value + reach, level, "Fisher, own orders")
        persons.append(PersonEstimate(main.people[person], estimate, order.shape[1], sure))
    return persons
