"""What no device could take is refused by the host, in words, before a byte goes on the wire."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import InputError
from squeezefilm.instruments.device.host import DeviceHost
from squeezefilm.instruments.device.machine.device import Machine
from squeezefilm.instruments.device.ports import SerialDrive
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import State
from squeezefilm.instruments.device.wire.link import Link

from .wire import Wire

NO_NUMBER = (None, "x", b"x", 1j, object(), 10**400, [[1.0], [1.0, 2.0]])
NOT_FINITE = (math.nan, math.inf, -math.inf)
NO_VOLTS = (*NO_NUMBER, *NOT_FINITE, -1.0, -5, -1e-30, 1e300, 2**40, 15.2, [1.0])
NO_SCALAR = (*NO_NUMBER, *NOT_FINITE, 1e300, -1e300, [1.0], np.array([1.0, 2.0]))


def playing(voltage: float = 15.1) -> tuple[Wire, DeviceHost]:
    wire = Wire(Machine(sensor=lambda: (0, 0, True)))
    host = DeviceHost(Link(wire, wire.clock, wire.wait))
    host.open(Limits(voltage, 1e6, voltage, 100.0, 20e3, 60e3, insulation="glass"))
    host.load_tile(0.0, 1e-3, [0.0])
    host.arm()
    host.start(30e3)
    return wire, host


CALLS: dict[str, tuple[Callable[[DeviceHost, Any], object], tuple[object, ...]]] = {
    "an amplitude": (lambda host, odd: host.play([0.0, odd], 1e-3), NO_VOLTS),
    "amplitudes": (lambda host, odd: host.play(odd, 1e-3), (*NO_NUMBER, math.nan, 1.0, b"xx", ())),
    "a period": (lambda host, odd: host.play([1.0], odd), (*NO_SCALAR, 0.0, -1e-3, 0.066)),
    "a start": (lambda host, odd: host.play([1.0], 1e-3, odd), (3.7, math.nan, "x", [1])),
    "a place": (lambda host, odd: host.play_at(odd), (*NO_SCALAR, 2148.0)),
    "a tile's amplitude": (lambda host, odd: host.load_tile(0.0, 1e-3, [odd]), NO_VOLTS),
    "a tile": (
        lambda host, odd: host.load_tile(0.0, 1e-3, odd),
        (*NO_NUMBER, 1.0, (), [0.0] * 513),
    ),
    "an origin": (lambda host, odd: host.load_tile(odd, 1e-3, [1.0]), NO_SCALAR),
    "a pitch": (lambda host, odd: host.load_tile(0.0, odd, [1.0]), (*NO_SCALAR, 0.0, 1e-9)),
    "a report": (lambda host, odd: host.report(odd), (*NO_SCALAR, -1.0, 1e-300, 199e-6)),
    "a frequency": (lambda host, odd: host.set_frequency(odd), (*NO_SCALAR, 0.0, 19e3, 61e3)),
    "a first frequency": (lambda host, odd: host.start(odd), (*NO_SCALAR, 0.0, 19e3, 61e3)),
    "a block": (lambda host, odd: SerialDrive(host, 1e-3).write(np.array([odd])), NO_VOLTS[:-1]),
    "a drive's period": (lambda host, odd: SerialDrive(host, odd), (*NO_SCALAR, 0.0)),
    "a drive's lead": (lambda host, odd: SerialDrive(host, 1e-3, odd), (*NO_SCALAR, -1.0)),
}


@pytest.mark.parametrize("what", list(CALLS))
def test_what_no_device_could_take_is_refused_before_it_is_sent(what: str) -> None:
    call, odd = CALLS[what]
    wire, host = playing()
    for value in odd:
        # A block is an array already; what cannot be one is its maker's mistake.
        if what == "a block" and isinstance(value, list):
            continue
        sent = host.link.statistics.sent
        with pytest.raises(InputError) as refused:
            call(host, value)
        assert host.link.statistics.sent == sent, value
        assert len(str(refused.value)) > 20
    host.play([1.0], 1e-3)
    wire.wait(5e-3)
    host.poll()
    assert host.state is State.PLAYING


@pytest.mark.parametrize("volts", [-1.0, 2000.1, -1e-45, math.nan])
def test_messages_carry_no_voltage_that_no_device_takes(volts: float) -> None:
    for message in (
        m.Envelope(1000, (1.0, volts)),
        m.TimedEnvelope(0, 1000, (volts,)),
        m.TileData(0, (volts,)),
        m.SetLimits(volts, 1, 1.0, 1, 1, 1, 1, 1, 1),
        m.SetLimits(1.0, 1, volts, 1, 1, 1, 1, 1, 1),
    ):
        with pytest.raises(InputError):
            message.payload()


@pytest.mark.parametrize("odd", [math.nan, 1.5, -1, 2**32, None, "x", [1]])
def test_messages_carry_no_number_that_does_not_fit(odd: Any) -> None:
    for message in (
        m.Hello(odd),
        m.Arm(odd),
        m.Start(odd),
        m.SetFrequency(odd),
        m.Envelope(odd, (1.0,)),
        m.TileBegin(0, odd, 1),
        m.TileBegin(0, 1, odd),
        m.TileData(odd, (1.0,)),
        m.ClearFault(odd),
        m.Report(odd),
        m.TimedEnvelope(odd, 1, (1.0,)),
        m.TimedEnvelope(0, odd, (1.0,)),
        m.SetLimits(1.0, odd, 1.0, 1, 1, 1, 1, 1, 1),
    ):
        with pytest.raises(InputError):
            message.payload()


def test_an_amplitude_at_the_limit_is_within_it() -> None:
    above = [volts for volts in np.arange(1, 800) / 10 if np.float32(volts) > volts]
    assert len(above) > 200  # these binary32 rounds up, and the device's limit is rounded down
    for volts in [*above[::20], 15.1 * (1 + 1e-12)]:
        wire, host = playing(volts)
        host.play([volts], 1e-3)
        for _ in range(20):
            wire.wait(1e-3)
            host.pump()
        host.poll()
        assert wire.machine.level == pytest.approx(volts * 1e6, abs=10)
