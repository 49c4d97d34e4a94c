"""A quantity of people, from what each one's answers say of it: a mixed model on grids.

Each person has a value x of their own (here the logarithm of a Weber fraction). Over people x is
normal, with the mean μ and the standard deviation τ of the population. What a person's answers say
of x is a likelihood on a grid, however skewed or cut off, with everything else of that person
(bias, lapses) integrated out; integrated over x it says how likely the answers are under μ and τ.
Products over people, with a flat prior of μ and a half-normal one of τ (Gelman 2006,
10.1214/06-BA117A: a flat one covers too much where there are few people), give the posterior of the
population. That is
a generalised linear mixed model of the answers (Moscatelli, Mezzetti and Lacquaniti 2012,
10.1167/12.11.26) with lapses, integrated exactly instead of by Laplace's method.

The interval of τ is no posterior: with few people the prior does most of the work, and such an
interval holds a τ in the middle of the prior nearly always and one in its tail too seldom. It is
made of the values that the scatter of the people does not refuse (the Q profile of Viechtbauer
2007, 10.1002/sim.2514): Σ (xᵢ − x̄)²/(vᵢ + τ²), x̄ the mean with the same weights, is χ² with one
degree of freedom less than there are people, xᵢ and vᵢ being mean and variance of a likelihood.

Lapse rates are of the population too. A prior that is a little wrong for everybody would push
everybody's Weber fraction the same way, and the mean over people with it: so the mean lapse rate h
has a flat prior in its logarithm, a person's lapse rate is Beta(1, 1/h − 1) about it, and the
answers of all say which h.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.special import chdtri

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.study.psychometric.estimate import Estimate, holding

_MEANS, _SPREADS = 161, 41
_WIDEST = 2.0
"""Greatest standard deviation over people of a logarithm that is held possible (1)."""
USUAL_SPREAD = 0.5
"""Scale of τ's half-normal prior (1): thresholds of most people lie within a factor of e of the
middle one. Assumed."""
_NARROWEST = 1e-3
NOT_DOING_IT: si.Dimensionless = 0.1
"""Share of people who do not do the task, as a robust estimate has it. Assumed."""
# Spreads at which the scatter of people is computed; two people may bound theirs nowhere below.
_TRIED = np.concatenate([[0.0], np.geomspace(1e-3, 1e3, 700)])

MEAN_LAPSES: tuple[si.Dimensionless, ...] = (0.005, 0.01, 0.02, 0.04, 0.08)
"""Mean lapse rates over people that are held possible, alike in their logarithm (1): 1 to 5 % are
usual, and one person's may be far more."""
_EDGES = np.array([0, 0.0025, 0.0075, 0.015, 0.025, 0.04, 0.065, 0.1, 0.15, 0.22, 0.32, 0.45, 0.6])
LAPSES: si.DimensionlessArray = 0.5 * (_EDGES[1:] + _EDGES[:-1])
"""Lapse rates of a person on the grid (1)."""


def lapse_weights() -> si.DimensionlessArray:
    """Probability of each of `LAPSES` under each mean, shape (means, lapses); rows sum to 1."""
    below = np.array([1.0 - (1.0 - _EDGES) ** (1.0 / h - 1.0) for h in MEAN_LAPSES])
    weights = np.diff(below, axis=1)
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))


class Population:
    """People's likelihoods on one grid of μ and τ, from which any group of them is estimated.

    Args:
        x: the middle of each cell, rising, in the population's unit, shape (cells,).
        width: of each cell, likewise.
        people: likelihood of each one's answers at x under each of `MEAN_LAPSES`, up to one factor,
            shape (lapses, cells).
        otherwise: likelihood of each one's answers from somebody who does not do the task, up to
            the same factor; 0 where it is not known.

    Raises `InputError` for nobody.
    """

    def __init__(
        self,
        x: si.FloatArray,
        width: si.FloatArray,
        people: Sequence[si.FloatArray],
        otherwise: Sequence[float] = (),
    ) -> None:
        if not people:
            raise InputError("a population needs at least one person")
        self._means = np.linspace(float(x[0]), float(x[-1]), _MEANS)
        # Denser where few people differ little: flat in τ by the cells' widths.
        edges = _NARROWEST + (_WIDEST - _NARROWEST) * np.linspace(0.0, 1.0, _SPREADS + 1) ** 2
        self._spreads = 0.5 * (edges[1:] + edges[:-1])
        self._widths = np.diff(edges) * np.exp(-0.5 * (self._spreads / USUAL_SPREAD) ** 2)
        self._edges = edges
        self._x, self._width, self._people = x, width, people
        self._otherwise = otherwise or [0.0] * len(people)
        self._logs = self._log_likelihoods()

    def _log_likelihoods(self) -> si.FloatArray:
        """ln of everybody's likelihood under each μ, τ and h, shape (people, means, spreads,
        lapses)."""
        weights = np.array([likelihood * self._width for likelihood in self._people])
        weights /= weights.max(axis=(1, 2), keepdims=True)
        logs = np.empty((len(weights), self._means.size, self._spreads.size, len(MEAN_LAPSES)))
        away = (self._x[None, :] - self._means[:, None]) ** 2
        for at, spread in enumerate(self._spreads):
            # A spread below the cells' width would fall between them: it is their width at least.
            wide = np.hypot(spread, 0.5 * self._width)
            density = np.exp(-0.5 * away / wide**2) / wide
            for one, weight in zip(logs, weights, strict=True):
                one[:, at] = density @ weight.T
        return np.log(np.maximum(logs, 1e-300))

    @property
    def size(self) -> int:
        """Number of people."""
        return int(self._logs.shape[0])

    def lapses(self) -> si.DimensionlessArray:
        """Posterior probability of each of `MEAN_LAPSES`, of all people; sums to 1."""
        total = self._logs.sum(axis=0)
        weight = np.exp(total - total.max()) * self._widths[:, None]
        return np.asarray(weight.sum(axis=(0, 1)) / weight.sum())

    @property
    def lapse_note(self) -> str:
        """A note where answers at random are more than the model knows; else "".

        A surface that is not felt is guessed too. The model then takes a part of the guesses for a
        lack of sharpness.
        """
        # Twice what the prior has: beside a flat slope guesses are never sure.
        if self.lapses()[-1] < 2.0 / len(MEAN_LAPSES):
            return ""
        return (
            f"answers at random may be more than the {si.percent(MEAN_LAPSES[-1])} of all that the "
            "model knows, as where surfaces are not felt and are guessed; the Weber fraction is "
            "then too large"
        )

    def estimate(
        self, level: si.Dimensionless = 0.95, people: si.IntArray | None = None
    ) -> tuple[Estimate, Estimate]:
        """Mean and spread over people in the unit of x, of all or of those of the numbers `people`:
        the posterior's median of μ with a central credible interval, and that of τ between the ends
        of what the scatter of the people does not refuse.

        With one person the interval of μ is wide, and τ is not known: NaN.
        Raises `InputError` for a level not between 0 and 1.
        """
        si.require("level", level, above=0.0, below=1.0)
        logs = self._logs if people is None else self._logs[people]
        total = logs.sum(axis=0)
        mean = self._mean(total, level, "posterior, mixed model")
        weight = np.exp(total - total.max()).sum(axis=(0, 2)) * self._widths
        _, spread, _ = _quantiles(self._edges, weight, (0.0, 0.5, 1.0))
        lapses = np.einsum("msl,s->l", np.exp(total - total.max()), self._widths)
        chosen = range(self.size) if people is None else people
        moments = np.array([self._moments(person, lapses) for person in chosen])
        scatter = scatter_interval(moments[:, 0], moments[:, 1], level)
        if logs.shape[0] == 1:
            return mean, Estimate(math.nan, math.nan, math.nan, level, scatter.method)
        # People who are more alike than chance makes them refuse every spread.
        return mean, holding(spread, scatter.low, scatter.high, level, scatter.method)

    def _moments(self, person: int, lapses: si.FloatArray) -> tuple[float, float]:
        """Mean and variance of x as a likelihood has them, under weights of mean lapse rates."""
        density = lapses @ self._people[person] * self._width
        density = density / density.sum()
        mean = float(density @ self._x)
        return mean, float(density @ (self._x - mean) ** 2)

    def robust(self, level: si.Dimensionless = 0.95) -> Estimate:
        """The mean over people who do the task, where each may be one of the `NOT_DOING_IT` who do
        not: a mixture in place of a verdict."""
        si.require("level", level, above=0.0, below=1.0)
        greatest = [(likelihood * self._width).max() for likelihood in self._people]
        other = np.array(self._otherwise) / np.array(greatest)
        # The densities over x leave this factor out.
        with np.errstate(divide="ignore"):
            otherwise = np.log(NOT_DOING_IT * other * np.sqrt(2 * np.pi))
        mixed = np.logaddexp(np.log(1 - NOT_DOING_IT) + self._logs, otherwise[:, None, None, None])
        return self._mean(mixed.sum(axis=0), level, "posterior, some do not do the task")

    def _mean(self, total: si.FloatArray, level: float, method: str) -> Estimate:
        """Median of μ with its interval from the logarithm of a likelihood of all people."""
        weight = np.exp(total - total.max()).sum(axis=2) @ self._widths
        step = self._means[1] - self._means[0]
        edges = np.append(self._means - step / 2, self._means[-1] + step / 2)
        tails = 0.5 * (1.0 - level), 0.5 * (1.0 + level)
        return Estimate(*_quantiles(edges, weight, (0.5, *tails)), level, method)


def scatter_interval(
    values: si.FloatArray, variances: si.FloatArray, level: si.Dimensionless = 0.95
) -> Estimate:
    """The deviation of normal people that makes their scatter what is expected (Paule and Mandel
    1982), between the ends of those that it does not refuse (the Q profile: Viechtbauer 2007,
    10.1002/sim.2514).

    `values` are estimates of two people or more, `variances` of their errors, both (people,) and
    known. All are 0 where people are more alike than chance makes them.
    """
    wide = variances[:, None] + _TRIED**2
    middle = (values[:, None] / wide).sum(axis=0) / (1.0 / wide).sum(axis=0)
    scatter = ((values[:, None] - middle) ** 2 / wide).sum(axis=0)
    free = max(values.size - 1, 1)
    tails = float(chdtri(free, 0.5 * (1.0 - level))), float(chdtri(free, 0.5 * (1.0 + level)))
    # Scatter falls with the deviation.
    middle, least, most = np.interp([-float(free), *(-tail for tail in tails)], -scatter, _TRIED)
    how = "Q profile, over people"
    return Estimate(float(middle), float(least), float(most), level, how)


def _quantiles(
    edges: si.FloatArray, probability: si.FloatArray, shares: tuple[float, float, float]
) -> tuple[float, float, float]:
    heights = np.concatenate([[0.0], np.cumsum(probability)])
    a, b, c = np.interp(shares, heights / heights[-1], edges)
    return float(a), float(b), float(c)
