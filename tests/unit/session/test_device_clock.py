"""The device's clock on the host's: wraps, jitter, drift."""

from __future__ import annotations

import random

import pytest

from squeezefilm.device.machine import CLOCK
from squeezefilm.session.device_clock import WORST_DRIFT, DeviceClock


def heard(seconds: float, drift: float, first: int) -> tuple[float, DeviceClock]:
    """Worst error of stamps over a session: messages each ms, 0.3 ms on the way and more at times."""
    clock, chance, worst = DeviceClock(), random.Random(4), 0.0
    for number in range(round(seconds * 1000)):
        true = 5.0 + number * 1e-3
        device = first + round((true - 5.0) * (1 + drift) * 1e6)
        delay = 0.3e-3 + (chance.expovariate(1 / 2e-3) if chance.random() < 0.5 else 0.0)
        stamp = clock.heard(device & CLOCK, true + delay)
        if number > 100:
            worst = max(worst, abs(stamp - true - 0.3e-3))
    return worst, clock


@pytest.mark.parametrize("drift", [0.0, 100e-6, -100e-6])
@pytest.mark.parametrize("first", [0, CLOCK - 5_000_000])
def test_stamps_are_late_by_the_shortest_way_only(drift: float, first: int) -> None:
    worst, _ = heard(20.0, drift, first)
    print(f"drift {drift:g}: worst error {1e6 * worst:.1f} us")
    assert worst < 50e-6


def test_the_way_back_is_the_inverse() -> None:
    _, clock = heard(20.0, 0.0, CLOCK - 5_000_000)
    now = 25.0
    device = clock.device_time(now)
    assert clock.heard(device, now) == pytest.approx(now, abs=1e-6)


def test_a_late_message_moves_nothing_but_the_creep() -> None:
    clock = DeviceClock()
    clock.heard(1_000_000, 3.0)
    before = clock.offset
    clock.heard(2_000_000, 9.0)
    assert clock.offset == pytest.approx(before + 6 * WORST_DRIFT)
