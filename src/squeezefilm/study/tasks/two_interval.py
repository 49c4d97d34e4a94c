"""Two intervals, which has more: psychometric functions, Weber fractions, d′, the intervals' bias.

Constant stimuli are fitted as "the comparison has more" over ln of the comparison, with lapses to
either side; adaptive series as "correct" over the difference, with a guess rate of ½. Both give a
Weber fraction: the difference, in parts of the reference, that is told in 75 % of the trials in
which somebody attends. People are put together by `population`.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.study.identification.proportions import proportion_interval
from squeezefilm.study.psychometric.discrimination import (
    Sensitivity,
    corrected_proportion,
    sensitivity,
    two_interval_sensitivity,
)
from squeezefilm.study.psychometric.fit import PsychometricFit, fit_psychometric
from squeezefilm.study.psychometric.prior import PsychometricPrior
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.tasks.findings import ConditionFinding, Estimate, PersonEstimate, through
from squeezefilm.study.tasks.population import PersonLikelihood

_QUARTILE = 0.6744897501960817
_TAIL = 1.6448536269514722
# ln(1 + Weber fraction) over the width of a Gaussian function on a logarithmic axis.
_PER_WIDTH = _QUARTILE / (2.0 * _TAIL)


def comparisons(main: Answers) -> tuple[si.IntArray, NDArray[np.bool_], NDArray[np.bool_]]:
    """Of each trial the surface compared with the reference, whether it came first, and whether it
    was said to have more."""
    values = main.values
    design = main.design
    here = design.judged_value(design.stimulus(design.reference))
    is_first = values[main.first] != here
    surface = np.where(is_first, main.first, main.second)
    return surface, is_first, (main.choice == 0) == is_first


def weber_fractions(
    main: Answers, level: si.Dimensionless, tell: Callable[[str], None]
) -> tuple[list[PersonEstimate], list[PersonLikelihood], dict[str, PsychometricFit]]:
    """Each person's Weber fraction, what their answers say of its logarithm, and their function."""
    persons, likelihoods, fits = [], [], {}
    for count, person in enumerate(np.unique(main.participant)):
        name = main.people[person]
        tell(f"psychometric function {count + 1} of {len(main.people)}")
        mine = main.take(main.participant == person)
        adaptive = (mine.series >= 0).any()
        fit = _fit_adaptive(mine, level) if adaptive else _fit_constant(mine, level)
        parameter = "threshold" if adaptive else "width"
        shift: Callable[[si.FloatLike], si.FloatArray] = (
            np.asarray if adaptive else (lambda width: np.expm1(_PER_WIDTH * np.asarray(width)))
        )
        low, high = (float(shift(one)) for one in fit.posterior_interval[parameter])
        # The middle of what the answers allow: the likeliest width is biased where they are few.
        value = float(shift(fit.posterior.quantile(parameter, 0.5)))
        estimate = Estimate(value, low, high, level, "posterior")
        bounded = parameter in fit.bounded_by_prior
        persons.append(PersonEstimate(name, estimate, mine.trials, bounded))
        likelihoods.append(_likelihood(fit, parameter, shift))
        fits[name] = fit
    return persons, likelihoods, fits


def _fit_constant(mine: Answers, level: float) -> PsychometricFit:
    surface, _, more = comparisons(mine)
    values = mine.values[surface]
    every = [mine.design.judged_value(one) for one in mine.design.stimuli]
    return fit_psychometric(
        values,
        more,
        shape="gaussian",
        axis="log",
        guess_rate=None,
        prior=PsychometricPrior.for_stimuli(np.array(every), "log"),
        level=level,
        replicates=0,
    )


def _fit_adaptive(mine: Answers, level: float) -> PsychometricFit:
    among = mine.design.adaptive
    ends = np.array([min(s.lowest for s in among), max(s.highest for s in among)])
    return fit_psychometric(
        mine.intensity,
        mine.correct == 1.0,
        axis="log",
        guess_rate=0.5,
        prior=adaptive_prior(float(ends[0]), float(ends[1])),
        level=level,
        replicates=0,
    )


def adaptive_prior(lowest: float, highest: float) -> PsychometricPrior:
    """The weak prior of a series' function: that of the forty differences a Bayesian choice has,
    whatever was presented."""
    return PsychometricPrior.for_stimuli(np.geomspace(lowest, highest, 40), "log")


def _likelihood(
    fit: PsychometricFit, parameter: str, shift: Callable[[si.FloatLike], si.FloatArray]
) -> PersonLikelihood:
    """Of ln(Weber fraction), from a posterior whose prior is flat in the logarithm of the fitted
    parameter."""
    at = ("threshold", "width").index(parameter)
    edges = np.asarray(fit.posterior.edges[at])
    flat = np.diff(np.log(edges))
    x = np.log(np.asarray(shift(edges)))
    density = fit.posterior.marginal(parameter) / flat
    return PersonLikelihood(0.5 * (x[1:] + x[:-1]), np.diff(x), density)


def two_interval_conditions(
    main: Answers, level: si.Dimensionless, seed: int
) -> tuple[ConditionFinding, ...]:
    """Each comparison: how often it was said to have more, and its d′ from the reference."""
    surface, is_first, more = comparisons(main)
    found = []
    for one in sorted(np.unique(surface), key=lambda s: main.values[s]):
        here = surface == one
        hits, trials = int(more[here].sum()), int(here.sum())
        bounds = proportion_interval(hits, trials, level)
        d = _mean_d_prime(main, here, is_first, level, seed)
        found.append(
            ConditionFinding(
                main.surfaces[one].name,
                float(main.values[one]),
                trials,
                int(np.unique(main.participant[here]).size),
                Estimate(hits / trials, bounds.low, bounds.high, level, "Wilson, over trials"),
                d,
            )
        )
    return tuple(found)


def _mean_d_prime(
    main: Answers, here: NDArray[np.bool_], is_first: NDArray[np.bool_], level: float, seed: int
) -> Estimate | None:
    """Over people; the comparison counts as the signal where it is right to choose it."""
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


def two_interval_numbers(
    main: Answers, fits: dict[str, PsychometricFit], level: si.Dimensionless
) -> dict[str, Estimate]:
    """The bias for the first interval; of constant stimuli the point of subjective equality, of
    staircases the mean of their reversals."""
    people = np.unique(main.participant)
    first = np.array([np.mean(main.choice[main.participant == one] == 0) for one in people])
    due = np.array([np.mean(main.right[main.participant == one] == 0) for one in people])
    found = {"bias for the first interval": t_interval(first - due, level)}
    if not (main.series >= 0).any():
        design = main.design
        here = design.judged_value(design.stimulus(design.reference))
        points = np.log([fits[main.people[one]].function.threshold / here for one in people])
        name = "point of subjective equality from the reference"
        found[name] = through(t_interval(points, level), math.expm1)
        return found
    for number, series in enumerate(main.design.adaptive):
        if series.method != "staircase":
            continue
        ends_of = [_reversals(main, person, number) for person in people]
        logs = np.log([one for one in ends_of if one])
        if logs.size:
            target = 0.5 ** (1.0 / series.down)
            name = f"reversals of '{series.name}' ({100 * target:.1f} % right)"
            found[name] = through(t_interval(logs, level), math.exp)
    return found


def _reversals(main: Answers, person: int, series: int) -> float:
    from squeezefilm.study.adaptive.series import adaptive_method
    from squeezefilm.study.adaptive.staircase import Staircase

    mine = (main.participant == person) & (main.series == series)
    answers = zip(main.intensity[mine].tolist(), (main.correct[mine] == 1.0).tolist(), strict=True)
    method = adaptive_method(main.design.adaptive[series], answers)
    assert isinstance(method, Staircase)
    try:
        return method.threshold()
    except InputError:
        return 0.0
