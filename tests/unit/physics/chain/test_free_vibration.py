"""The vibration without a finger: by voltage, given, and beside the resonance."""

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.chain.touch import amplitude_per_volt, free_vibration
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.working_mode import working_mode

PLATE = load_display("biet2008-plate")
MODE = working_mode(PLATE.actuator, "timoshenko")


def test_the_amplitude_is_in_proportion_to_the_voltage() -> None:
    own = free_vibration(PLATE, MODE, None, None, None)
    assert own.voltage == PLATE.drive.voltage
    assert own.frequency == MODE.resonance_frequency
    assert own.amplitude == pytest.approx(PLATE.drive.voltage * MODE.amplitude_per_volt)
    assert free_vibration(PLATE, MODE, None, 3.0, None).amplitude == pytest.approx(
        own.amplitude * 3.0 / PLATE.drive.voltage
    )


def test_beside_the_resonance_the_response_is_asked() -> None:
    frequency = 1.01 * MODE.resonance_frequency
    wanted = MODE.response(np.array([frequency]))[0]
    assert amplitude_per_volt(MODE, frequency) == wanted < MODE.amplitude_per_volt


def test_a_given_amplitude_has_no_voltage() -> None:
    given = free_vibration(PLATE, MODE, None, None, 2e-6)
    assert (given.voltage, given.amplitude, given.source) == (None, 2e-6, "given")
    with pytest.raises(InputError, match="vibration_amplitude"):
        free_vibration(PLATE, MODE, None, None, -1e-6)
