"""The host's own limits: refused with a reason, never clipped."""

import contextlib
import dataclasses
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import InputError
from squeezefilm.instruments.device.machine.limits import level_of
from squeezefilm.instruments.device.ports import Use, require_safe_drive
from squeezefilm.instruments.device.wire.messages import limits_message

from .adversary import LIMITS


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"insulation": " "}, "touch-side insulation"),
        ({"slew": 5999.0}, "at least 6000 V/s"),
        ({"continuous_voltage": 61.0}, "continuous_voltage"),
        ({"highest_frequency": 1e3}, "which is lowest_frequency"),
        ({"voltage": float("nan")}, "voltage"),
        ({"voltage": 2001.0}, "at most 2 kV"),
        ({"duty": 1.01}, "duty"),
        ({"duty_window": 0.0}, "duty_window"),
        ({"heat": -1.0}, "heat"),
    ],
)
def test_limits_that_cannot_be_used_are_refused(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        dataclasses.replace(LIMITS, **changes)


CARD: Any = SimpleNamespace(stops_by_itself=False)
DEVICE: Any = SimpleNamespace(stops_by_itself=True)
LOW = dataclasses.replace(LIMITS, voltage=42.0)


@pytest.mark.parametrize(
    ("use", "refused"), [("own hand", "bench_only"), ("study", "in a study"), ("bench", None)]
)
def test_which_drives_are_safe(use: Use, refused: str | None) -> None:
    for limits in (LIMITS, LOW):
        require_safe_drive(DEVICE, limits, use)
    with pytest.raises(InputError, match=r"does not stop by itself .* at most 42 V"):
        require_safe_drive(CARD, LIMITS, use)
    with pytest.raises(InputError, match=refused) if refused else contextlib.nullcontext():
        require_safe_drive(CARD, LOW, use)


def test_the_wire_rounds_limits_to_the_safe_side() -> None:
    asked = Limits(33.3, 3337.9, 11.1, 1.2345678, 20000.0001, 30000.0009, 0.1239, 1.23456)
    sent = limits_message(asked)
    assert 33.3 - 4e-6 < sent.voltage <= 33.3
    assert 11.1 - 1e-6 < sent.continuous_voltage <= 11.1
    assert level_of(sent.voltage) <= 33_300_000
    assert (sent.slew, sent.heat, sent.duty, sent.duty_window) == (3337, 1234, 123, 1234)
    assert (sent.lowest_frequency, sent.highest_frequency) == (20_000_001, 30_000_000)
