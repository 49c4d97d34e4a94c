"""The serial link on a real pseudo-terminal: a session, an unplugged device, one that hangs."""

import contextlib
import os
import select
import threading
import time
import tty
from collections.abc import Iterator
from types import TracebackType

import numpy as np
import pytest

from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.instruments.device.host import DeviceHost
from squeezefilm.instruments.device.machine.device import Machine
from squeezefilm.instruments.device.machine.playing import CLOCK
from squeezefilm.instruments.device.wire.frames import Fault, State
from squeezefilm.instruments.device.wire.link import Link
from squeezefilm.instruments.device.wire.streams import SerialStream, open_stream

LIMITS = Limits(40.0, 20e3, 40.0, 0.0, 20e3, 60e3)


class DeviceOnPty:
    """A machine that runs in a thread behind a pseudo-terminal, in real time."""

    def __init__(self) -> None:
        self.machine = Machine(5, sensor=lambda: (1_000, 0, True), pickup=lambda: 1)
        self.master, slave = os.openpty()
        tty.setraw(slave)
        self.port = os.ttyname(slave)
        os.close(slave)
        os.set_blocking(self.master, False)
        self.hung = False
        self._running = True
        self._thread = threading.Thread(target=self._run)

    def __enter__(self) -> "DeviceOnPty":
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.unplug()

    def unplug(self) -> None:
        if self._running:
            self._running = False
            self._thread.join()
            os.close(self.master)

    def _run(self) -> None:
        while self._running:
            if self.hung:
                time.sleep(1e-3)
                continue
            now = time.monotonic_ns() // 1000 & CLOCK
            self.machine.tick(now)
            out = self.machine.outgoing()
            if select.select([self.master], [], [], 0.5e-3)[0]:
                with contextlib.suppress(OSError):  # nobody has opened the port yet
                    out += self.machine.receive(os.read(self.master, 4096), now)
            if out:
                with contextlib.suppress(OSError):
                    os.write(self.master, out)


@pytest.fixture
def device() -> Iterator[DeviceOnPty]:
    with DeviceOnPty() as running:
        yield running


@pytest.fixture
def host(device: DeviceOnPty) -> Iterator[DeviceHost]:
    with contextlib.closing(open_stream(f"serial:{device.port}@115200")) as stream:
        yield DeviceHost(Link(stream))


def limited(call: object) -> float:
    """How long a call took; it must raise DeviceError and never hang."""
    began = time.monotonic()
    with pytest.raises(DeviceError, match="unplugged or switched off"):
        call()  # type: ignore[operator]
    return time.monotonic() - began


def test_a_session_on_a_pseudo_terminal(device: DeviceOnPty, host: DeviceHost) -> None:
    host.open(LIMITS)
    host.load_tile(0.0, 1e-3, np.linspace(0.0, 40.0, 300))
    host.report(1e-3)
    assert device.machine.tile.ready
    came = []
    end = time.monotonic() + 0.2
    while time.monotonic() < end:
        host.pump()
        came += host.poll()
        time.sleep(1e-3)
    assert len(came) > 10
    host.stop()
    statistics = host.link.statistics
    assert statistics.damaged == statistics.unknown == statistics.doubled == 0
    print(f"round trip on a pty: mean {statistics.mean_round_trip * 1e3:.2f} ms")


@pytest.mark.parametrize("what", ["poll", "pump", "stop"])
def test_unplugging_is_told_and_never_hangs(
    device: DeviceOnPty, host: DeviceHost, what: str
) -> None:
    host.open(LIMITS)
    host.report(1e-3)
    device.unplug()

    def use() -> None:
        while True:  # what had arrived before may still be read
            getattr(host, what)()

    limited(use)
    limited(host.stop)
    limited(lambda: host.open(LIMITS))


def test_a_device_that_hangs_is_told_after_a_second(device: DeviceOnPty, host: DeviceHost) -> None:
    host.open(LIMITS)
    device.hung = True
    with pytest.raises(DeviceError, match=r"did not answer (KeepAlive|Arm) within 1 s"):
        host.arm()


def test_a_device_that_takes_no_bytes_does_not_stop_the_host(
    device: DeviceOnPty, host: DeviceHost
) -> None:
    host.open(LIMITS)
    device.hung = True

    def use() -> None:
        for _ in range(10_000):
            host.play(np.ones(56), 1e-3)

    with pytest.raises(DeviceError, match=r"takes no more: .* at most 65536"):
        use()


def test_a_device_that_was_left_playing_is_opened_again(device: DeviceOnPty) -> None:
    with contextlib.closing(SerialStream(device.port)) as stream:
        first = DeviceHost(Link(stream))
        first.open(LIMITS)
        first.report(0.5e-3)
        first.arm()
        first.start(30e3)
    time.sleep(0.1)
    with contextlib.closing(SerialStream(device.port)) as stream:
        second = DeviceHost(Link(stream))
        second.open(LIMITS)
        assert second.state is State.OFF
        assert device.machine.fault is Fault.NONE


def test_a_port_is_taken_once(device: DeviceOnPty) -> None:
    with (
        contextlib.closing(SerialStream(device.port)),
        pytest.raises(DeviceError, match="cannot be opened"),
    ):
        SerialStream(device.port)


@pytest.mark.parametrize("where", ["", "serial:", "tcp:host", "serial:/dev/x@", "serial:/dev/x@-1"])
def test_what_names_no_stream(where: str) -> None:
    with pytest.raises(InputError, match="names no stream"):
        open_stream(where)


def test_a_port_that_is_not_there() -> None:
    with pytest.raises(DeviceError, match=r"cannot be opened: .* plugged in"):
        open_stream("serial:/dev/no-such-port")
