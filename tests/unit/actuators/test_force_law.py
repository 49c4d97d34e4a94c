"""The force law: a table turned around, its error observed, a voltage that is cut once."""

from dataclasses import replace

import numpy as np
import pytest

from squeezefilm.actuators.motor.force_law import (
    ForceLaw,
    ForceState,
    amplitude_for_force,
    force_step,
)
from squeezefilm.core.errors import InputError

SPEED, AMPLITUDE = np.array([0.0, 0.1]), np.array([0.0, 1e-6, 2e-6])
THRUST = np.array([[-1.0, 2.0, 3.0], [-2.0, 1.0, 2.0]])
LAW = ForceLaw(SPEED, AMPLITUDE, THRUST, 1e7, 5e-4, 5e-4, 4e-3, 5e-4, 30.0)


@pytest.mark.parametrize(("force", "speed"), [(0.5, 0.0), (1.5, 0.1), (2.5, 0.05)])
def test_the_table_is_turned_around(force: float, speed: float) -> None:
    amplitude = amplitude_for_force(LAW, force, speed)
    row = THRUST[0] + (THRUST[1] - THRUST[0]) * speed / 0.1
    assert np.interp(amplitude, AMPLITUDE, row) == pytest.approx(min(force, row[-1]))


def steady(factor: float, gain: float, wanted: float) -> tuple[ForceState, float]:
    """A plant with another friction and gain than the law's: its end, and its force."""
    state, force, amplitude = ForceState(), -factor, 0.0
    kept = np.exp(-LAW.interval / LAW.time_constant)
    for _ in range(400):
        state = force_step(LAW, state, wanted, force, amplitude, 0.0)
        amplitude = kept * amplitude + (1 - kept) * gain * state.voltage / LAW.volts_per_metre
        force = factor * float(np.interp(amplitude, AMPLITUDE, THRUST[0]))
    return state, force


@pytest.mark.parametrize("factor", [0.8, 1.0, 1.2])
@pytest.mark.parametrize("gain", [0.8, 1.0])
def test_what_the_law_does_not_know_leaves_no_error(factor: float, gain: float) -> None:
    state, force = steady(factor, gain, 1.5)
    assert force == pytest.approx(1.5, rel=1e-6)
    assert state.cut == 0


def test_what_is_out_of_reach_is_cut_counted_and_forgotten() -> None:
    weak = replace(LAW, highest_voltage=5.0)
    state = force_step(weak, ForceState(), 3.0, 0.0, 0.0, 0.0)
    assert state.voltage == 5.0
    assert state.cut == 1
    state = force_step(weak, state, -1.0, 0.0, 1e-6, 0.0)
    assert state.voltage == 0.0


def test_a_table_that_cannot_be_turned_around_is_refused() -> None:
    with pytest.raises(InputError, match="leave out amplitudes at which it no longer grows"):
        replace(LAW, thrust=THRUST[:, ::-1].copy())
    with pytest.raises(InputError, match=r"shape \(2, 3\); it needs a row for each of 2 speeds"):
        replace(LAW, amplitude=np.array([0.0, 1e-6]))
