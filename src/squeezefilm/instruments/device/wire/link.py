"""The host's side of the wire: numbers frames, matches answers, and by them knows the device's
clock; counts what went wrong.

Not thread-safe: one thread owns a link and all that is built on it. Nothing waits but `request`.
Answers may come late, out of order, twice or never. A status is matched by the number of the frame
it answers; what comes twice is dropped by the device's own count; a reading older than one that
was handed out is dropped.
"""

from __future__ import annotations

import math
import time
from collections import OrderedDict, deque
from collections.abc import Callable
from dataclasses import dataclass

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import DeviceError, RefusedError
from squeezefilm.instruments.device.machine.playing import CLOCK, until
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Deframer, Fault, Frame, Reason, State
from squeezefilm.instruments.device.wire.streams import SerialStream

WORST_DRIFT: si.Dimensionless = 200e-6
"""Relative rate between the clocks that is allowed for; a quartz has below 100e-6."""
# The device counts whole µs: bounds may cross by that much and contradict nothing.
_RESOLUTION: si.Second = 2e-6


@dataclass(slots=True)
class DeviceClock:
    """Estimate of the offset host − device: 32 bits of µs that wrap, against seconds.

    A status says when the device answered; that was after the host sent the frame and before it
    heard the answer. Each round trip so bounds the offset from both sides (the method of NTP, RFC
    5905 §8, without its assumption that both ways take equally long: that is only the middle of
    the bounds). A reading bounds it from one side. Bounds loosen with time, as quartzes drift.

    Times of the device are unwrapped: seconds since the first message, on from the device's own
    clock then. They may come out of order by less than 35 minutes.
    """

    lowest: si.Second = -math.inf
    highest: si.Second = math.inf
    _unwrapped: int = 0
    _last: int | None = None
    _widened: si.Second = -math.inf

    @property
    def known(self) -> bool:
        """True where a round trip has been seen."""
        return math.isfinite(self.lowest) and math.isfinite(self.highest)

    @property
    def error(self) -> si.Second:
        """Largest error of the offset (s); infinite before a round trip."""
        return (self.highest - self.lowest) / 2

    @property
    def offset(self) -> si.Second:
        """Host minus device (s), the middle of its bounds; not finite before a round trip."""
        return (self.highest + self.lowest) / 2

    def unwrapped(self, device: int) -> si.Second:
        """The device's time (s) of a stamp (µs, 32 bits), which never wraps."""
        last = self._last
        self._unwrapped = device if last is None else self._unwrapped + until(device, last)
        self._last = device
        return self._unwrapped * 1e-6

    def answered(self, sent: si.Second, device: int, heard: si.Second) -> None:
        """A frame sent at `sent` (s) was answered at `device` (µs); heard at `heard` (s)."""
        self.heard(device, heard)
        at = self._unwrapped * 1e-6
        self.lowest = max(self.lowest, sent - at)
        if self.highest < self.lowest <= self.highest + _RESOLUTION:
            self.lowest = self.highest
        if self.lowest > self.highest:
            # The clocks drift faster than allowed, or one was set: believe the newest alone.
            self.lowest, self.highest = sent - at, heard - at

    def heard(self, device: int, heard: si.Second) -> None:
        """A message stamped `device` (µs) was heard at `heard` (s)."""
        at = self.unwrapped(device)
        if heard > self._widened:
            if math.isfinite(self._widened):
                drift = WORST_DRIFT * (heard - self._widened)
                self.lowest, self.highest = self.lowest - drift, self.highest + drift
            self._widened = heard
        self.highest = min(self.highest, heard - at)
        if self.lowest > self.highest + _RESOLUTION:
            self.lowest = -math.inf
        self.lowest = min(self.lowest, self.highest)

    def device_time(self, host: si.Second) -> si.Second:
        """The device's unwrapped time (s) at a time of the host (s)."""
        return host - self.offset

    def stamp(self, device: si.Second) -> int:
        """The 32 bits of µs of an unwrapped time of the device (s)."""
        return round(device * 1e6) & CLOCK


KEEP_ALIVE_PERIOD: si.Second = 15e-3
"""Silence of the host after which a keep alive is due; the watchdog waits 50 ms."""
ANSWER_LIMIT: si.Second = 1.0
"""After which an answer counts as lost."""
TIMEOUT: si.Second = 1.0
ATTEMPTS = 8
_PAUSE: si.Second = 0.2e-3

WORDS: dict[Reason, str] = {
    Reason.ACCEPTED: "it was accepted",
    Reason.VERSION: "the device speaks another version of the protocol; update its firmware",
    Reason.TYPE: "the device does not know this command; update its firmware",
    Reason.LENGTH: "the payload has the wrong length; update its firmware",
    Reason.SEQUENCE: "the frame is old, doubled, or no session is open; open the device again",
    Reason.STATE: "the device's state does not allow it; look at the order of commands",
    Reason.VALUE: "a value is outside the device's limits; lower it, or set other limits",
    Reason.TOKEN: "the arming token is stale; read a status and arm again",
    Reason.NO_LIMITS: "no limits are set; open the device with limits first",
    Reason.TILE: "no complete tile is loaded, or its parts came out of order; load it again",
    Reason.FULL: "the device's queue is full; send later",
    Reason.NO_LOOPS: "the device has no loops, or no gains for them; set those first",
}
"""Why a frame was refused, and what to do."""
_GOALS: dict[type[m.Message], State] = {
    m.Arm: State.ARMED,
    m.Start: State.PLAYING,
    m.ClearFault: State.OFF,
}
"""Commands that may not be sent twice, and the state that shows that one has worked."""
_REMEMBERED = 256
"""The device's frames among which one that comes twice is known."""


@dataclass(slots=True)
class LinkStatistics:
    """Counts since the link was made; round trips in s, NaN before the first.

    `sent` frames, `answered`, `lost` (no answer within a second), `refused`, `repeated` (sent
    again), `damaged` and `unknown` (came, but no message), `doubled`, `stale` (readings overtaken
    by newer ones), `missed` (the device's frames that never came, by its own count).
    """

    sent: int = 0
    answered: int = 0
    lost: int = 0
    refused: int = 0
    repeated: int = 0
    damaged: int = 0
    unknown: int = 0
    doubled: int = 0
    stale: int = 0
    missed: int = 0
    readings: int = 0
    shortest_round_trip: si.Second = math.nan
    mean_round_trip: si.Second = math.nan
    longest_round_trip: si.Second = math.nan

    def count_round_trip(self, duration: si.Second) -> None:
        """One more answer, after `duration` (s)."""
        self.answered += 1
        if self.answered == 1:
            self.shortest_round_trip = self.longest_round_trip = self.mean_round_trip = duration
        self.shortest_round_trip = min(self.shortest_round_trip, duration)
        self.longest_round_trip = max(self.longest_round_trip, duration)
        self.mean_round_trip += (duration - self.mean_round_trip) / self.answered


class Link:
    """Messages over a stream. See the module for what it survives.

    Args:
        stream: the bytes.
        clock: the host's time (s), which never falls.
        wait: lets time pass (s); only `request` calls it.
    """

    def __init__(
        self,
        stream: SerialStream,
        clock: Callable[[], si.Second] = time.monotonic,
        wait: Callable[[si.Second], None] = time.sleep,
    ) -> None:
        self.stream, self.clock, self.wait = stream, clock, wait
        self.device_clock = DeviceClock()
        self.status: m.Status | None = None
        self.refusals: deque[tuple[str, m.Status]] = deque(maxlen=100)
        self._statistics = LinkStatistics()
        self._deframer = Deframer()
        self._sequence = 0
        self._asked: dict[int, tuple[si.Second, str]] = {}
        self._sent_at = -math.inf
        self._heard: int | None = None
        self._recent: OrderedDict[int, bytes] = OrderedDict()
        self._newest_reading: int | None = None
        self._unpolled: list[m.Answer] = []

    @property
    def statistics(self) -> LinkStatistics:
        """Numbers of frames sent, answered, lost and damaged up to now."""
        self._statistics.damaged = self._deframer.damaged
        return self._statistics

    def drop(self) -> None:
        """Forget what has arrived, which another program may have asked for, and the clock."""
        while self.stream.read():
            continue
        self._deframer = Deframer(self._deframer.damaged)
        self._recent.clear()
        self._unpolled.clear()
        self.refusals.clear()
        self._heard = self._newest_reading = self.status = None
        self.device_clock = DeviceClock()

    def send(self, message: m.Message) -> int:
        """Send a message; returns its sequence number. Its status comes by `poll`.

        Raises:
            InputError: a message that its layout cannot carry; nothing is sent.
            DeviceError: a stream that is gone.
        """
        sequence = (self._sequence + 1) & 0xFFFF
        data = message.frame(sequence).encoded()
        self._sequence = sequence
        # Before writing: the device cannot have it earlier.
        self._sent_at = self.clock()
        self.stream.write(data)
        self._asked[sequence] = (self._sent_at, type(message).__name__)
        self._statistics.sent += 1
        return sequence

    def keep_alive(self, period: si.Second = KEEP_ALIVE_PERIOD) -> None:
        """Send a keep alive if nothing was sent for `period` (s)."""
        if self.clock() - self._sent_at >= period:
            self.send(m.KeepAlive())

    def poll(self) -> list[m.Answer]:
        """Messages since the last call, in order. Raises `DeviceError` if the stream is gone."""
        self._hear()
        came, self._unpolled = self._unpolled, []
        return came

    def request(self, message: m.Message, timeout: si.Second = TIMEOUT) -> m.Status:
        """Send a message and wait for its status; the watchdog is fed meanwhile.

        Without an answer it is sent again, with a new number, up to 8 times in all. What must not
        be done twice (arm, start, clear fault) is sent again only where the device's state shows
        that it did not arrive; the device itself refuses tile data that it has. What else comes
        meanwhile waits for `poll`.

        Raises:
            RefusedError: the device refused it; carries its reason.
            DeviceError: it did not answer in time; the message says which command and why.
            InputError: a message that its layout cannot carry.
        """
        name = type(message).__name__
        each = timeout / ATTEMPTS
        overtaken: m.Status | None = None
        for attempt in range(ATTEMPTS):
            if attempt:
                self._statistics.repeated += 1
                goal = _GOALS.get(type(message))
                if goal is not None:
                    seen = self._answer(self.send(m.KeepAlive()), each)
                    if seen is None:
                        continue
                    if seen.state == goal:
                        return seen
            status = self._answer(self.send(message), each)
            # A frame that a later one overtook is old for the device: it did nothing.
            if status is None or status.reason == Reason.SEQUENCE:
                overtaken = status
                continue
            # A part of a tile does not fit behind itself: the first one had arrived.
            there = attempt > 0 and isinstance(message, m.TileData) and status.reason == Reason.TILE
            if status.reason != Reason.ACCEPTED and not there:
                raise refusal(name, status)
            return status
        if overtaken is not None:
            raise refusal(name, overtaken)
        raise DeviceError(
            f"the device did not answer {name} within {timeout:g} s ({ATTEMPTS} sent); look at its "
            "power and its cable, and whether the port is the right one"
        )

    def _answer(self, sequence: int, timeout: si.Second) -> m.Status | None:
        end = self.clock() + timeout
        while True:
            for status in self._hear():
                if status.answered_sequence == sequence:
                    return status
            if self.clock() >= end:
                return None
            if self.status is not None:
                self.keep_alive()
            self.wait(_PAUSE)

    def _hear(self) -> list[m.Status]:
        """Take what has arrived; returns the statuses among it."""
        data = self.stream.read()
        # Read first, then the clock: else what comes between would seem to come too early, and
        # the bounds on the device's clock would contradict each other.
        now, statuses = self.clock(), []
        for frame in self._deframer.take(data):
            if frame is None or self._doubled(frame):
                continue
            kind = m.ANSWERS.get(frame.type)
            message = None if kind is None else kind.read(frame.payload)
            if message is None:
                self._statistics.unknown += 1
            elif isinstance(message, m.Status):
                self._take_status(message, now)
                statuses.append(message)
                self._unpolled.append(message)
            elif not isinstance(message, m.Reading) or self._take_reading(message, now):
                self._unpolled.append(message)
        for sequence, (sent, _) in list(self._asked.items()):
            if now - sent <= ANSWER_LIMIT:
                break
            del self._asked[sequence]
            self._statistics.lost += 1
        return statuses

    def _doubled(self, frame: Frame) -> bool:
        """True where a device's frame came before, by its number; counts those that never came."""
        if self._recent.get(frame.sequence) == frame.payload:
            self._statistics.doubled += 1
            return True
        self._recent[frame.sequence] = frame.payload
        if len(self._recent) > _REMEMBERED:
            self._recent.popitem(last=False)
        if self._heard is not None:
            ahead = (frame.sequence - self._heard) & 0xFFFF
            if ahead >= 0x8000:
                self._statistics.missed -= 1  # counted when a later one overtook it
                return False
            self._statistics.missed += ahead - 1
        self._heard = frame.sequence
        return False

    def _take_status(self, status: m.Status, now: si.Second) -> None:
        # By the host's own numbers: the device's clock falls where it was restarted.
        ahead = 0
        if self.status is not None:
            ahead = (status.answered_sequence - self.status.answered_sequence) & 0xFFFF
        if ahead < 0x8000:
            self.status = status
        sent, name = self._asked.pop(status.answered_sequence, (None, "a frame"))
        if sent is not None:
            self._statistics.count_round_trip(now - sent)
            self.device_clock.answered(sent, status.time, now)
        if status.reason != Reason.ACCEPTED:
            self._statistics.refused += 1
            self.refusals.append((name, status))

    def _take_reading(self, reading: m.Reading, now: si.Second) -> bool:
        newest = self._newest_reading
        if newest is not None and until(reading.time, newest) <= 0:
            self._statistics.stale += 1
            return False
        self._newest_reading = reading.time
        self._statistics.readings += 1
        self.device_clock.heard(reading.time, now)
        return True


def refusal(name: str, status: m.Status) -> RefusedError:
    """The error of a refused command: which one, why, and the device's state."""
    try:
        why = WORDS[Reason(status.reason)]
    except ValueError:
        why = f"reason {status.reason}, which this program does not know; update it"
    state = State(status.state).name if status.state <= State.FAULT else str(status.state)
    if status.state == State.FAULT and status.fault <= Fault.TRIPPED:
        state += f" ({Fault(status.fault).name.lower().replace('_', ' ')})"
    told = f"the device refused {name} in state {state}: {why}"
    return RefusedError(told, reason=status.reason)
