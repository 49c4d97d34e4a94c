"""What is left of a square grating's swing, against a cycle that is walked through."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import pytest

from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.physics.render.resonator.compensation import DrivenEnvelope
from squeezefilm.physics.render.resonator.envelope import sine_swing_kept
from squeezefilm.physics.render.resonator.square_swing import (
    fastest_compensated_speed,
    least_cycle,
    square_fundamental_compensated,
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


def quickest(swing: float, ceiling: float, bottom: float) -> float:
    """Rise at full drive and fall at the lowest command from the best level, by trying many."""
    level = np.linspace(1e-15, ceiling - swing, 200_001)
    rising = 2e-3 * np.log((TOP - level) / (TOP - level - swing))
    return float(np.min(rising + 5e-3 * np.log((level + swing - bottom) / (level - bottom))))


@pytest.mark.parametrize("swing", [0.2e-6, 1e-6, 1.9e-6])
@pytest.mark.parametrize("highest", [None, 2e-6, 2.9e-6])
def test_the_least_cycle_is_that_of_the_best_level(swing: float, highest: float | None) -> None:
    # At the limit itself a rise takes for ever: the level stays below.
    ceiling = TOP * (1 - 1e-9) if highest is None else highest
    for envelope, bottom in ((BRAKED, -TOP), (COASTING, 0.0)):
        assert least_cycle(envelope, swing, highest) == pytest.approx(
            quickest(swing, ceiling, bottom), rel=1e-6
        )


def test_the_least_cycle_of_the_whole_room_and_what_is_refused() -> None:
    # A swing up to the ceiling has one level only: 0.
    alone = 2e-3 * math.log(3 / 1) + 5e-3 * math.log(5 / 3)
    assert least_cycle(BRAKED, 2e-6, 2e-6) == pytest.approx(alone)
    for swing, highest in ((0.0, None), (TOP, None), (2.1e-6, 2e-6), (1e-6, 1.01 * TOP)):
        with pytest.raises(InputError, match=r"swing|highest"):
            least_cycle(BRAKED, swing, highest)


def stepped(period: float, speed: float, envelope: DrivenEnvelope, way: str) -> float:
    """The fundamental left, of a cycle stepped until it repeats, by the discrete sum."""
    count = 20_000
    step = period / speed / count
    bare = way == "none"
    top = HIGH if bare else envelope.amplitude_limit
    bottom = LOW if bare else envelope.lowest_command
    rise, fall = (
        math.exp(-step / tau) for tau in (envelope.rise_time_constant, envelope.fall_time_constant)
    )
    a, values = LOW, np.zeros(count)
    for _ in range(max(6, int(30 * 5e-3 * speed / period))):
        for k in range(count):
            values[k] = a
            if k < count // 2:
                a = min(HIGH, top - (top - a) * rise)
            else:
                a = max(LOW, bottom + (a - bottom) * fall)
    wanted = np.where(np.arange(count) < count // 2, HIGH, LOW)
    return float(abs(np.fft.rfft(values)[1]) / abs(np.fft.rfft(wanted)[1]))


@pytest.mark.parametrize("way", ["none", "inverse"])
@pytest.mark.parametrize(
    "speed", [0.15, *(pytest.param(one, marks=pytest.mark.slow) for one in (0.05, 0.4))]
)
def test_the_fundamental_is_that_of_the_cycle_stepped_through(speed: float, way: Way) -> None:
    found = square_fundamental_compensated(2e-3, speed, BRAKED, LOW, HIGH, way)
    assert found == pytest.approx(stepped(2e-3, speed, BRAKED, way), rel=1e-3)


def test_of_one_time_constant_the_fundamental_is_that_of_a_lag() -> None:
    plain = DrivenEnvelope(1e-3, 1e-3, TOP)
    for speed in (1e-3, 0.1, 1.0):
        found = square_fundamental_compensated(1e-3, speed, plain, 0.0, HIGH, "none")
        assert found == pytest.approx(float(sine_swing_kept(1e-3, speed, 1e-3)), rel=1e-9)
        assert found < square_swing_compensated(1e-3, speed, plain, 0.0, HIGH, "none")
    # What has all the time it needs is the square itself.
    slow = square_fundamental_compensated(1e-3, 1e-7, BRAKED, LOW, HIGH)
    assert slow == pytest.approx(1.0, rel=1e-3)
