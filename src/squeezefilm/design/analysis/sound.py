"""The airborne sound of a solved plate as it is driven."""

from __future__ import annotations

import math

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.solid.response import HarmonicResponse
from squeezefilm.physics.plate.sound import DISTANCES, SoundField, rectangular_surface, sound_field

# Points to a wave in air, and at the least along a side: halved, levels change by 0.1 dB.
_POINTS_OF_A_WAVE, _LEAST_POINTS = 6, 31
_SOUND_SPEED: si.MetrePerSecond = 343.2


def plate_sound(
    response: HarmonicResponse,
    at: int,
    frequency: si.Hertz,
    voltage: si.Volt,
    distances: tuple[si.Metre, ...] = DISTANCES,
) -> SoundField:
    """The sound of a plate's face alone, in a baffle, at a voltage (V, zero-to-peak).

    The face moves as at the solved frequency of number `at`, with the `frequency` (Hz) of the
    drive. No finger is on it. Range, model and errors are those of
    `physics.plate.sound.sound_field`.
    """
    plate, wave = response.plate, _SOUND_SPEED / frequency
    x, y = (
        np.linspace(0, side, max(_LEAST_POINTS, math.ceil(_POINTS_OF_A_WAVE * side / wave) + 1))
        for side in (plate.length, plate.width)
    )
    w = voltage * response.displacement(x, y)[at]
    surface = rectangular_surface(x, y, 2j * np.pi * frequency * w, frequency)
    return sound_field(surface, distances)
