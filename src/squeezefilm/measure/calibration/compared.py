"""Measured values beside those of the model alone, before and after a calibration.

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
        for seen, column in zip(problem.observations, problem.columns, strict=True):
            intervals[id(seen)] = _ends(before[:, column], seen), _ends(after[:, column], seen)
    if friction is not None:
        posterior = friction.posterior
        drawn = posterior.curves[:first_draws]
        for k, seen in enumerate(posterior.likelihood.observations):
            intervals[id(seen)] = _ends(drawn[:, k], seen), _ends(friction.curves[:, k], seen)
    return tuple(_compared(seen, *intervals.get(id(seen), ((), ()))) for seen in observations)


def _ends(values: si.FloatArray, seen: Observation) -> tuple[float, ...]:
    """Low end, median and high end over what was measured; none where most draws have no value."""
    known = values[np.isfinite(values)] / seen.value
    if known.size < 0.5 * values.size:
        return ()
    return tuple(round(float(end), _DIGITS) for end in np.quantile(known, _TAILS))


def _compared(
    seen: Observation, before: tuple[float, ...], after: tuple[float, ...]
) -> ComparedAnswer:
    of_friction = seen.answer == FRICTION
    unit = UNITS.get(seen.answer, "")
    measured = si.format_quantity(seen.value, si.Unit(unit), 5) if unit else f"{seen.value:.4g}"
    return ComparedAnswer(
        said=said_of(seen),
        measured=measured,
        error=float(f"{seen.standard_error / seen.value:.3g}"),
        before=before,
        after=after,
        recording=seen.recording,
        relative_friction=float(f"{seen.value:.6g}") if of_friction else None,
        vibration_amplitude=(
            float(f"{seen.conditions['vibration_amplitude']:.6g}") if of_friction else None
        ),
    )


def said_of(seen: Observation) -> str:
    """An observation's answer in words, with the conditions that tell it from others."""
    return touching(seen).said if seen.answer == FRICTION else asked_by(seen).said
