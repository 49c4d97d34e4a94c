"""What is left of a square grating's swing, against a cycle that is walked through."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import pytest

from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.physics.render.resonator.compensation import (
    DrivenEnvelope,
    fastest_compensated_speed,
    square_swing_compensated,
)

TOP = 3e-6
BRAKED, COASTING = (DrivenEnvelope(2e-3, 5e-3, TOP, braking) for braking in (True, False))
LOW, HIGH = 0.4e-6, 1.9e-6
Way = Literal["none", "inverse"]


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
    assert isinstance(square_swing_compensated(2e-3, 0.1, BRAKED, LOW, HIGH, way), float)


def test_ends_that_cannot_be_are_refused() -> None:
    for low, high in ((-1e-9, HIGH), (HIGH, HIGH), (LOW, 1.01 * TOP)):
        with pytest.raises(InputError, match=r"low|high"):
            square_swing_compensated(2e-3, 0.1, BRAKED, low, high)
    for period, speed in ((0.0, 0.1), (2e-3, 0.0)):
        with pytest.raises(InputError, match=r"spatial_period|speed"):
            square_swing_compensated(period, speed, BRAKED, LOW, HIGH)


@pytest.mark.parametrize("way", ["none", "inverse"])
@pytest.mark.parametrize("kept", [0.3, 0.9, 0.999])
def test_the_fastest_speed_keeps_what_was_asked(way: Way, kept: float) -> None:
    speed = fastest_compensated_speed(2e-3, BRAKED, LOW, HIGH, way, kept)
    assert square_swing_compensated(2e-3, speed, BRAKED, LOW, HIGH, way) == pytest.approx(
        kept, rel=1e-9
    )
    assert fastest_compensated_speed(6e-3, BRAKED, LOW, HIGH, way, kept) == pytest.approx(3 * speed)


def test_a_share_that_is_none_or_all_and_one_kept_at_any_speed_are_refused() -> None:
    for kept in (0.0, 1.0):
        with pytest.raises(InputError, match="kept"):
            fastest_compensated_speed(2e-3, BRAKED, LOW, HIGH, "none", kept)
    # From its limit down to next to nothing below: no speed is so fast that less than this is kept.
    with pytest.raises(OutOfRangeError, match="left at any speed") as caught:
        fastest_compensated_speed(2e-3, BRAKED, LOW, HIGH, "none", 1e-14)
    assert caught.value.quantity == "kept"
