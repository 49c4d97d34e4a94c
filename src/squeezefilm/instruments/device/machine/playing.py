"""Playing and reporting of a device: an envelope from now, a timed envelope, or its tile, a
texture of amplitudes (µV) over position (µm), at a place or at the finger.

One at a time; a new one takes the last one's place. Times are the device's 32 bits of µs, which
may wrap, so they are compared by their difference.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from enum import Enum, auto

from squeezefilm.instruments.device.wire.frames import Reason
from squeezefilm.instruments.device.wire.messages import (
    CAME_LATE,
    LONGEST_TILE,
    RAN_DRY,
)

CLOCK = 0xFFFFFFFF
LONGEST_QUEUE = 512
"""Amplitudes of a timed envelope that a device keeps."""
MOST_AHEAD = 1_000_000
"""µs that a timed envelope may begin before or after now; more is a host with a wrong clock."""
SHORTEST_REPORT = 200
"""µs; readings more often than this would fill the wire."""
LONGEST_REPORT = 1_000_000_000
"""µs; 32 bits of µs cannot tell a longer one from one that has passed."""

Finger = tuple[int, int, bool]
"""Position x and y (µm), and whether it touches."""


class Mode(Enum):
    """Kind of output that is played."""

    NOTHING = auto()
    ENVELOPE = auto()
    TIMED = auto()
    PLACE = auto()
    FINGER = auto()


def until(time: int, now: int) -> int:
    """µs from `now` to `time`, negative if it has passed; both 32 bits of µs within 35 min."""
    return ((time - now + 0x80000000) & CLOCK) - 0x80000000


@dataclass(slots=True)
class Tile:
    """A table of amplitudes, read linearly, zero outside; it plays once it is full.

    It is filled in order. Not thread-safe.
    """

    origin: int = 0
    pitch: int = 1
    size: int = 0
    levels: list[int] = field(default_factory=list)

    @property
    def ready(self) -> bool:
        """True where every amplitude has arrived."""
        return self.size > 0 and len(self.levels) == self.size

    def begin(self, origin: int, pitch: int, size: int) -> Reason:
        """A new one, still empty."""
        if pitch == 0 or not 1 <= size <= LONGEST_TILE:
            return Reason.VALUE
        self.origin, self.pitch, self.size, self.levels = origin, pitch, size, []
        return Reason.ACCEPTED

    def fill(self, first: int, count: int, levels: tuple[int, ...] | None) -> Reason:
        """The next `count` amplitudes (µV; None: not within the limits), from number `first`."""
        if first != len(self.levels) or first + count > self.size:
            return Reason.TILE
        if levels is None:
            return Reason.VALUE
        self.levels += levels
        return Reason.ACCEPTED

    def level(self, x: int) -> int:
        """The amplitude (µV) at `x` µm; towards the table's own value where division rounds."""
        along = x - self.origin
        if not self.ready or along < 0:
            return 0
        index, rest = divmod(along, self.pitch)
        if index >= self.size - 1:
            return self.levels[-1] if index == self.size - 1 and rest == 0 else 0
        here, there = self.levels[index], self.levels[index + 1]
        if there >= here:
            return here + (there - here) * rest // self.pitch
        return here - (here - there) * rest // self.pitch


@dataclass(slots=True)
class Reports:
    """A reading every `period` µs, none for 0; `due` is when the next one is. Not thread-safe."""

    period: int = 0
    due: int = 0

    def begin(self, now: int, period: int) -> Reason:
        """Every `period` µs from now on."""
        if period and not SHORTEST_REPORT <= period <= LONGEST_REPORT:
            return Reason.VALUE
        self.period, self.due = period, (now + period) & CLOCK
        return Reason.ACCEPTED

    def take(self, now: int) -> bool:
        """True where one is due now. One that was missed is not made up; the phase is kept."""
        if self.period == 0:
            return False
        late = -until(self.due, now)
        if late < 0:
            return False
        self.due = (self.due + (late // self.period + 1) * self.period) & CLOCK
        return True


@dataclass(slots=True)
class Playing:
    """Output that is played, and the rest of it. Not thread-safe.

    `dry`: a timed envelope's last amplitude was held past its period. `late`: one of its
    amplitudes arrived after its time. Both stay until `take_marks`.
    """

    mode: Mode = Mode.NOTHING
    dry: bool = False
    late: bool = False
    _levels: tuple[int, ...] = ()
    _period: int = 1
    _began: int = 0
    _place: int = 0
    _queue: deque[tuple[int, int]] = field(default_factory=deque)
    _held: int = 0
    _played: int | None = None

    def stop(self) -> None:
        """Play nothing."""
        self.mode = Mode.NOTHING
        self._queue.clear()

    def take_marks(self) -> int:
        """The flags of `dry` and `late` in a reading, which clears them."""
        marks = RAN_DRY * self.dry | CAME_LATE * self.late
        self.dry = self.late = False
        return marks

    def play_envelope(self, now: int, period: int, levels: tuple[int, ...] | None) -> Reason:
        """One amplitude (µV) every `period` µs from now; the last one holds. None for `levels`:
        not within the limits."""
        if levels is None or period == 0:
            return Reason.VALUE
        self.stop()
        self.mode = Mode.ENVELOPE
        self._levels, self._period, self._began = levels, period, now
        return Reason.ACCEPTED

    def play_place(self, x: int) -> None:
        """The tile at `x` µm."""
        self.stop()
        self.mode, self._place = Mode.PLACE, x

    def play_finger(self) -> None:
        """The tile at the device's own sensor."""
        self.stop()
        self.mode = Mode.FINGER

    def play_timed(
        self, now: int, level: int, start: int, period: int, levels: tuple[int, ...] | None
    ) -> Reason:
        """Amplitudes (µV) from `start` on, in place of what was queued from there on.

        `level` is the output now (µV), which holds until the first one is due. Amplitudes at or
        before the newest that was played are left out: nothing is played twice, or backwards.
        """
        if levels is None or period == 0 or abs(until(start, now)) > MOST_AHEAD:
            return Reason.VALUE
        timed = self.mode is Mode.TIMED
        kept = sum(until(time, start) < 0 for time, _ in self._queue) if timed else 0
        played = self._played if timed else None
        new = [((start + i * period) & CLOCK, level) for i, level in enumerate(levels)]
        if played is not None:
            new = [sample for sample in new if until(sample[0], played) > 0]
        if kept + len(new) > LONGEST_QUEUE:
            return Reason.FULL
        if not timed:
            self.stop()
            self.mode, self._held, self._played = Mode.TIMED, level, None
        while len(self._queue) > kept:
            self._queue.pop()
        if new and until(new[0][0], now) < 0:
            self.late = True
        self._queue.extend(new)
        self._period = period
        return Reason.ACCEPTED

    def level(self, now: int, tile: Tile, finger: Finger | None) -> int:
        """The amplitude wanted now (µV)."""
        match self.mode:
            case Mode.ENVELOPE:
                return self._of_envelope(now)
            case Mode.TIMED:
                return self._of_queue(now)
            case Mode.PLACE:
                return tile.level(self._place)
            case Mode.FINGER:
                return tile.level(finger[0]) if finger is not None and finger[2] else 0
        return 0

    def _of_envelope(self, now: int) -> int:
        index = ((now - self._began) & CLOCK) // self._period
        if index >= len(self._levels) - 1:
            # Only the last one is kept, so that the clock may wrap while it holds.
            self._levels = self._levels[-1:]
            return self._levels[0]
        return self._levels[index]

    def _of_queue(self, now: int) -> int:
        queue = self._queue
        while queue and until(queue[0][0], now) <= 0:
            self._played, self._held = queue.popleft()
        if not queue and self._played is not None:
            held = (now - self._played) & CLOCK
            if held >= self._period:
                self.dry = True
            if held > 2 * MOST_AHEAD:
                # No amplitude that old is taken any more; so the clock may wrap while it holds.
                self._played = None
        return self._held
