"""The state machine of a device: OFF → ARMED → PLAYING, and FAULT, which is latched.

The twin of `firmware/squeezefilm_fw.c`, rule by rule and number by number: integers throughout
(µs, µV, mHz, µm), and a clock that is passed in, 32 bits of µs that may wrap. It boots off.
`docs/development/protocol.md` states the rules.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, field

from squeezefilm.instruments.device.machine.held import HeldPlate
from squeezefilm.instruments.device.machine.limits import DeviceLimits, Loads
from squeezefilm.instruments.device.machine.playing import (
    CLOCK,
    Finger,
    Mode,
    Playing,
    Reports,
    Tile,
)
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import (
    VERSION,
    Deframer,
    Fault,
    Frame,
    Reason,
    State,
)

SILENCE = 50_000
"""µs without an accepted frame after which an armed device faults."""
LATE_TICK = 10_000
"""µs between ticks above which an armed device faults: it cannot vouch for its output."""
LONGEST_RISE = 1_000
"""µs of slew that one tick may rise by, so that a late tick makes no jump."""
TICK_PERIOD = 100
"""µs between the ticks of a device that does not say otherwise."""
FIRMWARE_VERSION = 1
_SEED = 0x9E3779B9
_MOST_UNREAD = 1 << 16


def next_token(token: int) -> int:
    """The arming token after `token` (xorshift32, Marsaglia 2003): a guard against replays."""
    token ^= (token << 13) & CLOCK
    token ^= token >> 17
    return token ^ ((token << 5) & CLOCK)


@dataclass(slots=True)
class Machine:
    """One device. Give it bytes and the time; it gives answers and its output. Not thread-safe.

    `seed` is where its tokens start (a device takes a random number); `own` are the firmware's
    limits, which no message passes. `sensor` gives the finger's position x and y (µm) and whether
    it touches, `pickup` the amplitude at the pickup's input (µV); both are called in a tick that
    needs them. `tick_period` (µs) is how often `tick` is meant to be called. `loops` hold the plate
    where the device can and a host says so. `excused` (µs) is by how much longer the watchdog waits
    for the next accepted frame: 0 but where a twin says so.
    """

    seed: int = 1
    own: DeviceLimits = field(default_factory=DeviceLimits)
    sensor: Callable[[], Finger] | None = None
    pickup: Callable[[], int] | None = None
    tick_period: int = TICK_PERIOD
    loops: HeldPlate = field(default_factory=HeldPlate)
    state: State = State.OFF
    fault: Fault = Fault.NONE
    level: int = 0
    frequency: int = 0
    excused: int = 0
    limits: DeviceLimits | None = None
    loads: Loads = field(default_factory=Loads)
    tile: Tile = field(default_factory=Tile)
    playing: Playing = field(default_factory=Playing)
    accepted: int = 0
    refused: int = 0
    late_ticks: int = 0
    token: int = 0
    session: int = 0
    _deframer: Deframer = field(default_factory=Deframer)
    _now: int = 0
    _ticked: int = 0
    _heard: int = 0
    _opened: bool = False
    _last: int = 0
    _sent: int = 0
    _reports: Reports = field(default_factory=Reports)
    _unread: bytearray = field(default_factory=bytearray)

    def __post_init__(self) -> None:
        self.token = (self.seed & CLOCK) or _SEED

    @property
    def damaged(self) -> int:
        """Number of frames that were damaged."""
        return self._deframer.damaged

    @property
    def enabled(self) -> bool:
        """True where the amplifier's enable line is held."""
        return self.state in (State.ARMED, State.PLAYING) or self.level > 0

    @property
    def reading_due(self) -> int | None:
        """Time at which the next reading is due (32 bits of µs); None if none is asked for."""
        return self._reports.due if self._reports.period else None

    def receive(self, data: bytes, now: int) -> bytes:
        """Take bytes that arrived at `now` (µs); returns `outgoing`, the answers among it."""
        for frame in self._deframer.take(data):
            self._advance(now)
            if frame is not None:
                self._answer(frame)
        return self.outgoing()

    def outgoing(self) -> bytes:
        """The bytes for the host since the last call: answers and readings, in order.

        What nobody fetches is kept up to 64 KiB; later readings are lost, as on a full wire.
        """
        out = bytes(self._unread)
        self._unread.clear()
        return out

    def trip(self) -> None:
        """The amplifier's fault line or an opened enable line: FAULT, latched, from any state."""
        self._fail(Fault.TRIPPED)

    def tick(self, now: int) -> int:
        """Advance to `now` (µs); returns the output (µV). To be called at least every 1 ms."""
        if self.state is State.PLAYING:
            since = (now - self._ticked) & CLOCK
            if since > self.tick_period + self.tick_period // 2:
                self.late_ticks = (self.late_ticks + 1) & CLOCK
                self.loops.skip()
        self._ticked = now & CLOCK
        return self._advance(now, ticked=True)

    def _advance(self, now: int, ticked: bool = False) -> int:
        elapsed = (now - self._now) & CLOCK
        self._now = now & CLOCK
        due = self._reports.take(self._now)
        finger = None
        if self.sensor is not None and (due or self.playing.mode is Mode.FINGER):
            finger = self.sensor()
        if self.limits is not None and (elapsed != 0 or (ticked and self.loops.on)):
            self._move(elapsed, self.limits, finger, ticked)
        if due:
            self._read(finger)
        return self.level

    def _move(
        self, elapsed: int, limits: DeviceLimits, finger: Finger | None, ticked: bool
    ) -> None:
        # The output was held since the last tick: count that, then move.
        self.loads.count(self.level, elapsed, limits.continuous_voltage, limits.duty)
        falling = elapsed
        if self.state in (State.ARMED, State.PLAYING):
            silent = (self._now - self._heard) & CLOCK
            if silent > SILENCE + self.excused:
                # The ramp counts from the deadline, not from the tick that noticed it.
                falling = min(elapsed, silent - SILENCE - self.excused)
                self._fail(Fault.WATCHDOG)
            elif elapsed > LATE_TICK:
                falling = 0
                self._fail(Fault.LATE_TICK)
            elif self.state is State.PLAYING:
                if self.loads.heat > limits.heat * 1_000_000_000:
                    self._fail(Fault.HEAT)
                elif self.loads.used > limits.duty * limits.duty_window * 1000:
                    self._fail(Fault.DUTY)
        target = 0
        if self.state is State.PLAYING:
            target = self.playing.level(self._now, self.tile, finger)
            if self.loops.on:
                target = self.loops.level(target, self.level, ticked)
                self.frequency = self.loops.command.frequency
        if target > self.level:
            rise = limits.slew * min(elapsed, LONGEST_RISE)
            self.level = min(target, self.level + rise)
        else:
            self.level = max(target, self.level - limits.slew * falling)

    def _read(self, finger: Finger | None) -> None:
        x, y, touching = finger or (0, 0, False)
        flags = (
            m.SENSOR_PRESENT * (self.sensor is not None)
            | m.PICKUP_PRESENT * (self.pickup is not None)
            | self.playing.take_marks()
        )
        pickup = 0 if self.pickup is None else self.pickup()
        reading = m.Reading(
            self._now,
            x,
            y,
            int(touching),
            self.state,
            self.fault,
            flags,
            self.level,
            pickup,
            self.late_ticks,
        )
        # The number is used up even where nobody fetches: the host then sees the loss.
        self._sent = (self._sent + 1) & 0xFFFF
        if len(self._unread) < _MOST_UNREAD:
            self._unread += reading.frame(self._sent).encoded()

    def _send(self, message: m.Message) -> None:
        self._sent = (self._sent + 1) & 0xFFFF
        self._unread += message.frame(self._sent).encoded()

    def _fail(self, fault: Fault) -> None:
        if self.state is not State.FAULT:
            self.state, self.fault = State.FAULT, fault
            self.playing.stop()

    def _answer(self, frame: Frame) -> None:
        reason = self._take(frame)
        if reason is Reason.ACCEPTED:
            self.accepted = (self.accepted + 1) & CLOCK
            self._heard, self.excused = self._now, 0
        else:
            self.refused = (self.refused + 1) & CLOCK
        status = m.Status(
            frame.sequence,
            reason,
            self.state,
            self.fault,
            0,
            self.token,
            self.level,
            self.accepted,
            self.refused,
            self.damaged & CLOCK,
            self.session,
            self._now,
        )
        self._send(status)
        if reason is not Reason.ACCEPTED:
            return
        if frame.type == m.AskInfo.TYPE:
            self._send(self._info())
        elif frame.type == m.Negotiate.TYPE:
            self._send(self.loops.capabilities())
        elif frame.type == m.AskLoops.TYPE:
            self._send(self.loops.report(self._now))

    def _info(self) -> m.Info:
        return m.Info(
            **asdict(self.own),
            tick_period=self.tick_period,
            has_sensor=int(self.sensor is not None),
            has_pickup=int(self.pickup is not None),
            longest_tile=m.LONGEST_TILE,
            firmware_version=FIRMWARE_VERSION,
        )

    def _take(self, frame: Frame) -> Reason:
        if frame.version != VERSION:
            return Reason.VERSION
        kind = m.COMMANDS.get(frame.type)
        if kind is None or (frame.type > m.Negotiate.TYPE and self.loops.revision < 2):
            return Reason.TYPE
        message = kind.read(frame.payload)
        if message is None:
            return Reason.LENGTH
        if isinstance(message, m.Hello):
            return self._open(message, frame.sequence)
        ahead = (frame.sequence - self._last) & 0xFFFF
        fresh = self._opened and 1 <= ahead < 0x8000
        if fresh:
            self._last = frame.sequence
        if isinstance(message, m.Stop):
            return self._stop()
        return self._obey(message) if fresh else Reason.SEQUENCE

    def _open(self, hello: m.Hello, sequence: int) -> Reason:
        if self.state not in (State.OFF, State.FAULT):
            return Reason.STATE
        self._opened, self._last, self.session = True, sequence, hello.session
        self._reports.period, self.loops.revision = 0, 1
        self.loops.drop()
        return Reason.ACCEPTED

    def _stop(self) -> Reason:
        if self.state is not State.FAULT:
            self.state = State.OFF
            self.playing.stop()
        return Reason.ACCEPTED

    def _obey(self, message: m.Message) -> Reason:
        match message:
            case m.KeepAlive() | m.AskInfo():
                return Reason.ACCEPTED
            case m.Report():
                return self._reports.begin(self._now, message.period)
            case m.ClearFault():
                return self._clear(message.fault)
            case m.SetLimits():
                return self._limit(message)
            case m.Negotiate():
                return self.loops.negotiate(message.revision)
            case m.AskLoops():
                return Reason.NO_LOOPS if self.loops.gains is None else Reason.ACCEPTED
        if self.limits is None:
            return Reason.NO_LIMITS
        match message:
            case m.Arm():
                return self._arm(message.token)
            case m.TileBegin() | m.TileData() if self.state is State.FAULT:
                return Reason.STATE
            case m.TileBegin():
                return self.tile.begin(message.origin, message.pitch, message.size)
            case m.TileData():
                levels = self.limits.levels(message.levels)
                return self.tile.fill(message.first, len(message.levels), levels)
            case m.Start():
                return self._tune(message.frequency, self.limits, State.ARMED)
            case m.SetLoops():
                return self.loops.set(message.gains, self.limits, at_rest=self._at_rest)
            case m.SwitchLoops():
                return self.loops.switch(message.on, faulted=self.state is State.FAULT)
        if self.state is not State.PLAYING:
            return Reason.STATE
        match message:
            case m.SetFrequency():
                return self._tune(message.frequency, self.limits, State.PLAYING)
            case m.Envelope():
                levels = self.limits.levels(message.levels)
                return self.playing.play_envelope(self._now, message.period, levels)
            case m.Position():
                if not self.tile.ready:
                    return Reason.TILE
                self.playing.play_place(message.x)
                return Reason.ACCEPTED
            case m.Follow():
                if not self.tile.ready:
                    return Reason.TILE
                if self.sensor is None:
                    return Reason.VALUE
                self.playing.play_finger()
                return Reason.ACCEPTED
            case m.TimedEnvelope():
                levels, period = self.limits.levels(message.levels), message.period
                return self.playing.play_timed(self._now, self.level, message.start, period, levels)
        return Reason.TYPE  # pragma: no cover - every command is named above

    def _clear(self, fault: int) -> Reason:
        if self.state is not State.FAULT or self.level > 0:
            return Reason.STATE
        if fault != self.fault:
            return Reason.VALUE
        self.state, self.fault = State.OFF, Fault.NONE
        return Reason.ACCEPTED

    @property
    def _at_rest(self) -> bool:
        return self.state is State.OFF and self.level == 0

    def _limit(self, asked: m.SetLimits) -> Reason:
        if not self._at_rest:
            return Reason.STATE
        limits = self.own.narrowed(asked)
        if limits is None:
            return Reason.VALUE
        self.limits = limits
        self.tile = Tile()
        self.loops.drop()
        return Reason.ACCEPTED

    def _arm(self, token: int) -> Reason:
        if not self._at_rest:
            return Reason.STATE
        if token != self.token:
            return Reason.TOKEN
        self.token = next_token(self.token)
        self.state = State.ARMED
        return Reason.ACCEPTED

    def _tune(self, frequency: int, limits: DeviceLimits, wanted: State) -> Reason:
        if self.state is not wanted:
            return Reason.STATE
        if not limits.lowest_frequency <= frequency <= limits.highest_frequency:
            return Reason.VALUE
        self.frequency = frequency
        if self.state is State.ARMED:
            self._ticked, self.state = self._now, State.PLAYING
            if self.loops.on:
                self.loops.begin(anew=False)
        return Reason.ACCEPTED
