"""The state machine of a device: OFF → ARMED → PLAYING, and FAULT, which is latched.

The twin of `firmware/squeezefilm_fw.c`, rule by rule and number by number: integers throughout
(µs, µV, mHz, µm), and a clock that is passed in, 32 bits of µs that may wrap. It boots off.
`docs/protocol.md` states the rules.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum

from squeezefilm.device import messages as m
from squeezefilm.device.frames import VERSION, Deframer, Frame
from squeezefilm.device.loads import Loads
from squeezefilm.device.tile import Tile

CLOCK = 0xFFFFFFFF
SILENCE = 50_000
"""µs without an accepted frame after which an armed device faults."""
LATE_TICK = 10_000
"""µs between ticks above which an armed device faults: it cannot vouch for its output."""
LONGEST_RISE = 1_000
"""µs of slew that one tick may rise by, so that a late tick makes no jump."""
RAMP = 10_000
TOUCH_LEVEL = 42_000_000
HIGHEST_LEVEL = 2_000_000_000
NO_LEVEL = -1
_SEED = 0x9E3779B9


class State(IntEnum):
    """What the device is doing."""

    OFF = 0
    ARMED = 1
    PLAYING = 2
    FAULT = 3


class Fault(IntEnum):
    """Why it faulted."""

    NONE = 0
    WATCHDOG = 1
    HEAT = 2
    DUTY = 3
    LATE_TICK = 4
    TRIPPED = 5


class Reason(IntEnum):
    """What became of a frame."""

    ACCEPTED = 0
    VERSION = 1
    TYPE = 2
    LENGTH = 3
    SEQUENCE = 4
    STATE = 5
    VALUE = 6
    TOKEN = 7
    NO_LIMITS = 8
    TILE = 9


@dataclass(frozen=True, slots=True)
class DeviceLimits:
    """Limits as the device holds them: µV, V/s (= µV/µs), µV, V²·ms, mHz, permille, ms.

    The defaults are the most the wire can ask for; a firmware's own are set for its amplifier.
    """

    voltage: int = HIGHEST_LEVEL
    slew: int = 1_000_000_000
    continuous_voltage: int = HIGHEST_LEVEL
    heat: int = 4_000_000_000
    lowest_frequency: int = 1_000
    highest_frequency: int = 1_000_000_000
    duty: int = 1000
    duty_window: int = 3_600_000


def level_of(volts: float) -> int:
    """µV of a binary32 in V, to the nearest; `NO_LEVEL` if NaN, negative or above 2000 V."""
    if not 0 <= volts <= HIGHEST_LEVEL / 1e6:
        return NO_LEVEL
    # 24 bits times 10⁶ is exact in binary64, so C and Python cut the same number.
    return int(volts * 1e6 + 0.5)


def next_token(token: int) -> int:
    """The arming token after `token` (xorshift32, Marsaglia 2003): a guard against replays."""
    token ^= (token << 13) & CLOCK
    token ^= token >> 17
    return token ^ ((token << 5) & CLOCK)


@dataclass(slots=True)
class Machine:
    """One device. Give it bytes and the time; it gives answers and its output. Not thread-safe.

    `seed` is where its tokens start (a device takes a random number); `own` are the firmware's
    limits, which no message passes.
    """

    seed: int = 1
    own: DeviceLimits = field(default_factory=DeviceLimits)
    state: State = State.OFF
    fault: Fault = Fault.NONE
    level: int = 0
    frequency: int = 0
    limits: DeviceLimits | None = None
    loads: Loads = field(default_factory=Loads)
    tile: Tile = field(default_factory=Tile)
    accepted: int = 0
    refused: int = 0
    token: int = 0
    session: int = 0
    _deframer: Deframer = field(default_factory=Deframer)
    _now: int = 0
    _heard: int = 0
    _opened: bool = False
    _last: int = 0
    _sent: int = 0
    _envelope: tuple[int, ...] = ()
    _period: int = 1
    _began: int = 0
    _at: int | None = None

    def __post_init__(self) -> None:
        self.token = (self.seed & CLOCK) or _SEED

    @property
    def damaged(self) -> int:
        """How many frames were no frames."""
        return self._deframer.damaged

    @property
    def enabled(self) -> bool:
        """Whether the amplifier's enable line is held."""
        return self.state in (State.ARMED, State.PLAYING) or self.level > 0

    def receive(self, data: bytes, now: int) -> bytes:
        """Take bytes that arrived at `now` (µs); returns the answers' bytes."""
        answers = bytearray()
        for frame in self._deframer.take(data):
            self.tick(now)
            if frame is not None:
                answers += self._answer(frame)
        return bytes(answers)

    def trip(self) -> None:
        """The amplifier's fault line or an opened enable line: FAULT, latched, from any state."""
        self._fail(Fault.TRIPPED)

    def tick(self, now: int) -> int:
        """Advance to `now` (µs); returns the output (µV). To be called at least every 1 ms."""
        elapsed = (now - self._now) & CLOCK
        self._now = now & CLOCK
        if elapsed == 0 or self.limits is None:
            return self.level
        limits = self.limits
        # The output was held since the last tick: count that, then move.
        self.loads.count(self.level, elapsed, limits.continuous_voltage, limits.duty)
        falling = elapsed
        if self.state in (State.ARMED, State.PLAYING):
            silent = (self._now - self._heard) & CLOCK
            if silent > SILENCE:
                # The ramp counts from the deadline, not from the tick that noticed it.
                falling = min(elapsed, silent - SILENCE)
                self._fail(Fault.WATCHDOG)
            elif elapsed > LATE_TICK:
                falling = 0
                self._fail(Fault.LATE_TICK)
            elif self.state is State.PLAYING:
                if self.loads.heat > limits.heat * 1_000_000_000:
                    self._fail(Fault.HEAT)
                elif self.loads.used > limits.duty * limits.duty_window * 1000:
                    self._fail(Fault.DUTY)
        target = self._wanted() if self.state is State.PLAYING else 0
        if target > self.level:
            rise = limits.slew * min(elapsed, LONGEST_RISE)
            self.level = min(target, self.level + rise)
        else:
            self.level = max(target, self.level - limits.slew * falling)
        return self.level

    def _wanted(self) -> int:
        if self._at is not None:
            return self.tile.level(self._at)
        if not self._envelope:
            return 0
        index = ((self._now - self._began) & CLOCK) // self._period
        if index >= len(self._envelope) - 1:
            # Only the last one is kept, so that the clock may wrap while it holds.
            self._envelope = self._envelope[-1:]
            return self._envelope[0]
        return self._envelope[index]

    def _fail(self, fault: Fault) -> None:
        if self.state is not State.FAULT:
            self.state, self.fault = State.FAULT, fault
            self._forget_playing()

    def _forget_playing(self) -> None:
        self._envelope, self._at = (), None

    def _answer(self, frame: Frame) -> bytes:
        reason = self._take(frame)
        if reason is Reason.ACCEPTED:
            self.accepted = (self.accepted + 1) & CLOCK
            self._heard = self._now
        else:
            self.refused = (self.refused + 1) & CLOCK
        status = m.Status(
            frame.sequence, reason, self.state, self.fault, 0, self.token, self.level,
            self.accepted, self.refused, self.damaged & CLOCK, self.session,
        )  # fmt: skip
        self._sent = (self._sent + 1) & 0xFFFF
        return status.frame(self._sent).encoded()

    def _take(self, frame: Frame) -> Reason:
        if frame.version != VERSION:
            return Reason.VERSION
        kind = m.COMMANDS.get(frame.type)
        if kind is None:
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
        return Reason.ACCEPTED

    def _stop(self) -> Reason:
        if self.state is not State.FAULT:
            self.state = State.OFF
            self._forget_playing()
        return Reason.ACCEPTED

    def _obey(self, message: m.Message) -> Reason:
        match message:
            case m.KeepAlive():
                return Reason.ACCEPTED
            case m.ClearFault():
                return self._clear(message.fault)
            case m.SetLimits():
                return self._limit(message)
        if self.limits is None:
            return Reason.NO_LIMITS
        match message:
            case m.Arm():
                return self._arm(message.token)
            case m.TileBegin():
                return self._begin_tile(message)
            case m.TileData():
                return self._fill_tile(message, self.limits)
            case m.Start():
                return self._tune(message.frequency, self.limits, State.ARMED)
        if self.state is not State.PLAYING:
            return Reason.STATE
        match message:
            case m.SetFrequency():
                return self._tune(message.frequency, self.limits, State.PLAYING)
            case m.Envelope():
                return self._play(message, self.limits)
            case m.Position():
                if not self.tile.ready:
                    return Reason.TILE
                self._forget_playing()
                self._at = message.x
                return Reason.ACCEPTED
        return Reason.TYPE  # pragma: no cover - every command is named above

    def _clear(self, fault: int) -> Reason:
        if self.state is not State.FAULT or self.level > 0:
            return Reason.STATE
        if fault != self.fault:
            return Reason.VALUE
        self.state, self.fault = State.OFF, Fault.NONE
        return Reason.ACCEPTED

    def _limit(self, asked: m.SetLimits) -> Reason:
        if self.state is not State.OFF or self.level > 0:
            return Reason.STATE
        voltage, continuous = level_of(asked.voltage), level_of(asked.continuous_voltage)
        own = self.own
        good = (
            0 < voltage <= own.voltage
            and 0 <= continuous <= min(voltage, own.continuous_voltage)
            and asked.slew <= own.slew
            and asked.slew * RAMP >= voltage
            and asked.heat <= own.heat
            and own.lowest_frequency <= asked.lowest_frequency <= asked.highest_frequency
            and asked.highest_frequency <= own.highest_frequency
            and 1 <= asked.duty <= own.duty
            and 1 <= asked.duty_window <= own.duty_window
            and asked.insulated <= 1
            and (voltage <= TOUCH_LEVEL or asked.insulated == 1)
        )
        if not good:
            return Reason.VALUE
        self.limits = DeviceLimits(
            voltage, asked.slew, continuous, asked.heat, asked.lowest_frequency,
            asked.highest_frequency, asked.duty, asked.duty_window,
        )  # fmt: skip
        self.tile = Tile()
        return Reason.ACCEPTED

    def _arm(self, token: int) -> Reason:
        if self.state is not State.OFF or self.level > 0:
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
        self.frequency, self.state = frequency, State.PLAYING
        return Reason.ACCEPTED

    def _play(self, message: m.Envelope, limits: DeviceLimits) -> Reason:
        levels = _levels(message.levels, limits)
        if levels is None or message.period == 0:
            return Reason.VALUE
        self._envelope, self._period, self._began = levels, message.period, self._now
        self._at = None
        return Reason.ACCEPTED

    def _begin_tile(self, message: m.TileBegin) -> Reason:
        if self.state is State.FAULT:
            return Reason.STATE
        if message.pitch == 0 or not 1 <= message.size <= m.LONGEST_TILE:
            return Reason.VALUE
        self.tile = Tile(message.origin, message.pitch, message.size)
        return Reason.ACCEPTED

    def _fill_tile(self, message: m.TileData, limits: DeviceLimits) -> Reason:
        if self.state is State.FAULT:
            return Reason.STATE
        filled = len(self.tile.levels)
        if message.first != filled or filled + len(message.levels) > self.tile.size:
            return Reason.TILE
        levels = _levels(message.levels, limits)
        if levels is None:
            return Reason.VALUE
        self.tile.levels += levels
        return Reason.ACCEPTED


def _levels(volts: tuple[float, ...], limits: DeviceLimits) -> tuple[int, ...] | None:
    """µV of every amplitude, or None if any is outside the limits: one bad one refuses all."""
    levels = tuple(level_of(volt) for volt in volts)
    if all(0 <= level <= limits.voltage for level in levels):
        return levels
    return None
