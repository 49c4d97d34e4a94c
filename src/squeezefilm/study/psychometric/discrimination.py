"""d′ from answers to pairs and sets of stimuli, and just noticeable differences.

Formulas of Macmillan & Creelman, Detection Theory: A User's Guide, 2nd edition 2005 (chapters 1,
7, 9 and 10). d′ is the distance of two stimuli over the standard deviation of one percept.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtr, ndtri

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.study.psychometric.estimate import holding
from squeezefilm.study.psychometric.fit import Interval, PsychometricFit

# Nodes of the integral over the percept of the right alternative; the integrand is smooth.
_NODES, _WEIGHTS = np.polynomial.hermite_e.hermegauss(120)
_LARGEST_D_PRIME = 20.0


def _require_proportion(name: str, value: si.Dimensionless) -> None:
    si.require(name, value, above=0.0, below=1.0)


def corrected_proportion(count: int, trials: int) -> si.Dimensionless:
    """(count + ½)/(trials + 1): a proportion that is never 0 or 1 (Hautus 1995, log-linear).

    Raises:
        InputError: a count that is below 0 or above the trials, or no trials.
    """
    si.require("trials", trials, at_least=1)
    si.require("count", count, at_least=0, at_most=trials)
    return (count + 0.5) / (trials + 1.0)


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """d′ and the criterion, in standard deviations of a percept; `model` says of which task."""

    d_prime: si.Dimensionless
    criterion: si.Dimensionless
    model: str


def yes_no_sensitivity(
    hit_rate: si.Dimensionless, false_alarm_rate: si.Dimensionless
) -> Sensitivity:
    """d′ = z(H) − z(F), c = −(z(H) + z(F))/2 of one stimulus a trial.

    Raises:
        InputError: a rate not between 0 and 1; `corrected_proportion` mends that.
    """
    _require_proportion("hit_rate", hit_rate)
    _require_proportion("false_alarm_rate", false_alarm_rate)
    h, f = float(ndtri(hit_rate)), float(ndtri(false_alarm_rate))
    return Sensitivity(h - f, -0.5 * (h + f), "yes/no")


def two_interval_sensitivity(
    hit_rate: si.Dimensionless, false_alarm_rate: si.Dimensionless
) -> Sensitivity:
    """d′ = (z(H) − z(F))/√2 and the bias of 2IFC: d′ = √2 z(p) where there is no bias.

    Args:
        hit_rate: share of "first" where the first interval is right.
        false_alarm_rate: share of "first" where the second is.

    Raises:
        InputError: a rate not between 0 and 1.
    """
    plain = yes_no_sensitivity(hit_rate, false_alarm_rate)
    return Sensitivity(plain.d_prime / math.sqrt(2), plain.criterion, "two-interval forced choice")


def correct_of_alternatives(d_prime: si.Dimensionless, alternatives: int) -> si.Dimensionless:
    """Share correct of an unbiased choice among m: ∫ φ(t − d′) Φ(t)^(m−1) dt.

    Percepts of equal variance, independent. By Gauss–Hermite quadrature.

    Raises:
        InputError: fewer than two alternatives, or a d′ beyond ±20.
    """
    si.require("alternatives", alternatives, at_least=2)
    si.require("d_prime", d_prime, at_least=-_LARGEST_D_PRIME, at_most=_LARGEST_D_PRIME)
    values = ndtr(_NODES + d_prime) ** (alternatives - 1)
    return float(np.sum(_WEIGHTS * values) / math.sqrt(2 * math.pi))


def alternatives_d_prime(correct: si.Dimensionless, alternatives: int) -> si.Dimensionless:
    """d′ of an unbiased choice among m alternatives from the share correct.

    Raises:
        InputError: a share not between 0 and 1, too near to them for a d′ within ±20, or fewer
            than two alternatives.
    """
    _require_proportion("correct", correct)
    reach = _LARGEST_D_PRIME
    least, most = (correct_of_alternatives(end, alternatives) for end in (-reach, reach))
    if not least < correct < most:
        raise InputError(
            f"correct = {correct:g} needs a d′ beyond ±{reach:g}; check the counts",
            quantity="correct",
        )
    return float(
        brentq(lambda d: correct_of_alternatives(d, alternatives) - correct, -reach, reach)
    )


def differencing_rates(
    d_prime: si.Dimensionless, criterion: si.Dimensionless
) -> tuple[si.Dimensionless, si.Dimensionless]:
    """Shares of "different" in same/different, where the difference of the percepts decides.

    H = Φ((d′ − k)/√2) + Φ((−d′ − k)/√2), F = 2 Φ(−k/√2), with the criterion k at least 0.

    Raises:
        InputError: a value below 0.
    """
    si.require("d_prime", d_prime, at_least=0.0)
    si.require("criterion", criterion, at_least=0.0)
    return _hits(d_prime, criterion), float(2 * ndtr(-criterion / math.sqrt(2.0)))


def _hits(d_prime: float, criterion: float) -> float:
    root = math.sqrt(2.0)
    return float(ndtr((d_prime - criterion) / root) + ndtr((-d_prime - criterion) / root))


def differencing_sensitivity(
    hit_rate: si.Dimensionless, false_alarm_rate: si.Dimensionless
) -> Sensitivity:
    """d′ of same/different by the differencing model, for a roving standard.

    k = −√2 z(F/2), and d′ solves `differencing_rates`. Hits no more than false alarms give 0.

    Args:
        hit_rate: share of "different" where they are different.
        false_alarm_rate: share of "different" where they are the same.

    Raises:
        InputError: a rate not between 0 and 1.
    """
    _require_proportion("hit_rate", hit_rate)
    _require_proportion("false_alarm_rate", false_alarm_rate)
    k = -math.sqrt(2) * float(ndtri(0.5 * false_alarm_rate))
    if hit_rate <= false_alarm_rate:
        return Sensitivity(0.0, k, "same/different, differencing")
    highest = k + math.sqrt(2) * (abs(float(ndtri(hit_rate))) + 10.0)
    d = brentq(lambda one: _hits(one, k) - hit_rate, 0.0, highest)
    return Sensitivity(float(d), k, "same/different, differencing")


def independent_observation_sensitivity(
    hit_rate: si.Dimensionless, false_alarm_rate: si.Dimensionless
) -> Sensitivity:
    """d′ of same/different by the independent-observation model, for a fixed pair of stimuli.

    p = Φ((z(H) − z(F))/2) is the share correct without bias, and p = Φ(d′/2)² + Φ(−d′/2)² gives
    d′ = 2 z((1 + √(2p − 1))/2). Hits no more than false alarms give 0. The criterion is
    −(z(H) + z(F))/2.

    Raises:
        InputError: a rate not between 0 and 1.
    """
    plain = yes_no_sensitivity(hit_rate, false_alarm_rate)
    unbiased = float(ndtr(0.5 * plain.d_prime))
    d = 2 * float(ndtri(0.5 * (1 + math.sqrt(max(2 * unbiased - 1, 0.0)))))
    return Sensitivity(d, plain.criterion, "same/different, independent observations")


@dataclass(frozen=True, slots=True)
class SensitivityInterval:
    """A sensitivity from counts, with its interval: `level` of the draws' d′ lie within."""

    sensitivity: Sensitivity
    interval: Interval
    level: si.Dimensionless


_MODELS = {
    "yes-no": yes_no_sensitivity,
    "two-interval": two_interval_sensitivity,
    "differencing": differencing_sensitivity,
    "independent-observation": independent_observation_sensitivity,
}


def sensitivity(
    hits: int,
    signals: int,
    false_alarms: int,
    noises: int,
    model: str,
    *,
    level: si.Dimensionless = 0.95,
    draws: int = 2000,
    seed: int = 0,
) -> SensitivityInterval:
    """d′ from counts, by one of the models, with a credible interval.

    The point comes of corrected proportions (Hautus 1995); the interval of independent Jeffreys
    posteriors, Beta(count + ½, rest + ½), of the two rates, opened to the point where few trials
    leave it in a tail.

    Args:
        hits: of `signals` trials; false_alarms: of `noises` trials.
        model: "yes-no", "two-interval", "differencing" or "independent-observation".
        level: of the interval; draws: of the posterior; seed: of the draws.

    Raises:
        InputError: an unknown model or a value outside its range.
    """
    si.require_one_of("model", model, _MODELS)
    si.require("level", level, above=0.0, below=1.0)
    si.require("draws", draws, at_least=39)
    of = _MODELS[model]
    point = of(corrected_proportion(hits, signals), corrected_proportion(false_alarms, noises))
    random = np.random.default_rng(seed)
    h = _within(random.beta(hits + 0.5, signals - hits + 0.5, draws))
    f = _within(random.beta(false_alarms + 0.5, noises - false_alarms + 0.5, draws))
    values = np.array([of(float(a), float(b)).d_prime for a, b in zip(h, f, strict=True)])
    ends = np.quantile(values, [0.5 - 0.5 * level, 0.5 + 0.5 * level])
    low, high = holding(point.d_prime, *ends)
    return SensitivityInterval(point, (float(low), float(high)), level)


def _within(rates: si.FloatArray) -> si.FloatArray:
    # A draw may round to 0 or 1, whose z is infinite.
    return np.clip(rates, 1e-12, 1 - 1e-12)


@dataclass(frozen=True, slots=True)
class JustNoticeableDifference:
    """What a comparison with a standard tells of the difference that is just noticed.

    Attributes:
        standard: the intensity compared with.
        equality: point of subjective equality, where either is chosen alike, with its interval.
        difference: half the distance from 25 to 75 % of the shape, with its interval; it is
            0.954 standard deviations of the difference's percept, d′ = 0.954, for a Gaussian.
        weber_fraction: the difference over the standard, with its interval.
        level: of the intervals.
        by: "posterior" or "bootstrap".
    """

    standard: float
    equality: float
    equality_interval: Interval
    difference: float
    difference_interval: Interval
    weber_fraction: si.Dimensionless
    weber_fraction_interval: Interval
    level: si.Dimensionless
    by: str


def just_noticeable_difference(
    fit: PsychometricFit, standard: float, by: str = "posterior"
) -> JustNoticeableDifference:
    """The just noticeable difference of a fit of "the comparison is the greater".

    The function is of the comparison's intensity and rises from 0, or a guess rate that was
    fitted as a lapse, to 1; not of the share correct. On a linear axis the difference is in
    proportion to the width. On a logarithmic one the ratio of the 75 % to the 25 % point is
    1 + Weber fraction, squared.

    Raises:
        InputError: a standard not above 0, answers that fall with intensity, a guess rate known to
            be above 0.1, which is that of choices among alternatives, or intervals asked by a
            bootstrap that was not made.
    """
    si.require("standard", standard, above=0.0)
    if fit.falls:
        raise InputError(f"there is no just noticeable difference: {fit.notes[0]}")
    known = "guess_rate" not in fit.fitted
    if known and fit.function.guess_rate > 0.1:
        raise InputError(
            f"guess_rate = {fit.function.guess_rate:g} is that of correct answers; fit the answers "
            "'the comparison is greater', with a guess rate of 0 or fitted",
            quantity="guess_rate",
        )
    intervals = {"posterior": fit.posterior_interval, "bootstrap": fit.bootstrap_interval}
    if not intervals.get(by):
        raise InputError(
            f"by = {by!r} gives no intervals; it must be 'posterior', or 'bootstrap' of a fit "
            "with replicates",
            quantity="by",
        )
    low, high = intervals[by]["width"]
    fraction = [_weber_fraction(fit, standard, w) for w in (fit.function.width, low, high)]
    return JustNoticeableDifference(
        standard=standard,
        equality=fit.function.threshold,
        equality_interval=intervals[by]["threshold"],
        difference=fraction[0] * standard,
        difference_interval=(fraction[1] * standard, fraction[2] * standard),
        weber_fraction=fraction[0],
        weber_fraction_interval=(fraction[1], fraction[2]),
        level=fit.level,
        by=by,
    )


def _weber_fraction(fit: PsychometricFit, standard: float, width: float) -> float:
    function = fit.function
    # Quartiles of the shape, in widths; they do not depend on threshold or width.
    if function.axis == "log":
        spread = math.log(function.quantile(0.75) / function.quantile(0.25)) / function.width
        return math.expm1(0.5 * spread * width)
    spread = (function.quantile(0.75) - function.quantile(0.25)) / function.width
    return 0.5 * spread * width / standard
