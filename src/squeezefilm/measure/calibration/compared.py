"""What was measured beside what the model alone says of it, before and after a calibration.

Without the discrepancy that a calibration samples: with it every answer that was observed comes out
near what was observed, and a model that is wrong would look right.
"""

from __future__ import annotations

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.calibration_record import ComparedAnswer
from squeezefilm.measure.calibration.friction_likelihood import touching
from squeezefilm.measure.calibration.friction_posterior import FrictionDraws
from squeezefilm.measure.calibration.plate_fit import PlateFit, prior_scores
from squeezefilm.measure.calibration.solved_answers import FRICTION, MODE_FREQUENCY, asked_by
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.physics.uncertainty.intervals import LEVEL

UNITS: dict[str, str] = {
    "resonance_frequency": "Hz",
    "parallel_resonance_frequency": "Hz",
    MODE_FREQUENCY: "Hz",
    "static_capacitance": "F",
    "amplitude_per_volt": "m/V",
    "half_wavelength": "m",
    "mass": "kg",
    "modal_mass": "kg",
}
"""The SI unit of each answer; the others have none."""
_PRIOR_DRAWS = 1024
_TAILS = ((1 - LEVEL) / 2, 0.5, (1 + LEVEL) / 2)
_DIGITS = 6


def compared(
    observations: tuple[Observation, ...],
    plate: PlateFit | None,
    friction: FrictionDraws | None,
    first_draws: int,
    seed: int,
) -> tuple[ComparedAnswer, ...]:
    """Every observation with the model's interval at `LEVEL` before and after, as shares of what
    was measured.

    Of µ′/µ the first `first_draws` of the posterior's draws are those of the priors.
    """
    intervals: dict[int, tuple[tuple[float, ...], tuple[float, ...]]] = {}
    if plate is not None:
        problem = plate.problem
        points = prior_scores(len(problem.scores.parameters), _PRIOR_DRAWS, seed)
        before, after = (
            np.exp(problem.answers(scores)) for scores in (points, plate.posterior.scores)
        )
        for one, column in zip(problem.observations, problem.columns, strict=True):
            intervals[id(one)] = _ends(before[:, column], one), _ends(after[:, column], one)
    if friction is not None:
        posterior = friction.posterior
        drawn = posterior.curves[:first_draws]
        for k, one in enumerate(posterior.likelihood.observations):
            intervals[id(one)] = _ends(drawn[:, k], one), _ends(friction.curves[:, k], one)
    return tuple(_compared(one, *intervals.get(id(one), ((), ()))) for one in observations)


def _ends(values: si.FloatArray, one: Observation) -> tuple[float, ...]:
    """Low end, median and high end over what was measured; none where most draws have no value."""
    known = values[np.isfinite(values)] / one.value
    if known.size < 0.5 * values.size:
        return ()
    return tuple(round(float(end), _DIGITS) for end in np.quantile(known, _TAILS))


def _compared(
    one: Observation, before: tuple[float, ...], after: tuple[float, ...]
) -> ComparedAnswer:
    of_friction = one.answer == FRICTION
    unit = UNITS.get(one.answer, "")
    measured = si.format_quantity(one.value, si.Unit(unit), 5) if unit else f"{one.value:.4g}"
    return ComparedAnswer(
        said=said_of(one),
        measured=measured,
        error=float(f"{one.standard_error / one.value:.3g}"),
        before=before,
        after=after,
        recording=one.recording,
        relative_friction=float(f"{one.value:.6g}") if of_friction else None,
        vibration_amplitude=(
            float(f"{one.conditions['vibration_amplitude']:.6g}") if of_friction else None
        ),
    )


def said_of(one: Observation) -> str:
    """An observation's answer in words, with the conditions that tell it from others."""
    return touching(one).said if one.answer == FRICTION else asked_by(one).said
