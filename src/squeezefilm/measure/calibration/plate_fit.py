"""The plate's part of a calibration: solves, emulator, posterior, and once more where it points."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.core.progress import ShareProgress, within
from squeezefilm.measure.calibration.emulator import HELD_OUT, emulator_of, least_points
from squeezefilm.measure.calibration.plate_posterior import (
    PlatePosterior,
    PlateProblem,
    predictive,
    sampled_posterior,
)
from squeezefilm.measure.calibration.priors import NormalScores, with_calibrated
from squeezefilm.measure.calibration.solved_answers import (
    MODE_FREQUENCY,
    PLATE_ANSWERS,
    Asked,
    SolvedAnswers,
    asked_by,
    solved_answers,
)
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.uncertainty.parameters import Parameter

_MOST_LOST = 0.25
_SOLVES = 0.95  # of the time; the rest is that of the posterior
_SMALL = 0.3  # of a standard error; so much adds a twentieth to it
WORKING = (Asked("resonance_frequency"), Asked("amplitude_per_volt"), Asked("quality_factor"))
"""Answers of a plate that friction needs."""


@dataclass(frozen=True, eq=False)
class PlateFit:
    """A plate's problem (with its last emulator), posterior and predictions, of `solves` plates."""

    problem: PlateProblem
    posterior: PlatePosterior
    predictive: Mapping[Asked, si.FloatArray]
    solves: int

    @property
    def paths(self) -> tuple[str, ...]:
        """Paths of the parameters."""
        return self.problem.scores.paths

    @property
    def middle(self) -> Mapping[str, float]:
        """The values by path at the mean of the posterior's scores, which keeps what only
        combinations of them fix."""
        return next(self.problem.scores.by_path(self.posterior.scores.mean(axis=0)[None, :]))


def answers_to_solve(display: Display, observations: tuple[Observation, ...]) -> tuple[Asked, ...]:
    """Answers that are solved of a display: its working mode's answers, one neighbouring mode, and
    every mode that was observed. Raises `InputError` for an observation without an answer."""
    names = [name for name in PLATE_ANSWERS if name != "modal_mass"]
    actuator = display.actuator
    asked = [Asked(name) for name in names]
    if isinstance(actuator, RectangularPlate):
        n, m = actuator.working_label
        lines = (n - 1, 0) if m == 0 else (0, m - 1)
        if max(lines) >= 2:
            asked.append(Asked(MODE_FREQUENCY, lines))
    asked += [asked_by(seen) for seen in observations]
    return tuple(dict.fromkeys(asked))


def design_sizes(parameters: int) -> tuple[int, int]:
    """Number of plates solved over the priors, and of those solved where the data point."""
    return max(8 * parameters, least_points(parameters)), 4 * parameters + HELD_OUT


class Solves:
    """Solved plates as they are added: their scores (`points`), what was `solved` of each, and why
    others were `refused`."""

    def __init__(
        self,
        display: Display,
        scores: NormalScores,
        observations: tuple[Observation, ...],
    ) -> None:
        self.display, self.scores = display, scores
        self.asked = answers_to_solve(display, observations)
        observed = {asked_by(seen) for seen in observations}
        self._needed = np.array([answer in observed or answer in WORKING for answer in self.asked])
        self.points: list[si.FloatArray] = []
        self.solved: list[SolvedAnswers] = []
        self.refused: list[str] = []

    def add(self, points: si.DimensionlessArray, said: str, tell: ShareProgress) -> None:
        """Solve plates at scores; one that has no such mode is left out and counted."""
        for number, values in enumerate(self.scores.by_path(points)):
            tell(f"{said}: plate {number + 1} of {len(points)}", number / len(points))
            try:
                actuator = with_calibrated(self.display, values).actuator
                solved = solved_answers(actuator, self.asked)
            except SqueezefilmError as error:
                self.refused.append(str(error))
                continue
            lacking = self._needed & ~(solved.values > 0)
            if np.any(lacking):
                self.refused.append(f"it has no {self.asked[int(np.argmax(lacking))].said}")
                continue
            self.points.append(points[number])
            self.solved.append(solved)

    def require_enough(self) -> None:
        """Refuse priors in which too many plates have no answer."""
        lost, total = len(self.refused), len(self.refused) + len(self.points)
        if lost > _MOST_LOST * total:
            raise InputError(
                f"{lost} of {total} plates within the priors have no answer (the first: "
                f"{self.refused[0]}); narrow the ranges, or say working_frequency in the file"
            )

    def problem(self, observations: tuple[Observation, ...]) -> PlateProblem:
        """Observations beside an emulator of all plates so far. An answer that some of them
        have not, and that was not observed, is left out."""
        values, errors, readings = (np.array(rows) for rows in zip(*self.solved, strict=True))
        logs = np.log(values)
        whole = np.asarray(np.isfinite(logs).all(axis=0))
        emulator = emulator_of(self.scores.coordinates(np.array(self.points)), logs[:, whole])
        solver_errors, readings = (
            np.sqrt(np.mean(part**2, axis=0))[whole] for part in (errors, readings)
        )
        asked = tuple(part for part, has in zip(self.asked, whole.tolist(), strict=True) if has)
        return PlateProblem(self.scores, emulator, asked, solver_errors, readings, observations)


def fitted_plate(
    display: Display,
    parameters: tuple[Parameter, ...],
    observations: tuple[Observation, ...],
    *,
    seed: int,
    size: tuple[int, int] | None = None,
    progress: ShareProgress | None = None,
) -> PlateFit:
    """The posterior of a plate's or disc's parameters.

    `size` plates are solved over the priors and, where the emulator is not much better than the
    observations, where a first posterior points (`design_sizes` without one): one to two seconds
    each, kept on disk as they come. Raises `InputError` where
    nothing was observed, an observation has no answer, or a tenth of the plates has no such mode.
    """
    tell = progress or (lambda _, __: None)
    scores = NormalScores(parameters)
    first, second = size or design_sizes(len(parameters))
    half = _SOLVES * first / (first + second)
    solves = Solves(display, scores, observations)
    points = prior_scores(len(parameters), first, seed)
    solves.add(points, "over the priors", within(tell, 0.0, half))
    solves.require_enough()
    tell("emulator", half)
    problem = solves.problem(observations)
    posterior = sampled_posterior(problem, seed=seed, steps=600)
    # Where the emulator's error widens what some observation says.
    if second and np.any(problem.emulator.errors[problem.columns] > _SMALL * problem.noise):
        random = np.random.default_rng(seed)
        chosen = posterior.scores[random.choice(len(posterior.scores), second, replace=False)]
        # A little wider, so that the emulator does not end where the posterior does.
        chosen = chosen + random.normal(0, 0.25, chosen.shape)
        solves.add(chosen, "where the data point", within(tell, half, _SOLVES))
        tell("emulator", _SOLVES)
        problem = solves.problem(observations)
    posterior = sampled_posterior(problem, seed=seed, progress=within(tell, _SOLVES, 1.0))
    made = predictive(problem, posterior, seed=seed)
    return PlateFit(problem, posterior, made, len(solves.points) + len(solves.refused))


def prior_scores(
    parameters: Annotated[int, si.AtLeast(1)], count: Annotated[int, si.AtLeast(1)], seed: int
) -> si.DimensionlessArray:
    """`count` scrambled Sobol' points of the priors in scores, shape (count, parameters)."""
    from scipy.special import ndtri
    from scipy.stats import qmc

    power = math.ceil(math.log2(max(count, 2)))
    points = qmc.Sobol(parameters, rng=seed).random_base2(power)[:count]
    return np.asarray(ndtri(np.clip(points, 1e-6, 1 - 1e-6)))
