"""`calibrate`: from a described display and what was observed of it to a calibrated one."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.distributions import Distribution
from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.core.progress import SayProgress, ShareProgress
from squeezefilm.measure.calibration.calibration import (
    CalibratedValue,
    Calibration,
    FrictionInterval,
    Joint,
    compared,
)
from squeezefilm.measure.calibration.discrepancy import FrictionLikelihood, Touching
from squeezefilm.measure.calibration.friction_posterior import (
    DRAWS,
    FEWEST,
    ROUNDS,
    FrictionDraws,
    FrictionPosterior,
    finger_mixture,
    friction_of_points,
    friction_posterior,
    normal_scores,
)
from squeezefilm.measure.calibration.identified import (
    Identification,
    NextMeasurement,
    candidates,
    friction_candidate,
    identification,
    ranked,
)
from squeezefilm.measure.calibration.plate_fit import (
    WORKING,
    PlateFit,
    design_sizes,
    fitted_plate,
)
from squeezefilm.measure.calibration.priors import calibration_parameters, with_calibrated
from squeezefilm.measure.calibration.solved_answers import (
    DRAW_TAKES,
    FRICTION,
    MODE_FREQUENCY,
    PLATE_TAKES,
    Asked,
    in_parts,
)
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.chain.touch import touch
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.working_mode import WorkingMode
from squeezefilm.physics.uncertainty.draws import (
    Draw,
    Mixture,
    as_drawn,
    between_limits,
    mixture_of,
)
from squeezefilm.physics.uncertainty.intervals import LEVEL, MOST_REFUSED, evaluate, quantiles
from squeezefilm.physics.uncertainty.parameters import Parameter
from squeezefilm.physics.uncertainty.uncertainty import sobol_points

_JOINT = 1024
_BEFORE = 256
_TOLD = 64
_TOUCH_TAKES = 0.02  # seconds of a drawn finger on its plate
_TAILS = ((1 - LEVEL) / 2, 0.5, (1 + LEVEL) / 2)


class Effort(NamedTuple):
    """Amount that is computed: plates over the priors and where the data point (None: by the number
    of parameters), draws of finger and laws, joint draws for friction's interval."""

    plates: tuple[int, int] | None = None
    finger_draws: Annotated[int, si.AtLeast(32)] = DRAWS
    joint_draws: Annotated[int, si.AtLeast(32)] = _JOINT


USUAL_EFFORT = Effort()


def calibrate(
    display: Display,
    observations: Sequence[Observation],
    *,
    parameters: Mapping[str, Distribution | None] | None = None,
    seed: int = 1,
    progress: SayProgress | None = None,
    effort: Effort = USUAL_EFFORT,
) -> Calibration:
    """Learn from observations of a display: values with spreads, laws, friction's interval.

    `observations` may be of the plate or disc (`solved_answers.PLATE_ANSWERS`, and
    `mode_frequency` of a mode by its nodal lines) and of µ′/µ at a vibration amplitude, normal
    force and finger speed. `parameters` are those of the actuator to move
    (`priors.calibration_parameters`); of finger, surface, gas and laws all that is uncertain is
    drawn. Some two to four minutes for eight parameters; solved plates and draws are kept on disk,
    so that what was interrupted goes on. Valid for linear vibration near the described display: no
    parameter leaves its prior.

    Raises `InputError` where nothing was observed or an observation has no answer, and what the
    solvers raise.
    """
    every = tuple(observations)
    if not every:
        raise InputError("nothing was observed; give at least one observation")
    of_friction = tuple(seen for seen in every if seen.answer == FRICTION)
    of_plate = tuple(seen for seen in every if seen.answer != FRICTION)
    likelihood = FrictionLikelihood(of_friction)
    _ = likelihood.where  # refused before any long work
    plate = None
    chosen = calibration_parameters(display, parameters) if of_plate else ()
    size = effort.plates or design_sizes(len(chosen))
    seconds = (
        sum(size) * PLATE_TAKES if of_plate else 0.0,
        _BEFORE * _TOUCH_TAKES,
        effort.finger_draws * (1 + ROUNDS / 2) * DRAW_TAKES if of_friction else 0.0,
        effort.joint_draws * _TOUCH_TAKES,
        effort.joint_draws * DRAW_TAKES,
    )
    steps = in_parts(progress, seconds)
    tell = next(steps)
    if of_plate:
        plate = fitted_plate(display, chosen, of_plate, seed=seed, size=size, progress=tell)
    calibrated = display if plate is None else with_calibrated(display, plate.middle)
    tell = next(steps)
    tell("friction as described", 0.0)
    before = friction_before(display, seed)
    finger = _fitted_finger(calibrated, likelihood, effort, seed, next(steps))
    joint = _joint(finger, plate, effort.joint_draws, seed, next(steps))
    return _calibration(display, calibrated, every, plate, finger, before, joint, seed, next(steps))


def friction_before(display: Display, seed: int) -> FrictionInterval | None:
    """µ′/µ of a display as described with its interval, as `physics.uncertainty.uncertainty` draws
    it; None where more than 2 % of the draws have no friction."""
    prediction = predict(display)
    mixture = mixture_of(display, prediction)
    drawn, refused = evaluate(mixture, sobol_points(mixture, _BEFORE, seed), lambda _: None)
    return _interval(drawn.friction, drawn.amplitude, refused.share)


def _interval(
    friction: si.FloatArray, amplitude: si.MetreArray, refused: float
) -> FrictionInterval | None:
    """The interval of draws; None where too large a share of them was `refused`."""
    if refused > MOST_REFUSED:
        return None
    low, middle, high = (float(quantile) for quantile in quantiles(friction))
    return FrictionInterval(middle, (low, high), float(np.nanmedian(amplitude)))


class _Finger(NamedTuple):
    """Draws of finger and laws at `points` of a mixture's unit cube: those of a posterior where
    friction was observed (by so many `first_draws`), else of the priors."""

    mixture: Mixture
    points: si.DimensionlessArray
    draws: FrictionDraws | None = None
    first_draws: int = 0

    @property
    def posterior(self) -> FrictionPosterior | None:
        """The posterior, where friction was observed."""
        return None if self.draws is None else self.draws.posterior


def _fitted_finger(
    display: Display, likelihood: FrictionLikelihood, effort: Effort, seed: int, tell: ShareProgress
) -> _Finger:
    mixture = finger_mixture(display, predict(display))
    if not likelihood.observations:
        return _Finger(mixture, sobol_points(mixture, effort.joint_draws, seed))
    posterior = friction_posterior(
        mixture, likelihood, seed=seed, draws=effort.finger_draws, progress=tell
    )
    draws = posterior.resampled(effort.joint_draws, seed)
    return _Finger(mixture, draws.points, draws, effort.finger_draws)


@as_drawn()
def _joint(
    finger: _Finger, plate: PlateFit | None, count: int, seed: int, tell: ShareProgress
) -> Joint:
    """Draws of plate and finger at once, with what comes of them at the display's voltage."""
    random = np.random.default_rng(seed)
    p = finger.mixture.prediction
    volts = p.voltage
    felt = np.full((count, 2), np.nan)
    free = np.full(count, p.held_amplitude)
    modes: list[WorkingMode] = [p.mode] * count
    answers: Mapping[Asked, si.FloatArray] = {}
    if plate is not None:
        rows = random.integers(len(plate.posterior.scores), size=count)
        answers = {asked: draws[rows] for asked, draws in plate.predictive.items()}
        _, per_volt, quality = (answers[asked] for asked in WORKING)
        free = free if volts is None else per_volt * volts
        modes = [
            dataclasses.replace(p.mode, amplitude_per_volt=float(a), quality_factor=float(q))
            for a, q in zip(per_volt, quality, strict=True)
        ]
    for number, draw in enumerate(finger.mixture.draws(finger.points)):
        if number % _TOLD == 0:
            tell(f"friction with what was measured, draw {number + 1} of {count}", number / count)
        try:
            felt[number] = _felt(finger.mixture, draw, modes[number], float(free[number]))
        except SqueezefilmError:
            continue
    amplitude, friction = felt.T
    alone = friction
    if finger.draws is not None:
        where = (Touching(float(np.nanmedian(amplitude))),)
        friction = finger.draws.with_error(friction[:, None], where, seed)[:, 0]
    return Joint(
        finger.mixture.paths,
        normal_scores(finger.points),
        answers,
        free,
        amplitude,
        friction,
        friction - alone,
    )


def _felt(mixture: Mixture, draw: Draw, mode: WorkingMode, free: si.Metre) -> tuple[float, float]:
    """The amplitude (m) that a drawn finger leaves, and µ′/µ there."""
    law = mixture.law(draw)
    if mixture.prediction.voltage is None or mode.modal_mass is None:
        return free, float(between_limits(law, draw, np.array([free]))[0])
    felt = touch(mode, law, free, tolerance=1e-4)
    friction = between_limits(law, draw, np.array([felt.amplitude]))
    return felt.amplitude, float(friction[0])


def _calibration(
    described: Display,
    calibrated: Display,
    observations: tuple[Observation, ...],
    plate: PlateFit | None,
    finger: _Finger,
    before: FrictionInterval | None,
    joint: Joint,
    seed: int,
    tell: ShareProgress,
) -> Calibration:
    refused = float(np.mean(~np.isfinite(joint.friction)))
    after = _interval(joint.friction, joint.felt_amplitude, refused)
    misfits = [] if plate is None else [plate.posterior.misfit]
    misfits += [] if finger.posterior is None else [finger.posterior.misfit]
    errors: dict[str, float] = {}
    if plate is not None:
        pairs = zip(plate.problem.asked, plate.problem.emulator.errors.tolist(), strict=True)
        errors = {asked.said: error for asked, error in pairs}
    return Calibration(
        described=described,
        display=calibrated,
        observations=observations,
        values=_values(plate, finger, joint),
        identification=_identified(plate, finger),
        laws={} if finger.posterior is None else finger.posterior.shares(),
        misfits=tuple(misfits),
        before=before,
        after=after,
        next_measurements=()
        if after is None
        else _next(finger, joint, after.amplitude, observations, seed, tell),
        emulator_errors=errors,
        solves=0 if plate is None else plate.solves,
        seed=seed,
        doubts=_doubts(plate, finger, refused),
        joint=joint,
        compared=compared(observations, plate, finger.draws, finger.first_draws, seed),
    )


def _doubts(plate: PlateFit | None, finger: _Finger, refused: float) -> tuple[str, ...]:
    doubts = []
    if plate is not None and plate.posterior.effective < 200:
        doubts.append(
            f"The draws of the plate are worth {plate.posterior.effective:.0f} independent ones "
            "only; the ends of its intervals are rough."
        )
    if finger.posterior is not None and finger.posterior.effective < FEWEST:
        doubts.append(
            f"The draws of finger and laws are worth {finger.posterior.effective:.0f} independent "
            "ones only: the observations of friction are sharper than what was drawn. The ends of "
            "friction's interval are rough; draw more."
        )
    if refused > MOST_REFUSED:
        doubts.append(
            f"{si.percent(refused, 1)} of the draws have no friction at this voltage, so it is "
            "given no interval."
        )
    return tuple(doubts)


def _values(plate: PlateFit | None, finger: _Finger, joint: Joint) -> tuple[CalibratedValue, ...]:
    """Plate and finger before and after."""
    values = []
    if plate is not None:
        after = plate.problem.scores.values(plate.posterior.scores)
        for k, parameter in enumerate(plate.problem.scores.parameters):
            values.append(_value(parameter, after[:, k], plate.posterior.scores[:, k]))
    if finger.posterior is not None:
        for parameter, drawn, scores in _of_finger(finger, joint):
            values.append(_value(parameter, drawn, scores))
    return tuple(values)


def _of_finger(
    finger: _Finger, joint: Joint
) -> Iterator[tuple[Parameter, si.FloatArray, si.DimensionlessArray]]:
    """Each uncertain value of finger, surface and gas, with its draws in its unit and in scores."""
    from scipy.special import ndtr

    for item, scores in zip(finger.mixture.inputs, joint.finger.T, strict=True):
        if isinstance(item, Parameter):
            yield item, np.array(item.drawn(ndtr(scores))), scores


def _value(
    parameter: Parameter, after: si.FloatArray, scores: si.DimensionlessArray
) -> CalibratedValue:
    low, middle, high = (float(quantile) for quantile in np.quantile(after, _TAILS))
    ends = parameter.distribution.quantile(np.array([_TAILS[0], _TAILS[-1]]))
    return CalibratedValue(
        parameter.path,
        parameter.unit,
        (float(ends[0]), float(ends[1])),
        middle,
        float(np.std(after)),
        (low, high),
        min(float(np.std(scores)), 1.0),
    )


def _identified(plate: PlateFit | None, finger: _Finger) -> Identification:
    parts = []
    if plate is not None:
        parts.append(identification(plate.paths, plate.posterior.scores))
    if finger.posterior is not None:
        scores = normal_scores(finger.posterior.points)
        parts.append(
            identification(finger.mixture.paths, scores, finger.posterior.weights.sum(axis=1))
        )
    return Identification(
        tuple(known for part in parts for known in part.known),
        tuple(known for part in parts for known in part.combinations),
    )


def _next(
    finger: _Finger,
    joint: Joint,
    amplitude: si.Metre,
    observations: tuple[Observation, ...],
    seed: int,
    tell: ShareProgress,
) -> tuple[NextMeasurement, ...]:
    """Candidates that were not measured yet, ranked; of friction at an amplitude and at half of
    it."""
    done = {observation.answer for observation in observations}
    drawn = {
        asked.name: draws
        for asked, draws in joint.answers.items()
        if asked.name not in done or asked.name == MODE_FREQUENCY
    }
    drawn |= {parameter.path: values for parameter, values, _ in _of_finger(finger, joint)}
    options = candidates(drawn)
    # The error of the law at the first is that in the joint draws, by the seed.
    where = (Touching(amplitude), Touching(amplitude / 2))
    curves = friction_of_points(
        finger.mixture, finger.points, where, lambda _, share: tell("what to measure next", share)
    )
    if finger.draws is not None:
        curves = finger.draws.with_error(curves, where, seed)
    curves = np.where(np.isfinite(curves), curves, 1.0)
    options += [
        friction_candidate(curve, one.amplitude) for curve, one in zip(curves.T, where, strict=True)
    ]
    return ranked(joint.friction, options, seed=seed)
