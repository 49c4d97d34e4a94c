"""A host that is held up inside the link: what it knows of the device's clock stays true."""

from __future__ import annotations

from dataclasses import dataclass, field

from squeezefilm.instruments.device.machine.device import Machine
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.link import Link


@dataclass
class HeldUp:
    """A wire whose `read` and `write` take 3 ms on the clock, during which the device goes on."""

    machine: Machine = field(default_factory=Machine)
    now: float = 10.0
    arrived: bytearray = field(default_factory=bytearray)

    def clock(self) -> float:
        return self.now

    def wait(self, duration: float) -> None:
        for _ in range(round(duration * 1e4)):
            self.now += 1e-4
            self.machine.tick(self.device_time())
        self.arrived += self.machine.outgoing()

    def device_time(self) -> int:
        return round((self.now - 10.0) * 1e6)

    def read(self) -> bytes:
        self.wait(3e-3)
        data = bytes(self.arrived)
        self.arrived.clear()
        return data

    def write(self, data: bytes) -> None:
        self.arrived += self.machine.receive(data, self.device_time())
        self.wait(3e-3)

    def close(self) -> None:
        pass


def test_bounds_on_the_clock_hold_however_long_the_host_is_held_up() -> None:
    wire = HeldUp()
    link = Link(wire, wire.clock, wire.wait)
    link.request(m.Hello(1))
    link.request(m.Report(1000))
    for _ in range(100):
        link.send(m.KeepAlive())
        link.poll()
        wire.wait(1e-3)
        clock = link.device_clock
        assert clock.known
        assert clock.lowest - 2e-6 <= 10.0 <= clock.highest + 2e-6
