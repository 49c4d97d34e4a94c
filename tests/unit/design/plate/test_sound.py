"""The sound of a plate that moves as a test says."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.design.plate.solved import plate_sound
from squeezefilm.physics.plate.sound import DISTANCES, rectangular_surface, sound_field

PLATE = SimpleNamespace(length=60e-3, width=30e-3)


def moved(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Two shapes per volt, one for each of two frequencies."""
    wave = np.outer(np.cos(4 * np.pi * x / PLATE.length), 1 + 0 * y)
    return np.stack([1e-9 * wave, -20e-9j * wave])


RESPONSE: Any = SimpleNamespace(plate=PLATE, displacement=moved)


@pytest.mark.slow
def test_the_face_sounds_as_it_moves_at_the_frequency_asked_for() -> None:
    found = plate_sound(RESPONSE, 1, 30e3, 15.0)
    assert found.distances == DISTANCES
    x, y = np.linspace(0, 60e-3, 71), np.linspace(0, 30e-3, 36)
    fine = rectangular_surface(x, y, 2j * np.pi * 30e3 * 15 * moved(x, y)[1], 30e3)
    # What the coarser grid costs; twice the voltage is 6 dB, whatever the grid.
    expected = sound_field(fine).sound_pressure_level_dB
    assert found.sound_pressure_level_dB == pytest.approx(expected, abs=0.1)
    (level,) = plate_sound(RESPONSE, 1, 30e3, 30.0, (0.5,)).sound_pressure_level_dB
    assert level == pytest.approx(found.sound_pressure_level_dB[1] + 20 * np.log10(2), abs=1e-6)
    (quiet,) = plate_sound(RESPONSE, 0, 30e3, 15.0, (0.5,)).sound_pressure_level_dB
    assert quiet == pytest.approx(found.sound_pressure_level_dB[1] - 20 * np.log10(20), abs=1e-6)
