"""A twin whose process was held up: what came meanwhile is heard evenly over that time."""

from __future__ import annotations

import functools
import itertools
import os
import select
import sys
import time
import tty
from collections.abc import Iterator

import pytest

from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Fault, State
from squeezefilm.instruments.twin import pty_server
from squeezefilm.instruments.twin.device import TwinDevice
from squeezefilm.instruments.twin.pty_server import PtyServer
from squeezefilm.instruments.twin.settings import TwinSettings
from squeezefilm.instruments.twin.working_point import WorkingPoint, working_point
from squeezefilm.physics.display import load_display

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there are no ptys on Windows")


class Told:
    """In place of a twin's device: what it was told, and when."""

    def __init__(self) -> None:
        self.now = 0
        self.heard: list[tuple[int, bytes]] = []

    def advance(self, now: int) -> bytes:
        assert now >= self.now
        self.now = now
        return b""

    def receive(self, data: bytes, now: int) -> None:
        assert now == self.now
        self.heard.append((now, data))

    def close(self) -> None:
        """Nothing to close."""


class Clock:
    """Stands while the server works, but for one jump; ends the server some looks after it."""

    def __init__(self, server: PtyServer, jump: int) -> None:
        self.looks, self.server, self.jump = 0, server, jump

    def __call__(self) -> int:
        self.looks += 1
        if self.looks > 6:
            self.server.stop()
        return 0 if self.looks == 1 else self.jump * 1000


@pytest.fixture
def host() -> Iterator[list[int]]:
    opened: list[int] = []
    yield opened
    for one in opened:
        os.close(one)


@pytest.mark.parametrize("jump", [30_000, 200_000, 3_000_000])
def test_what_came_meanwhile_is_heard_evenly_and_whole(
    jump: int, host: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    device = Told()
    server = PtyServer(device)  # type: ignore[arg-type] # all that a server asks of it
    host.append(os.open(server.port, os.O_RDWR | os.O_NOCTTY))
    tty.setraw(host[0])
    sent = bytes(range(256)) * 8
    os.write(host[0], sent)
    monkeypatch.setattr(pty_server.time, "monotonic_ns", Clock(server, jump))
    server.serve()
    server.close()
    assert device.now == jump
    assert b"".join(data for _, data in device.heard) == sent
    times = [0, *(at for at, _ in device.heard), jump]
    assert max(b - a for a, b in itertools.pairwise(times)) <= max(2_000, jump / 1000)


@functools.cache
def point() -> WorkingPoint:
    return working_point(load_display("biet2008-stator"), TwinSettings())


def playing_twin() -> TwinDevice:
    device = TwinDevice(load_display("biet2008-stator"), TwinSettings(), point=point())
    said = [
        m.Hello(1),
        m.SetLimits(10.0, 15_000, 10.0, 1000, 38_000_000, 42_000_000, 1000, 1000, 0),
    ]
    said += [m.Arm(device.machine.token), m.Start(40_500_000), m.Envelope(200, (0.5, 1.0))]
    for number, message in enumerate(said, start=1):
        device.receive(message.frame(number).encoded(), 1000 * number)
    device.advance(6000)
    assert device.machine.state is State.PLAYING
    return device


@pytest.mark.parametrize(
    ("spoken", "fault"), [(40, Fault.NONE), (0, Fault.WATCHDOG)], ids=["spoke", "silent"]
)
def test_a_host_that_spoke_meanwhile_did_not_fall_silent(
    spoken: int, fault: Fault, host: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    device = playing_twin()
    server = PtyServer(device)
    host.append(os.open(server.port, os.O_RDWR | os.O_NOCTTY))
    tty.setraw(host[0])
    alive = (m.KeepAlive().frame(number + 6).encoded() for number in range(spoken))
    os.write(host[0], b"".join(alive))
    monkeypatch.setattr(pty_server.time, "monotonic_ns", Clock(server, device.now + 200_000))
    server.serve()
    assert device.machine.fault is fault
    server.close()


def test_a_patient_twin_that_was_held_up_itself_blames_nobody(
    host: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    device = playing_twin()
    server = PtyServer(device, patient=True)
    host.append(os.open(server.port, os.O_RDWR | os.O_NOCTTY))
    monkeypatch.setattr(pty_server.time, "monotonic_ns", Clock(server, device.now + 900_000))
    server.serve()
    assert device.machine.fault is Fault.NONE
    server.close()


class Seconds:
    """A clock of 1 ms a look, and what a host has read by then; `faulted` is when the twin did."""

    def __init__(self, server: PtyServer, device: TwinDevice, reads: range) -> None:
        self.server, self.device, self.reads = server, device, reads
        self.began = self.now = device.now
        self.read, self.faulted = 0, -1

    def __call__(self) -> int:
        self.now += 1000
        since = (self.now - self.began) // 1000
        if since in self.reads:
            self.read = self.server._said
        if self.device.machine.state is State.FAULT:
            self.faulted = since
        if self.faulted >= 0 or since > 3000:
            self.server.stop()
        return self.now * 1000 if since > 1 else 0


@pytest.mark.parametrize(
    ("reads", "patient", "earliest", "latest"),
    [
        (range(3000), True, 50, 53),
        (range(3000), False, 50, 53),
        (range(0), False, 50, 53),
        (range(0), True, 1_040, 1_070),
        (range(300, 3000), True, 330, 360),
    ],
    ids=["reads on", "reads on, strict", "is held up, strict", "is stopped", "reads again"],
)
def test_a_twins_watchdog_waits_for_a_host_that_is_held_up(
    reads: range,
    patient: bool,
    earliest: int,
    latest: int,
    host: list[int],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    device = playing_twin()
    device.receive(m.Report(1000).frame(6).encoded(), device.now)
    server = PtyServer(device, patient=patient)
    host.append(os.open(server.port, os.O_RDWR | os.O_NOCTTY))
    clock = Seconds(server, device, reads)
    monkeypatch.setattr(server, "_unread", lambda: server._said - clock.read)
    monkeypatch.setattr(pty_server, "_PAUSE", 0.0)
    monkeypatch.setattr(pty_server.time, "monotonic_ns", clock)
    # The port is full at some time; what does not fit is lost, and was not said.
    server.serve()
    server.close()
    assert device.machine.fault is Fault.WATCHDOG
    assert earliest <= clock.faulted <= latest


@pytest.mark.parametrize(
    ("carried", "patient", "latest"),
    [(range(5000), True, 53), (range(200, 5000), True, 270), (range(200, 5000), False, 53)],
    ids=["carries", "carries again", "strict"],
)
def test_a_twins_watchdog_waits_for_a_system_that_carries_nothing(
    carried: range,
    patient: bool,
    latest: int,
    host: list[int],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    device = playing_twin()
    server = PtyServer(device, patient=patient)
    host.append(os.open(server.port, os.O_RDWR | os.O_NOCTTY))
    clock = Seconds(server, device, range(0))
    read = os.read

    def arrives(fd: int, count: int) -> bytes:
        if fd != server._way._near:
            return read(fd, count)
        if (clock.now - clock.began) // 1000 not in carried:
            raise BlockingIOError
        return bytes(1)

    monkeypatch.setattr(pty_server.os, "read", arrives)
    monkeypatch.setattr(pty_server, "_PAUSE", 0.0)
    monkeypatch.setattr(pty_server.time, "monotonic_ns", clock)
    server.serve()
    server.close()
    assert device.machine.fault is Fault.WATCHDOG
    assert latest - 25 <= clock.faulted <= latest


@pytest.mark.parametrize("patient", [True, False], ids=["patient", "strict"])
def test_who_speaks_while_the_twin_is_held_up_at_its_port_did_not_fall_silent(
    patient: bool, host: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Held up after it has looked at the clock, while it waits for the port."""
    device = playing_twin()
    server = PtyServer(device, patient=patient)
    host.append(os.open(server.port, os.O_RDWR | os.O_NOCTTY))
    tty.setraw(host[0])
    alive = b"".join(m.KeepAlive().frame(number + 6).encoded() for number in range(40))
    began = now = device.now
    looks, calls = itertools.count(1), itertools.count()

    def flags(wait: float) -> int:
        nonlocal now
        look = next(looks)
        if look == 2:
            os.write(host[0], alive)
            now += 200_000
        if look == 6:
            server.stop()
        return select.POLLIN

    monkeypatch.setattr(server, "_flags", flags)
    # The first look is when the twin's time began.
    monkeypatch.setattr(pty_server.time, "monotonic_ns", lambda: now * 1000 if next(calls) else 0)
    server.serve()
    server.close()
    assert device.now == began + 200_000
    assert device.machine.fault is Fault.NONE


def test_a_byte_goes_to_and_fro_through_the_system() -> None:
    server = PtyServer(Told(), patient=True)  # type: ignore[arg-type] # as above
    assert server._way.held_up_since(1000) == 1000
    end = time.monotonic() + 30.0
    while server._way.held_up_since(2000) != 2000 and time.monotonic() < end:
        time.sleep(1e-3)
    assert time.monotonic() < end
    server.close()


def test_how_much_a_host_has_not_read_is_known(host: list[int]) -> None:
    server = PtyServer(Told(), patient=True)  # type: ignore[arg-type] # as above
    assert server._unread() == 0
    host.append(os.open(server.port, os.O_RDWR | os.O_NOCTTY))
    tty.setraw(host[0])

    def comes_to(count: int) -> bool:
        end = time.monotonic() + 30.0
        while server._unread() != count and time.monotonic() < end:
            time.sleep(1e-3)
        return server._unread() == count

    server._connected = True
    server._say(bytes(300))
    assert comes_to(300)
    assert os.read(host[0], 120) == bytes(120)
    assert comes_to(180)
    assert os.read(host[0], 4096) == bytes(180)
    assert comes_to(0)
    server.close()
