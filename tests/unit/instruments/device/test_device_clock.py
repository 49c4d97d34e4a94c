"""A device's clock against the host's: bounds from round trips and readings, drift, wrapping."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.instruments.device.wire.link import WORST_DRIFT, DeviceClock

TURN = 2**32


def test_nothing_is_known_before_a_round_trip() -> None:
    clock = DeviceClock()
    assert not clock.known
    assert clock.error == math.inf
    assert not math.isfinite(clock.offset)
    clock.heard(2_000_000, 10.0)
    # A reading says from one side only: the device was not later than it was heard.
    assert (clock.known, clock.lowest, clock.highest) == (False, -math.inf, 8.0)


def test_a_round_trip_bounds_the_offset_from_both_sides() -> None:
    clock = DeviceClock()
    clock.answered(10.0, 2_000_000, 10.004)
    assert clock.known
    assert (clock.lowest, clock.highest) == pytest.approx((8.0, 8.004), abs=1e-12)
    assert clock.offset == pytest.approx(8.002)
    assert clock.error == pytest.approx(2e-3)
    assert clock.device_time(12.002) == pytest.approx(4.0)


def test_bounds_tighten_by_what_is_heard_and_loosen_with_time() -> None:
    clock = DeviceClock()
    clock.answered(10.0, 2_000_000, 10.004)
    # One second later both sides are 200 us farther, and a reading 1 ms old cuts the upper one.
    clock.heard(3_000_000, 11.001)
    drift = 1e6 * WORST_DRIFT * (11.001 - 10.004)
    assert (1e6 * clock.lowest, 1e6 * clock.highest) == pytest.approx((8e6 - drift, 8.001e6))
    # A round trip that took longer tells nothing new but of its sending.
    clock.answered(11.0005, 3_000_600, 11.2)
    later = 1e6 * WORST_DRIFT * (11.2 - 11.001)
    assert 1e6 * clock.highest == pytest.approx(8.001e6 + later)
    assert 1e6 * clock.lowest == pytest.approx(11.0005e6 - 3_000_600)


def test_what_is_heard_out_of_order_loosens_nothing() -> None:
    clock, other = DeviceClock(), DeviceClock()
    for one in (clock, other):
        one.answered(10.0, 2_000_000, 10.004)
    clock.heard(1_990_000, 9.995)
    clock.heard(2_000_000, 10.004)
    assert (clock.lowest, clock.highest) == (other.lowest, other.highest)
    clock.heard(3_000_000, 11.1)
    other.heard(3_000_000, 11.1)
    assert (clock.lowest, clock.highest) == (other.lowest, other.highest)


@pytest.mark.parametrize(("ahead", "believed"), [(1, False), (3, True), (1000, True)])
def test_a_round_trip_that_contradicts_is_believed_alone(ahead: int, believed: bool) -> None:
    # All within one moment of the host, so that nothing drifts.
    clock = DeviceClock()
    clock.answered(10.0, 2_000_000, 10.0)
    clock.answered(10.0, 2_000_000 - ahead, 10.0)
    assert clock.error == pytest.approx(0.0, abs=1e-12)
    # A device that counts whole microseconds may be off by one of them.
    off = ahead * 1e-6 if believed else 0.0
    assert clock.offset == pytest.approx(8.0 + off, abs=2e-7)


def test_the_newest_round_trip_brings_both_its_bounds() -> None:
    clock = DeviceClock()
    clock.answered(10.0, 2_000_000, 10.001)
    # The device was reset: its clock is seven tenths of a second behind.
    clock.answered(10.1, 1_400_000, 10.102)
    assert (clock.lowest, clock.highest) == pytest.approx((8.7, 8.702))


@pytest.mark.parametrize(("behind", "known"), [(1, True), (3, False)])
def test_a_reading_that_contradicts_leaves_one_side(behind: int, known: bool) -> None:
    clock = DeviceClock()
    clock.answered(10.0, 2_000_000, 10.0)
    clock.heard(2_000_000 + behind, 10.0)
    assert clock.known is known
    assert clock.highest == pytest.approx(8.0 - behind * 1e-6, abs=2e-7)
    assert clock.lowest == (clock.highest if known else -math.inf)


def test_times_go_on_where_the_clock_wraps_in_order_or_not() -> None:
    clock = DeviceClock()
    begin = TURN - 100
    assert clock.unwrapped(begin) == pytest.approx(begin * 1e-6)
    stamps = (28, TURN - 72, 28, 2**31)
    found = [clock.unwrapped(stamp) for stamp in stamps]
    steps = [(one - begin * 1e-6) * 1e6 for one in found]
    assert steps == pytest.approx([128, 28, 128, 2**31 + 100], abs=1e-2)
    assert [clock.stamp(at) for at in found] == list(stamps)


def test_a_step_of_less_than_half_a_turn_has_its_direction() -> None:
    for step in (2**31 - 1, 1, -1, -(2**31)):
        clock = DeviceClock()
        first = clock.unwrapped(1000)
        assert clock.unwrapped((1000 + step) % TURN) - first == pytest.approx(step * 1e-6)


def test_a_stamp_is_rounded_to_the_nearest_microsecond() -> None:
    clock = DeviceClock()
    assert [clock.stamp(at * 1e-6) for at in (0.4, 0.6, 7.0, -1.0, TURN + 3.0)] == [
        0, 1, 7, TURN - 1, 3,
    ]  # fmt: skip


def test_the_true_offset_is_always_within_the_bounds() -> None:
    # Quartzes 100 ppm apart for an hour and more, past a wrap of the device's clock.
    rng = np.random.default_rng(4)
    clock, true, worst = DeviceClock(), 1234.5, 0.0
    start = TURN * 1e-6 - 1000.0
    for host in np.sort(rng.uniform(0.0, 4000.0, 1500)):
        there, back = rng.exponential(1e-3, 2)
        device = start + (host + there) * (1 + 1e-4)
        stamp = int(device * 1e6) % TURN
        if rng.random() < 0.5:
            clock.answered(true + host, stamp, true + host + there + back)
        else:
            clock.heard(stamp, true + host + there + back)
        if clock.known:
            offset = true + host + there - device
            assert clock.lowest - 2e-6 <= offset <= clock.highest + 2e-6
            worst = max(worst, clock.error)
    assert 1e-4 < worst < 0.02
