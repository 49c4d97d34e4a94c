"""The device's own limits: each bound by itself, at it and just past it."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from squeezefilm.instruments.device.machine.limits import NO_LEVEL, DeviceLimits, level_of
from squeezefilm.instruments.device.wire.messages import SetLimits

OWN = DeviceLimits(
    voltage=60_000_000, slew=20_000, continuous_voltage=30_000_000, heat=5_000,
    lowest_frequency=20_000_000, highest_frequency=60_000_000, duty=800, duty_window=10_000,
)  # fmt: skip
# All that these limits allow.
MOST: dict[str, Any] = dict(
    zip(
        (field.name for field in dataclasses.fields(SetLimits)),
        (60.0, 20_000, 30.0, 5_000, 20_000_000, 60_000_000, 800, 10_000, 1),
        strict=True,
    )
)


def asked(**changes: Any) -> DeviceLimits | None:
    assert set(changes) <= set(MOST)
    return OWN.narrowed(SetLimits(**{**MOST, **changes}))


def test_all_that_is_allowed_may_be_asked_for() -> None:
    assert asked() == OWN
    least = asked(
        voltage=40.0, slew=4_000, continuous_voltage=0.0, heat=0, lowest_frequency=40_000_000,
        highest_frequency=40_000_000, duty=1, duty_window=1, insulated=0,
    )  # fmt: skip
    assert least == DeviceLimits(40_000_000, 4_000, 0, 0, 40_000_000, 40_000_000, 1, 1)


@pytest.mark.parametrize(
    "changes",
    [
        {"voltage": 60.00001}, {"voltage": 0.0, "continuous_voltage": 0.0}, {"voltage": -1.0},
        {"voltage": math.nan}, {"slew": 20_001}, {"slew": 5_999}, {"continuous_voltage": 30.00001},
        {"continuous_voltage": -0.1}, {"continuous_voltage": math.nan},
        {"voltage": 29.0, "continuous_voltage": 30.0}, {"heat": 5_001},
        {"lowest_frequency": 19_999_999}, {"highest_frequency": 60_000_001},
        {"lowest_frequency": 40_000_001, "highest_frequency": 40_000_000}, {"duty": 801},
        {"duty": 0}, {"duty_window": 10_001}, {"duty_window": 0}, {"insulated": 2},
        {"insulated": 0}, {"voltage": 40.0, "slew": 4_000, "insulated": 2},
    ],
)  # fmt: skip
def test_what_is_just_past_a_limit_is_refused(changes: dict[str, Any]) -> None:
    assert asked(**changes) is None


def test_what_may_be_touched_needs_no_insulation() -> None:
    at, past = {"continuous_voltage": 0.0, "insulated": 0}, np.nextafter(np.float32(42), 99)
    assert asked(voltage=42.0, **at) is not None
    assert asked(voltage=float(past), **at) is None
    # A slope that comes to rest from there in 10 ms, and one that does not.
    assert asked(voltage=42.0, slew=4_200, **at) is not None
    assert asked(voltage=42.0, slew=4_199, **at) is None


def test_without_a_firmwares_own_they_are_the_most_that_the_wire_carries() -> None:
    # 2000 V, 1 GV/s, 4e6 V2 s, 1 Hz to 1 MHz, always on, an hour.
    assert DeviceLimits() == DeviceLimits(
        2_000_000_000, 1_000_000_000, 2_000_000_000, 4_000_000 * 1000, 1000, 10**6 * 1000, 1000,
        3600 * 1000,
    )  # fmt: skip


def test_volts_become_microvolts_to_the_nearest() -> None:
    assert [level_of(volts) for volts in (0.0, 1e-6, 0.4e-6, 0.6e-6, 2000.0)] == [
        0, 1, 0, 1, 2_000_000_000,
    ]  # fmt: skip
    for bad in (-1e-9, 2000.0001, math.nan, math.inf, -math.inf):
        assert level_of(bad) == NO_LEVEL == -1


def test_one_bad_amplitude_refuses_all() -> None:
    assert OWN.levels((0.0, 60.0, 1.5)) == (0, 60_000_000, 1_500_000)
    assert OWN.levels(()) == ()
    for bad in (60.00001, -0.1, math.nan):
        assert OWN.levels((1.0, bad, 2.0)) is None
