"""Amplitudes of sines in a signal, over whole periods of the first line."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.contact.sliding.skin_vibration import line_amplitudes

STEP = 1e-4
TIME = np.arange(700) * STEP


def test_sines_of_any_phase_are_found_beside_a_level_and_a_drift() -> None:
    signal = 3 + 20 * TIME + 0.5 * np.sin(100 * math.pi * TIME + 1) + np.cos(300 * math.pi * TIME)
    found = line_amplitudes(np.stack([signal, -2 * signal]), STEP, np.array([50.0, 150.0, 200.0]))
    assert found.shape == (2, 3)
    assert found[0] == pytest.approx([0.5, 1.0, 0.0], abs=1e-9)
    assert found[1] == pytest.approx(2 * found[0], abs=1e-9)


def test_what_is_not_asked_for_does_not_leak_over_whole_periods_of_the_first_line() -> None:
    # 0.07 s are 3.5 periods of 50 Hz: three are taken, and 100 Hz is then none of the lines'.
    signal = np.cos(100 * math.pi * TIME) + 5 * np.cos(200 * math.pi * TIME)
    found = line_amplitudes(signal, STEP, np.array([50.0, 150.0]))
    assert found == pytest.approx([1.0, 0.0], abs=0.02)


def test_less_than_a_period_is_refused() -> None:
    with pytest.raises(InputError, match=r"3\.5 periods|0\.7 periods"):
        line_amplitudes(np.zeros(700), STEP, np.array([10.0]))
    with pytest.raises(InputError, match="lines"):
        line_amplitudes(np.zeros(700), STEP, np.array([[50.0]]))
