"""What `device check` says of a good device, and of devices each of which breaks one promise."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest

from squeezefilm.core.errors import DeviceError
from squeezefilm.instruments.bench import loop_check
from squeezefilm.instruments.bench.check import DeviceCheck, check_device
from squeezefilm.instruments.bench.conversation import Conversation
from squeezefilm.instruments.bench.loop_check import loop_result
from squeezefilm.instruments.device.machine import device
from squeezefilm.instruments.device.machine.device import Machine
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Frame
from squeezefilm.instruments.device.wire.states import Reason
from squeezefilm.instruments.session.loop.lateness import CLASSES, Lateness, lateness_class

FREQUENCY = 30_000.0


@dataclass
class Bench:
    """A machine on a wire of some latency, on a clock that only `wait` moves."""

    machine: Machine
    latency: float = 0.5e-3
    now: float = 0.0
    upwards: list[tuple[float, bytes]] = field(default_factory=list)
    downwards: bytearray = field(default_factory=bytearray)
    spoil: Callable[[bytes], bytes] = bytes
    _ticks: int = 0

    def clock(self) -> float:
        return self.now

    def wait(self, duration: float) -> None:
        self.now += duration
        while (self._ticks + 1) * 100 <= self.now * 1e6:
            self._ticks += 1
            at = self._ticks * 100
            while self.upwards and self.upwards[0][0] * 1e6 <= at:
                self.downwards += self.machine.receive(self.upwards.pop(0)[1], at)
            self.machine.tick(at)
        self.downwards += self.machine.outgoing()

    def read(self) -> bytes:
        data = self.spoil(bytes(self.downwards))
        self.downwards.clear()
        return data

    def write(self, data: bytes) -> None:
        self.upwards.append((self.now + self.latency, data))

    def close(self) -> None:
        pass


def sensed() -> tuple[int, int, bool]:
    return (1000, 0, True)


def checked(machine: Machine | None = None, **bench: object) -> DeviceCheck:
    made = machine or Machine(sensor=sensed, pickup=lambda: 5)
    wire = Bench(made, **bench)  # type: ignore[arg-type]
    return check_device(Conversation(wire, wire.clock, wire.wait), FREQUENCY, drive="test")


def failed(check: DeviceCheck) -> set[str]:
    return {result.name for result in check.results if not result.passed}


def test_a_good_device_passes_every_check() -> None:
    check = checked()
    for result in check.results:
        print(f"{result.name:36} {result.measured:60} {result.allowed}")
    assert check.passed
    assert all(result.advice == "" for result in check.results)
    zero = next(one for one in check.results if one.name == "watchdog")
    assert "ms after the last frame" in zero.measured


def test_a_device_that_is_left_is_off_and_says_nothing() -> None:
    machine = Machine(sensor=sensed)
    checked(machine)
    assert machine.state is device.State.OFF
    assert machine.level == 0
    assert machine.reading_due is None


def test_a_device_that_was_in_fault_is_checked_all_the_same() -> None:
    machine = Machine(sensor=sensed)
    machine.trip()
    assert checked(machine).passed


def test_no_sensor_and_a_slow_link_are_told() -> None:
    assert failed(checked(Machine())) == {"finger sensor"}
    assert "round trip" in failed(checked(latency=30e-3))


def test_a_device_that_says_nothing_is_an_error() -> None:
    with pytest.raises(DeviceError, match="does not answer"):
        checked(spoil=lambda _: b"")


def test_noise_on_the_wire_is_counted() -> None:
    count = 0

    def noise(data: bytes) -> bytes:
        nonlocal count
        count += 1
        return data if count % 37 or not data else b"\x05\x05" + data[2:]

    assert "link" in failed(checked(spoil=noise))


class NoToken(Machine):
    __slots__ = ()

    def _arm(self, token: int) -> Reason:
        return super()._arm(self.token)


class NoWindow(Machine):
    __slots__ = ()

    def _tune(self, frequency: int, limits: device.DeviceLimits, wanted: device.State) -> Reason:
        loose = replace(limits, lowest_frequency=1, highest_frequency=1 << 31)
        return super()._tune(frequency, loose, wanted)


class NoVoltageLimit(Machine):
    __slots__ = ()

    def _obey(self, message: m.Message) -> Reason:
        kept = self.limits
        if kept is None or not isinstance(message, m.Envelope):
            return super()._obey(message)
        self.limits = replace(kept, voltage=2 * kept.voltage)
        reason = super()._obey(message)
        self.limits = kept
        return reason


class NoSequence(Machine):
    __slots__ = ()

    def _take(self, frame: Frame) -> Reason:
        self._last = (frame.sequence - 1) & 0xFFFF
        return super()._take(frame)


class NoWatchdog(Machine):
    __slots__ = ()

    def _advance(self, now: int, ticked: bool = False) -> int:
        self._heard = now & device.CLOCK
        return super()._advance(now, ticked)


class NoLatch(Machine):
    __slots__ = ()

    def _advance(self, now: int, ticked: bool = False) -> int:
        level = super()._advance(now, ticked)
        if self.state is device.State.FAULT and self.level == 0:
            self.state, self.fault = device.State.OFF, device.Fault.NONE
        return level


@pytest.mark.parametrize(
    ("kind", "name"),
    [
        (NoToken, "refused: wrong token"),
        (NoWindow, "refused: frequency above its window"),
        (NoVoltageLimit, "refused: voltage above its limit"),
        (NoSequence, "refused: an old sequence number"),
        (NoWatchdog, "watchdog"),
        (NoLatch, "watchdog latches"),
    ],
)
def test_a_device_that_breaks_a_promise_is_found_out(kind: type[Machine], name: str) -> None:
    check = checked(kind(sensor=sensed))
    assert name in failed(check)
    assert all(result.advice for result in check.results if not result.passed)


@pytest.mark.parametrize("state", device.State)
def test_a_device_that_does_not_stop_in_one_state_is_found_out(state: device.State) -> None:
    class NoStop(Machine):
        __slots__ = ()

        def _stop(self) -> Reason:
            return Reason.STATE if self.state is state else super()._stop()

    check = checked(NoStop(sensor=sensed))
    found = next(one for one in check.results if one.name == "stop in every state")
    assert not found.passed
    assert state.name in found.measured.removeprefix("refused in ").split(", ")


def lateness(made: int, lost: int) -> Lateness:
    import numpy as np

    counts = np.zeros(CLASSES, dtype=np.int64)
    counts[lateness_class(5e3)] = made
    return Lateness(5e3, made, lost, 1e-3, counts)


def test_a_loop_that_loses_ticks_fails_with_advice() -> None:
    assert loop_result(lateness(10_000, 50), 0.0).passed
    lost = loop_result(lateness(10_000, 500), 0.0)
    assert not lost.passed
    assert "95.24 %" in lost.measured
    assert "host" not in lost.measured
    assert "real-time priority" in lost.advice


def test_a_loop_whose_host_took_the_time_fails_too_and_says_so() -> None:
    # 9900 of 10 500 ticks at 5 kHz: 395 ticks or 79 ms short of 99 %.
    for stolen, word in ((0.078, "real-time priority"), (0.080, "host of this virtual computer")):
        lost = loop_result(lateness(10_000, 500), stolen)
        assert not lost.passed
        assert f"its host took {1e3 * stolen:.0f} ms" in lost.measured
        assert word in lost.advice
    assert loop_result(lateness(10_000, 50), 1.0).passed


def test_what_the_host_took_is_read_where_the_system_tells(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = tmp_path / "stat"
    monkeypatch.setattr(loop_check, "Path", lambda _: told)
    assert loop_check.stolen_time() == 0.0
    told.write_text("cpu  11 22 33 44 55 66 77 250 0 0\ncpu0 1 2 3 4 5 6 7 8 0 0\n")
    assert loop_check.stolen_time() == 250 / os.sysconf("SC_CLK_TCK")
    told.write_text("cpu  11 22\n")
    assert loop_check.stolen_time() == 0.0


def test_every_promise_is_looked_at() -> None:
    refused = [
        name.removeprefix("refused: ")
        for name in (result.name for result in checked().results)
        if name.startswith("refused: ")
    ]
    assert refused == [
        "wrong token", "frequency above its window", "frequency below its window",
        "voltage above its limit", "voltage below zero", "voltage not a number",
        "voltage infinite", "an old sequence number", "frame of a wrong length",
    ]  # fmt: skip
