"""What is left of a square grating's swing, against a cycle that is walked through."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.verification.square_swing import Way, fastest_compensated_speed, square_swing_compensated

from squeezefilm.physics.render.resonator.envelope import DrivenEnvelope

TOP = 3e-6
BRAKED, COASTING = (DrivenEnvelope(2e-3, 5e-3, TOP, braking) for braking in (True, False))
LOW, HIGH = 0.4e-6, 1.9e-6


def walked(half: float, bottom: float, way: Way) -> float:
    """The share of the swing after many cycles, each half a stretch of exponential."""
    top, bottom = (HIGH, LOW) if way == "none" else (TOP, bottom)
    a = LOW
    for _ in range(4000):
        peak = min(HIGH, top - (top - a) * math.exp(-half / 2e-3))
        a = max(LOW, bottom + (peak - bottom) * math.exp(-half / 5e-3))
    return (peak - a) / (HIGH - LOW)


@pytest.mark.parametrize("way", ["none", "inverse"])
def test_the_swing_is_that_of_the_cycle_that_repeats(way: Way) -> None:
    halves = np.array([0.01e-3, 0.2e-3, 0.7e-3, 1.5e-3, 4e-3, 50e-3])
    for envelope, bottom in ((BRAKED, -TOP), (COASTING, 0.0)):
        found = square_swing_compensated(2e-3, 1e-3 / halves, envelope, LOW, HIGH, way)
        assert found == pytest.approx([walked(h, bottom, way) for h in halves], rel=1e-9)


@pytest.mark.parametrize("way", ["none", "inverse"])
@pytest.mark.parametrize("kept", [0.3, 0.9, 0.999])
def test_the_fastest_speed_keeps_what_was_asked(way: Way, kept: float) -> None:
    speed = fastest_compensated_speed(2e-3, BRAKED, LOW, HIGH, way, kept)
    assert square_swing_compensated(2e-3, speed, BRAKED, LOW, HIGH, way) == pytest.approx(
        kept, rel=1e-9
    )
    assert fastest_compensated_speed(6e-3, BRAKED, LOW, HIGH, way, kept) == pytest.approx(3 * speed)
