"""Fitting a psychometric function: its best value, credible intervals, goodness of fit."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize
from scipy.special import ndtr, xlogy

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import Interval, Result, values_of
from squeezefilm.study.psychometric import kernel
from squeezefilm.study.psychometric.estimate import holding
from squeezefilm.study.psychometric.function import (
    Axis,
    PsychometricFunction,
    PsychometricPrior,
    Shape,
    on_axis,
    shape_code,
)
from squeezefilm.study.psychometric.posterior import (
    PARAMETERS,
    Answered,
    PsychometricPosterior,
    coarse_maxima,
    grid_posterior,
)

# Answers fall where fewer guessers than this fall as clearly: a guesser is rarely told so.
_FALLING = 1e-3


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PsychometricFit(Result):
    """A psychometric function fitted to answers.

    Attributes:
        function: of the largest posterior density (in threshold, ln width, lapse and guess
            rate): maximum likelihood but for the priors of the rates.
        intensity, positive, trials: the data, one row an intensity, shape (places,).
        prior: of the parameters.
        fitted: names of the parameters that were fitted.
        level: of the intervals (1).
        posterior: of the parameters, on a grid.
        posterior_interval: credible interval by parameter, in the parameter's unit: the central
            one, opened to the fitted value where that lies in a tail, as it does at the bound of a
            prior. It holds at least `level`.
        deviance: from the saturated model.
        bounded_by_prior: parameters with an interval that ends at a bound of the prior of
            threshold or width: the data do not say how far they go.
        falling_p: probability that answers to which intensity does not matter fall with it as
            clearly as these, one-sided; small where the answers fall (see `falling_probability`).
    """

    function: PsychometricFunction
    intensity: si.FloatArray
    positive: si.FloatArray
    trials: si.FloatArray
    prior: PsychometricPrior
    fitted: tuple[str, ...]
    level: si.Dimensionless
    posterior: PsychometricPosterior
    posterior_interval: dict[str, Interval]
    deviance: float
    bounded_by_prior: tuple[str, ...]
    falling_p: si.Dimensionless
    _shown: ClassVar[str] = (
        "function.shape function.threshold function.width function.lapse_rate posterior_interval "
        "notes"
    )

    @property
    def falls(self) -> bool:
        """True where answers fall with intensity, more clearly than one guesser in a thousand."""
        return self.falling_p < _FALLING

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences to be read before a number of this fit is used."""
        sentences = []
        if self.falls:
            sentences.append(
                f"the answers fall with intensity (trend test, p = {self.falling_p:.1g}), and a "
                "psychometric function rises: no number of this fit describes them; if answers "
                "were exchanged, fit trials - positive"
            )
        if self.bounded_by_prior:
            names = " and ".join(self.bounded_by_prior)
            sentences.append(
                f"the answers do not bound the {names}: an end of the interval is the prior's, and "
                "more trials near the threshold, or a prior of your own, are wanted"
            )
        return tuple(sentences)

    def summary(self) -> dict[str, Any]:
        """The numbers for JSON."""
        return {
            **{name: getattr(self.function, name) for name in PARAMETERS},
            **values_of(
                self,
                "function.shape function.axis fitted posterior_interval deviance bounded_by_prior "
                "falling_p notes prior",
            ),
            "interval_level": self.level,
            "trials": int(self.trials.sum()),
        }

    def _table(self) -> Any:
        return {"intensity": self.intensity, "positive": self.positive, "trials": self.trials}


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class FitRequest:
    """Arguments of `fit_psychometric`."""

    intensity: ArrayLike
    positive: ArrayLike
    trials: ArrayLike | None = None
    _: KW_ONLY
    shape: Shape = "logistic"
    axis: Axis = "linear"
    guess_rate: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(0.5)] | None = 0.5
    prior: PsychometricPrior | None = None
    level: Annotated[si.Dimensionless, si.Above(0.0), si.Below(1.0)] = 0.95


@reads_text
@called_with(FitRequest)
def fit_psychometric(asked: FitRequest) -> PsychometricFit:
    """Fit a psychometric function to answers.

    Args:
        intensity: of the stimuli, shape (rows,).
        positive: how many answers were "yes" or correct (rows,): counts, or without `trials`
            one answer a row (true, false).
        trials: how many answers there were (rows,).
        shape, axis: of the function.
        guess_rate: where it is known, at least 0 and at most 0.5 (1/m for one of m
            alternatives); None to fit it, as for a yes/no task.
        prior: without one, `PsychometricPrior.for_stimuli`.
        level: of the intervals, between 0 and 1.

    Raises:
        InputError: data that are no counts, of unlike shape or empty, or a value outside its
            range.
    """
    axis, level, guess_rate = asked.axis, asked.level, asked.guess_rate
    code = shape_code(asked.shape, axis)
    places, k, n = _by_place(asked.intensity, asked.positive, asked.trials)
    prior = PsychometricPrior.for_stimuli(places, axis) if asked.prior is None else asked.prior
    answered = Answered(code, axis, prior, guess_rate, on_axis(places, axis), k, n)
    best = _likeliest(answered)
    posterior = grid_posterior(answered, best)
    fitted = PARAMETERS if guess_rate is None else PARAMETERS[: kernel.GUESS]
    likelihood = kernel.log_density(code, best, np.ones(4), answered.x, k, n)
    saturated = float(np.sum(xlogy(k, k / n) + xlogy(n - k, 1 - k / n)))
    function = _function(asked.shape, axis, best)
    return PsychometricFit(
        function=function,
        intensity=places,
        positive=k,
        trials=n,
        prior=prior,
        fitted=fitted,
        level=level,
        posterior=posterior,
        posterior_interval={name: _opened(function, name, posterior, level) for name in fitted},
        deviance=max(2.0 * (saturated - likelihood), 0.0),
        bounded_by_prior=_bounded(prior, posterior),
        falling_p=falling_probability(answered.x, k, n),
    )


def falling_probability(
    x: si.FloatArray, positive: si.FloatArray, trials: si.FloatArray
) -> si.Dimensionless:
    """Probability that answers to which `x` does not matter fall with it as clearly as these.

    The test of Cochran (1954) and Armitage (1955, 10.2307/3001775) for a trend of proportions,
    one-sided: near 1 where answers rise, ½ without a trend or where all answers are alike. Its
    normal limit is rough with a handful of trials. It holds too where answers chose the stimuli,
    since the answer to a stimulus is still random under the hypothesis.

    Args:
        x: places on the axis of the function, shape (places,).
        positive, trials: counts at each, shape (places,).
    """
    share = positive.sum() / trials.sum()
    away = x - (trials @ x) / trials.sum()
    spread = share * (1.0 - share) * float(trials @ away**2)
    if spread <= 0.0:
        return 0.5
    return float(ndtr(float(away @ (positive - trials * share)) / np.sqrt(spread)))


def _opened(
    function: PsychometricFunction, name: str, posterior: PsychometricPosterior, level: float
) -> Interval:
    """The interval of a parameter of a function, opened to its value there."""
    interval = posterior.interval(name, level)
    opened = holding(getattr(function, name), *interval, level, "posterior")
    return Interval(opened.low, opened.high)


def _likeliest(answered: Answered) -> si.FloatArray:
    """θ of the largest ln density of the answers and the priors of the rates, within the prior."""
    a, rate = answered, answered.guess_rate
    low, high = a.prior.bounds(a.axis)
    beta, free = np.array([*a.prior.lapse_rate, *a.prior.guess_rate]), 4
    if rate is not None:
        # A known rate has no prior; without a bound γ + λ could reach 1.
        beta[2:], free = 1.0, kernel.GUESS
        high[kernel.LAPSE] = min(high[kernel.LAPSE], 0.99 - rate)
    bounds = list(zip(low, high, strict=True))[:free]

    def loss(part: si.FloatArray) -> float:
        theta = part if rate is None else np.append(part, rate)
        return -kernel.log_density(a.code, theta, beta, a.x, a.k, a.n)

    found = [
        minimize(loss, start[:free], method="L-BFGS-B", bounds=bounds) for start in coarse_maxima(a)
    ]
    near = min(found, key=lambda one: float(one.fun)).x
    # Its derivatives are differences; the simplex has none, and settles the last digits.
    best = minimize(loss, near, method="Nelder-Mead", bounds=bounds, tol=1e-10).x
    return np.asarray(best if rate is None else np.append(best, rate))


def _function(shape: Shape, axis: Axis, theta: si.FloatArray) -> PsychometricFunction:
    """The function of the kernel's θ."""
    threshold = float(np.exp(theta[0])) if axis == "log" else float(theta[0])
    width, lapse, guess = float(np.exp(theta[1])), float(theta[2]), float(theta[3])
    return PsychometricFunction(shape, threshold, width, guess, lapse, axis)


def _bounded(prior: PsychometricPrior, posterior: PsychometricPosterior) -> tuple[str, ...]:
    names = []
    for name in ("threshold", "width"):
        low, high = getattr(prior, name)
        edges, marginal = posterior.edges[PARAMETERS.index(name)], posterior.marginal(name)
        # A posterior that has not died away at the bound is cut by it.
        density = marginal / np.diff(edges)
        if (np.isclose(edges[0], low) and density[0] > 0.05 * density.max()) or (
            np.isclose(edges[-1], high) and density[-1] > 0.05 * density.max()
        ):
            names.append(name)
    return tuple(names)


def _by_place(
    intensity: ArrayLike, positive: ArrayLike, trials: ArrayLike | None
) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray]:
    """Rows of the same intensity together, in rising order."""
    given = np.asarray(intensity, dtype=float)
    k = np.asarray(positive, dtype=float)
    n = np.ones_like(k) if trials is None else np.asarray(trials, dtype=float)
    if given.ndim != 1 or given.shape != k.shape or given.shape != n.shape or given.size == 0:
        raise InputError(
            f"intensity, positive and trials have the shapes {given.shape}, {k.shape} and "
            f"{n.shape}; all must be one-dimensional, of one length, with at least one row"
        )
    si.require("intensity", given)
    si.require("positive", k, at_least=0.0)
    si.require("trials", n, at_least=0.0)
    if np.any(k > n) or np.any(k != np.round(k)) or np.any(n != np.round(n)):
        row = int(np.flatnonzero((k > n) | (k != np.round(k)) | (n != np.round(n)))[0])
        raise InputError(
            f"positive = {k[row]:g} of trials = {n[row]:g} at intensity {given[row]:g} is no "
            "count; both must be whole, and positive no more than trials",
            quantity="positive",
        )
    if not np.any(n > 0):
        raise InputError("trials = 0 everywhere; there must be at least one answer")
    places, where = np.unique(given[n > 0], return_inverse=True)
    counts = (np.bincount(where, one[n > 0], places.size) for one in (k, n))
    summed_k, summed_n = (np.asarray(count, dtype=float) for count in counts)
    return places, summed_k, summed_n
