"""Posterior of a plate's parameters by observations: least squares, then draws of the posterior.

Everything happens in normal scores (`priors.NormalScores`) and in logarithms of the answers. The
last scores are those of the discrepancy's scales, one for each of `KINDS`. The draws are by the
affine-invariant ensemble sampler of Goodman and Weare (2010), 10.2140/camcos.2010.5.65, as emcee
has it (10.1086/670067).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, optional
from squeezefilm.core.progress import ShareProgress
from squeezefilm.measure.calibration.discrepancy import (
    KINDS,
    READ_ALONE,
    Misfit,
    misfit_of,
    scales_of,
    solver_covariance,
    unit_covariances,
)
from squeezefilm.measure.calibration.emulator import Emulator
from squeezefilm.measure.calibration.priors import NormalScores
from squeezefilm.measure.calibration.solved_answers import Asked, asked_by
from squeezefilm.measure.fits.estimate import Observation

STEPS, BURN_IN = 2000, 500
"""Steps of each walker: kept, and left out before."""
_DRAWS = 2000
BOUND = ("resonance_frequency", "parallel_resonance_frequency", "coupling_coefficient")
"""Frequencies of which each follows from the other two, by what a coupling coefficient is."""
# Of ln k: a body that is nearly all ceramic stays below.
_MOST_COUPLED = -0.01
# In standard deviations: further out the covariances of errors cannot be told from singular ones.
_FURTHEST = 10.0
_PASSES, _STARTS = 3, 4


@dataclass(frozen=True, eq=False)
class PlateProblem:
    """Observations of a plate's answers beside the emulator that predicts them.

    `asked` are the emulator's answers; `solver_errors` (asked,) what the solver itself may be off
    by, and `readings` (asked,) what all readings of an answer are off by together
    (`SolvedAnswers.readings`), both relative. Where resonance, parallel resonance and coupling are
    all asked, the parallel one follows from the other two (k² = 1 − (fs/fp)²), its error too.
    """

    scores: NormalScores
    emulator: Emulator
    asked: tuple[Asked, ...]
    solver_errors: si.DimensionlessArray
    readings: si.DimensionlessArray
    observations: tuple[Observation, ...]

    def __post_init__(self) -> None:
        for seen in self.observations:
            if not (seen.value > 0 and seen.standard_error > 0):
                raise InputError(
                    f"{asked_by(seen).said} was observed as {seen.value:.6g} with a standard error "
                    f"of {seen.standard_error:.6g}; both must be above 0"
                )

    @cached_property
    def columns(self) -> list[int]:
        """Columns of the emulator's answers that the observations are of."""
        return [self.asked.index(asked_by(seen)) for seen in self.observations]

    @cached_property
    def observed(self) -> si.FloatArray:
        """Logarithms of what was observed, shape (observations,)."""
        return np.log([seen.value for seen in self.observations])

    @cached_property
    def noise(self) -> si.DimensionlessArray:
        """Relative standard errors of the observations, shape (observations,)."""
        return np.array([seen.standard_error / seen.value for seen in self.observations])

    @cached_property
    def reading_covariance(self) -> si.DimensionlessArray:
        """Covariance of what the observations are off the bench's true answers, shape
        (observations, observations): their noise, each recording's own reading error, and the one
        that all readings of an answer share, which no number of them averages away."""
        same = np.equal.outer(self.columns, self.columns)
        shared = self.readings[self.columns]
        own = np.array([READ_ALONE.get(seen.answer, 0.0) for seen in self.observations])
        return np.asarray(np.outer(shared, shared) * same + np.diag(self.noise**2 + own**2))

    @cached_property
    def model_covariance(self) -> si.DimensionlessArray:
        """Covariance of the emulator's and the solver's relative errors, shape (asked, asked); not
        to be used of an answer that others fix (`moved`)."""
        names = [answer.name for answer in self.asked]
        covariance = solver_covariance(names, self.solver_errors)
        return np.asarray(covariance + np.diag(self.emulator.errors**2))

    @cached_property
    def covariance(self) -> si.DimensionlessArray:
        """Covariance of the observed logarithms if the model is right, shape (observations,
        observations): of the measurement, the emulator and the solver."""
        here = self.answers(np.zeros((1, len(self.scores.parameters))))
        moved = self.moved(here)[0, self.columns]
        return np.asarray(self.reading_covariance + moved @ self.model_covariance @ moved.T)

    @cached_property
    def discrepancies(self) -> si.DimensionlessArray:
        """`unit_covariances` of the emulator's answers, shape (kinds, asked, asked)."""
        return unit_covariances([answer.name for answer in self.asked])

    def answers(self, scores: si.DimensionlessArray) -> si.FloatArray:
        """Logarithms of all answers at scores (points, parameters), shape (points, asked)."""
        return self.bound(self.emulator(self.scores.coordinates(scores)))

    @cached_property
    def _bound(self) -> tuple[int, int, int] | None:
        """The columns of resonance, parallel resonance and coupling, if all are asked."""
        three = [Asked(name) for name in BOUND]
        if not set(three) <= set(self.asked):
            return None
        short, opened, coupling = (self.asked.index(answer) for answer in three)
        return short, opened, coupling

    def bound(self, logs: si.FloatArray) -> si.FloatArray:
        """Logarithms of answers (points, asked), with the parallel resonance that goes with
        resonance and coupling."""
        if self._bound is None:
            return logs
        short, opened, coupling = self._bound
        bound = np.array(logs)
        squares = np.exp(2 * np.minimum(bound[:, coupling], _MOST_COUPLED))
        bound[:, opened] = bound[:, short] - np.log1p(-squares) / 2
        return bound

    def moved(self, logs: si.FloatArray) -> si.DimensionlessArray:
        """Shift of the answers (rows) by errors of the answers (columns) at `logs` (points, asked),
        shape (points, asked, asked): each its own but for a parallel resonance that is `bound`."""
        moved = np.tile(np.eye(len(self.asked)), (len(logs), 1, 1))
        if self._bound is not None:
            short, opened, coupling = self._bound
            squares = np.exp(2 * np.minimum(logs[:, coupling], _MOST_COUPLED))
            moved[:, opened, opened] = 0.0
            moved[:, opened, short] = 1.0
            moved[:, opened, coupling] = squares / (1 - squares)
        return moved

    def residuals(self, scores: si.DimensionlessArray) -> si.FloatArray:
        """Observed less predicted logarithms, shape (points, observations)."""
        return self.observed - self.answers(scores)[:, self.columns]

    def whitened(self, scores: si.DimensionlessArray) -> si.FloatArray:
        """Residuals at scores, independent and of variance 1 where the model is right."""
        root = np.linalg.cholesky(self.covariance)
        return np.asarray(np.linalg.solve(root, self.residuals(scores).T).T)

    def slopes(self, scores: si.DimensionlessArray, step: float) -> si.FloatArray:
        """Derivatives of `whitened` at scores (parameters,), by central differences, shape
        (parameters, observations)."""
        count = scores.size
        there = self.whitened(scores + step * np.vstack([np.eye(count), -np.eye(count)]))
        return np.asarray((there[:count] - there[count:]) / (2 * step))

    def errors(self, scales: si.DimensionlessArray) -> si.DimensionlessArray:
        """Covariances of the model's errors, emulator and solver included, at the discrepancy's
        `scales` (points, kinds), shape (points, asked, asked)."""
        wide = np.einsum("pk,kij->pij", scales**2, self.discrepancies)
        return np.asarray(wide + self.model_covariance)

    def log_posterior(self, points: si.DimensionlessArray) -> si.FloatArray:
        """The logarithm of the posterior density, but for a constant, at `points` (points,
        parameters + kinds): scores, and last those of the discrepancy's scales; none of a
        discrepancy `_FURTHEST` from the usual, which proposals of the sampler reach."""
        usual = np.all(np.abs(points[:, -len(KINDS) :]) < _FURTHEST, axis=1)
        densities = np.full(len(points), -np.inf)
        points = points[usual]
        scores, scales = points[:, : -len(KINDS)], scales_of(points[:, -len(KINDS) :])
        prior = -np.sum(points**2, axis=1) / 2
        logs = self.answers(scores)
        off = (self.observed - logs[:, self.columns])[:, :, None]
        moved = self.moved(logs)[:, self.columns]
        covariance = moved @ self.errors(scales) @ moved.transpose(0, 2, 1)
        covariance += self.reading_covariance
        squares = (off * np.linalg.solve(covariance, off)).sum(axis=(1, 2))
        densities[usual] = prior - (squares + np.linalg.slogdet(covariance)[1]) / 2
        return densities


@dataclass(frozen=True, eq=False)
class PlatePosterior:
    """Draws of a plate's posterior: `scores` (draws, parameters) and the discrepancy's `scales`
    (draws, kinds).

    `best` are the scores of the best fit without discrepancy. `effective` is how many independent
    draws they are worth, by the integrated autocorrelation time; below some hundred their ends are
    rough.
    """

    scores: si.DimensionlessArray
    scales: si.DimensionlessArray
    best: si.DimensionlessArray
    misfit: Misfit
    effective: float


def best_fit(problem: PlateProblem, seed: int = 1) -> si.DimensionlessArray:
    """The most probable scores without a discrepancy, shape (parameters,), by least squares from
    several starts."""
    from scipy.optimize import least_squares

    count = len(problem.scores.parameters)

    def off(scores: si.FloatArray) -> si.FloatArray:
        return np.asarray(np.r_[scores, problem.whitened(scores[None, :])[0]])

    def slopes(scores: si.FloatArray) -> si.FloatArray:
        return np.vstack([np.eye(count), problem.slopes(scores, 1e-4).T])

    random = np.random.default_rng(seed)
    begun = np.vstack([np.zeros(count), random.normal(0, 0.7, (_STARTS - 1, count))])
    fits = [least_squares(off, fitted, jac=slopes) for fitted in begun]
    return np.asarray(min(fits, key=lambda fitted: float(fitted.cost)).x)


def sampled_posterior(
    problem: PlateProblem,
    *,
    seed: int,
    steps: Annotated[int, si.AtLeast(100)] = STEPS,
    progress: ShareProgress | None = None,
) -> PlatePosterior:
    """The posterior of a plate's parameters and of the discrepancy's scales."""
    with optional("measure", "a calibration"):
        import emcee

    tell = progress or (lambda _, __: None)
    tell("least squares", 0.0)
    best = best_fit(problem, seed=seed)
    count, random = best.size + len(KINDS), np.random.default_rng(seed)
    walkers = 2 * max(2 * count, 16)
    start = np.column_stack(
        [
            best + random.multivariate_normal(np.zeros(best.size), _around(problem, best), walkers),
            random.normal(0, 0.7, (walkers, len(KINDS))),
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
        tell(f"posterior, {100 * part // parts} %", part / parts)
        state = sampler.run_mcmc(state, (steps + BURN_IN) // parts)
    chain = sampler.get_chain(discard=BURN_IN)
    time = float(np.max(emcee.autocorr.integrated_time(chain, quiet=True, tol=0)))
    flat = chain.reshape(-1, count)
    kept = flat[random.choice(len(flat), min(_DRAWS, len(flat)), replace=False)]
    off = problem.residuals(best[None, :])[0] / np.sqrt(np.diag(problem.covariance))
    squares = best @ best + np.sum(problem.whitened(best[None, :]) ** 2)
    names = [seen.in_words(asked_by(seen).said) for seen in problem.observations]
    return PlatePosterior(
        kept[:, : best.size],
        scales_of(kept[:, best.size :]),
        best,
        misfit_of(float(squares), names, off),
        len(flat) / max(time, 1.0),
    )


def _around(problem: PlateProblem, best: si.DimensionlessArray) -> si.FloatArray:
    """The covariance of the scores about the best fit if all were linear."""
    slopes = problem.slopes(best, 1e-3)
    return np.asarray(np.linalg.inv(np.eye(best.size) + slopes @ slopes.T))


def predictive(
    problem: PlateProblem, posterior: PlatePosterior, *, seed: int
) -> dict[Asked, si.FloatArray]:
    """Draws of the true answers of the bench itself (SI, (draws,)): the emulator's at draws of the
    posterior, with what the model may be off by.

    The discrepancy of an answer that was observed is what the observation left of it; of another
    one it is what its kind's scale allows, less what observed answers of its kind say of it.
    """
    random = np.random.default_rng(seed)
    answers = problem.answers(posterior.scores)
    columns = problem.columns
    prior = problem.errors(posterior.scales)
    # The error of all answers, given those that were observed: Gaussian for every draw, but for the
    # little by which the parallel resonance is no linear function of the others.
    middle = np.zeros_like(answers)
    for _ in range(_PASSES):
        there = problem.bound(answers + middle)
        moved = problem.moved(there)[:, columns]
        crossed = moved @ prior
        seen = crossed @ moved.transpose(0, 2, 1) + problem.reading_covariance
        gain = np.linalg.solve(seen, crossed).transpose(0, 2, 1)
        left = problem.observed - there[:, columns] + np.einsum("doa,da->do", moved, middle)
        middle = np.einsum("dao,do->da", gain, left)
    wide = prior - gain @ crossed
    # A hair of each answer's own keeps the factor where an observation left nothing.
    hair = 1e-9 * np.einsum("daa->da", prior)
    root = np.linalg.cholesky(wide + hair[:, :, None] * np.eye(len(problem.asked)))
    error = middle + np.einsum("dab,db->da", root, random.normal(size=answers.shape))
    return dict(zip(problem.asked, np.exp(problem.bound(answers + error)).T, strict=True))
