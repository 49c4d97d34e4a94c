"""What a device plays: an envelope from now, a timed envelope, the tile at a place or a finger.

One at a time; a new one takes the last one's place. Times are the device's 32 bits of µs, which
may wrap, so they are compared by their difference.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from enum import Enum, auto

from squeezefilm.device.machine.tile import Tile
from squeezefilm.device.wire.states import Reason

CLOCK = 0xFFFFFFFF
LONGEST_QUEUE = 512
"""Amplitudes of a timed envelope that a device keeps."""
MOST_AHEAD = 1_000_000
"""µs that a timed envelope may begin before or after now; more is a host with a wrong clock."""

Finger = tuple[int, int, bool]
"""Position x and y (µm), and whether it touches."""


class Mode(Enum):
    """What is played."""

    NOTHING = auto()
    ENVELOPE = auto()
    TIMED = auto()
    PLACE = auto()
    FINGER = auto()


def until(time: int, now: int) -> int:
    """µs from `now` to `time`, negative if it has passed; both 32 bits of µs within 35 min."""
    return ((time - now + 0x80000000) & CLOCK) - 0x80000000


@dataclass(slots=True)
class Playing:
    """What is played, and what is left of it. Not thread-safe.

    `dry`: a timed envelope's last amplitude was held past its period. `late`: one of its
    amplitudes arrived after its time. Both stay until `forget_marks`.
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

    def forget_marks(self) -> None:
        """Clear `dry` and `late`."""
        self.dry = self.late = False

    def play_envelope(self, now: int, period: int, levels: tuple[int, ...]) -> None:
        """One amplitude (µV) every `period` µs from now; the last one holds."""
        self.stop()
        self.mode = Mode.ENVELOPE
        self._levels, self._period, self._began = levels, period, now

    def play_place(self, x: int) -> None:
        """The tile at `x` µm."""
        self.stop()
        self.mode, self._place = Mode.PLACE, x

    def play_finger(self) -> None:
        """The tile at the device's own sensor."""
        self.stop()
        self.mode = Mode.FINGER

    def play_timed(
        self, now: int, level: int, start: int, period: int, levels: tuple[int, ...]
    ) -> Reason:
        """Amplitudes (µV) from `start` on, in place of what was queued from there on.

        `level` is the output now (µV), which holds until the first one is due. Amplitudes at or
        before the newest that was played are left out: nothing is played twice, or backwards.
        """
        if period == 0 or abs(until(start, now)) > MOST_AHEAD:
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
