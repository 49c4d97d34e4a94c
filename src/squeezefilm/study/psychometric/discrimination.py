"""d′ from answers to pairs of stimuli.

Formulas of Macmillan & Creelman, Detection Theory: A User's Guide, 2nd edition 2005 (chapters 1, 7
and 9). d′ is the distance of two stimuli over the standard deviation of one percept.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtri

from squeezefilm.core import quantities as si
from squeezefilm.study.design.tasks.same_different import called_different
from squeezefilm.study.psychometric.estimate import Estimate, holding

Rate = Annotated[si.Dimensionless, si.Above(0.0), si.Below(1.0)]
"""Share of trials that is neither none nor all of them."""


def corrected_proportion(count: int, trials: int) -> si.Dimensionless:
    """(count + ½)/(trials + 1): a proportion that is never 0 or 1 (Hautus 1995, log-linear).

    Raises:
        InputError: a count that is below 0 or above the trials, or no trials.
    """
    si.require("trials", trials, at_least=1)
    si.require("count", count, at_least=0, at_most=trials)
    return (count + 0.5) / (trials + 1.0)


@si.checked_numbers
def yes_no_d_prime(hit_rate: Rate, false_alarm_rate: Rate) -> si.Dimensionless:
    """d′ = z(H) − z(F) of one stimulus a trial.

    Raises:
        InputError: a rate not between 0 and 1; `corrected_proportion` mends that.
    """
    return float(ndtri(hit_rate)) - float(ndtri(false_alarm_rate))


def two_interval_d_prime(hit_rate: Rate, false_alarm_rate: Rate) -> si.Dimensionless:
    """d′ = (z(H) − z(F))/√2 of 2IFC: d′ = √2 z(p) where there is no bias.

    Args:
        hit_rate: share of "first" where the first interval is right.
        false_alarm_rate: share of "first" where the second is.

    Raises:
        InputError: a rate not between 0 and 1.
    """
    return yes_no_d_prime(hit_rate, false_alarm_rate) / math.sqrt(2)


@si.checked_numbers
def differencing_d_prime(hit_rate: Rate, false_alarm_rate: Rate) -> si.Dimensionless:
    """d′ of same/different by the differencing model, for a roving standard.

    F = 2 Φ(−k/√2) gives the criterion k, and d′ solves H = Φ((d′ − k)/√2) + Φ((−d′ − k)/√2). Hits
    no more than false alarms give 0.

    Args:
        hit_rate: share of "different" where they are different.
        false_alarm_rate: share of "different" where they are the same.

    Raises:
        InputError: a rate not between 0 and 1.
    """
    k = -math.sqrt(2) * float(ndtri(0.5 * false_alarm_rate))
    if hit_rate <= false_alarm_rate:
        return 0.0
    highest = k + math.sqrt(2) * (abs(float(ndtri(hit_rate))) + 10.0)
    return float(brentq(lambda d: float(called_different(d, k)) - hit_rate, 0.0, highest))


MODELS: dict[str, Callable[[si.Dimensionless, si.Dimensionless], si.Dimensionless]] = {
    "yes-no": yes_no_d_prime,
    "two-interval": two_interval_d_prime,
    "differencing": differencing_d_prime,
}
"""d′ of hit and false alarm rate, by model."""


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
) -> Estimate:
    """d′ from counts, by one of the models, with a credible interval.

    The point comes of corrected proportions (Hautus 1995); the interval of independent Jeffreys
    posteriors, Beta(count + ½, rest + ½), of the two rates, opened to the point where few trials
    leave it in a tail.

    Args:
        hits: of `signals` trials; false_alarms: of `noises` trials.
        model: "yes-no", "two-interval" or "differencing".
        level: of the interval; draws: of the posterior; seed: of the draws.

    Raises:
        InputError: an unknown model or a value outside its range.
    """
    si.require_one_of("model", model, MODELS)
    si.require("level", level, above=0.0, below=1.0)
    si.require("draws", draws, at_least=39)
    of = MODELS[model]
    point = of(corrected_proportion(hits, signals), corrected_proportion(false_alarms, noises))
    random = np.random.default_rng(seed)
    h = _within(random.beta(hits + 0.5, signals - hits + 0.5, draws))
    f = _within(random.beta(false_alarms + 0.5, noises - false_alarms + 0.5, draws))
    values = np.array([of(float(a), float(b)) for a, b in zip(h, f, strict=True)])
    low, high = np.quantile(values, [0.5 - 0.5 * level, 0.5 + 0.5 * level])
    return holding(point, low, high, level, "Jeffreys, over trials")


def _within(rates: si.FloatArray) -> si.FloatArray:
    # A draw may round to 0 or 1, whose z is infinite.
    return np.clip(rates, 1e-12, 1 - 1e-12)
