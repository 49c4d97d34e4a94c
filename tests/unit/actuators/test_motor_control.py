"""The force law that inverts a motor, in time."""

import numpy as np
import pytest
from tests.unit.actuators.test_motor import motor

from squeezefilm.actuators.motor.closed_loop import inverted_law, track_force
from squeezefilm.core.errors import InputError

SPEED = 0.01


def tracked(friction: float, steps: int = 60) -> tuple[float, float, float, float]:
    """A step of the force with another µ than the law's: largest error from 3 ms on, mean errors at
    both ends, largest overshoot, all over the wanted force."""
    amplitudes = np.linspace(0.2e-6, 1.5e-6, 14)
    law = inverted_law(motor(), np.array([SPEED]), amplitudes)
    low, high = 0.3 * law.thrust[0, -1], 0.7 * law.thrust[0, -1]
    wanted = np.concatenate([np.full(steps, low), np.full(steps, high)])
    found = track_force(motor(friction=friction), law, wanted, SPEED)
    assert found.cut == 0
    begun = found.time[steps - 1]
    after = found.force[steps:] / high - 1
    late = found.time[steps:] - begun > 3e-3
    last = float(np.mean(found.force[-10:])) / high - 1
    first = float(np.mean(found.force[steps - 10 : steps])) / low - 1
    return float(np.max(np.abs(after[late]))), first, last, float(np.max(after))


@pytest.mark.parametrize(
    "friction",
    [
        pytest.param(0.24, marks=pytest.mark.slow),
        *(pytest.param(friction, marks=pytest.mark.nightly) for friction in (0.3, 0.36)),
    ],
)
def test_a_step_of_force_is_tracked_whatever_the_friction(friction: float) -> None:
    largest, first, last, overshoot = tracked(friction)
    assert largest < 0.05
    assert abs(first) < 0.02
    assert abs(last) < 0.02
    assert overshoot < 0.05


def test_at_rest_no_amplitude_can_be_found_for_a_force() -> None:
    with pytest.raises(InputError, match="at rest a slider that the feet leave is pushed"):
        inverted_law(motor(), np.array([0.0]), np.linspace(0.8e-6, 1.5e-6, 5))
