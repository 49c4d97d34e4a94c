"""A host that has a device hold its plate: revisions, gains, what it is told, and older devices."""

from __future__ import annotations

import cmath
from dataclasses import dataclass, replace

import pytest

from squeezefilm.core.errors import DeviceError, OutOfRangeError, RefusedError
from squeezefilm.instruments.control.gains import IdentifiedPlate, LoopAims, loop_gains
from squeezefilm.instruments.control.plate_loop import LOCKED, NOT_FOUND, SEARCHING
from squeezefilm.instruments.device.host import DeviceHost
from squeezefilm.instruments.device.machine.device import Machine
from squeezefilm.instruments.device.machine.held import HeldPlate
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Frame, Reason, State
from squeezefilm.instruments.device.wire.link import Link

from .adversary import LIMITS as NARROW
from .wire import Wire

LIMITS = replace(NARROW, continuous_voltage=60.0, duty=1.0)
PLATE = IdentifiedPlate(30e3, 150.0, 0.01)
AIMS = LoopAims(25e3, 30.2e3, 300.0, 10.0)


@dataclass
class Plate:
    """A plate of Q 150 at 29.95 kHz, a step each time it is heard; `there` or broken off."""

    there: bool = True
    load: float = 0.0
    z: complex = 0j
    machine: Machine | None = None

    def phases(self) -> tuple[int, int]:
        assert self.machine is not None
        at = 29.95e3 if self.there else 80e3
        rate = 1.0 + self.load + 1j * (self.machine.frequency * 1e-3 - at) / 100.0
        rest = 0.01 * self.machine.level / rate
        self.z = rest + (self.z - rest) * cmath.exp(-rate * 0.0628)
        return round(self.z.real), round(self.z.imag)


class OldMachine(Machine):
    """A device of revision 1, which knows no message above 0x10."""

    def _take(self, frame: Frame) -> Reason:
        return Reason.TYPE if frame.type > m.TimedEnvelope.TYPE else super()._take(frame)


def hosted(machine: Machine) -> tuple[Wire, DeviceHost]:
    wire = Wire(machine)
    return wire, DeviceHost(Link(wire, wire.clock, wire.wait))


def with_plate() -> tuple[Plate, Machine, Wire, DeviceHost]:
    plate = Plate()
    machine = Machine(loops=HeldPlate(plate.phases, lambda: 31_500))
    plate.machine = machine
    return plate, machine, *hosted(machine)


def pumped(wire: Wire, host: DeviceHost, duration: float) -> None:
    end = wire.clock() + duration
    while wire.clock() < end:
        host.pump()
        wire.wait(1e-3)


def playing(host: DeviceHost, volts: float) -> None:
    host.arm()
    host.start(30e3)
    host.play([volts], 1e-3)


def test_the_device_holds_the_amplitude_and_says_how() -> None:
    plate, machine, wire, host = with_plate()
    host.open(LIMITS)
    assert host.hold(PLATE, AIMS) == ""
    playing(host, 12.0)
    pumped(wire, host, 0.3)
    said = host.loops
    assert said is not None
    assert (said.mode, said.flags) == (LOCKED, m.LOOPS_ON | m.TEMPERATURE_KNOWN)
    assert said.frequency == pytest.approx(29.95e6, rel=1e-5)
    assert (said.target, said.error) == (119_999, pytest.approx(0, abs=200))
    assert said.reserve == pytest.approx(48e6, rel=1e-3)
    assert said.temperature == 31_500
    plate.load = 0.5
    pumped(wire, host, 0.1)
    said = host.loops
    assert said.load / 65536 == pytest.approx(0.5, rel=0.02)
    assert said.error == pytest.approx(0, abs=500)
    # 12 V and half as much again for the finger.
    assert said.reserve == pytest.approx(42e6, rel=0.01)
    assert machine.frequency == pytest.approx(said.frequency, abs=20)


def test_gains_stay_within_the_limits_and_the_limits_count_what_is_applied() -> None:
    plate, machine, wire, host = with_plate()
    host.open(NARROW)
    host.hold(PLATE, AIMS)  # its aims go to 300 V and 25 kHz
    gains = machine.loops.gains
    assert gains is not None
    assert (gains.highest_level, gains.lowest_frequency) == (60_000_000, 25_000_000)
    plate.load = 8.0
    playing(host, 20.0)
    pumped(wire, host, 0.25)
    # Asked are 20 V, needed 180 V, on the plate 60 V: that warms it, and is on.
    assert machine.loops.wanted == 20_000_000
    assert max(level for _, level in wire.levels) == 60_000_000
    assert machine.state is State.FAULT
    rises = [b - a for (_, a), (_, b) in zip(wire.levels, wire.levels[1:], strict=False)]
    assert max(rises) <= NARROW.slew * 100
    assert min(rises) >= -NARROW.slew * 100


def test_a_search_that_found_nothing_is_begun_anew_by_the_host() -> None:
    plate, machine, wire, host = with_plate()
    plate.there = False
    host.open(LIMITS)
    host.hold(PLATE, LoopAims(29.8e3, 30.1e3, 60.0, 5.0))
    playing(host, 5.0)
    pumped(wire, host, 0.15)
    assert host.loops is not None
    assert (host.loops.mode, machine.level) == (NOT_FOUND, 0)
    plate.there = True
    pumped(wire, host, 0.05)
    assert host.loops.mode == NOT_FOUND
    host.search()
    assert machine.loops.state.mode == SEARCHING
    pumped(wire, host, 0.1)
    assert host.loops.mode == LOCKED
    host.release()
    pumped(wire, host, 0.02)
    assert (host.loops, machine.level) == (None, 5_000_000)


def test_an_older_device_refuses_politely_and_plays_without() -> None:
    machine = OldMachine()
    wire, host = hosted(machine)
    host.open(LIMITS)
    assert "knows no loops (it speaks revision 1 of the messages)" in host.hold(PLATE, AIMS)
    playing(host, 12.0)
    pumped(wire, host, 0.05)
    assert (machine.state, machine.level, host.loops) == (State.PLAYING, 12_000_000, None)


class Forgetful(Machine):
    """A device that never answers what it is asked about revisions."""

    def _answer(self, frame: Frame) -> None:
        if frame.type != m.Negotiate.TYPE:
            super()._answer(frame)


def test_a_device_that_is_silent_is_not_taken_for_an_older_one() -> None:
    """Whatever it refused before."""
    wire, host = hosted(Forgetful())
    host.open(LIMITS)
    with pytest.raises(RefusedError) as refused:
        host.link.request(m.SwitchLoops(1))
    assert refused.value.reason == Reason.TYPE
    with pytest.raises(DeviceError, match="did not answer Negotiate"):
        host.hold(PLATE, AIMS)
    assert wire.machine.state is State.OFF


def test_a_device_without_a_phase_plays_without() -> None:
    wire, host = hosted(Machine())
    host.open(LIMITS)
    assert "need a pickup with a phase" in host.hold(PLATE, AIMS)
    with pytest.raises(DeviceError, match="no loops, or no gains"):
        host.search()
    assert wire.machine.state is State.OFF


def test_a_device_that_says_no_more_is_an_error() -> None:
    _, _, wire, host = with_plate()
    host.open(LIMITS)
    wire.unplugged = True
    with pytest.raises(DeviceError, match="unplugged"):
        host.hold(PLATE, AIMS)


def test_a_resonance_outside_is_refused_by_the_host() -> None:
    *_, host = with_plate()
    host.open(LIMITS)
    with pytest.raises(OutOfRangeError, match="outside the allowed"):
        host.hold(PLATE, LoopAims(31e3, 32e3, 60.0, 5.0))


def test_the_loops_messages_need_the_revision_that_has_them() -> None:
    _, machine, wire, host = with_plate()
    host.open(LIMITS)
    gains = loop_gains(PLATE, LoopAims(29e3, 30.2e3, 60.0, 5.0))
    for message in (m.SetLoops(gains), m.SwitchLoops(1), m.AskLoops()):
        with pytest.raises(DeviceError, match="does not know this command"):
            host.link.request(message)
    host.link.request(m.Negotiate(1))
    with pytest.raises(DeviceError, match="does not know this command"):
        host.link.request(m.SetLoops(gains))
    host.link.request(m.Negotiate(65_535))
    assert machine.loops.revision == 2
    host.link.request(m.SetLoops(gains))
    assert machine.loops.gains == gains
    for bad in (m.Negotiate(0), m.SwitchLoops(2)):
        with pytest.raises(DeviceError, match="outside the device's limits"):
            host.link.request(bad)
    machine.trip()
    with pytest.raises(DeviceError, match="state does not allow"):
        host.link.request(m.SwitchLoops(1))
    assert wire.machine.state is State.FAULT


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("keep", 0), ("take", 0), ("turnover", 65_535), ("ratio", 0), ("ratio", (1 << 26) + 1),
        ("inverse", 0), ("half_bandwidth", 0), ("half_bandwidth", (1 << 24) + 1),
        ("track_share", -1), ("rate_share", (1 << 24) + 1), ("load_share", -1),
        ("lowest_frequency", 19_999_999), ("lowest_frequency", 30_000_001),
        ("highest_frequency", 29_999_999), ("highest_frequency", 60_000_001), ("sweep", 0),
        ("reference", 10), ("lowest_level", -1), ("lowest_level", 1),
        ("highest_level", 60_000_001), ("highest_level", 4_999_999), ("search_level", 0),
        ("floor", 0), ("floor", (1 << 24) + 1), ("soft", -1), ("soft", (1 << 24) + 1),
        ("heaviest", -1), ("heaviest", (1 << 22) + 1), ("patience", 3), ("patience", (1 << 20) + 1),
    ],
)  # fmt: skip
def test_gains_that_could_overflow_or_leave_the_limits_are_refused(name: str, value: int) -> None:
    _, machine, _, host = with_plate()
    host.open(LIMITS)
    gains = loop_gains(PLATE, LoopAims(29e3, 30.2e3, 60.0, 5.0))
    host.link.request(m.Negotiate(2))
    with pytest.raises(DeviceError, match="outside the device's limits"):
        host.link.request(m.SetLoops(gains._replace(**{name: value})))
    assert machine.loops.gains is None
