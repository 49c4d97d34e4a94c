"""Published thresholds of friction modulation beside rival senses.

At one speed a spatial period and a frequency are the same variable: senses that go by frequency
("temporal"), by period ("spatial") or half by either ("mixed": by the root of their product) have
the same thresholds there, and part at any other speed. The skin goes by the frequency with all of
them. What the stretch of sliding skin masks was fitted to the medians (`tools/threshold_fit.py`).
The mean friction is not published: assumed. Nothing is known of how people differ.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.results import to_json
from squeezefilm.measure.recordings.kinds import DetectionThresholds, Told
from squeezefilm.physics.contact.finger.fingerpad import FingerpadDynamics
from squeezefilm.physics.perception.felt import Rubbed, grating_evidence
from squeezefilm.physics.perception.observer import Observer, load_observer

Rival = Literal["temporal", "mixed", "spatial"]
RIVALS: Mapping[Rival, si.Dimensionless] = {"temporal": 1.0, "mixed": 0.5, "spatial": 0.0}
"""Rival senses by the speed's exponent in their channels; at `TUNED_AT` all are alike."""
MEAN_FRICTION: si.Dimensionless = 0.5
"""Mean friction coefficient of the stimuli: assumed."""
METHOD_RATIO: si.Dimensionless = 1.45
"""What two intervals, three down and one up, the mean of the last six trials and the larger of two
directions give, over the amplitude with d′ = 1: simulated by `tools/threshold_fit.py`, 1.4 to 1.6
by what of the method is not published."""
_SAMPLES = 256


@dataclass(frozen=True, eq=False)
class DetectionComparison:
    """Measured medians beside what each rival gives by the published method: `rivals` has their
    names and amplitudes of the friction coefficient (1), of the shape of the measured ones."""

    measured: DetectionThresholds
    rivals: tuple[tuple[Rival, si.DimensionlessArray], ...]

    @property
    def told(self) -> Told:
        """Who measured, when and how."""
        return self.measured.told

    def summary(self) -> dict[str, Any]:
        """What ``--json`` prints; keys carry units."""
        return {
            "recording": to_json(self.told),
            "people": self.measured.people,
            "finger_speed_m_per_s": self.measured.speed,
            "mean_friction_assumed": MEAN_FRICTION,
            "spatial_period_m": self.measured.period.tolist(),
            "measured_friction_coefficient": self.measured.amplitude.tolist(),
            "rivals_friction_coefficient": {name: x.tolist() for name, x in self.rivals},
        }


def rival_observer(observer: Observer, rival: Rival) -> Observer:
    """The observer whose channels go by what a rival says. Raises `InputError` for another."""
    si.require_one_of("rival", rival, tuple(RIVALS))
    channels = tuple(
        dataclasses.replace(channel, speed_exponent=RIVALS[rival]) for channel in observer.channels
    )
    return dataclasses.replace(observer, name=f"{observer.name}, {rival}", channels=channels)


@si.checked_numbers
def detection_threshold(
    observer: Observer,
    period: Annotated[si.MetreArray, si.Above(0.0)],
    speed: Annotated[si.MetrePerSecond, si.Above(0.0)],
    normal_force: Annotated[si.Newton, si.Above(0.0), si.AtMost(2.0)],
    friction_coefficient: Annotated[si.Dimensionless, si.Above(0.0)] = MEAN_FRICTION,
) -> si.DimensionlessArray:
    """The amplitude (zero-to-peak) of the friction coefficient (1) about its mean that has d′ = 1,
    of sines of periods (m), shape (n,), under the published pad that slides at a speed (m/s) and a
    force (N). Raises `InputError` for a value out of range. Source: `physics.perception.felt`."""
    pad = FingerpadDynamics.pressed(normal_force)
    rubbed = Rubbed(friction_coefficient * normal_force, pad, speed)
    wave = np.sin(2 * math.pi * np.arange(_SAMPLES) / _SAMPLES) * np.ones((period.size, 1))
    small = 1e-3
    # d′ is in proportion to the amplitude.
    d_prime = grating_evidence(observer, period, wave, lambda share: 1 + small * share, rubbed)
    return np.asarray(small * friction_coefficient / d_prime)


def detection_medians(
    observer: Observer,
    measured: DetectionThresholds,
    *,
    speed: si.MetrePerSecond | None = None,
    period: si.MetreArray | None = None,
) -> si.DimensionlessArray:
    """What the published method would give of this observer (1), shape (periods,): where thresholds
    were measured, or at another speed (m/s) and other periods (m)."""
    return METHOD_RATIO * detection_threshold(
        observer,
        measured.period if period is None else period,
        measured.speed if speed is None else speed,
        measured.normal_force,
    )


def compare_detection(measured: DetectionThresholds) -> DetectionComparison:
    """Measured medians beside the rivals of the preset observer."""
    observer = load_observer()
    made = [detection_medians(rival_observer(observer, rival), measured) for rival in RIVALS]
    return DetectionComparison(measured, tuple(zip(RIVALS, made, strict=True)))
