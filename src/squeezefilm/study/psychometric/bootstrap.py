"""Goodness of fit of a psychometric function, by answers that are simulated at the fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import bdtr

from squeezefilm.core import quantities as si
from squeezefilm.study.psychometric import kernel
from squeezefilm.study.psychometric.kernel import BoolArray


@dataclass(frozen=True, slots=True, eq=False)
class PenalisedLikelihood:
    """The data and the prior of one fit, as the kernel takes them; θ as the kernel's.

    Attributes:
        code: of the shape.
        free: which of the four parameters are fitted.
        low, high: bounds of θ, shape (4,).
        beta: exponents of the Beta priors of lapse and guess rate, shape (4,).
        x, k, n: places on the axis, answers, trials, shape (places,).
    """

    code: int
    free: BoolArray
    low: si.FloatArray
    high: si.FloatArray
    beta: si.FloatArray
    x: si.FloatArray
    k: si.FloatArray
    n: si.FloatArray

    @property
    def model(self) -> kernel.Model:
        """The model that is fitted, as the kernel takes it."""
        return kernel.Model(self.code, self.free, self.low, self.high, self.beta)

    def maximum(self, start: si.FloatArray) -> tuple[si.FloatArray, float]:
        """θ of the largest ln density near a start, and that ln density."""
        theta = start.copy()
        return theta, kernel.maximise(self.model, theta, self.x, self.k, self.n)


def simulated_deviances(
    likelihood: PenalisedLikelihood, best: si.FloatArray, replicates: int, seed: int
) -> si.DimensionlessArray:
    """Deviances from the saturated model of answers of people of θ `best` at the places and trials
    of the data, each set refitted; shape (replicates,).

    Raises `InputError` for fewer than 39 replicates.
    """
    si.require("replicates", replicates, at_least=39)
    shares = np.random.default_rng(seed).random((replicates, likelihood.x.size))
    answers, deviances = np.empty_like(shares), np.empty(replicates)
    p = kernel.probabilities(likelihood.code, best, likelihood.x)
    for place, trials in enumerate(likelihood.n):
        heights = bdtr(np.arange(trials + 1), int(trials), p[place])
        answers[:, place] = np.searchsorted(heights, shares[:, place])
    kernel.refit(likelihood.model, best, likelihood.x, likelihood.n, answers, deviances)
    return deviances


def share_as_large(deviances: si.DimensionlessArray, deviance: float) -> si.Dimensionless:
    """Probability of a deviance at least as large where the simulated function is the truth; the
    data count as one more set of answers."""
    larger = int(np.count_nonzero(deviances >= deviance - 1e-9))
    return (1 + larger) / (1 + deviances.size)
