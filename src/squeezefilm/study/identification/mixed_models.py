"""Right answers with people as random effects; needs statsmodels (the extra `study`).

Two models of the same log-odds by stimulus. The mixed model speaks of a typical person, the
population-averaged one (GEE) of the mean over people: the second lies nearer 50 % the more people
differ.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, optional
from squeezefilm.study.identification.confusion import one_per_trial

_MOST_TRIALS = 50_000


@dataclass(frozen=True, slots=True, eq=False)
class MixedModel:
    """Log-odds of a right answer by stimulus, with a random intercept for each participant.

    Attributes:
        names: of the stimuli, in the order of the arrays; arrays of shape (stimuli,).
        log_odds, log_odds_error: of a typical participant, posterior mean and standard deviation.
        proportion_correct: of a typical participant.
        participant_spread: standard deviation of the participants' intercepts, in log-odds.
        participant_spread_low, participant_spread_high: 95 % of its posterior.
        average_log_odds, average_error: of the mean over people (GEE, exchangeable correlation,
            robust standard errors reduced in bias after Mancl & DeRouen 2001).
        average_proportion_correct: the same as a proportion.
        correlation: of two trials of a participant (GEE).
        separated: stimuli always or never answered rightly: their log-odds have no finite
            estimate; the mixed model's is held by its prior, the GEE's is NaN.
        model: what was fitted.
    """

    names: tuple[str, ...]
    log_odds: si.DimensionlessArray
    log_odds_error: si.DimensionlessArray
    proportion_correct: si.DimensionlessArray
    participant_spread: si.Dimensionless
    participant_spread_low: si.Dimensionless
    participant_spread_high: si.Dimensionless
    average_log_odds: si.DimensionlessArray
    average_error: si.DimensionlessArray
    average_proportion_correct: si.DimensionlessArray
    correlation: si.Dimensionless
    separated: tuple[str, ...]
    model: str


def mixed_model(
    participant: ArrayLike,
    stimulus: ArrayLike,
    correct: ArrayLike,
    names: tuple[str, ...],
    prior_spread: si.Dimensionless = 2.0,
) -> MixedModel:
    """Fit both models to trials.

    The mixed model is Bayesian by variational approximation: N(0, `prior_spread`²) on each log-odds
    and N(0, 1) on the logarithm of the participants' standard deviation. The approximation takes
    the posterior for somewhat narrower than it is.

    Args:
        participant: who, shape (trials,); numbers or texts; at least 2 people.
        stimulus: its number, shape (trials,), 0 to len(names) − 1, each of them present.
        correct: whether the answer was right, shape (trials,).
        names: of the stimuli.
        prior_spread: of the log-odds; above 0.

    Raises:
        InputError: statsmodels is not installed, arrays of unequal length, one participant, a
            stimulus without a trial, or more than 50 000 trials.
    """
    api = _statsmodels()
    si.require("prior_spread", prior_spread, above=0.0)
    people, kind, right = _trials(participant, stimulus, correct)
    count = int(people.max()) + 1
    mixed = _mixed(kind, right, names)
    fixed = (kind[:, None] == np.arange(len(names))).astype(float)
    random = (people[:, None] == np.arange(count)).astype(float)
    # Begun where statsmodels begins but for its noise: the same trials have the same answer.
    bayes = api.BinomialBayesMixedGLM(
        right, fixed, random, np.zeros(count, dtype=int), vcp_p=1.0, fe_p=prior_spread
    ).fit_vb(sd=np.full(len(names) + 1 + count, np.exp(-0.5)))
    spread, spread_error = float(bayes.vcp_mean[0]), float(bayes.vcp_sd[0])
    average, error = np.full(len(names), np.nan), np.full(len(names), np.nan)
    correlation = float("nan")
    if mixed.size:
        use = np.isin(kind, mixed)
        fitted = _averaged(right[use], fixed[use][:, mixed], people[use])
        average[mixed], error[mixed] = fitted.params, fitted.bse
        correlation = float(np.squeeze(fitted.cov_struct.dep_params))
    log_odds = np.asarray(bayes.fe_mean, dtype=float)
    return MixedModel(
        names,
        log_odds,
        np.asarray(bayes.fe_sd, dtype=float),
        1 / (1 + np.exp(-log_odds)),
        float(np.exp(spread)),
        float(np.exp(spread - 1.96 * spread_error)),
        float(np.exp(spread + 1.96 * spread_error)),
        average,
        error,
        1 / (1 + np.exp(-average)),
        correlation,
        tuple(names[k] for k in range(len(names)) if k not in mixed),
        "logit(right) = stimulus + participant; variational Bayes, and GEE (statsmodels)",
    )


def _trials(
    participant: ArrayLike, stimulus: ArrayLike, correct: ArrayLike
) -> tuple[si.IntArray, si.IntArray, si.FloatArray]:
    """Of each trial the numbers of participant and stimulus, and whether the answer was right.
    Raises `InputError` for arrays that do not fit, one participant or too many trials."""
    who, people = np.unique(np.asarray(participant), return_inverse=True)
    kind, right = np.asarray(stimulus, dtype=np.int64), np.asarray(correct, dtype=float)
    one_per_trial(participant=people, stimulus=kind, correct=right)
    if who.size < 2 or kind.size > _MOST_TRIALS:
        raise InputError(
            f"{who.size} participants with {kind.size} trials cannot be fitted; at least 2 people "
            f"and at most {_MOST_TRIALS} trials are wanted (take a part of the people)"
        )
    return people, kind, right


def _mixed(kind: si.IntArray, right: si.FloatArray, names: tuple[str, ...]) -> si.IntArray:
    """Numbers of the stimuli that were answered both rightly and wrongly. Raises `InputError` where
    one has no trial."""
    count = np.bincount(kind, minlength=len(names))
    if count.size != len(names) or np.any(count == 0):
        raise InputError(f"trials by stimulus are {count.tolist()}; each of {names} needs some")
    share = np.bincount(kind, right, len(names)) / count
    return np.flatnonzero((share > 0) & (share < 1))


def _averaged(right: si.FloatArray, fixed: si.FloatArray, people: si.IntArray) -> Any:
    """The population-averaged model, as statsmodels fitted it."""
    api = _statsmodels()
    with warnings.catch_warnings():
        # It warns of designs without a constant column; the columns here sum to one.
        warnings.simplefilter("ignore")
        return api.GEE(
            right,
            fixed,
            people,
            family=api.families.Binomial(),
            cov_struct=api.cov_struct.Exchangeable(),
        ).fit(cov_type="bias_reduced")


def _statsmodels() -> ModuleType:
    with optional("study", "a mixed model"):
        from statsmodels import api
    found: ModuleType = api
    return found
