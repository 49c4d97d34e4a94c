"""What observations of a plate say of its parameters: least squares, then draws of the posterior.

Everything happens in normal scores (`priors.NormalScores`) and in logarithms of the answers. The
last score is that of the discrepancy's scale. The draws are by the affine-invariant ensemble
sampler of Goodman and Weare (2010), 10.2140/camcos.2010.5.65, as emcee has it (10.1086/670067).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.measure.calibration.discrepancy import BELIEVED, Misfit, misfit_of, scale_of
from squeezefilm.measure.calibration.emulator import Emulator
from squeezefilm.measure.calibration.priors import NormalScores
from squeezefilm.measure.calibration.solved_answers import Asked, asked_by
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.progress import SayProgress

STEPS, BURN_IN = 2000, 500
"""Of each walker: kept, and left out before."""
_DRAWS = 2000


@dataclass(frozen=True, eq=False)
class PlateProblem:
    """Observations of a plate's answers beside the emulator that predicts them.

    `asked` are the emulator's answers; `solver_errors` (asked,) what the solver itself may be off
    by, relative.
    """

    scores: NormalScores
    emulator: Emulator
    asked: tuple[Asked, ...]
    solver_errors: si.DimensionlessArray
    observations: tuple[Observation, ...]

    def __post_init__(self) -> None:
        for one in self.observations:
            if not (one.value > 0 and one.standard_error > 0):
                raise InputError(
                    f"{asked_by(one).said} was observed as {one.value:.6g} with a standard error "
                    f"of {one.standard_error:.6g}; both must be above 0"
                )
            if asked_by(one) not in self.asked:
                raise InputError(f"the emulator does not know the {asked_by(one).said}")

    @cached_property
    def columns(self) -> list[int]:
        """Which of the emulator's answers each observation is of."""
        return [self.asked.index(asked_by(one)) for one in self.observations]

    @cached_property
    def observed(self) -> si.FloatArray:
        """Logarithms of what was observed, shape (observations,)."""
        return np.log([one.value for one in self.observations])

    @cached_property
    def variances(self) -> si.DimensionlessArray:
        """Of the logarithms (observations,): of the measurement, the emulator and the solver."""
        noise = np.array([one.standard_error / one.value for one in self.observations])
        return noise**2 + self.model_errors[self.columns] ** 2

    @cached_property
    def model_errors(self) -> si.DimensionlessArray:
        """Of the emulator and the solver together, relative, shape (asked,)."""
        return np.hypot(self.emulator.errors, self.solver_errors)

    @cached_property
    def believed(self) -> si.DimensionlessArray:
        """`BELIEVED` of each of the emulator's answers, shape (asked,)."""
        return np.array([BELIEVED[one.name] for one in self.asked])

    @property
    def names(self) -> list[str]:
        """What was observed, in words."""
        return [asked_by(one).said for one in self.observations]

    def answers(self, scores: si.DimensionlessArray) -> si.FloatArray:
        """Logarithms of all answers at scores (points, parameters), shape (points, asked)."""
        return self.emulator(self.scores.coordinates(scores))

    def residuals(self, scores: si.DimensionlessArray) -> si.FloatArray:
        """Observed less predicted logarithms, shape (points, observations)."""
        return self.observed - self.answers(scores)[:, self.columns]

    def log_posterior(self, points: si.DimensionlessArray) -> si.FloatArray:
        """The logarithm of the posterior density, but for a constant, at `points` (points,
        parameters + 1): scores, and last the score of the discrepancy's scale."""
        scores, scale = points[:, :-1], scale_of(points[:, -1])
        prior = -np.sum(points**2, axis=1) / 2
        off = self.residuals(scores)
        loose = np.outer(scale, self.believed[self.columns]) ** 2
        variance = self.variances + loose
        return np.asarray(prior - np.sum(off**2 / variance + np.log(variance), axis=1) / 2)


@dataclass(frozen=True, eq=False)
class PlatePosterior:
    """Draws of a plate's posterior: `scores` (draws, parameters) and discrepancy `scales` (draws,).

    `best` are the scores of the best fit without discrepancy. `effective` is how many independent
    draws they are worth, by the integrated autocorrelation time; below some hundred their ends are
    rough.
    """

    scores: si.DimensionlessArray
    scales: si.DimensionlessArray
    best: si.DimensionlessArray
    misfit: Misfit
    effective: float


def best_fit(problem: PlateProblem, starts: int = 4, seed: int = 1) -> si.DimensionlessArray:
    """The most probable scores without a discrepancy, shape (parameters,), by least squares from
    several starts."""
    from scipy.optimize import least_squares

    count = len(problem.scores.parameters)
    errors = np.sqrt(problem.variances)

    def off(scores: si.FloatArray) -> si.FloatArray:
        return np.asarray(np.r_[scores, problem.residuals(scores[None, :])[0] / errors])

    def slopes(scores: si.FloatArray) -> si.FloatArray:
        step = 1e-4
        moved = scores + step * np.vstack([np.eye(count), -np.eye(count)])
        there = problem.residuals(moved) / errors
        return np.vstack([np.eye(count), (there[:count] - there[count:]).T / (2 * step)])

    random = np.random.default_rng(seed)
    begun = np.vstack([np.zeros(count), random.normal(0, 0.7, (max(starts - 1, 0), count))])
    fits = [least_squares(off, one, jac=slopes) for one in begun]
    return np.asarray(min(fits, key=lambda one: float(one.cost)).x)


def sampled_posterior(
    problem: PlateProblem,
    *,
    seed: int,
    steps: Annotated[int, si.AtLeast(100)] = STEPS,
    progress: SayProgress | None = None,
) -> PlatePosterior:
    """The posterior of a plate's parameters and of the discrepancy's scale.

    Raises `InputError` where nothing was observed of the plate; interrupted, it leaves nothing.
    """
    import emcee

    if not problem.observations:
        raise InputError("nothing of the plate was observed; give at least one observation of it")
    tell = progress or (lambda _: None)
    tell("least squares")
    best = best_fit(problem, seed=seed)
    count, random = best.size + 1, np.random.default_rng(seed)
    walkers = 2 * max(2 * count, 16)
    start = np.column_stack(
        [
            best + random.multivariate_normal(np.zeros(best.size), _around(problem, best), walkers),
            random.normal(0, 0.7, walkers),
        ]
    )
    # Differential evolution finds the way along ridges, where the stretch move alone is slow.
    moves = [
        (emcee.moves.DEMove(), 0.6),
        (emcee.moves.DESnookerMove(), 0.1),
        (emcee.moves.StretchMove(), 0.3),
    ]
    sampler = emcee.EnsembleSampler(
        walkers, count, problem.log_posterior, moves=moves, vectorize=True
    )
    state = emcee.State(start, random_state=np.random.RandomState(seed % 2**32).get_state())
    parts = 10
    for part in range(parts):
        tell(f"posterior, {100 * part // parts} %")
        state = sampler.run_mcmc(state, (steps + BURN_IN) // parts)
    chain = sampler.get_chain(discard=BURN_IN)
    time = float(np.max(emcee.autocorr.integrated_time(chain, quiet=True, tol=0)))
    flat = chain.reshape(-1, count)
    kept = flat[random.choice(len(flat), min(_DRAWS, len(flat)), replace=False)]
    off = problem.residuals(best[None, :])[0] / np.sqrt(problem.variances)
    return PlatePosterior(
        kept[:, :-1],
        scale_of(kept[:, -1]),
        best,
        misfit_of(float(best @ best + off @ off), problem.names, off),
        len(flat) / max(time, 1.0),
    )


def _around(problem: PlateProblem, best: si.DimensionlessArray) -> si.FloatArray:
    """The covariance of the scores about the best fit if all were linear."""
    step = 1e-3
    moved = best + step * np.vstack([np.eye(best.size), -np.eye(best.size)])
    there = problem.residuals(moved) / np.sqrt(problem.variances)
    slopes = (there[: best.size] - there[best.size :]) / (2 * step)
    return np.asarray(np.linalg.inv(np.eye(best.size) + slopes @ slopes.T))


@dataclass(frozen=True, eq=False)
class Predictive:
    """Draws of the true answers of the bench itself: the emulator's at draws of the posterior, with
    what the model may be off by, shape (draws, asked), in SI units."""

    asked: tuple[Asked, ...]
    values: si.FloatArray

    def of(self, asked: Asked) -> si.FloatArray:
        """The draws of one answer, shape (draws,). Raises `InputError` for one that is not
        there."""
        if asked not in self.asked:
            known = ", ".join(one.said for one in self.asked)
            raise InputError(f"nothing was computed of the {asked.said}; there are: {known}")
        return np.asarray(self.values[:, self.asked.index(asked)])


def predictive(problem: PlateProblem, posterior: PlatePosterior, *, seed: int) -> Predictive:
    """What the posterior predicts of every answer of the emulator.

    The discrepancy of an answer that was observed is what the observation left of it; that of
    another one is as wide as its draw's scale says.
    """
    random = np.random.default_rng(seed)
    answers = problem.answers(posterior.scores)
    wide = np.outer(posterior.scales, problem.believed) ** 2 + problem.model_errors**2
    middle = np.zeros_like(answers)
    noise = np.array([one.standard_error / one.value for one in problem.observations])
    for number, column in enumerate(problem.columns):
        # Of several observations of one answer each in turn narrows what the last one left.
        left = problem.observed[number] - answers[:, column] - middle[:, column]
        share = wide[:, column] / (wide[:, column] + noise[number] ** 2)
        middle[:, column] += share * left
        wide[:, column] *= 1 - share
    values = answers + middle + np.sqrt(wide) * random.normal(size=answers.shape)
    return Predictive(problem.asked, np.exp(values))
