"""Playing a texture: sensor → loop → link → device, and all that happened into the record.

`Player` is one pass of bookkeeping after the other; it neither waits nor has a clock of its own.
On hardware its clock is the loop's, in `tests/virtual_play.py` a variable: one code.

The loop's commands carry the time at which they are meant to act. The player turns that into the
device's clock and sends them ahead, so that what the link's jitter shifts is only when the device
hears of them. Should the player be held up, the device's watchdog ends what it plays.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import DeviceError, LoopError
from squeezefilm.instruments.device.host import DeviceHost
from squeezefilm.instruments.device.ports import Sensor
from squeezefilm.instruments.device.wire.frames import Fault, State
from squeezefilm.instruments.device.wire.messages import (
    MOST_LEVELS,
    PICKUP_PRESENT,
    SENSOR_PRESENT,
    Reading,
)
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.loop.process import LoopProcess
from squeezefilm.instruments.session.loop.rows import flag_meanings
from squeezefilm.instruments.session.play.plan import (
    REPORT_PERIOD,
    Ending,
    HeldState,
    PlayPlan,
    PlayView,
    held_columns,
)
from squeezefilm.instruments.session.play.usability import TickCount, Usability
from squeezefilm.instruments.session.record.trace_file import TraceWriter

RESTING_SAMPLE: si.Second = 20e-3
"""A sensor slower than the reports repeats its last place; such repeats are fed this seldom."""
LOOP_LIMIT: si.Second = 25e-3
"""Silence of the loop after which the device is stopped: its last command would hold for ever."""
DEAF_LIMIT: si.Second = 0.25
"""Silence of the device after which it is taken to be gone."""
FADE: si.Second = 30e-3
"""Time from muting the loop to stopping the device: the last commands ramp to zero in it."""
_STOP_LIMIT: si.Second = 0.5
_MICRO = 1e-6


class Player:
    """A session on a device. Call `begin`, then `step` about every millisecond, then `end`.

    Args:
        plan: what to play.
        loop: the loop that runs the plan's `loop`.
        host: of the device.
        writer: of the record, with `rows.COLUMNS`.
        clock: the time on the loop's clock (s).
        sensor: where the finger is, if not by the device's own sensor; its times are the clock's.
        tap: is given each block of rows after it was recorded, shape (n, columns); must be quick.
    """

    def __init__(
        self,
        plan: PlayPlan,
        loop: LoopProcess,
        host: DeviceHost,
        writer: TraceWriter,
        clock: Callable[[], si.Second],
        sensor: Sensor | None = None,
        tap: Callable[[si.FloatArray], None] | None = None,
    ) -> None:
        self.tap = tap
        self.plan, self.loop, self.host, self.writer = plan, loop, host, writer
        self.clock, self.sensor = clock, sensor
        self.state, self.fault = State.OFF, Fault.NONE
        self.readings = self.late_commands = self.repeated = self.device_late_ticks = 0
        self.ending: Ending | None = None
        self._last: Reading | None = None
        self._fed = self._heard = self._commanded = self._stepped = -math.inf
        self._faded = math.nan
        self._ticks = TickCount(plan.loop.period)
        # The longest time between two steps of late (s), and when it was.
        self.held_up, self._held_up_at = 0.0, -math.inf
        self._sending = False
        self.unheld = ""
        self._row: si.FloatArray = np.full(len(column.COLUMNS), math.nan)
        self._row[[column.TICK, column.FLAGS]] = 0.0

    def begin(self) -> None:
        """Give the device its limits and the texture's tile, arm it and start the carrier.

        Raises:
            DeviceError: a device that refuses or does not answer, or lacks the sensor it needs.
        """
        host, plan = self.host, self.plan
        host.open(plan.limits)
        if plan.hold is not None:
            self.unheld = host.hold(*plan.hold)
            self.writer.event("loops", {"held": not self.unheld, "message": self.unheld})
        if plan.tile is not None:
            levels = plan.tile.amplitude / plan.loop.amplitude_per_volt
            host.load_tile(plan.tile.origin, plan.tile.pitch, levels)
        host.report(REPORT_PERIOD)
        host.arm()
        host.start(plan.frequency)
        if plan.mode == "tile":
            host.follow()
        self._heard = self._commanded = self.clock()
        self.writer.event("begin", {"mode": plan.mode, "frequency_Hz": plan.frequency})

    def step(self) -> None:
        """Hear the device, feed the loop, send its commands, write its rows; never waits.

        Sets `ending` where the device faulted.

        Raises:
            DeviceError: a link that broke, or a device silent for too long.
            LoopError: a loop that died, or made no command for too long.
            RecordError: a record that cannot be written.
        """
        now = self.clock()
        gap = now - self._stepped
        if math.isfinite(gap) and (gap >= self.held_up or now - self._held_up_at > DEAF_LIMIT):
            self.held_up, self._held_up_at = gap, now
        samples = self._hear(now)
        if self.sensor is not None:
            samples = self._sensed(self.sensor)
        if samples:
            self.loop.feed(np.array(samples))
        self._send(now)
        self.drain()
        if now - self._heard > DEAF_LIMIT:
            raise DeviceError(
                f"the device has said nothing for {now - self._heard:.2g} s; it stops by its own "
                "watchdog. Look at its power and its cable"
            )

    def fade(self) -> None:
        """Let the loop's next commands be zero; step on for `FADE` before `end`."""
        if math.isnan(self._faded):
            self._faded = self.clock()
            self.loop.mute()

    def end(self, why: Ending, wait: Callable[[si.Second], None], message: str = "") -> None:
        """Stop the device, wait until its output is at zero, and write the last rows.

        A device that does not answer any more is left to its watchdog.
        """
        self.ending = why
        stopped = False
        try:
            self.host.stop()
            deadline = self.clock() + _STOP_LIMIT
            while not stopped and self.clock() < deadline:
                wait(1e-3)
                self._hear(self.clock())
                level = 1 if self._last is None else self._last.level
                stopped = self.state in (State.OFF, State.FAULT) and level == 0
            self.host.report(0.0)
        except DeviceError as error:
            message = message or str(error)
        self.drain()
        fields = {
            "why": why.value,
            "message": message,
            "device_at_zero": stopped,
            "faded_at_s": self._faded,
            "device_clock_offset_s": self.host.clock.offset,
            "device_clock_error_s": self.host.clock.error,
            "readings": self.readings,
            "repeated_readings": self.repeated,
            "late_commands": self.late_commands,
            "device_late_ticks": self.device_late_ticks,
        }
        self.writer.event("end", fields)

    def judge(self) -> Usability:
        """Verdict on whether what was played can be used; it goes into the record."""
        usability = self._ticks.judged(self.late_commands)
        self.writer.event("usability", usability.to_json())
        return usability

    @property
    def _held(self) -> HeldState | None:
        said = self.host.loops
        return None if said is None else HeldState.of(said)

    def view(self) -> PlayView:
        """View of what there is to see now."""
        row = self._row
        return PlayView(
            time=float(row[column.TIME]),
            x=float(row[column.X]),
            speed=float(row[column.SPEED]),
            wanted=float(row[column.WANTED]),
            amplitude=float(row[column.AMPLITUDE]),
            relative_friction=float(row[column.FRICTION]),
            level=float(row[column.LEVEL]),
            lag=float(row[column.LAG]),
            lateness=float(row[column.LATENESS]),
            state=self.state,
            fault=self.fault,
            readings=self.readings,
            rows=self.writer.acknowledged,
            flags=tuple(flag_meanings(int(row[column.FLAGS]) & ~column.NEW_SAMPLE)),
            held=self._held,
        )

    def _hear(self, now: si.Second) -> list[tuple[float, ...]]:
        """Readings since the last call as samples for the loop."""
        samples: list[tuple[float, ...]] = []
        for reading in self.host.poll():
            clock = self.host.clock
            stamp = clock.unwrapped(reading.time) + clock.offset
            self._heard = now
            self.readings += 1
            self.device_late_ticks = reading.late_ticks
            self._changed(reading, stamp)
            if self.sensor is None:
                if self._repeats(reading, stamp):
                    self.repeated += 1
                else:
                    samples.append(self._sample(reading, stamp))
                    self._fed = stamp
            self._last = reading
        return samples

    def _repeats(self, reading: Reading, stamp: si.Second) -> bool:
        """True where a reading shows a place that was fed already and no news of the finger."""
        last = self._last
        if last is None or stamp - self._fed >= RESTING_SAMPLE:
            return False
        return (last.x, last.y, last.touching) == (reading.x, reading.y, reading.touching)

    def _sample(self, reading: Reading, stamp: si.Second) -> tuple[float, ...]:
        if not reading.flags & SENSOR_PRESENT:
            raise DeviceError(
                "the device has no finger sensor; give one as sensor replay:FILE, or connect it"
            )
        return (
            stamp - self.plan.device.sensor.latency,
            reading.x * _MICRO,
            reading.y * _MICRO,
            float(reading.touching),
            *self._reported(reading),
        )

    def _reported(self, reading: Reading | None) -> tuple[si.Volt, si.Metre]:
        """The device's output level and the amplitude by its pickup, NaN where not known."""
        if reading is None:
            return math.nan, math.nan
        amplitude, per_volt = math.nan, self.plan.device.amplitude_per_pickup
        if per_volt is not None and reading.flags & PICKUP_PRESENT:
            amplitude = per_volt * reading.pickup * _MICRO
        return reading.level * _MICRO, amplitude

    def _sensed(self, sensor: Sensor) -> list[tuple[float, ...]]:
        samples: list[tuple[float, ...]] = []
        reported = self._reported(self._last)
        while (sample := sensor.read()) is not None and len(samples) < 1000:
            samples.append((sample.time, sample.x, sample.y, float(sample.touching), *reported))
        return samples

    def _changed(self, reading: Reading, stamp: si.Second) -> None:
        state, fault = State(reading.state), Fault(reading.fault)
        if (state, fault) != (self.state, self.fault):
            self.state, self.fault = state, fault
            self.writer.event(
                "device",
                {
                    "state": state.name.lower(),
                    "fault": fault.name.lower(),
                    "time_s": stamp,
                    "device_time_us": reading.time,
                },
            )
            if state is State.FAULT:
                self.ending = Ending.FAULT

    def _send(self, now: si.Second) -> None:
        commands = self.loop.take_commands()
        longest = max(LOOP_LIMIT, 3 * self.plan.loop.period)
        # Where this player was held up itself, the loop's silence is not the loop's.
        if len(commands) or now - self._stepped > 0.5 * longest:
            self._commanded = now
        self._stepped = now
        if self.plan.mode == "stream" and now - self._commanded > longest:
            raise LoopError(
                f"the loop has made no command for {1e3 * (now - self._commanded):.0f} ms; the "
                "device is stopped. This machine may be overloaded: try again, or a lower rate"
            )
        if self.plan.mode == "stream" and self.state is State.PLAYING and self.host.clock.known:
            late = commands[:, column.COMMAND_TIME] < now
            # Those from before the device played are not late; nobody wanted them.
            self.late_commands += int(np.count_nonzero(late)) if self._sending else 0
            fresh = commands[~late]
            self._sending = self._sending or len(fresh) > 0
            period, clock = self.plan.loop.period, self.host.clock
            for part in _blocks(fresh):
                start = clock.stamp(clock.device_time(float(part[0, column.COMMAND_TIME])))
                self.host.play(np.abs(part[:, column.COMMAND_VOLTAGE]), period, start)
        self.host.pump()

    def drain(self) -> None:
        """Write the rows that the loop has made since, also after it ended."""
        made = self.loop.take_rows()
        if len(made):
            held = None if self.plan.hold is None else held_columns(self._held, len(made))
            self.writer.append(made if held is None else np.hstack((made, held)))
            if self.state is State.PLAYING and math.isnan(self._faded):
                self._ticks.take(made)
            if self.tap is not None:
                self.tap(made)
            self._row = made[-1]


def _blocks(commands: si.FloatArray) -> list[si.FloatArray]:
    """Commands cut where ticks are missing, and to what fits a frame."""
    ticks = commands[:, column.COMMAND_TICK]
    runs = np.split(commands, np.flatnonzero(np.diff(ticks) != 1) + 1)
    return [
        run[first : first + MOST_LEVELS]
        for run in runs
        for first in range(0, len(run), MOST_LEVELS)
    ]
