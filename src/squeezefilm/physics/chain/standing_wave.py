"""The working mode under a finger: its resonance then, and what the pad meets along the wave."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.chain.pad_law import DEFAULT_MODEL
from squeezefilm.physics.chain.played_texture import FingerMotion
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.contact.sliding.march import SpeedFriction
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import DiscPlate
from squeezefilm.physics.render.program.inverse import (
    FrictionInverse,
    FrictionTable,
    WaveCompensation,
)
from squeezefilm.physics.render.texture.pattern import AlongX, AlongY

Wave = Literal["ignored", "felt", "compensated"]
WAVES: tuple[Wave, ...] = get_args(Wave)
"""Treatment of the standing wave's nodes: left out, felt, or felt and made up for."""

# Of a stroke's steps and its speeds, 160 MB.
_MOST_FRICTIONS = 20_000_000
# How much more amplitude a pad may seem to meet off an antinode than on it.
_BETTER = 1.5


def resonance_with_finger(p: Prediction) -> tuple[si.Dimensionless, si.Hertz]:
    """Quality factor and resonance (Hz) with the finger on the mode, where that is known."""
    mode = p.touch.mode or p.mode
    return mode.quality_factor, mode.resonance_frequency


def wave_factors(display: Display, p: Prediction) -> WaveCompensation:
    """The amplitude that the pad meets along the wave, over that at the best place.

    It explains the friction along the wave under a finger at the prediction's speed, and is taken
    to be the same at others: what changes with the speed is how friction follows the amplitude.
    By the default model where the prediction's own knows the finger over an antinode only. Raises
    `InputError` for a disc, whose wave is none along a line.
    """
    plate = display.actuator
    if isinstance(plate, DiscPlate):
        raise InputError(
            "the wave of a disc is no standing wave along a line; leave wave out for a disc"
        )
    along = AlongY() if plate.lines_across == "width" else AlongX()
    half, law = p.mode.half_wavelength, p.law
    if not law.kind.shares_load:
        law = law.by(DEFAULT_MODEL)
    ripple = law.ripple(p.vibration_amplitude)
    # Off the antinode friction may be less than the display makes centred on it.
    wide = _BETTER * p.vibration_amplitude
    inverse = FrictionInverse.from_function(law.table(wide), wide)
    reached = np.clip(ripple.relative_friction, inverse.least_friction, 1.0)
    return WaveCompensation.from_ripple(ripple.position, reached, inverse, half, along=along)


def factor_of_law(p: Prediction, factors: WaveCompensation) -> si.Dimensionless:
    """The factor of `wave_factors` where the prediction's law has its pad: at the best place, or
    over an antinode of an even wave."""
    return 1.0 if p.law.place is not None else float(factors.factor(0.0))


@dataclass(frozen=True)
class UnderPad:
    """The friction that a pad meets at an amplitude, with or without the wave's nodes.

    `friction` is the display's law; `factors` are the amplitude that the pad meets over that at
    the best place, and `of_law` is theirs where the law has its pad.
    """

    wave: Wave
    friction: FrictionTable
    felt: FrictionTable
    inverse: FrictionInverse
    factors: WaveCompensation | None
    of_law: float

    @classmethod
    def of(cls, display: Display, p: Prediction, wave: Wave) -> UnderPad:
        """Wave under the pad on a display."""
        friction, inverse, largest = p.friction, p.inverse, p.vibration_amplitude
        if wave == "ignored":
            return cls(wave, friction, friction, inverse, None, 1.0)
        factors = wave_factors(display, p)
        of_law = factor_of_law(p, factors)
        felt = p.law.table(largest / of_law)
        if wave == "compensated":
            inverse = felt.inverse(p.law.over_speeds, largest, of_law)
        return cls(wave, friction, felt, inverse, factors, of_law)

    @property
    def compensation(self) -> WaveCompensation | None:
        """Compensation by which the renderer drives harder, None where it does not."""
        return self.factors if self.wave == "compensated" else None

    def reached(
        self, amplitude: si.MetreArray, speed: si.MetrePerSecondArray
    ) -> si.DimensionlessArray:
        """Relative friction (1) where the renderer asks for amplitudes (m), under a finger at
        speeds (m/s)."""
        if self.wave == "compensated":
            return self.felt(amplitude / self.of_law, speed)
        return self.friction(amplitude, speed)

    def of_the_skin(
        self, amplitude: si.MetreArray, friction_coefficient: si.Dimensionless
    ) -> SpeedFriction | si.DimensionlessArray:
        """Friction at amplitudes that the pad meets along a way (m) by the skin's own speed, which
        is not the finger's where the skin yields; `friction_coefficient` is that at rest.

        A stroke of hundreds of thousands of steps takes fewer of the table's speeds.
        """
        table = self.felt
        if table.speed.size == 1:
            return np.asarray(friction_coefficient * table(amplitude))
        count = min(max(int(_MOST_FRICTIONS / amplitude.size), 5), table.speed.size)
        taken = np.unique(np.linspace(0, table.speed.size - 1, count).round().astype(int))
        rows = np.empty((amplitude.size, taken.size))
        for column, at in zip(rows.T, taken, strict=True):
            relative = np.interp(amplitude, table.amplitude, table.relative_friction[at])
            column[:] = friction_coefficient * relative
        return SpeedFriction(table.speed[taken], rows)

    def factor(self, finger: FingerMotion) -> si.DimensionlessArray:
        """The amplitude along the way over that where the display's law has its pad (1)."""
        if self.factors is None:
            return np.ones(finger.time.size)
        return self.factors.factor(finger.x, finger.y) / self.of_law


# A study plays many textures under one finger of one display, and all need the same.
@functools.lru_cache(maxsize=8)
def at_largest_amplitude(display: Display, wave: Wave, **point: Any) -> tuple[Prediction, UnderPad]:
    """Prediction of a display at its largest amplitude, at a working `point` as of `predict`, and
    what the pad meets of it. Raises `InputError` where it changes no friction."""
    p = predict(display, **point)
    if p.vibration_amplitude <= 0.0 or p.relative_friction >= 1.0:
        raise InputError(
            f"display '{display.name}' changes no friction at {p.voltage or 0.0:g} V, so "
            "it renders no texture; give it a voltage"
        )
    return p, UnderPad.of(display, p, wave)
