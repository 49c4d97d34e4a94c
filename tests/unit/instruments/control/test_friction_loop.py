"""The friction loop on a plate of first order and a finger that is not the table's."""

import math

import numpy as np
import pytest
from tests.friction_loop import (
    CORRECTION_HELD,
    OUT_OF_REACH,
    FrictionGains,
    FrictionState,
    friction_gains,
    friction_step,
)

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.core.errors import InputError, OutOfRangeError

STEP, EVERY, LAG, BANDWIDTH = 2e-4, 5, 1.5e-3, 30.0
"""5 kHz, a sensor at 1 kHz, a plate of 1.5 ms."""
VOLTAGE = np.linspace(0, 100, 201)
FRICTION = 0.6 * np.exp(-VOLTAGE / 50)  # N over V: an exponential, as curves at 10 mm/s are
GAINS, LEVELS = friction_gains(VOLTAGE, FRICTION, BANDWIDTH, LAG, STEP, EVERY * STEP, 0.15)


@compiled()
def held(
    gains: FrictionGains, levels: si.Array, wanted: si.Array, finger: si.Array, sign: float
) -> si.Array:
    """Friction (N) and flags at each step; the true friction is the table's times `finger`."""
    out = np.zeros((wanted.size, 2))
    state, measured, voltage = FrictionState(0, 0, 0), 0, 0.0
    kept = math.exp(-STEP / LAG)
    for n in range(wanted.size):
        force = 0.6 * math.exp(-voltage / 50.0) * finger[n]
        fresh = n % EVERY == 0
        if fresh:
            measured = round(sign * force * 1e6)
        state, command = friction_step(
            gains, levels, state, round(wanted[n] * 1e6), measured, fresh
        )
        voltage = command.level * 1e-6 + (voltage - command.level * 1e-6) * kept
        out[n, 0], out[n, 1] = force, command.flags
    return out


T = STEP * np.arange(20_000)


def run(
    wanted: si.FloatArray | float, finger: si.FloatArray | float = 1.0, sign: float = 1.0
) -> si.FloatArray:
    return held(GAINS, LEVELS, 0 * T + wanted, 0 * T + finger, sign)


def share(answer: si.FloatArray, cause: si.FloatArray, frequency: float) -> complex:
    last = slice(-10_000, None)
    wave = np.exp(-2j * math.pi * frequency * T[last])
    return complex((answer[last] @ wave) / (cause[last] @ wave))


def test_another_finger_gets_the_wanted_friction() -> None:
    for finger in (0.8, 1.0, 1.2):
        rows = run(0.3, finger)
        assert rows[-1, 0] == pytest.approx(0.3, rel=1e-3)
        assert np.all(rows[5000:, 1] == 0)
    without = 0.6 * 1.2 * math.exp(-np.interp(0.3, FRICTION[::-1], VOLTAGE[::-1]) / 50)
    assert without == pytest.approx(0.36, rel=1e-2)


@pytest.mark.parametrize("frequency", [2.0, 5.0, 10.0])
def test_a_changing_finger_is_left_as_the_closed_form_says(frequency: float) -> None:
    """s/(s + ω) of it, the sensor's hold and the steps' delay on top (a tenth)."""
    wave = 0.05 * np.sin(2 * math.pi * frequency * T)
    rows = run(0.3, 1 + wave)
    left = share(rows[:, 0] - 0.3, 0.3 * wave, frequency)
    s, pace = 2j * math.pi * frequency, 2 * math.pi * BANDWIDTH
    assert abs(left) == pytest.approx(abs(s / (s + pace)), rel=0.12)


@pytest.mark.parametrize("frequency", [10.0, 50.0])
def test_the_wanted_friction_is_followed_with_the_plate_alone(frequency: float) -> None:
    wave = 0.02 * np.sin(2 * math.pi * frequency * T)
    rows = run(0.3 + wave, 1.1)
    answer = share(rows[:, 0] - 0.3, wave, frequency)
    s = 2j * math.pi * frequency
    assert abs(answer) == pytest.approx(abs(1 / (LAG * s + 1)), rel=0.1)


def test_no_limit_cycle_with_a_tenth_of_error_or_more() -> None:
    for finger in (0.7, 1.0, 1.3):
        assert np.ptp(run(0.3, finger)[-5000:, 0]) < 2e-4 * 0.3


def test_what_is_out_of_reach_and_what_contradicts_is_flagged() -> None:
    # Half the limit is not yet a contradiction.
    assert np.all(run(0.3, 1.3)[5000:, 1] == 0)
    turned = run(0.3, 1.0, -1.0)[:, 1].astype(int)
    assert np.any(turned & CORRECTION_HELD)
    assert np.all(run(0.05)[-5000:, 1] == OUT_OF_REACH)
    back = run(np.where(T < 2, 0.05, 0.3))
    soon = (T > 2.1) & (T < 4)
    assert back[soon, 0] == pytest.approx(0.3, rel=0.02)


def test_a_table_that_cannot_be_turned_around_is_refused() -> None:
    with pytest.raises(InputError, match="turned around"):
        friction_gains(VOLTAGE, FRICTION[::-1], BANDWIDTH, LAG, STEP, 1e-3, 0.3)
    with pytest.raises(InputError, match="shape"):
        friction_gains(VOLTAGE, FRICTION[:-1], BANDWIDTH, LAG, STEP, 1e-3, 0.3)
    with pytest.raises(OutOfRangeError, match="too fast for a sensor"):
        friction_gains(VOLTAGE, FRICTION, 200.0, LAG, STEP, 1e-3, 0.3)
