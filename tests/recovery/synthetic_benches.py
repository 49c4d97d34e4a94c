"""Synthetic benches of the paper's plate: truths drawn from the priors, answers with noise."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from squeezefilm.measure.calibration.discrepancy import (
    GRID,
    KINDS,
    FrictionLikelihood,
    Touching,
    scales_of,
)
from squeezefilm.measure.calibration.friction_posterior import (
    finger_mixture,
    friction_of_points,
    weighted,
)
from squeezefilm.measure.calibration.identified import (
    FRICTION_ACCURACY,
    friction_candidate,
    ranked,
)
from squeezefilm.measure.calibration.plate_fit import Solves, prior_scores
from squeezefilm.measure.calibration.plate_posterior import (
    PlateProblem,
    predictive,
    sampled_posterior,
)
from squeezefilm.measure.calibration.priors import NormalScores, calibration_parameters
from squeezefilm.measure.calibration.solved_answers import FRICTION, Asked
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import Display, load_display

NOISE = {
    "parallel_resonance_frequency": 5e-4,
    "coupling_coefficient": 0.01,
    "static_capacitance": 0.01,
    "quality_factor": 0.03,
    "mass": 1e-3,
}
"""What a bench observes, with relative standard errors; resonance and amplitude are left blind."""
BLIND = (Asked("resonance_frequency"), Asked("amplitude_per_volt"))
AMPLITUDES = (0.4e-6, 0.7e-6, 1.0e-6, 1.4e-6)
BLIND_AMPLITUDE = 2e-6
FRICTION_NOISE = 0.03


def paper_display() -> Display:
    """The preset, whose priors are the assumed ones."""
    return load_display("biet2008-plate")


@dataclass
class Plates:
    """Plates around the paper's: an emulator of `count` solved ones, asked again and again."""

    display: Display
    problem: PlateProblem

    @classmethod
    def of(cls, count: int, seed: int = 11) -> Plates:
        display = paper_display()
        scores = NormalScores(calibration_parameters(display))
        nothing = tuple(Observation(name, 1.0, 1.0) for name in NOISE)
        solves = Solves(display, scores, nothing)
        points = prior_scores(len(scores.parameters), count, seed)
        solves.add(points, "benches", lambda _, __: None)
        return cls(display, solves.problem(nothing))

    def posed(self, observations: tuple[Observation, ...]) -> PlateProblem:
        known = self.problem
        return PlateProblem(
            known.scores,
            known.emulator,
            known.asked,
            known.solver_errors,
            known.readings,
            observations,
        )

    def truth(
        self, scores: np.ndarray, scales: np.ndarray | float, random: np.random.Generator
    ) -> np.ndarray:
        """Answers of a bench at scores (parameters,), the model's error drawn at `scales` (kinds,)
        of the discrepancy."""
        squares = np.broadcast_to(np.square(scales), len(KINDS))
        covariance = np.tensordot(squares, self.problem.discrepancies, 1)
        covariance = covariance + self.problem.model_covariance
        errors = random.multivariate_normal(np.zeros(len(covariance)), covariance)
        return self.bound(self.problem.answers(scores[None, :])[0] + errors)

    def bound(self, logs: np.ndarray) -> np.ndarray:
        """Answers of their logarithms, with the parallel resonance that is a bench's by what its
        coupling coefficient is: no bench has another."""
        return np.exp(self.problem.bound(logs[None, :])[0])

    def least_errors(self, scores: np.ndarray) -> np.ndarray:
        """The standard deviations (relative) that anybody's estimate of the blind answers has at
        least, on average over such benches, where the model is right: van Trees' bound, of priors,
        slopes at `scores`, and the errors of emulator, solver and instruments."""
        asked, step = self.problem.asked, 1e-3
        moved = step * np.vstack([np.eye(scores.size), -np.eye(scores.size)])
        there = self.problem.answers(scores + moved)
        slopes = (there[: scores.size] - there[scores.size :]).T / (2 * step)
        spread = self.problem.moved(self.problem.answers(scores[None, :]))[0]
        prior = slopes @ slopes.T + spread @ self.problem.model_covariance @ spread.T
        seen = [asked.index(Asked(name)) for name in NOISE]
        blind = [asked.index(one) for one in BLIND]
        noise = np.diag(np.square(list(NOISE.values())))
        gain = prior[np.ix_(blind, seen)] @ np.linalg.inv(prior[np.ix_(seen, seen)] + noise)
        left = prior[np.ix_(blind, blind)] - gain @ prior[np.ix_(seen, blind)]
        return np.sqrt(np.diag(left))

    def observed(
        self, answers: np.ndarray, random: np.random.Generator, *, misread: bool
    ) -> tuple[Observation, ...]:
        """What the bench's instruments say of its answers: with noise, and where they are `misread`
        with as much beside it as a calibration believes of readings."""
        true = {name: float(answers[self.problem.asked.index(Asked(name))]) for name in NOISE}
        exact = tuple(Observation(name, true[name], true[name] * NOISE[name]) for name in NOISE)
        covariance = np.diag(np.square(list(NOISE.values())))
        if misread:
            covariance = self.posed(exact).reading_covariance
        off = np.exp(random.multivariate_normal(np.zeros(len(exact)), covariance))
        return tuple(
            dataclasses.replace(one, value=one.value * by)
            for one, by in zip(exact, off.tolist(), strict=True)
        )


@dataclass
class PlateBench:
    """What one bench gave: ranks (0 to 1) of its parameters and of its blind answers, relative
    errors and interval widths of these (90 %), whether they are inside, whether it fits."""

    ranks: np.ndarray
    blind_ranks: np.ndarray
    errors: np.ndarray
    widths: np.ndarray
    inside: np.ndarray
    fits: bool


def plate_bench(
    plates: Plates,
    scores: np.ndarray,
    answers: np.ndarray,
    seed: int,
    steps: int = 800,
    *,
    misread: bool = False,
) -> PlateBench:
    """Calibrate on what the bench observed, and compare the rest."""
    random = np.random.default_rng(seed)
    problem = plates.posed(plates.observed(answers, random, misread=misread))
    posterior = sampled_posterior(problem, seed=seed, steps=steps)
    made = predictive(problem, posterior, seed=seed)
    drawn = np.stack([made[one] for one in BLIND], axis=1)
    true = np.array([answers[problem.asked.index(one)] for one in BLIND])
    low, middle, high = np.quantile(drawn, [0.05, 0.5, 0.95], axis=0)
    return PlateBench(
        np.mean(posterior.scores < scores, axis=0),
        np.mean(drawn < true, axis=0),
        middle / true - 1,
        (high - low) / true,
        (low <= true) & (true <= high),
        posterior.misfit.judgement == "fits",
    )


def drawn_scales(random: np.random.Generator) -> np.ndarray:
    """The discrepancy's scales (kinds,) from their prior."""
    return scales_of(random.normal(size=(1, len(KINDS))))[0]


@dataclass
class Fingers:
    """A bank of draws of finger and laws with their µ′/µ at all amplitudes, the blind one last."""

    points: np.ndarray
    curves: np.ndarray
    mixture: object

    WHERE = tuple(Touching(one) for one in (*AMPLITUDES, BLIND_AMPLITUDE))

    @classmethod
    def of(cls, count: int, seed: int = 5) -> Fingers:
        display = paper_display()
        mixture = finger_mixture(display, predict(display))
        points = np.random.default_rng(seed).random((count, len(mixture.inputs)))
        curves = friction_of_points(mixture, points, cls.WHERE, lambda _, __: None)
        return cls(points, curves, mixture)

    def discrepancy(self, random: np.random.Generator) -> np.ndarray:
        """A law's error at all amplitudes, its scale drawn from the grid's prior."""
        scale = float(random.choice(GRID))
        fake = tuple(
            Observation(FRICTION, 0.5, 1e-6, {"vibration_amplitude": one.amplitude})
            for one in self.WHERE
        )
        covariance = FrictionLikelihood(fake)._covariance(scale)
        return random.multivariate_normal(np.zeros(len(self.WHERE)), covariance)

    def blind(self, curve: np.ndarray, bank: slice, seed: int) -> tuple[np.ndarray, bool, float]:
        """Draws of the blind µ′/µ after the observed part of a curve, whether it fits, and how many
        draws that was worth."""
        random = np.random.default_rng(seed)
        observations = tuple(
            Observation(
                FRICTION,
                float(value + FRICTION_NOISE * random.normal()),
                FRICTION_NOISE,
                {"vibration_amplitude": amplitude},
            )
            for value, amplitude in zip(curve, AMPLITUDES, strict=False)
        )
        own = self.curves[bank]
        posterior = weighted(
            self.mixture, FrictionLikelihood(observations), self.points[bank], own[:, :-1]
        )
        draws = posterior.resampled(1000, seed)
        found = draws.with_error(own[draws.rows, -1:], self.WHERE[-1:], seed)[:, 0]
        return found, posterior.misfit.judgement == "fits", posterior.effective

    def next_measurements(self, bank: slice, truths: range) -> tuple[np.ndarray, np.ndarray]:
        """Of µ′/µ at each other amplitude, after one at the first: which share of the interval of
        the blind one it is expected to leave, and leaves on benches of the truths (means)."""
        own, expected, achieved = self.curves[bank], [], []
        for number in truths:
            random = np.random.default_rng(number)
            true = self.curves[number] + self.discrepancy(random)
            if not np.isfinite(true).all():
                continue
            seen = [
                Observation(
                    FRICTION,
                    float(value + FRICTION_ACCURACY * random.normal()),
                    FRICTION_ACCURACY,
                    {"vibration_amplitude": amplitude},
                )
                for value, amplitude in zip(true, AMPLITUDES, strict=False)
            ]

            def drawn(rows: list[int], seed: int, seen: list[Observation] = seen) -> np.ndarray:
                likelihood = FrictionLikelihood(tuple(seen[k] for k in rows))
                posterior = weighted(self.mixture, likelihood, self.points[bank], own[:, rows])
                draws = posterior.resampled(1000, seed)
                at = own[draws.rows]
                return draws.with_error(at, self.WHERE, seed)

            now = drawn([0], number)
            options = [
                friction_candidate(now[:, k], AMPLITUDES[k]) for k in range(1, len(AMPLITUDES))
            ]
            found = {one.name: one.left for one in ranked(now[:, -1], options, seed=number)}
            expected.append([found[one.name] for one in options])
            width = np.diff(np.quantile(now[:, -1], [0.05, 0.95]))[0]
            after = [drawn([0, k], number)[:, -1] for k in range(1, len(AMPLITUDES))]
            achieved.append([np.diff(np.quantile(one, [0.05, 0.95]))[0] / width for one in after])
        return np.mean(expected, axis=0), np.mean(achieved, axis=0)
