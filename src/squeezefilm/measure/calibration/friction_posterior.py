"""Posterior of a finger and of the laws by observations of µ′/µ: weighted draws.

Draws of everything that `physics.uncertainty.draws.Mixture` has uncertain (values, laws and
mechanisms), first from the priors, then from a Gaussian about those that the observations speak for
(in normal scores of the unit cube, mixed with the priors so that no weight runs away): adaptive
importance sampling, Cappé et al. 2004, 10.1198/106186004X12803. The laws are weighted by it as
values are.
"""

from __future__ import annotations

import copy
import dataclasses
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import OutOfRangeError, SqueezefilmError
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.progress import ShareProgress, within
from squeezefilm.measure.calibration.discrepancy import (
    GRID,
    FrictionLikelihood,
    Misfit,
    Touching,
)
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.display import Display
from squeezefilm.physics.uncertainty.draws import Draw, Mixture, as_drawn, between_limits
from squeezefilm.physics.uncertainty.intervals import hash_of_draws

DRAWS, ROUNDS = 2048, 2
"""Draws from the priors, and how often half as many more are drawn where the observations point."""
FEWEST: float = 60.0
"""Independent draws that a friction posterior should be worth; fewer are told."""
_DEFENSIVE = 0.25
_WIDER = 1.3
_CHUNK = 64
_KEPT: Kept[si.FloatArray] = Kept("friction_draws", si.FloatArray)


def finger_mixture(display: Display, prediction: Prediction) -> Mixture:
    """All that is uncertain of finger, surface, gas and laws; the actuator stands still."""
    mixture = copy.copy(Mixture(display, prediction, driven=True))
    # A drawn actuator is the plate's posterior, which is drawn beside this one.
    beside = ("actuator.", "joint.")
    mixture.inputs = tuple(item for item in mixture.inputs if not item.path.startswith(beside))
    mixture.paths = tuple(item.path for item in mixture.inputs)
    return mixture


def friction_of(mixture: Mixture, draw: Draw, where: tuple[Touching, ...]) -> si.DimensionlessArray:
    """µ′/µ of a draw under each of some conditions, NaN where its contact is refused."""
    friction = np.full(len(where), np.nan)
    law = mixture.law(draw)
    for force, speed in dict.fromkeys((at.force, at.speed) for at in where):
        rows = [k for k, at in enumerate(where) if (at.force, at.speed) == (force, speed)]
        here = dataclasses.replace(
            law,
            normal_force=law.normal_force if force is None else force,
            speed=law.speed if speed is None else speed,
        )
        try:
            friction[rows] = between_limits(
                here, draw, np.array([where[k].amplitude for k in rows])
            )
        except SqueezefilmError:
            continue
    return friction


def normal_scores(points: si.DimensionlessArray) -> si.DimensionlessArray:
    """Points of a unit cube as independent standard normal numbers, of the same shape."""
    from scipy.special import ndtri

    return np.asarray(ndtri(np.clip(points, 1e-9, 1 - 1e-9)))


@as_drawn()
def friction_of_points(
    mixture: Mixture,
    points: si.DimensionlessArray,
    where: tuple[Touching, ...],
    tell: ShareProgress,
) -> si.DimensionlessArray:
    """`friction_of` at points of the mixture's unit cube, shape (points, conditions).

    Kept on disk in pieces, so that what was interrupted goes on. `tell` is told some ten times.
    """
    friction = np.empty((len(points), len(where)))
    for first in range(0, len(points), _CHUNK):
        piece = points[first : first + _CHUNK]
        question = hash_of_draws(mixture, piece, where)
        kept = _KEPT.get(question)
        if kept is None:
            if first % (4 * _CHUNK) == 0:
                tell(f"friction of draw {first + 1} of {len(points)}", first / len(points))
            kept = np.concatenate(
                [friction_of(mixture, draw, where) for draw in mixture.draws(piece)]
            )
            _KEPT.put(question, kept)
        friction[first : first + len(piece)] = kept.reshape(len(piece), len(where))
    return friction


@dataclass(frozen=True, eq=False)
class FrictionPosterior:
    """Draws of finger and laws: `points` of the mixture's unit cube (draws, inputs), `weights`
    (draws, scales of `GRID`) that sum to 1, and their `curves` at the observed conditions.

    `effective` is how many independent draws they are worth.
    """

    mixture: Mixture
    likelihood: FrictionLikelihood
    points: si.DimensionlessArray
    weights: si.DimensionlessArray
    curves: si.DimensionlessArray
    misfit: Misfit

    @property
    def effective(self) -> float:
        """1 / Σ w² of the draws' weights (Kong's effective sample size)."""
        return float(1 / np.sum(self.weights.sum(axis=1) ** 2))

    def resampled(self, count: Annotated[int, si.AtLeast(1)], seed: int) -> FrictionDraws:
        """`count` draws with equal weights."""
        random = np.random.default_rng(seed)
        flat = self.weights.ravel()
        # Systematic resampling: less noise than independent choices.
        ends = np.cumsum(flat)
        places = (random.random() + np.arange(count)) / count * ends[-1]
        chosen = random.permutation(np.minimum(np.searchsorted(ends, places), flat.size - 1))
        rows, scales = np.divmod(chosen, GRID.size)
        return FrictionDraws(self, rows, self.points[rows], GRID[scales], self.curves[rows])

    def shares(self) -> dict[str, dict[str, float]]:
        """Weights of the options of each choice of a law, by its path."""
        from squeezefilm.physics.uncertainty.model_choices import LawChoice

        weight, after = self.weights.sum(axis=1), {}
        for k, item in enumerate(self.mixture.inputs):
            if isinstance(item, LawChoice):
                drawn = np.array(item.drawn(self.points[:, k]))
                shares = {o.name: float(weight[drawn == o.name].sum()) for o in item.options}
                after[item.path] = shares
        return after


@dataclass(frozen=True, eq=False)
class FrictionDraws:
    """Draws of a posterior with equal weights: which of its draws (`rows`), points of the unit
    cube, scales of the discrepancy, and curves at the observed conditions."""

    posterior: FrictionPosterior
    rows: si.IntArray
    points: si.DimensionlessArray
    scales: si.DimensionlessArray
    curves: si.DimensionlessArray

    def with_error(
        self, friction: si.DimensionlessArray, where: tuple[Touching, ...], seed: int
    ) -> si.DimensionlessArray:
        """µ′/µ (draws, conditions) of these draws with the law's error added; from 0 to 1 or a
        little above."""
        errors = self.posterior.likelihood.errors(self.curves, self.scales, where, seed)
        return np.clip(friction + errors, 0.0, 1.2)


def weighted(
    mixture: Mixture,
    likelihood: FrictionLikelihood,
    points: si.DimensionlessArray,
    curves: si.DimensionlessArray,
    log_proposal: si.FloatArray | None = None,
) -> FrictionPosterior:
    """The posterior of draws at `points` with their `curves`; `log_proposal` is the logarithm of
    the density they were drawn from over that of the priors (None: the priors).

    Raises `OutOfRangeError` where no draw has friction at all observed conditions.
    """
    logs = likelihood.logarithms(curves)
    if log_proposal is not None:
        logs = logs - log_proposal[:, None]
    most = float(np.max(logs))
    if not np.isfinite(most):
        raise OutOfRangeError(
            "no draw of finger and laws has friction at all observed conditions; check their "
            "amplitudes, forces and speeds, or leave out the largest amplitudes"
        )
    weights = np.exp(logs - most)
    return FrictionPosterior(
        mixture, likelihood, points, weights / weights.sum(), curves, likelihood.misfit(curves)
    )


def friction_posterior(
    mixture: Mixture,
    likelihood: FrictionLikelihood,
    *,
    seed: int,
    draws: Annotated[int, si.AtLeast(32)] = DRAWS,
    progress: ShareProgress | None = None,
) -> FrictionPosterior:
    """The posterior of finger and laws: some 5 to 10 ms for each of `draws` (a power of two) and of
    as many again in `ROUNDS` rounds. Raises `OutOfRangeError` as `weighted`; interrupted it goes on
    from what was kept.
    """
    from scipy.special import logsumexp, ndtr
    from scipy.stats import multivariate_normal, norm, qmc

    tell = progress or (lambda _, __: None)
    random = np.random.default_rng(seed)
    more_draws = draws // 2
    points = qmc.Sobol(len(mixture.inputs), rng=seed).random(draws)
    ends = [share / (2 + ROUNDS) for share in range(2, 3 + ROUNDS)]
    curves = friction_of_points(mixture, points, likelihood.where, within(tell, 0.0, ends[0]))
    posterior = weighted(mixture, likelihood, points, curves)
    # Draws of every round count by the mixture of all that was drawn from.
    rounds: list[tuple[si.FloatArray, si.FloatArray]] = []
    scores = normal_scores(points)
    for number in range(ROUNDS):
        weight = posterior.weights.sum(axis=1)
        middle = weight @ scores
        spread = (scores - middle).T @ (weight[:, None] * (scores - middle))
        # Few draws know little of a covariance: as much of the priors' as they are worth.
        share = posterior.effective / (posterior.effective + scores.shape[1])
        spread = _WIDER * (share * spread + (1 - share) * np.eye(len(middle)))
        fresh = random.multivariate_normal(middle, spread, more_draws)
        at_prior = random.random(more_draws) < _DEFENSIVE
        fresh[at_prior] = random.normal(size=(int(at_prior.sum()), len(middle)))
        rounds.append((middle, spread))
        more = ndtr(fresh)
        points = np.vstack([points, more])
        part = within(tell, *ends[number : number + 2])
        curves = np.vstack([curves, friction_of_points(mixture, more, likelihood.where, part)])
        scores = normal_scores(points)
        parts = [np.full(len(points), np.log(draws / len(points)))]
        for gaussian in rounds:
            # Its density over that of independent standard scores.
            ratio = multivariate_normal(*gaussian).logpdf(scores) - norm.logpdf(scores).sum(axis=1)
            own = np.log(1 - _DEFENSIVE) + ratio
            logs = np.logaddexp(np.log(_DEFENSIVE), own)
            parts.append(np.log(more_draws / len(points)) + logs)
        posterior = weighted(mixture, likelihood, points, curves, logsumexp(parts, axis=0))
    return posterior
