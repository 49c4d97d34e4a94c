"""Scales of surfaces: strengths by choices (Bradley–Terry, Plackett–Luce), exponents of magnitudes.

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
from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.confusion import proportion_interval
from squeezefilm.study.psychometric.estimate import Estimate, student, t_interval
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.tasks.findings import ConditionFinding, PersonEstimate, through
from squeezefilm.study.tasks.population import scatter_interval

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
    errors = np.sqrt(np.diag(covariance))
    findings = []
    for k, surface in enumerate(shown.tolist()):
        here = (order == k).any(axis=0)
        wins, pairs = int(before[k].sum()), int(before[k].sum() + before[:, k].sum())
        share = proportion_interval(wins, pairs, level)
        ln_strength = student(logs[k], errors[k], free, level, how)
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
        error = 1.0 / math.sqrt(float(information[0, 0]))
        estimate = student(value, error, math.inf, level, "Fisher, own orders")
        persons.append(PersonEstimate(main.people[person], estimate, order.shape[1], sure))
    return persons


# Every person has a scale of numbers of their own: an intercept of their own takes it out of the
# regression of ln number on ln stimulus, and modulus equalisation (Lane, Catania & Stevens 1961,
# 10.1121/1.1908600) out of geometric means.
def exponents(
    main: Answers, level: si.Dimensionless
) -> tuple[list[PersonEstimate], Estimate | None, Estimate | None]:
    """Each person's exponent with the t interval of their own line; the population's mean with
    that over people; and the spread over people."""
    people = np.unique(main.participant)
    persons = []
    for person in people:
        mine = main.participant == person
        x, y = np.log(main.values[main.presented[0][mine]]), np.log(main.estimate[mine])
        if x.size < 3 or np.ptp(x) == 0:
            continue
        line = stats.linregress(x, y)
        estimate = student(line.slope, line.stderr, x.size - 2, level, "t, own line")
        persons.append(PersonEstimate(main.people[person], estimate, x.size, False))
    return persons, *of_exponents(persons, level)


def of_exponents(
    persons: list[PersonEstimate], level: si.Dimensionless
) -> tuple[Estimate | None, Estimate | None]:
    """The population's mean exponent and its spread over people, without what each one's own error
    adds; of one person their own."""
    if len(persons) < 2:
        return persons[0].estimate if persons else None, None
    own = [person.estimate for person in persons]
    slopes = np.array([estimate.value for estimate in own])
    sure = float(stats.norm.isf((1 - level) / 2))
    errors = np.array([(estimate.high - estimate.low) / (2 * sure) for estimate in own])
    return t_interval(slopes, level), scatter_interval(slopes, errors**2, level)


def magnitude_conditions(
    main: Answers, level: si.Dimensionless
) -> tuple[tuple[ConditionFinding, ...], list[str]]:
    """Geometric mean of the numbers given to each stimulus, people's own scales taken out; and what
    needs care."""
    logs, people = np.log(main.estimate), np.unique(main.participant)
    scales, counts = [], []
    for person in people:
        mine = main.participant == person
        scales.append(logs[mine].mean())
        logs[mine] -= scales[-1]
        counts.append(np.bincount(main.presented[0][mine], minlength=len(main.surfaces)).tolist())
    notes = []
    if any(count != counts[0] for count in counts):
        notes.append(
            "people have not judged the stimuli equally often, so that their scales cannot be "
            "taken out exactly; the exponents do not suffer from it"
        )
    logs += np.mean(scales)
    findings = []
    for stimulus in sorted(np.unique(main.presented[0]), key=lambda s: main.values[s]):
        here = main.presented[0] == stimulus
        means = np.array(
            [
                logs[here & (main.participant == person)].mean()
                for person in np.unique(main.participant[here])
            ]
        )
        findings.append(
            ConditionFinding(
                main.surfaces[stimulus].name,
                float(main.values[stimulus]),
                int(here.sum()),
                means.size,
                magnitude=through(t_interval(means, level), math.exp),
            )
        )
    return tuple(findings), notes


def require_magnitudes(main: Answers) -> None:
    """Refuse stimuli without an amount, which have no logarithm. Raises `InputError`."""
    for one in np.unique(main.presented[0]):
        if not main.values[one] > 0.0:
            raise InputError(
                f"stimulus '{main.surfaces[one].name}' has {main.design.judged} 0; a power law "
                "needs amounts above 0. Leave it out of the design, or judge something else"
            )
