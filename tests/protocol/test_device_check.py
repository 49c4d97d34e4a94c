"""What `device check` says of a good device, of devices each of which breaks one promise, and of
devices and computers that are held up."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import DeviceError
from squeezefilm.instruments.bench import timing_checks
from squeezefilm.instruments.bench.check import check_device
from squeezefilm.instruments.bench.conversation import Conversation
from squeezefilm.instruments.bench.timing_checks import (
    DELAY_WITHIN,
    DeviceCheck,
    loop_result,
    reading_checks,
)
from squeezefilm.instruments.device.machine import device
from squeezefilm.instruments.device.machine.device import Machine
from squeezefilm.instruments.device.machine.playing import Finger
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Frame, Reason
from squeezefilm.instruments.session.loop.shared import CLASSES, Lateness, lateness_class
from squeezefilm.physics.render.motion.estimator import SensorModel

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
    slowness: float = 1.0
    held_up: Callable[[float], float] = lambda _: 0.0
    _ticks: int = 0

    def clock(self) -> float:
        return self.now

    def wait(self, duration: float) -> None:
        """Move the host's clock, by more where it is held up, and a share of it the device's."""
        self.now += duration + self.held_up(self.now)
        while (self._ticks + 1) * 100 <= self.now * self.slowness * 1e6:
            self._ticks += 1
            at = self._ticks * 100
            while self.upwards and self.upwards[0][0] * self.slowness * 1e6 <= at:
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


def finger(now: float) -> tuple[float, bool]:
    """40 mm to and fro each second, a fifth of one in the air."""
    part = now % 1.0
    return 0.08 * min(part, 1.0 - part), part < 0.8


@dataclass
class Sensor:
    """A sensor of a rate that shows the finger late, from a time on nothing new."""

    machine: Machine | None = None
    late: float = 1e-3
    rate: float = 500.0
    dead: float = math.inf
    lifts: bool = True

    def __call__(self) -> tuple[int, int, bool]:
        assert self.machine is not None
        now = min(self.machine._now * 1e-6, self.dead) - self.late
        place, touching = finger(math.floor(now * self.rate) / self.rate)
        return round(place * 1e6), 0, touching or not self.lifts


BELIEVED = SensorModel("the test's", 500.0, 1e-3, quantisation=1e-6)


def truth(when: si.SecondArray) -> si.MetreArray:
    return np.array([finger(now)[0] for now in when])


def with_sensor(kind: type[Machine] = Machine, **sensor: float) -> Machine:
    shows = Sensor(**sensor)  # type: ignore[arg-type]
    machine = kind(sensor=shows, pickup=lambda: 5)
    shows.machine = machine
    return machine


def checked(
    machine: Machine | None = None, waited: Callable[[Bench], float] | None = None, **bench: object
) -> DeviceCheck:
    wire = Bench(machine or with_sensor(), **bench)  # type: ignore[arg-type]
    talk = Conversation(wire, wire.clock, wire.wait, waited and (lambda: waited(wire)))
    return check_device(talk, FREQUENCY, drive="test", sensor=BELIEVED, truth=truth)


def failed(check: DeviceCheck) -> set[str]:
    return {result.name for result in check.results if result.verdict == "FAIL"}


def doubtful(check: DeviceCheck) -> set[str]:
    return {result.name for result in check.results if result.verdict == "doubt"}


def test_a_good_device_passes_every_check() -> None:
    check = checked()
    for result in check.results:
        print(f"{result.name:36} {result.measured:60} {result.allowed}")
    assert all(result.verdict == "pass" for result in check.results)
    assert all(result.advice == "" for result in check.results)
    said = {result.name: result.measured for result in check.results}
    assert "ms after the last frame" in said["watchdog"]
    assert said["sensor rate"].startswith("500 Hz; ")
    # A millisecond, and half a sample of 2 ms.
    assert float(said["sensor delay"].split()[0]) == pytest.approx(2.0, abs=200 * DELAY_WITHIN)
    assert (
        "0.5 V while it is touched; zero 0 ms after it was not, seen 3 times"
        in (said["sensor silence"])
    )


def test_a_device_that_is_left_is_off_and_says_nothing() -> None:
    machine = with_sensor()
    checked(machine)
    assert machine.state is device.State.OFF
    assert machine.level == 0
    assert machine.reading_due is None


def test_a_device_that_was_in_fault_is_checked_all_the_same() -> None:
    machine = with_sensor()
    machine.trip()
    assert checked(machine).passed


@pytest.mark.slow
def test_no_sensor_and_a_slow_link_are_told() -> None:
    assert failed(checked(Machine())) == {"finger sensor"}
    assert "round trip" in failed(checked(latency=30e-3))


def test_a_device_that_says_nothing_is_an_error() -> None:
    with pytest.raises(DeviceError, match="does not answer"):
        checked(spoil=lambda _: b"")


@pytest.mark.slow
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


BREAKS: list[tuple[type[Machine], str]] = [
    (NoToken, "refused: wrong token"),
    (NoWindow, "refused: frequency above its window"),
    (NoVoltageLimit, "refused: voltage above its limit"),
    (NoSequence, "refused: an old sequence number"),
    (NoWatchdog, "watchdog"),
    (NoLatch, "watchdog latches"),
]


@pytest.mark.parametrize(("kind", "name"), BREAKS)
def test_a_device_that_breaks_a_promise_is_found_out(kind: type[Machine], name: str) -> None:
    check = checked(with_sensor(kind))
    assert name in failed(check)
    assert all(result.advice for result in check.results if not result.passed)


@pytest.mark.parametrize("state", device.State)
def test_a_device_that_does_not_stop_in_one_state_is_found_out(state: device.State) -> None:
    class NoStop(Machine):
        __slots__ = ()

        def _stop(self) -> Reason:
            return Reason.STATE if self.state is state else super()._stop()

    check = checked(with_sensor(NoStop))
    found = next(one for one in check.results if one.name == "stop in every state")
    assert not found.passed
    assert state.name in found.measured.removeprefix("refused in ").split(", ")


class PlaysOn(Machine):
    """Follows its sensor also where nothing touches it."""

    __slots__ = ()

    def _move(
        self, elapsed: int, limits: device.DeviceLimits, seen: Finger | None, ticked: bool
    ) -> None:
        super()._move(elapsed, limits, seen and (seen[0], seen[1], True), ticked)


@pytest.mark.parametrize(
    ("machine", "name", "measured"),
    [
        (with_sensor(rate=240.0), "sensor rate", "240"),
        (with_sensor(late=3e-3), "sensor delay", "4 ms behind"),
        (with_sensor(PlaysOn), "sensor silence", "zero 19"),
        # It hangs while it is touched, 2.3 s after the start: some 0.7 s of what is watched.
        (with_sensor(dead=2.3), "sensor silence", "touched and still for"),
    ],
)  # fmt: skip
def test_a_sensor_that_is_not_as_believed_is_found_out(
    machine: Machine, name: str, measured: str
) -> None:
    check = checked(machine)
    result = next(result for result in check.results if result.name == name)
    print(result)
    assert name in failed(check)
    assert measured in result.measured
    assert result.advice


def test_readings_come_as_often_as_asked_by_the_devices_clock() -> None:
    wire = Bench(with_sensor())
    talk = Conversation(wire, wire.clock, wire.wait)
    talk.ask(m.Hello(1))
    results = reading_checks(talk, duration=0.2)
    assert [result.name for result in results] == ["readings", "device clock", "finger sensor"]
    assert all(result.passed for result in results)
    # A reading each millisecond, the first one after it was asked for.
    assert int(results[0].measured.split()[0]) == pytest.approx(200, abs=3)


@pytest.mark.slow
def test_what_no_finger_showed_is_in_doubt() -> None:
    still = checked(Machine(sensor=lambda: (1000, 0, True)))
    assert (failed(still), doubtful(still)) == (set(), {"sensor rate"})
    down = checked(with_sensor(lifts=False))
    assert (failed(down), doubtful(down)) == (set(), {"sensor silence"})


@pytest.mark.slow
def test_a_slow_device_is_judged_by_its_own_clock() -> None:
    """An emulated one: its watchdog, readings and sensor are right, and its clock is slow."""
    for waited, fails, doubts in (
        (None, {"device clock"}, set()),
        (lambda bench: 0.3 * bench.now, {"device clock"}, set()),
        (lambda bench: 0.9 * bench.now, set(), {"device clock"}),
    ):
        check = checked(slowness=0.4, waited=waited)  # type: ignore[arg-type]
        assert (failed(check), doubtful(check)) == (fails, doubts), waited
        assert check.passed == (not fails)
        clock = next(result for result in check.results if result.name == "device clock")
        assert "-60.0" in clock.measured or "-59.9" in clock.measured
        assert bool(clock.doubt) == (not fails)
    fast = checked(slowness=1.1, waited=lambda bench: bench.now)
    assert failed(fast) == {"device clock"}


def stalls(*times: float) -> Callable[[float], float]:
    """A host that is held up for 80 ms, once past each time."""
    left = list(times)

    def held_up(now: float) -> float:
        if left and now >= left[0]:
            left.pop(0)
            return 80e-3
        return 0.0

    return held_up


@pytest.mark.slow
def test_a_host_that_fell_silent_itself_checks_again() -> None:
    """The device rightly stops it; what it asks then is refused for the wrong reason."""
    for moment in np.arange(3.2, 3.36, 0.02):
        assert checked(held_up=stalls(float(moment))).passed, moment
    always = checked(held_up=stalls(*np.arange(3.2, 60.0, 0.01)))
    assert not failed(always)
    assert doubtful(always)


@pytest.mark.slow
def test_no_violation_is_excused_by_a_busy_computer() -> None:
    for kind, name in BREAKS:
        check = checked(
            with_sensor(kind), held_up=stalls(*np.arange(1.0, 60.0, 0.5)), waited=lambda b: b.now
        )
        assert name in failed(check), kind


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
    monkeypatch.setattr(timing_checks, "Path", lambda _: told)
    assert timing_checks.stolen_time() == 0.0
    told.write_text("cpu  11 22 33 44 55 66 77 250 0 0\ncpu0 1 2 3 4 5 6 7 8 0 0\n")
    assert timing_checks.stolen_time() == 250 / os.sysconf("SC_CLK_TCK")
    told.write_text("cpu  11 22\n")
    assert timing_checks.stolen_time() == 0.0


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
