"""Result of a calibration: parameters with their spreads, what is identified, friction's interval,
what to measure next, and measured values beside those of the model alone.

The latter without the discrepancy that a calibration samples: with it every answer that was
observed comes out near what was observed, and a model that is wrong would look right.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.calibration_record import ComparedAnswer
from squeezefilm.core.results import to_json, values_of
from squeezefilm.measure.calibration.discrepancy import Misfit, touching
from squeezefilm.measure.calibration.friction_posterior import FrictionDraws
from squeezefilm.measure.calibration.identified import Identification, NextMeasurement
from squeezefilm.measure.calibration.plate_fit import PlateFit, prior_scores
from squeezefilm.measure.calibration.solved_answers import FRICTION, MODE_FREQUENCY, Asked, asked_by
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.physics.display import Display
from squeezefilm.physics.uncertainty.intervals import LEVEL


@dataclass(frozen=True)
class CalibratedValue:
    """A parameter before and after: the prior's interval at `LEVEL`, the posterior's median,
    standard deviation and interval, all in `unit`; `left` is the share of the prior spread that is
    left."""

    path: str
    unit: si.Unit
    prior: tuple[float, float]
    median: float
    standard_deviation: float
    interval: tuple[float, float]
    left: si.Dimensionless


@dataclass(frozen=True)
class FrictionInterval:
    """µ′/µ at the display's own voltage, force and speed: median and interval at `LEVEL`.

    `amplitude` (m, median, with the finger on) is what it belongs to.
    """

    median: si.Dimensionless
    interval: tuple[si.Dimensionless, si.Dimensionless]
    amplitude: si.Metre

    @property
    def width(self) -> si.Dimensionless:
        """High less low."""
        return self.interval[1] - self.interval[0]


@dataclass(frozen=True, eq=False)
class Joint:
    """Draws of everything at once: in scores `finger` (draws, inputs of the mixture:
    `finger_paths`), the bench's own answers (SI; none without a plate's fit), and at the display's
    voltage the free amplitude, the one with the finger on and µ′/µ, of which `law_error` is what
    the laws themselves are taken to be off by, all (draws,)."""

    finger_paths: tuple[str, ...]
    finger: si.DimensionlessArray
    answers: Mapping[Asked, si.FloatArray]
    amplitude: si.MetreArray
    felt_amplitude: si.MetreArray
    friction: si.DimensionlessArray
    law_error: si.DimensionlessArray


@dataclass(frozen=True, eq=False)
class Calibration:
    """A display after measurements: `display` has the posterior's means in place of its values.

    `values` are the parameters of plate, finger and surface; `identification` says which of them
    the data told; `laws` are the weights of each choice of a law after the data (before:
    `physics.uncertainty.model_choices`). `misfits` judge the plate's and the friction's
    observations. `before` and `after` are friction's interval without and with what was measured;
    `next_measurements` the candidates, most telling first. `emulator_errors` are the emulator's own
    (relative, by answer), of `solves` plates. `doubts` are sentences that a reader must see.
    `compared` has every observation beside the model alone.
    """

    described: Display
    display: Display
    observations: tuple[Observation, ...]
    values: tuple[CalibratedValue, ...]
    identification: Identification
    laws: dict[str, dict[str, float]]
    misfits: tuple[Misfit, ...]
    before: FrictionInterval | None
    after: FrictionInterval | None
    next_measurements: tuple[NextMeasurement, ...]
    emulator_errors: dict[str, si.Dimensionless]
    solves: int
    seed: int
    doubts: tuple[str, ...]
    joint: Joint
    compared: tuple[ComparedAnswer, ...] = ()

    @property
    def fits(self) -> bool:
        """True where the model explains all that was observed."""
        return all(misfit.judgement == "fits" for misfit in self.misfits)

    @property
    def sentences(self) -> tuple[str, ...]:
        """Sentences on what came out, doubts first."""
        said = [*self.doubts, *(misfit.sentence for misfit in self.misfits)]
        if self.after is not None:
            low, high = self.after.interval
            words = f"µ′/µ = {self.after.median:.2f} ({low:.2f}–{high:.2f})"
            if self.before is not None:
                was = self.before.interval
                left = si.percent(self.after.width / self.before.width)
                words += (
                    f"; without what was measured {self.before.median:.2f} "
                    f"({was[0]:.2f}–{was[1]:.2f}): {left} of that interval is left"
                )
            said.append(f"{words}.")
        said += self.identification.sentences
        if self.next_measurements:
            said.append(f"Next: {self.next_measurements[0].sentence}.")
        return tuple(said)

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values."""
        return {
            "display": self.display.name,
            **values_of(
                self,
                "observations identification.combinations laws compared fits misfits solves seed",
            ),
            "parameters": [
                {
                    **values_of(value, "path median standard_deviation interval"),
                    "unit": value.unit.symbol,
                    "prior_interval": list(value.prior),
                    "share_of_prior_spread_left": value.left,
                }
                for value in self.values
            ],
            "relative_friction_before": to_json(self.before),
            "relative_friction": to_json(self.after),
            "interval_level": LEVEL,
            "measure_next": to_json(self.next_measurements),
            "emulator_relative_errors": to_json(self.emulator_errors),
            "said": list(self.sentences),
        }


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
