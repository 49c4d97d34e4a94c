"""Sound at the ear of somebody at a display, beside the published guidance.

The level is that of the plate's face in a baffle, without a finger, in its loudest direction
(`physics.plate.sound`). It is uncertain by the amplitude's interval and by what the baffle stands
for; where a limit lies inside, it is open whether it is kept.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import DiscPlate
from squeezefilm.physics.plate.ring.body import ring_body
from squeezefilm.physics.plate.sound import (
    EAR_DISTANCE,
    ExposureGuidance,
    RadiatingSurface,
    exposure_guidance,
    loudest,
    ring_surface,
)
from squeezefilm.physics.uncertainty.uncertainty import UncertainFriction

MODEL_ERROR_dB: si.Dimensionless = 6.0
"""Error of the level either way, assumed: a wall or a table may double the pressure, and a thin
plate without a baffle, whose back moves against its front, may halve it."""
AUDIBLE: si.Hertz = 17.8e3
"""The lower edge of the one-third-octave band around 20 kHz: below it limits of noise hold."""


@dataclass(frozen=True)
class EarLimit:
    """A limit, and whether the level is below it, above it, or it is open."""

    guidance: ExposureGuidance
    standing: str


@dataclass(frozen=True)
class EarExposure:
    """The sound pressure level (dB re 20 µPa) at an ear at a distance (m) from the display.

    `level_dB` while it is driven, between `low_dB` and `high_dB`; `mean_dB` is the level of the
    mean square with the drive's `duty`. The lower end of the verdict has the duty in it and the
    upper has not, since the texts were not read that say which of the two a limit is of.
    """

    frequency: si.Hertz
    distance: si.Metre
    duty: si.Dimensionless
    level_dB: si.Dimensionless
    low_dB: si.Dimensionless
    high_dB: si.Dimensionless
    limits: tuple[EarLimit, ...]
    model: str = "face in a baffle, loudest direction, no finger, nothing absorbed"

    @property
    def mean_dB(self) -> si.Dimensionless:
        """Level of the mean square over the time with and without output."""
        return self.level_dB + 10 * math.log10(self.duty)

    @property
    def standing(self) -> str:
        """Standing by the limit for the public: "below", "above", "open", or "" where there is
        none."""
        return next(
            (limit.standing for limit in self.limits if limit.guidance.audience == "public"), ""
        )

    @property
    def sentence(self) -> str:
        """The level and what every limit says of it."""
        duty = (
            "driven all the time"
            if self.duty == 1
            else f"driven {self.duty:.0%} of the time, {self.mean_dB:.0f} dB in the mean square"
        )
        said = (
            f"At an ear {self.distance:g} m away the display makes {self.level_dB:.0f} dB "
            f"({self.low_dB:.0f} to {self.high_dB:.0f}) at {self.frequency / 1e3:.3g} kHz, {duty}."
        )
        if self.frequency < AUDIBLE:
            return f"{said} People hear this frequency: the limits are those of audible noise."
        if not self.limits:
            return f"{said} No guidance was found for this frequency."
        each = [
            f"{_STANDING[limit.standing]} {limit.guidance.level_dB:.0f} dB recommended for "
            f"{'the public' if limit.guidance.audience == 'public' else 'workers'} "
            f"({limit.guidance.name})"
            for limit in self.limits
        ]
        return (
            f"{said} That is {', and '.join(each)}. These limits were read as quotations only, and "
            "reviews call their basis thin."
        )

    @property
    def short(self) -> str:
        """The level beside the guidance for the public, in a few words; empty without one."""
        public = next((limit for limit in self.limits if limit.guidance.audience == "public"), None)
        if public is None or self.frequency < AUDIBLE:
            return ""
        return (
            f"At an ear {self.distance:g} m away it makes {self.level_dB:.0f} dB, "
            f"{_STANDING[public.standing]} {public.guidance.level_dB:.0f} dB recommended."
        )


_STANDING = {"below": "below the", "above": "above the", "open": "not surely below the"}


def ear_exposure(
    display: Display,
    prediction: Prediction,
    unsure: UncertainFriction | None = None,
) -> EarExposure | None:
    """Sound at an ear at `EAR_DISTANCE` from a display where a prediction was made.

    The duty is the drive's. None where the plate's shape is not known (an amplitude that was given,
    a plate taken as a beam) or nothing vibrates. Raises `InputError` for a distance within the
    display's extent.
    """
    p = prediction
    free = p.touch.free_amplitude
    surface = moving_surface(display, p) if p.voltage is not None and free > 0 else None
    if surface is None:
        return None
    level = loudest(surface, EAR_DISTANCE).level_dB
    low = high = 0.0
    if unsure is not None and unsure.amplitude_interval is not None and p.vibration_amplitude > 0:
        ends = np.maximum(unsure.amplitude_interval, 1e-3 * p.vibration_amplitude)
        low, high = (20 * math.log10(float(end) / p.vibration_amplitude) for end in ends)
    low, high = level + low - MODEL_ERROR_dB, level + high + MODEL_ERROR_dB
    duty = display.drive.duty
    guidances = [exposure_guidance(p.frequency, people) for people in ("public", "occupational")]
    limits = tuple(
        EarLimit(guidance, _standing(low + 10 * math.log10(duty), high, guidance.level_dB))
        for guidance in guidances
        if guidance is not None
    )
    return EarExposure(p.frequency, EAR_DISTANCE, duty, level, low, high, limits)


def _standing(low: float, high: float, limit: float) -> str:
    return "below" if high < limit else "above" if low > limit else "open"


def moving_surface(display: Display, prediction: Prediction) -> RadiatingSurface | None:
    """The touched face as it moves without a finger, at the prediction's voltage and frequency;
    None where its shape is not known."""
    p, mode, actuator = prediction, prediction.mode, display.actuator
    omega = 2 * np.pi * p.frequency
    free = p.touch.free_amplitude
    if mode.solid is not None:
        # The shape at resonance; off it as much as its lobe moves less.
        return mode.solid.radiating(free / mode.solid.amplitude_per_volt, p.frequency)
    if isinstance(actuator, DiscPlate):
        ring_mode = ring_body(actuator).mode()
        shape = ring_mode.surface_shape / np.max(np.abs(ring_mode.surface_shape))
        radius = np.linspace(ring_mode.surface_radius[0], ring_mode.surface_radius[-1], 81)
        line = np.interp(radius, ring_mode.surface_radius, shape)
        return ring_surface(radius, 1j * omega * free * line, ring_mode.harmonic, p.frequency)
    return None
