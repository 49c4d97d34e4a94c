"""Two intervals, which has more: each person's Weber fraction, d′, the bias for an interval.

One model for constant stimuli and adaptive series, of whatever was presented: P("first") = λ/2 +
(1 − λ) Φ((Δ − b)/s), with Δ the difference of the logarithms of the first and the second, s the
deviation of that difference's percept, b the person's bias for an interval and λ their lapse rate.
The Weber fraction is exp(0.674 s) − 1: the difference, in parts of the reference, that is told in
75 % of the trials in which somebody attends and has no bias. s, b and λ are integrated on a grid;
how stimuli were chosen does not matter to that.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.special import betaln

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.study.adaptive.series import adaptive_method
from squeezefilm.study.adaptive.staircase import Staircase
from squeezefilm.study.identification.proportions import proportion_interval
from squeezefilm.study.psychometric import kernel
from squeezefilm.study.psychometric.discrimination import (
    Sensitivity,
    corrected_proportion,
    sensitivity,
    two_interval_sensitivity,
)
from squeezefilm.study.psychometric.estimate import Estimate
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.tasks.findings import (
    ConditionFinding,
    PersonEstimate,
    PersonFunction,
    through,
)
from squeezefilm.study.tasks.population import (
    LAPSES,
    PersonLikelihood,
    Population,
    lapse_weights,
)

QUARTILE = 0.6744897501960817
"""Quartile of a normal deviate: 75 % lie below."""
# From 5 to 95 % of a normal distribution, which is what the kernel calls the width.
_WIDTH = 2 * 1.6448536269514722
_SPREADS, _BIASES = 81, 41
_MOST = 600.0


def comparisons(main: Answers) -> tuple[si.IntArray, NDArray[np.bool_]]:
    """The surface compared with the reference in each trial, and whether it was said to have
    more."""
    values, design = main.values, main.design
    here = design.judged_value(design.stimulus(design.reference))
    is_first = values[main.first] != here
    return np.where(is_first, main.first, main.second), (main.choice == 0) == is_first


def differences(main: Answers) -> si.FloatArray:
    """ln of what is judged of the first surface over the second, of each trial (1)."""
    logs = np.log(main.values)
    return np.asarray(np.round(logs[main.first] - logs[main.second], 12))


def spread_edges(main: Answers, cells: int) -> si.FloatArray:
    """Edges of the cells of ln s: from an eighth of the least difference that the design has to
    eight times the greatest, whatever was presented."""
    design = main.design
    if design.adaptive:
        ends = [
            math.log1p(x) for series in design.adaptive for x in (series.lowest, series.highest)
        ]
    else:
        here = math.log(design.judged_value(design.stimulus(design.reference)))
        logs = [abs(math.log(design.judged_value(stimulus)) - here) for stimulus in design.stimuli]
        ends = [log for log in logs if log > 0]
    return np.linspace(math.log(min(ends) / 8), math.log(8 * max(ends)), cells + 1)


@dataclass(frozen=True, eq=False)
class PeopleOnGrid:
    """Likelihoods of each person's answers.

    Attributes:
        names: of the people.
        edges: of the cells of ln(Weber fraction), shape (cells + 1,).
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
        return Population(
            [
                PersonLikelihood(middle, width, one, other)
                for one, other in zip(self.likelihood, self.otherwise, strict=True)
            ]
        )

    def estimates(self, level: si.Dimensionless) -> list[PersonEstimate]:
        """Each person's Weber fraction: the posterior's median and central interval, with the
        lapse rates that all people's answers speak for."""
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

    def functions(self, level: si.Dimensionless) -> dict[str, PersonFunction]:
        """Each person's Weber fraction, bias and lapse rate, to be drawn."""
        return {
            estimate.person: PersonFunction(estimate.estimate.value, bias, lapse)
            for estimate, bias, lapse in zip(
                self.estimates(level), self.bias, self.lapse, strict=True
            )
        }


def on_grid(main: Answers, tell: Callable[[str], None]) -> PeopleOnGrid:
    """Likelihoods of each person's Weber fraction by their answers to two intervals."""
    edges = spread_edges(main, _SPREADS)
    middle = 0.5 * (edges[1:] + edges[:-1])
    apart, first = differences(main), (main.choice == 0).astype(float)
    reach = float(np.abs(apart).max())
    biases = np.linspace(-0.5, 0.5, _BIASES) * reach
    prior = lapse_weights()
    people = PeopleOnGrid(
        [], np.log(np.expm1(QUARTILE * np.exp(edges))), np.diff(edges), [], [], [], [], []
    )
    for person in np.unique(main.participant):
        tell(f"psychometric function {len(people.names) + 1} of {len(main.people)}")
        mine = main.participant == person
        places, where = np.unique(apart[mine], return_inverse=True)
        k = np.bincount(where, first[mine]).astype(np.float64)
        n = np.bincount(where).astype(np.float64)
        wide = middle + math.log(_WIDTH)
        found = kernel.guessing_log_likelihood(kernel.GAUSSIAN, biases, wide, LAPSES, places, k, n)
        turned = kernel.guessing_log_likelihood(
            kernel.GAUSSIAN, biases, wide, LAPSES, places, n - k, n
        )
        greatest = float(found.max())
        whole, mixed_up = np.exp(found - greatest), np.exp(np.minimum(turned - greatest, _MOST))
        people.names.append(main.people[person])
        people.likelihood.append(prior @ whole.mean(axis=1))
        keys = answers_anyhow(float(k.sum()), float(n.sum()), greatest)
        people.otherwise.append(0.5 * keys + 0.5 * float((prior[1] @ mixed_up.mean(axis=1)).mean()))
        total = whole.sum()
        people.bias.append(float(whole.sum(axis=(0, 2)) @ biases / total))
        people.lapse.append(float(whole.sum(axis=(1, 2)) @ LAPSES / total))
        people.trials.append(int(mine.sum()))
    return people


def answers_anyhow(said: float, trials: float, greatest: float) -> float:
    """Likelihood of answers that do not go by the surfaces, over one whose logarithm is `greatest`:
    one of two is given with a probability that may be anything (Jeffreys' prior)."""
    logs = float(betaln(said + 0.5, trials - said + 0.5) - betaln(0.5, 0.5))
    return math.exp(min(logs - greatest, _MOST))


def two_interval_conditions(
    main: Answers, level: si.Dimensionless, seed: int
) -> tuple[ConditionFinding, ...]:
    """Each comparison: how often it was said to have more, and its d′ from the reference."""
    surface, more = comparisons(main)
    findings = []
    for stimulus in sorted(np.unique(surface), key=lambda s: main.values[s]):
        here = surface == stimulus
        d = _mean_d_prime(main, here, level, seed)
        name, value = main.surfaces[stimulus].name, float(main.values[stimulus])
        findings.append(condition_finding(main, name, value, here, more, level, d))
    return tuple(findings)


def adaptive_conditions(main: Answers, level: si.Dimensionless) -> tuple[ConditionFinding, ...]:
    """The trials of adaptive series in eighths by their difference: how often they were right, and
    the mean difference of each, in parts of the reference."""
    parts, right = in_eighths(np.argsort(main.intensity, kind="stable")), main.correct == 1
    return tuple(
        condition_finding(main, name, float(main.intensity[part].mean()), part, right, level)
        for name, part in parts.items()
    )


def in_eighths(order: si.IntArray) -> dict[str, si.IntArray]:
    """Trials in the order of their difference, in eighths by name; none is empty."""
    parts = np.array_split(order, 8)
    return {f"eighth {k + 1} of the differences": part for k, part in enumerate(parts) if part.size}


def condition_finding(
    main: Answers,
    name: str,
    value: float,
    part: NDArray[np.bool_] | si.IntArray,
    hit: NDArray[np.bool_],
    level: si.Dimensionless,
    d_prime: Estimate | None = None,
) -> ConditionFinding:
    """Answers in a part of the trials (a mask or indices), given which of all are hits:
    the share of hits with its interval over trials."""
    hits, trials = int(hit[part].sum()), int(hit[part].size)
    bounds = proportion_interval(hits, trials, level)
    share = Estimate(hits / trials, bounds.low, bounds.high, level, "Wilson, over trials")
    people = int(np.unique(main.participant[part]).size)
    return ConditionFinding(name, value, trials, people, share, d_prime)


def _mean_d_prime(
    main: Answers, here: NDArray[np.bool_], level: float, seed: int
) -> Estimate | None:
    """Mean d′ over people; the comparison counts as the signal where it is right to choose it."""
    counts = []
    for person in np.unique(main.participant[here]):
        mine = here & (main.participant == person)
        # "First" where the first has more, and where the second has.
        said, first_right = main.choice[mine] == 0, main.right[mine] == 0
        signals, noises = int(first_right.sum()), int((~first_right).sum())
        if signals and noises:
            counts.append(
                (int((said & first_right).sum()), signals, int((said & ~first_right).sum()), noises)
            )
    return mean_sensitivity(counts, "two-interval", two_interval_sensitivity, level, seed)


def mean_sensitivity(
    counts: list[tuple[int, int, int, int]],
    model: str,
    of: Callable[[float, float], Sensitivity],
    level: si.Dimensionless,
    seed: int,
) -> Estimate | None:
    """Mean over people of d′ from (hits, signals, false alarms, noises); None of nobody."""
    if not counts:
        return None
    if len(counts) == 1:
        one = sensitivity(*counts[0], model, level=level, seed=seed)
        return Estimate(one.sensitivity.d_prime, *one.interval, level, "Jeffreys, over trials")
    values = np.array(
        [
            of(corrected_proportion(hits, signals), corrected_proportion(alarms, noises)).d_prime
            for hits, signals, alarms, noises in counts
        ]
    )
    return t_interval(values, level)


def t_interval(values: si.FloatArray, level: si.Dimensionless) -> Estimate:
    """The mean of people's values with Student's interval; NaN ends for one person."""
    mean, reach = float(values.mean()), math.nan
    if values.size > 1:
        error = float(values.std(ddof=1)) / math.sqrt(values.size)
        reach = float(stats.t.isf((1 - level) / 2, values.size - 1)) * error
    return Estimate(mean, mean - reach, mean + reach, level, "t, over people")


def two_interval_numbers(main: Answers, level: si.Dimensionless) -> dict[str, Estimate]:
    """The bias for the first interval, and of staircases the mean of their reversals."""
    people = np.unique(main.participant)
    first = np.array([np.mean(main.choice[main.participant == person] == 0) for person in people])
    due = np.array([np.mean(main.right[main.participant == person] == 0) for person in people])
    numbers = {"bias for the first interval": t_interval(first - due, level)}
    for number, series in enumerate(main.design.adaptive):
        if series.method != "staircase":
            continue
        ends_of = [_reversals(main, person, number) for person in people]
        logs = np.log([ends for ends in ends_of if ends])
        if logs.size:
            target = 0.5 ** (1.0 / series.down)
            name = f"reversals of '{series.name}' ({100 * target:.1f} % right)"
            numbers[name] = through(t_interval(logs, level), math.exp)
    return numbers


def _reversals(main: Answers, person: int, series: int) -> float:
    mine = (main.participant == person) & (main.series == series)
    answers = zip(main.intensity[mine].tolist(), (main.correct[mine] == 1.0).tolist(), strict=True)
    method = adaptive_method(main.design.adaptive[series], answers)
    assert isinstance(method, Staircase)
    try:
        return method.threshold()
    except InputError:
        return 0.0
