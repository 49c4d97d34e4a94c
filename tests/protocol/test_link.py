"""The host's side: commands, answers that go astray, clocks that drift, a stream without gaps."""

import dataclasses
import itertools
import math
import random

import numpy as np
import pytest

from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.instruments.device.host import DeviceHost
from squeezefilm.instruments.device.machine.device import Machine
from squeezefilm.instruments.device.machine.limits import DeviceLimits
from squeezefilm.instruments.device.ports import Drive, SerialDrive
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Fault, State
from squeezefilm.instruments.device.wire.link import Link

from .adversary import LIMITS
from .wire import Faults, Wire

FAST = Limits(60.0, 1e9, 60.0, 0.0, 20e3, 60e3, insulation="glass")
TILE = np.linspace(0.0, 30.0, 200)
BAD = Faults(flip=1e-4, drop=3e-4, lose=0.05, double=0.05, swap=0.05)


def made(limits: Limits = LIMITS, **changes: object) -> tuple[Wire, Link, DeviceHost]:
    machine = Machine(9, sensor=lambda: (12_000, -500, True), pickup=lambda: 250_000)
    wire = Wire(machine, **changes)  # type: ignore[arg-type]
    link = Link(wire, wire.clock, wire.wait)
    host = DeviceHost(link, session=77)
    host.open(limits)
    return wire, link, host


def playing(limits: Limits = LIMITS, **changes: object) -> tuple[Wire, Link, DeviceHost]:
    wire, link, host = made(limits, **changes)
    host.arm()
    host.start(40e3)
    return wire, link, host


def run(wire: Wire, host: DeviceHost, duration: float, step: float = 1e-3) -> list[m.Reading]:
    came = []
    end = wire.clock() + duration
    while wire.clock() < end:
        wire.wait(step)
        host.pump()
        came += host.poll()
    return came


def test_a_session_from_open_to_stop() -> None:
    wire, link, host = made()
    assert host.info is not None
    assert (host.info.has_sensor, host.info.has_pickup, host.info.longest_tile) == (1, 1, 512)
    assert wire.machine.limits is not None
    assert wire.machine.limits.voltage == 60_000_000
    host.arm()
    assert host.state is State.ARMED
    host.start(40e3)
    host.play([10.0, 20.0], 1e-3)
    run(wire, host, 0.01)
    assert wire.machine.level == 20_000_000
    host.load_tile(0.0, 1e-3, np.linspace(0.0, 30.0, 301))
    assert wire.machine.tile.ready
    host.play_at(10e-3)
    run(wire, host, 0.01)
    assert wire.machine.level == 1_000_000
    host.follow()
    run(wire, host, 0.01)
    assert wire.machine.level == 1_200_000
    host.set_frequency(41e3)
    assert wire.machine.frequency == 41_000_000
    host.stop()
    assert host.state is State.OFF
    assert link.statistics.refused == link.statistics.lost == link.statistics.damaged == 0
    assert link.statistics.sent == link.statistics.answered == wire.machine.accepted


def test_readings_of_sensor_and_pickup() -> None:
    wire, _, host = made()
    assert host.poll() == []
    host.report(1e-3)
    came = run(wire, host, 0.1)
    times = [reading.time for reading in came]
    assert len(came) in (98, 99, 100)
    assert set(np.diff(times)) == {1000}
    assert {(one.x, one.y, one.touching, one.pickup) for one in came} == {
        (12_000, -500, 1, 250_000)
    }
    assert {one.flags for one in came} == {m.SENSOR_PRESENT | m.PICKUP_PRESENT}
    host.report(0.0)
    assert run(wire, host, 0.05)[1:] == []


def test_a_device_without_sensor_or_pickup_says_so() -> None:
    wire = Wire(Machine(9))
    host = DeviceHost(Link(wire, wire.clock, wire.wait))
    host.open(LIMITS)
    host.report(1e-3)
    assert {one.flags for one in run(wire, host, 0.02)} == {0}
    host.load_tile(0.0, 1e-3, [1.0, 2.0])
    host.arm()
    host.start(40e3)
    with pytest.raises(DeviceError, match="refused Follow in state PLAYING"):
        host.follow()


def test_the_host_keeps_the_device_alive_and_a_silent_host_does_not() -> None:
    wire, _, host = playing()
    run(wire, host, 1.0, step=30e-3)
    assert host.state is State.PLAYING
    wire.wait(0.06)
    host.pump()
    wire.wait(0.01)
    assert host.poll() == []
    assert host.state is State.FAULT
    with pytest.raises(DeviceError, match=r"refused Start in state FAULT \(watchdog\)"):
        host.start(40e3)
    host.clear()
    assert host.state is State.OFF


def test_open_clears_what_a_silent_host_left_and_no_other_fault() -> None:
    wire, link, host = playing()
    wire.wait(0.2)
    assert wire.machine.fault is Fault.WATCHDOG
    again = DeviceHost(link, session=78)
    again.open(LIMITS)
    assert wire.machine.state is State.OFF
    wire.machine.trip()
    with pytest.raises(DeviceError, match="'tripped'"):
        again.open(LIMITS)
    again.clear()
    again.open(LIMITS)
    host.link.poll()


@pytest.mark.parametrize(
    ("field", "value", "own", "words"),
    [
        ("voltage", 60.0, DeviceLimits(voltage=50_000_000), "voltage is 60 V .* at most 50 V"),
        ("slew", 2e4, DeviceLimits(slew=10_000), "slew is 20000 V/s"),
        ("lowest_frequency", 2e4, DeviceLimits(lowest_frequency=30_000_000), "at least 30000 Hz"),
    ],
)
def test_limits_that_the_firmware_does_not_allow(
    field: str, value: float, own: DeviceLimits, words: str
) -> None:
    assert getattr(LIMITS, field) == value
    wire = Wire(Machine(9, own=own))
    with pytest.raises(DeviceError, match=words):
        DeviceHost(Link(wire, wire.clock, wire.wait)).open(LIMITS)


def test_a_silent_device_and_an_unplugged_one() -> None:
    wire, _, host = playing()
    wire.to_host.lose = 1.0
    began = wire.clock()
    with pytest.raises(DeviceError, match=r"did not answer Stop within 1 s \(8 sent\)"):
        host.stop()
    assert wire.clock() - began < 1.1
    assert wire.machine.state is State.OFF
    wire.unplugged = True
    for call in (host.pump, host.poll, host.stop):
        with pytest.raises(DeviceError, match="unplugged"):
            call()


def test_a_device_that_was_restarted_is_noticed() -> None:
    wire, _, host = playing()
    run(wire, host, 0.1)
    wire.machine = Machine(10)
    with pytest.raises(DeviceError, match="restarted"):
        run(wire, host, 0.1)
    host.open(LIMITS)
    host.arm()


def test_a_refused_amplitude_is_told_and_a_fault_is_not_an_error() -> None:
    wire, _, host = playing()
    host.link.send(m.Envelope(1000, (61.0,)))  # the host itself would refuse it
    with pytest.raises(DeviceError, match="refused Envelope in state PLAYING: a value is outside"):
        run(wire, host, 0.01)
    wire.machine.trip()
    host.play([1.0], 1e-3)
    run(wire, host, 0.01)
    assert host.state is State.FAULT


def test_what_cannot_be_sent_is_refused_here() -> None:
    wire, link, host = playing()
    sent = link.statistics.sent
    for call, words in (
        (
            lambda: host.play([1.0], 0.1),
            "period = 100 ms cannot be used: it must be .* at most 65.54 ms",
        ),
        (lambda: host.play([math.nan], 1e-3), "levels = nan V cannot be used: it must be finite"),
        (lambda: host.play([1.0] * 57, 1e-3), "1 to 56 fit"),
        (lambda: host.load_tile(0.0, 1e-3, [1.0] * 513), "1 to 512 fit"),
        (lambda: host.load_tile(0.0, 1e-7, [1.0]), "pitch"),
        (lambda: host.report(-1.0), "period"),
        (lambda: host.start(0.0), "frequency"),
    ):
        with pytest.raises(InputError, match=words):
            call()
    assert link.statistics.sent == sent
    assert not wire.closed


def whole_session(seed: int) -> tuple[Wire, Link]:
    wire, link, host = made(FAST, seed=seed, to_device=BAD, to_host=BAD, jitter=500)
    host.report(1e-3)
    host.load_tile(0.0, 1e-3, TILE)
    host.arm()
    host.start(40e3)
    host.follow()
    readings = run(wire, host, 0.5)
    times = [reading.time for reading in readings]
    assert times == sorted(set(times))
    assert {(reading.x, reading.y, reading.pickup) for reading in readings} == {
        (12_000, -500, 250_000)
    }
    assert wire.machine.tile.levels == [round(v * 1e6) for v in np.float32(TILE).astype(float)]
    host.stop()
    return wire, link


@pytest.mark.slow
def test_sessions_over_a_bad_line_both_ways() -> None:
    total: dict[str, int] = {}
    for seed in range(12):
        wire, link = whole_session(seed)
        assert wire.machine.state is State.OFF
        for field in ("sent", "answered", "lost", "repeated", "damaged", "doubled", "missed"):
            total[field] = total.get(field, 0) + getattr(link.statistics, field)
    print(f"12 sessions over a bad line: {total}")
    assert min(total.values()) > 0, total


@pytest.mark.parametrize("drift", [-100e-6, 100e-6])
def test_the_devices_clock_is_known_within_half_a_round_trip(drift: float) -> None:
    wire, link, host = made(drift=drift, jitter=2_000, boot=2**32 - 1_500_000)
    host.report(5e-3)
    errors = []
    for _ in range(300):
        run(wire, host, 10e-3)
        clock = link.device_clock
        stamp = clock.stamp(clock.device_time(wire.clock()))
        error = (stamp - wire.device_time + 2**31) % 2**32 - 2**31
        errors.append(abs(error) * 1e-6)
        assert errors[-1] <= clock.error + 2e-6
    assert max(errors[20:]) < 0.7e-3


def streamed(drift: float, jitter: int, block: int, seconds: float, seed: int) -> list[int]:
    """The values (mV) that a device played of 1, 2, 3, …, one per 200 µs, and how long each."""
    wire, _, host = playing(FAST, seed=seed, drift=drift, jitter=jitter)
    drive: Drive = SerialDrive(host, 200e-6, lead=6e-3)
    run(wire, host, 0.05)
    wire.levels.clear()
    count, dice = 0, random.Random(seed)
    total = round(seconds / 200e-6)
    start = wire.clock()
    while count < total:
        due = start + (count + block) * 200e-6
        # The writer wakes up to 1 ms late.
        wire.wait(max(1e-6, due + dice.uniform(0, 1e-3) - wire.clock()))
        host.pump()
        values = np.arange(count + 1, count + block + 1) * 1e-3 % 60.0
        assert drive.write(values) == block
        count += block
    run(wire, host, 0.03)
    assert drive.stops_by_itself
    assert drive.gaps == 0  # type: ignore[attr-defined]
    return [level for _, level in wire.levels]


@pytest.mark.slow
@pytest.mark.parametrize("block", [5, 25])
@pytest.mark.parametrize("drift", [-100e-6, 100e-6])
def test_a_stream_at_5_khz_has_no_gap_and_no_repeated_sample(block: int, drift: float) -> None:
    levels = streamed(drift, jitter=3_000, block=block, seconds=2.0, seed=block)
    held = [(value, len(list(ticks))) for value, ticks in itertools.groupby(levels)]
    values = [round(value / 1000) for value, _ in held if value]
    assert values == list(range(1, 10_001))
    # Every sample is held for its two ticks, but for one more or less where it is rounded.
    lengths = [length for value, length in held if value][:-1]
    assert set(lengths) <= {1, 2, 3}
    assert np.mean(lengths) == pytest.approx(2 * (1 + drift), abs=2e-3)
    print(
        f"5 kHz in blocks of {block}: held {sorted({n: lengths.count(n) for n in lengths}.items())}"
    )


def test_a_late_writer_starts_again_and_is_counted() -> None:
    wire, _, host = playing(FAST)
    host.report(1e-3)
    drive = SerialDrive(host, 200e-6)
    drive.write(np.full(25, 1.0))
    came = run(wire, host, 0.03)
    assert any(reading.flags & m.RAN_DRY for reading in came)
    drive.write(np.full(25, 2.0))
    run(wire, host, 0.02)
    assert drive.gaps == 1
    assert wire.machine.level == 2_000_000


def test_a_writer_far_ahead_is_told_what_fits() -> None:
    wire, _, host = playing(FAST)
    drive = SerialDrive(host, 200e-6)
    fitted = drive.write(np.full(2_000, 1.0))
    assert 400 < fitted < 512
    run(wire, host, 0.05)
    assert wire.machine.refused == 0
    assert drive.write(np.full(2_000, 1.0)) == pytest.approx(250, abs=10)


def test_a_writer_of_long_periods_is_at_most_a_second_ahead() -> None:
    _, _, host = playing(FAST)
    assert 90 < SerialDrive(host, 10e-3).write(np.full(200, 1.0)) < 100


def test_a_drive_needs_a_clock() -> None:
    wire = Wire(Machine(9))
    host = DeviceHost(Link(wire, wire.clock, wire.wait))
    with pytest.raises(DeviceError, match="clock is not known"):
        SerialDrive(host, 200e-6).write(np.zeros(5))
    with pytest.raises(InputError, match="lead"):
        SerialDrive(host, 200e-6, lead=0.2)


def test_statistics_are_plain_numbers() -> None:
    _, link, _ = made()
    fields = dataclasses.asdict(link.statistics)
    assert fields["shortest_round_trip"] <= fields["mean_round_trip"]
    assert fields["mean_round_trip"] <= fields["longest_round_trip"] < 2e-3


class SlowWire(Wire):
    """A wire whose calls take time, as those of a busy computer do."""

    def read(self) -> bytes:
        self.wait(2e-3)
        return super().read()

    def write(self, data: bytes) -> None:
        self.wait(1e-3)
        super().write(data)


def test_a_slow_computer_does_not_mistake_the_devices_clock() -> None:
    machine = Machine(9, sensor=lambda: (0, 0, True))
    wire = SlowWire(machine, jitter=1_000)
    link = Link(wire, wire.clock, wire.wait)
    host = DeviceHost(link)
    host.open(LIMITS)
    host.report(1e-3)
    for _ in range(200):
        run(wire, host, 5e-3)
        clock = link.device_clock
        stamp = clock.stamp(clock.device_time(wire.clock()))
        error = (stamp - wire.device_time + 2**31) % 2**32 - 2**31
        assert abs(error) * 1e-6 <= clock.error + 2e-6
        assert clock.error < 5e-3
