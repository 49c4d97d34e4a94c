"""The device's state machine: a clock of its own, limits that hold, and stop in every state."""

import random
import struct

import pytest

from squeezefilm.core.drive_limits import Limits
from squeezefilm.instruments.device.machine.device import Machine, next_token
from squeezefilm.instruments.device.machine.limits import DeviceLimits, level_of
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Fault, Frame, Reason, State, frame_from_bytes

from .adversary import LIMITS

# The slowest ramp that is allowed, and nothing else to stop it.
SLOWEST = Limits(60.0, 6000.0, 60.0, 0.0, 20e3, 60e3, insulation="glass")


class Host:
    """Sends messages in sequence and reads the answers."""

    def __init__(self, machine: Machine) -> None:
        self.machine, self.sequence, self.now = machine, 0, 0

    def say(self, message: m.Message) -> Reason:
        self.sequence += 1
        return self.answer(message.frame(self.sequence))

    def answer(self, frame: Frame) -> Reason:
        answer = self.machine.receive(frame.encoded(), self.now)
        status = m.Status.read(frame_from_bytes(answer[:-1]).payload)
        assert status is not None
        assert status.answered_sequence == frame.sequence
        return Reason(status.reason)

    def wait(self, microseconds: int, tick: int = 500) -> list[int]:
        end, levels = self.now + microseconds, []
        while self.now < end:
            self.now = min(end, self.now + tick)
            levels.append(self.machine.tick(self.now))
        return levels


def playing(level: float = 60.0, limits: Limits = LIMITS, start: int = 0) -> Host:
    host = Host(Machine())
    host.now = start
    host.machine.tick(start)
    for message in (m.Hello(1), m.limits_message(limits), m.Arm(host.machine.token)):
        assert host.say(message) is Reason.ACCEPTED
    assert host.say(m.Start(40_000_000)) is Reason.ACCEPTED
    assert host.say(m.Envelope(1000, (level,))) is Reason.ACCEPTED
    host.wait(5_000)
    return host


def test_it_boots_off_and_refuses_to_arm_without_limits_or_token() -> None:
    host = Host(Machine(seed=5))
    assert host.machine.state is State.OFF
    assert not host.machine.enabled
    assert host.say(m.KeepAlive()) is Reason.SEQUENCE  # no session yet
    assert host.say(m.Hello(1)) is Reason.ACCEPTED
    assert host.say(m.Arm(5)) is Reason.NO_LIMITS
    assert host.say(m.limits_message(LIMITS)) is Reason.ACCEPTED
    assert host.say(m.Start(40_000_000)) is Reason.STATE
    assert host.say(m.Arm(6)) is Reason.TOKEN
    assert host.say(m.Arm(5)) is Reason.ACCEPTED
    assert host.say(m.Stop()) is Reason.ACCEPTED
    assert host.say(m.Arm(5)) is Reason.TOKEN  # good once
    assert host.say(m.Arm(next_token(5))) is Reason.ACCEPTED


def test_a_latched_watchdog_and_its_ramp() -> None:
    host = playing(limits=SLOWEST)
    host.wait(45_000)
    assert host.machine.state is State.PLAYING
    assert host.machine.level == 60_000_000
    levels = host.wait(10_000)
    assert host.machine.fault is Fault.WATCHDOG
    assert levels == sorted(levels, reverse=True)
    assert levels[-1] == 0
    assert host.say(m.Envelope(1000, (1.0,))) is Reason.STATE
    assert host.say(m.ClearFault(Fault.HEAT)) is Reason.VALUE
    assert host.say(m.ClearFault(Fault.WATCHDOG)) is Reason.ACCEPTED
    assert host.machine.state is State.OFF


@pytest.mark.parametrize("start", [0, 2**32 - 30_000, 2**32 - 55_000])
@pytest.mark.parametrize("tick", [37, 500, 1000, 9_000])
@pytest.mark.parametrize("noise", [False, True])
def test_silence_is_zero_output_within_60_ms(start: int, tick: int, noise: bool) -> None:
    host = playing(limits=SLOWEST, start=start)
    host.wait(6_000)
    assert host.machine.level == 60_000_000
    assert host.say(m.KeepAlive()) is Reason.ACCEPTED
    heard = host.now
    pick = random.Random(tick)
    while host.now < heard + 60_000:
        assert host.machine.level > 0 or host.now > heard + 50_000
        host.wait(min(tick, heard + 60_000 - host.now), tick)
        if noise:  # damaged, old and refused frames are no sign of life
            host.machine.receive(pick.randbytes(20) + b"\0", host.now)
            host.machine.receive(m.KeepAlive().frame(host.sequence).encoded(), host.now)
            host.say(m.Arm(0))
    assert host.machine.level == 0
    assert host.machine.fault is Fault.WATCHDOG


@pytest.mark.parametrize("state", list(State))
@pytest.mark.parametrize("sequence", [0, 1, 2, 40_000])
def test_stop_is_taken_in_every_state_whatever_its_sequence(state: State, sequence: int) -> None:
    host = playing() if state in (State.PLAYING, State.FAULT) else Host(Machine())
    if state is State.ARMED:
        for message in (m.Hello(1), m.limits_message(LIMITS), m.Arm(1)):
            host.say(message)
    if state is State.FAULT:
        host.machine.trip()
    assert host.machine.state is state
    assert host.answer(m.Stop().frame(sequence)) is Reason.ACCEPTED
    assert host.machine.state is (State.FAULT if state is State.FAULT else State.OFF)
    host.wait(10_000)
    assert host.machine.level == 0
    assert not host.machine.enabled


@pytest.mark.parametrize("bad", [float("nan"), float("-inf"), float("inf"), -1e-3, 60.00001, 3e3])
@pytest.mark.parametrize("place", [0, 1, 5])
def test_one_bad_amplitude_refuses_the_whole_frame(bad: float, place: int) -> None:
    host = playing(12.0)
    levels = [30.0] * 6
    levels[place] = bad
    payload = struct.pack("<HB6f", 1000, 6, *levels)
    host.sequence += 1
    assert host.answer(Frame(m.Envelope.TYPE, host.sequence, payload)) is Reason.VALUE
    host.wait(10_000)
    assert host.machine.level == 12_000_000


def test_amplitudes_become_microvolts_to_the_nearest() -> None:
    assert level_of(60.0) == 60_000_000
    assert level_of(struct.unpack("<f", struct.pack("<f", 0.1))[0]) == 100_000
    assert level_of(-0.0) == 0
    assert level_of(2000.0) == 2_000_000_000
    assert level_of(float("nan")) == level_of(-1e-30) == level_of(2000.1) == -1


def test_an_envelope_plays_by_the_device_clock() -> None:
    host = playing(0.0)
    fast = (0.0, 5.0, 10.0, 5.0)
    assert host.say(m.Envelope(2000, fast)) is Reason.ACCEPTED
    levels = host.wait(12_000)
    assert levels[1] == 0
    assert levels[5] == 5_000_000
    assert levels[9] == 10_000_000
    assert levels[-1] == 5_000_000  # the last one holds


def test_a_tile_is_read_linearly_and_is_silent_outside() -> None:
    host = playing(0.0)
    assert host.say(m.Position(0)) is Reason.TILE
    assert host.say(m.TileBegin(-1000, 500, 3)) is Reason.ACCEPTED
    assert host.say(m.TileData(1, (1.0,))) is Reason.TILE
    assert host.say(m.TileData(0, (0.0, 10.0))) is Reason.ACCEPTED
    assert host.say(m.Position(-750)) is Reason.TILE  # not full yet
    assert host.say(m.TileData(2, (4.0,))) is Reason.ACCEPTED
    for x, level in ((-750, 5e6), (-500, 1e7), (-250, 7e6), (0, 4e6), (1, 0), (-1001, 0)):
        assert host.say(m.Position(x)) is Reason.ACCEPTED
        host.wait(5_000)
        assert host.machine.level == level


def test_heat_stops_it_when_the_budget_is_spent() -> None:
    host = playing(60.0)  # 60² − 30² = 2700 V² above the rating: 40 V²·s last 14.8 ms
    times = []
    for _ in range(60):
        host.wait(500)
        host.say(m.KeepAlive())
        if host.machine.state is State.PLAYING:
            times.append(host.now)
    assert host.machine.fault is Fault.HEAT
    assert times[-1] == pytest.approx(40 / 2700 * 1e6 + 2_000, abs=1_500)
    # Disarming does not cool it: only time does.
    heat = host.machine.loads.heat
    host.say(m.ClearFault(Fault.HEAT))
    host.say(m.limits_message(LIMITS))
    host.say(m.Arm(host.machine.token))
    assert host.machine.loads.heat == heat > 0


def test_duty_stops_it_when_it_was_on_too_long() -> None:
    host = playing(20.0)  # cool; duty 0.5 over 0.1 s: on for 0.1 s from rest
    while host.machine.state is State.PLAYING and host.now < 1_000_000:
        host.wait(500)
        host.say(m.KeepAlive())
    assert host.machine.fault is Fault.DUTY
    assert host.now == pytest.approx(100_000, abs=2_000)


def test_a_late_tick_faults_and_does_not_jump() -> None:
    host = playing(0.0)
    host.say(m.Envelope(1, (60.0,)))
    assert host.machine.tick(host.now + 9_000) == 20_000_000  # 1 ms of slew
    host = playing(20.0)
    host.machine.tick(host.now + 10_001)
    assert host.machine.fault is Fault.LATE_TICK


LOW = Limits(42.0, 4200.0, 42.0, 1.0, 20e3, 60e3)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("voltage", 61.0), ("voltage", 0.0), ("slew", 5_999), ("slew", 2**32 - 1),
        ("continuous_voltage", 60.5), ("heat", 4_000_000_001), ("lowest_frequency", 60_000_001),
        ("highest_frequency", 19_999_999), ("duty", 0), ("duty", 1001), ("duty_window", 0),
        ("insulated", 0), ("insulated", 2),
    ],
)  # fmt: skip
def test_limits_outside_the_firmwares_own_are_refused(field: str, value: float) -> None:
    host = Host(Machine(own=DeviceLimits(voltage=60_000_000)))
    host.say(m.Hello(1))
    good = {name: getattr(m.limits_message(LIMITS), name) for name in m.SetLimits.__slots__}
    assert host.say(m.SetLimits(**(good | {field: value}))) is Reason.VALUE
    assert host.machine.limits is None
    assert host.say(m.SetLimits(**good)) is Reason.ACCEPTED
    assert host.say(m.limits_message(LOW)) is Reason.ACCEPTED  # 42 V needs no insulation
    host.say(m.Arm(host.machine.token))
    assert host.say(m.limits_message(LIMITS)) is Reason.STATE


def test_a_hung_device_that_comes_back_remembers_what_its_output_did() -> None:
    host = playing(20.0)
    host.machine.tick((host.now + 4_000_000_000) % 2**32)
    assert host.machine.state is State.FAULT
    assert host.machine.loads.used == pytest.approx(500 * 4_000_000_000, rel=1e-4)
