"""Passes of the player's bookkeeping, with loop, device and record made by hand."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import DeviceError, InputError, LoopError
from squeezefilm.core.quantities import FloatArray
from squeezefilm.instruments.device.wire.frames import Fault, State
from squeezefilm.instruments.device.wire.messages import (
    MOST_LEVELS,
    PICKUP_PRESENT,
    SENSOR_PRESENT,
    Reading,
)
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.play.plan import (
    Ending,
    KnownDevice,
    PlayPlan,
    TextureTile,
)
from squeezefilm.instruments.session.play.player import FADE, LOOP_LIMIT, Player
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ

PlanOf = Callable[..., LoopPlan]
LIMITS = Limits(120.0, 1e6, 120.0, 0.0, 20e3, 60e3, insulation="glass")
FREQUENCY = 40e3
# The device's clock is so far behind the loop's.
OFFSET = 2.0


class Clock:
    """A device's clock that is known, and counts from the loop's minus `OFFSET`."""

    offset, error, known = OFFSET, 1e-4, True

    def unwrapped(self, device: int) -> float:
        return device * 1e-6

    def device_time(self, host: float) -> float:
        return host - OFFSET

    def stamp(self, device: float) -> int:
        return round(device * 1e6)


class Bench:
    """Loop, host, record and clock of one player, at whose hands everything lies."""

    def __init__(self, plan: PlayPlan, sensor: Any = None, tap: Any = None) -> None:
        self.now = 10.0
        self.calls: list[tuple[Any, ...]] = []
        self.fed: list[FloatArray] = []
        self.commands: FloatArray = np.empty((0, 4))
        self.rows: FloatArray = np.empty((0, 14))
        self.arriving: list[Reading] = []
        self.recorded: list[FloatArray] = []
        self.notes: list[tuple[str, dict[str, Any]]] = []
        self.gone = False
        host: Any = SimpleNamespace(
            loops=None,
            clock=Clock(), poll=self._poll,
            play=lambda volts, period, start: self._note("play", volts.tolist(), period, start),
            pump=lambda: self._note("pump"),
            open=lambda limits: self._note("open", limits),
            load_tile=lambda *tile: self._note("tile", tile[0], tile[1], tile[2].tolist()),
            report=lambda period: self._note("report", period),
            arm=lambda: self._note("arm"), start=lambda f: self._note("start", f),
            follow=lambda: self._note("follow"), stop=lambda: self._note("stop"),
        )  # fmt: skip
        loop: Any = SimpleNamespace(
            feed=self.fed.append, take_commands=lambda: self._taken("commands"),
            take_rows=lambda: self._taken("rows"), mute=lambda: self._note("mute"),
        )  # fmt: skip
        writer: Any = SimpleNamespace(
            append=self.recorded.append, acknowledged=77,
            event=lambda kind, fields: self.notes.append((kind, fields)),
        )  # fmt: skip
        self.player = Player(plan, loop, host, writer, lambda: self.now, sensor, tap)

    def _note(self, *call: Any) -> None:
        if self.gone:
            raise DeviceError("it is gone")
        self.calls.append(call)

    def _poll(self) -> list[Reading]:
        came, self.arriving = self.arriving, []
        return came

    def _taken(self, what: str) -> FloatArray:
        found: FloatArray = getattr(self, what)
        setattr(self, what, np.empty((0, found.shape[1])))
        return found

    def hears(self, **changes: Any) -> None:
        """A reading arrives that was taken now."""
        fields = {
            "time": round((self.now - OFFSET) * 1e6), "x": 1000, "y": -500, "touching": 1,
            "state": State.PLAYING, "fault": Fault.NONE, "flags": SENSOR_PRESENT,
            "level": 12_000_000, "pickup": 250_000, "late_ticks": 3,
        }  # fmt: skip
        self.arriving.append(Reading(**{**fields, **changes}))

    def commanded(self, *ticks: int, lead: float = 6e-3) -> None:
        """The loop made these ticks of 0.2 ms, the first meant for `lead` from now."""
        number = np.array(ticks, dtype=float)
        times = self.now + lead + (number - number[0]) * 0.2e-3
        volts = np.where(number % 2, -1.0, 1.0) * number
        self.commands = np.column_stack([number, times, number * 1e-8, volts])

    def step(self, after: float = 1e-3, **changes: Any) -> None:
        """A step that much later, with a reading and a command."""
        self.now += after
        self.hears(**changes)
        self.commanded(1)
        self.player.step()

    def played(self) -> list[tuple[Any, ...]]:
        return [call[1:] for call in self.calls if call[0] == "play"]


@pytest.fixture
def play_of(plan_of: PlanOf) -> Callable[..., PlayPlan]:
    def made(**changes: Any) -> PlayPlan:
        fields: dict[str, Any] = {"loop": plan_of(), "limits": LIMITS, "frequency": FREQUENCY}
        fields["device"] = dataclasses.replace(device_of(), amplitude_per_pickup=None)
        return PlayPlan(**{**fields, **changes})

    return made


PlayOf = Callable[..., PlayPlan]


def device_of(latency: float = 0.0) -> KnownDevice:
    return KnownDevice(dataclasses.replace(LVDT_10_KHZ, latency=latency), 2e-6)


def begun(plan: PlayPlan, **how: Any) -> Bench:
    bench = Bench(plan, **how)
    bench.player.begin()
    bench.step()
    bench.calls.clear()
    bench.fed.clear()
    return bench


def test_a_plan_must_fit_its_limits(play_of: PlayOf) -> None:
    for frequency in (20e3, 60e3):
        assert play_of(frequency=frequency).frequency == frequency
    for frequency in (19.99e3, 60.01e3):
        with pytest.raises(InputError, match="frequency"):
            play_of(frequency=frequency)
    # The loop's drive goes up to 100 V.
    low = Limits(99.9, 1e6, 99.9, 0.0, 20e3, 60e3, insulation="glass")
    with pytest.raises(InputError, match=r"may command 100 V and the limits allow 99\.9 V"):
        play_of(limits=low)
    exact = Limits(100.0, 1e6, 100.0, 0.0, 20e3, 60e3, insulation="glass")
    assert play_of(limits=exact).limits.voltage == 100.0


def test_beginning_a_stream_opens_reports_arms_and_starts(play_of: PlayOf) -> None:
    bench = Bench(play_of())
    bench.player.begin()
    assert bench.calls == [
        ("open", LIMITS), ("report", 1e-3), ("arm",), ("start", FREQUENCY),
    ]  # fmt: skip
    assert bench.notes == [("begin", {"mode": "stream", "frequency_Hz": FREQUENCY})]


def test_beginning_a_tile_loads_it_and_follows(play_of: PlayOf) -> None:
    # At 100 V per um: 80 V and 10 V.
    amplitude = np.array([0.8e-6, 0.1e-6, 0.8e-6])
    tile = TextureTile(0.5e-3, 1e-3, amplitude, None)
    bench = Bench(play_of(tile=tile))
    bench.player.begin()
    kinds = [call[0] for call in bench.calls]
    assert kinds == ["open", "tile", "report", "arm", "start", "follow"]
    (_, origin, pitch, levels) = bench.calls[1]
    assert (origin, pitch) == (0.5e-3, 1e-3)
    assert levels == pytest.approx([80.0, 10.0, 80.0])
    # The loop only watches: nothing it commands is sent, and its silence is no fault.
    bench.step()
    bench.now += 0.1
    bench.hears()
    bench.player.step()
    assert bench.played() == []


def test_a_reading_becomes_a_sample_on_the_loops_clock(play_of: PlayOf) -> None:
    bench = begun(play_of(device=device_of(latency=4e-3)))
    bench.step(x=1500, flags=SENSOR_PRESENT | PICKUP_PRESENT)
    bench.step(x=1600, touching=0)
    first, second = np.concatenate(bench.fed)
    stamp = 10.0 + 2e-3 - 4e-3
    assert first == pytest.approx([stamp, 1.5e-3, -0.5e-3, 1.0, 12.0, 0.25 * 2e-6])
    assert second[:5] == pytest.approx([stamp + 1e-3, 1.6e-3, -0.5e-3, 0.0, 12.0])
    # Without a pickup in the device its number means nothing.
    assert math.isnan(second[5])
    assert (bench.player.readings, bench.player.device_late_ticks) == (3, 3)
    unknown = begun(play_of())
    unknown.step(x=1500, flags=SENSOR_PRESENT | PICKUP_PRESENT)
    assert math.isnan(unknown.fed[0][0, 5])


def test_a_place_that_repeats_is_fed_seldom(play_of: PlayOf) -> None:
    bench = begun(play_of())
    for _ in range(45):
        bench.step()
    # Fed as it began, 20 ms after that, and again: 42 of 45 repeats are left out.
    assert len(bench.fed) == 2
    assert bench.player.repeated == 43
    for change in ({"x": 1001}, {"y": -501}, {"touching": 0}):
        count = len(bench.fed)
        bench.step(**change)
        bench.step(**change)
        assert len(bench.fed) == count + 1, change


def test_a_device_without_a_sensor_needs_another(play_of: PlayOf) -> None:
    bench = Bench(play_of())
    bench.player.begin()
    with pytest.raises(DeviceError, match="no finger sensor"):
        bench.step(flags=PICKUP_PRESENT)


class Sensor:
    def __init__(self, *samples: tuple[float, float, float, bool]) -> None:
        self.samples = list(samples)

    def read(self) -> Any:
        if not self.samples:
            return None
        time, x, y, touching = self.samples.pop(0)
        return SimpleNamespace(time=time, x=x, y=y, touching=touching)


def test_another_sensor_replaces_the_devices_own(play_of: PlayOf) -> None:
    sensor = Sensor((9.0, 1e-3, 2e-3, True), (9.1, 3e-3, 4e-3, False))
    bench = Bench(play_of(device=device_of()), sensor=sensor)
    bench.player.begin()
    bench.step(flags=PICKUP_PRESENT)
    (block,) = bench.fed
    amplitude = 0.25 * 2e-6
    np.testing.assert_allclose(
        block,
        [[9.0, 1e-3, 2e-3, 1.0, 12.0, amplitude], [9.1, 3e-3, 4e-3, 0.0, 12.0, amplitude]],
    )
    assert bench.player.repeated == 0
    # Before the device said anything nothing is known of its output.
    early = Bench(play_of(), sensor=Sensor((9.0, 1e-3, 2e-3, True)))
    early.player.begin()
    early.commanded(1)
    early.player.step()
    assert np.all(np.isnan(early.fed[0][0, 4:]))


def test_a_sensor_that_never_ends_does_not_hold_the_player_up(play_of: PlayOf) -> None:
    endless = Sensor(*[(9.0, 1e-3, 2e-3, True)] * 2500)
    bench = Bench(play_of(), sensor=endless)
    bench.player.begin()
    bench.step()
    assert len(bench.fed[0]) == 1000
    bench.step()
    assert 2500 - len(endless.samples) in (2000, 2001, 2002)


def test_commands_are_sent_ahead_on_the_devices_clock_without_their_sign(play_of: PlayOf) -> None:
    bench = begun(play_of())
    bench.now += 1e-3
    bench.hears()
    bench.commanded(10, 11, 12, 15, 16)
    bench.player.step()
    # Ticks 13 and 14 were lost: two blocks, each with its own time.
    start = round((bench.now + 6e-3 - OFFSET) * 1e6)
    assert bench.played() == [
        ([10.0, 11.0, 12.0], pytest.approx(0.2e-3), start),
        ([15.0, 16.0], pytest.approx(0.2e-3), start + 1000),
    ]
    assert bench.calls[-1] == ("pump",)
    assert bench.player.late_commands == 0


def test_a_block_holds_what_fits_a_frame(play_of: PlayOf) -> None:
    bench = begun(play_of())
    bench.now += 1e-3
    bench.hears()
    bench.commanded(*range(2 * MOST_LEVELS + 1))
    bench.player.step()
    assert [len(volts) for volts, _, _ in bench.played()] == [MOST_LEVELS, MOST_LEVELS, 1]
    starts = [start for _, _, start in bench.played()]
    assert np.diff(starts).tolist() == [MOST_LEVELS * 200] * 2


def test_commands_that_come_late_are_counted_and_not_sent(play_of: PlayOf) -> None:
    bench = begun(play_of())
    bench.now += 1e-3
    bench.hears()
    bench.commanded(10, 11, 12, 13, lead=-0.5e-3)
    bench.player.step()
    ((volts, _, _),) = bench.played()
    # Those meant for 0.5, 0.3 and 0.1 ms ago.
    assert volts == [13.0]
    assert bench.player.late_commands == 3


def test_nobody_wanted_what_came_before_the_device_played(play_of: PlayOf) -> None:
    bench = Bench(play_of())
    bench.player.begin()
    for state in (State.OFF, State.ARMED):
        bench.step(state=state)
    bench.now += 1e-3
    bench.hears(state=State.PLAYING)
    bench.commanded(10, 11, lead=-5e-3)
    bench.player.step()
    assert bench.played() == []
    assert bench.player.late_commands == 0
    bench.step()
    assert len(bench.played()) == 1
    # And nothing is sent on a clock that is not known.
    bench.player.host.clock.known = False  # type: ignore[misc]
    bench.step()
    assert len(bench.played()) == 1


def test_a_loop_that_makes_no_command_ends_the_session(play_of: PlayOf) -> None:
    bench = begun(play_of())
    for _ in range(25):
        bench.now += 1e-3
        bench.hears()
        bench.player.step()
    bench.now += 1e-3
    bench.hears()
    with pytest.raises(LoopError, match="no command for 26 ms"):
        bench.player.step()
    assert pytest.approx(25e-3) == LOOP_LIMIT


def test_where_the_player_was_held_up_the_loop_is_not_to_blame(play_of: PlayOf) -> None:
    bench = begun(play_of())
    # Longer than half of what a loop may be silent for: its silence counts from here.
    bench.now += 13e-3
    bench.hears()
    bench.player.step()
    for _ in range(24):
        bench.now += 1e-3
        bench.hears()
        bench.player.step()
    assert bench.player.held_up == pytest.approx(13e-3)


def test_a_slow_loop_may_be_silent_for_three_of_its_periods(
    play_of: PlayOf, plan_of: PlanOf
) -> None:
    bench = begun(play_of(loop=plan_of(rate=20.0)))
    for _ in range(15):
        bench.now += 9.9e-3
        bench.hears()
        bench.player.step()
    bench.now += 9.9e-3
    bench.hears()
    with pytest.raises(LoopError, match="no command for 158 ms"):
        bench.player.step()


def test_a_device_that_says_nothing_for_a_quarter_of_a_second_is_gone(play_of: PlayOf) -> None:
    bench = begun(play_of())
    for _ in range(25):
        bench.now += 0.00999
        bench.commanded(1)
        bench.player.step()
    bench.now += 0.00999
    bench.commanded(1)
    with pytest.raises(DeviceError, match=r"has said nothing for 0\.26 s"):
        bench.player.step()


def test_the_longest_pause_is_one_of_late(play_of: PlayOf) -> None:
    assert Bench(play_of()).player.held_up == 0.0
    bench = begun(play_of())
    for pause in (2e-3, 5e-3, 1e-3, 4e-3):
        bench.step(pause)
    assert bench.player.held_up == pytest.approx(5e-3)
    for _ in range(26):
        bench.step(9e-3)
        bench.step(1e-3)
    assert bench.player.held_up == pytest.approx(9e-3)
    for _ in range(130):
        bench.step(2e-3)
    # The 9 ms are more than a quarter of a second ago.
    assert bench.player.held_up == pytest.approx(2e-3)


def test_what_the_devices_state_does_is_noted_once(play_of: PlayOf) -> None:
    bench = begun(play_of())
    assert [kind for kind, _ in bench.notes] == ["begin", "device"]
    bench.step()
    assert len(bench.notes) == 2
    bench.step(state=State.FAULT, fault=Fault.HEAT)
    kind, fields = bench.notes[-1]
    assert kind == "device"
    assert fields == {
        "state": "fault", "fault": "heat", "time_s": pytest.approx(bench.now),
        "device_time_us": round((bench.now - OFFSET) * 1e6),
    }  # fmt: skip
    assert bench.player.ending is Ending.FAULT
    count = len(bench.notes)
    bench.step(state=State.FAULT, fault=Fault.DUTY)
    assert len(bench.notes) == count + 1


def rows_of(*ticks: int) -> FloatArray:
    rows = np.full((len(ticks), len(column.COLUMNS)), math.nan)
    rows[:, column.TICK] = ticks
    rows[:, [column.TIME, column.FLAGS]] = 0.0
    return rows


def test_rows_are_recorded_tapped_and_the_newest_is_shown(play_of: PlayOf) -> None:
    tapped: list[FloatArray] = []
    bench = begun(play_of(), tap=tapped.append)
    view = bench.player.view()
    assert math.isnan(view.time)
    assert view.flags == ()
    assert bench.recorded == tapped == []
    bench.rows = rows_of(4, 5)
    shown = {
        column.TIME: 1.5, column.X: 2e-3, column.SPEED: 0.06, column.WANTED: 1e-6,
        column.AMPLITUDE: 0.9e-6, column.FRICTION: 0.7, column.LEVEL: 12.0, column.LAG: 3e-4,
        column.LATENESS: 5e-5, column.FLAGS: float(column.AT_TOP | column.NEW_SAMPLE),
    }  # fmt: skip
    for place, value in shown.items():
        bench.rows[1, place] = value
    bench.step()
    (recorded,), (same,) = bench.recorded, tapped
    assert recorded is same
    assert recorded[:, column.TICK].tolist() == [4, 5]
    view = bench.player.view()
    assert (view.time, view.x, view.speed, view.wanted) == (1.5, 2e-3, 0.06, 1e-6)
    assert (view.amplitude, view.relative_friction, view.level) == (0.9e-6, 0.7, 12.0)
    assert (view.lag, view.lateness) == (3e-4, 5e-5)
    assert (view.state, view.fault) == (State.PLAYING, Fault.NONE)
    assert (view.readings, view.rows) == (2, 77)
    # That a sample came is no news to a person.
    assert view.flags == (column.FLAG_MEANINGS[column.AT_TOP],)
    bench.rows = rows_of(6)
    bench.player.drain()
    assert bench.recorded[-1][:, column.TICK].tolist() == [6]


def test_fading_mutes_the_loop_once_and_the_end_says_when(play_of: PlayOf) -> None:
    bench = begun(play_of())
    bench.player.fade()
    faded = bench.now
    bench.step()
    bench.player.fade()
    assert [call for call in bench.calls if call[0] == "mute"] == [("mute",)]
    waits: list[float] = []

    def wait(duration: float) -> None:
        waits.append(duration)
        bench.now += duration
        # Its output ramps to zero in three readings, and it is off before that.
        bench.hears(state=State.OFF, level=max(0, 3 - len(waits)))

    bench.rows = rows_of(9)
    bench.player.end(Ending.DURATION, wait)
    assert waits == [1e-3] * 3
    assert bench.calls[-2:] == [("stop",), ("report", 0.0)]
    assert bench.recorded[-1][:, column.TICK].tolist() == [9]
    kind, fields = bench.notes[-1]
    assert kind == "end"
    assert fields == {
        "why": "the time was over", "message": "", "device_at_zero": True, "faded_at_s": faded,
        "device_clock_offset_s": OFFSET, "device_clock_error_s": 1e-4, "readings": 5,
        "repeated_readings": bench.player.repeated, "late_commands": 0, "device_late_ticks": 3,
    }  # fmt: skip
    assert bench.player.ending is Ending.DURATION
    assert pytest.approx(30e-3) == FADE


@pytest.mark.parametrize(
    "said", [{"state": State.PLAYING, "level": 0}, {"state": State.OFF, "level": 1}, None]
)
def test_an_output_that_is_not_at_zero_within_half_a_second_is_told(
    play_of: PlayOf, said: dict[str, Any] | None
) -> None:
    bench = Bench(play_of())
    bench.player.begin()
    began = bench.now

    def wait(duration: float) -> None:
        bench.now += duration
        if said is not None:
            bench.hears(**said)

    bench.player.end(Ending.INTERRUPTED, wait)
    assert 0.5 <= bench.now - began < 0.502
    assert bench.notes[-1][1]["device_at_zero"] is False
    assert math.isnan(bench.notes[-1][1]["faded_at_s"])


def test_a_device_that_faulted_and_is_at_zero_was_stopped(play_of: PlayOf) -> None:
    bench = begun(play_of())
    bench.player.end(
        Ending.FAULT, lambda _: bench.hears(state=State.FAULT, fault=Fault.DUTY, level=0), "hot"
    )
    fields = bench.notes[-1][1]
    assert (fields["device_at_zero"], fields["message"]) == (True, "hot")


@pytest.mark.parametrize(("message", "told"), [("", "it is gone"), ("before", "before")])
def test_a_device_that_does_not_answer_any_more_is_left_to_its_watchdog(
    play_of: PlayOf, message: str, told: str
) -> None:
    bench = begun(play_of())
    bench.gone = True
    bench.rows = rows_of(3)
    bench.player.end(Ending.LINK, lambda _: None, message)
    fields = bench.notes[-1][1]
    assert (fields["why"], fields["message"]) == ("the link to the device broke", told)
    assert fields["device_at_zero"] is False
    assert len(bench.recorded) == 1
