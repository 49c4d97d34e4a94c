"""A conversation with a device frame by frame, for checks that must send what no host would send.

`instruments.device.wire.link` is what plays; this sends damaged, stale and refused frames on
purpose and looks at each answer. Time is passed in, so that it also runs on a simulated clock.
What is asked of a device is asked by its own clock: an emulated one may be slow.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si
from squeezefilm.core.drive_limits import WATCHDOG
from squeezefilm.instruments.device.machine.device import LATE_TICK
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Deframer, Fault, Frame, Reason, State

if TYPE_CHECKING:
    from squeezefilm.instruments.device.wire.streams import SerialStream

KEEP_ALIVE: si.Second = 20e-3
"""Between frames that feed the watchdog."""
_STEP: si.Second = 0.2e-3
_ANSWERS_WITHIN: si.Second = 0.5
_SLOWEST: si.Second = 1.0
"""The longest that something is waited for by the device's clock."""


@dataclass(frozen=True, slots=True)
class Heard:
    """A message that came from the device, and when (s, host clock)."""

    time: si.Second
    message: m.Message


@dataclass(slots=True)
class Conversation:
    """Frames to a device and what comes back. Not thread-safe.

    `clock` gives the time (s), `wait` lets some pass (s). `waited` gives the time (s) for which
    programs of this computer have waited for a processor, where the device is one of them; None
    for a device with a processor of its own.
    """

    stream: SerialStream
    clock: Callable[[], si.Second]
    wait: Callable[[si.Second], None]
    waited: Callable[[], si.Second] | None = None
    sequence: int = 0
    unknown: int = 0
    _deframer: Deframer = field(default_factory=Deframer)
    _rest: list[Heard] = field(default_factory=list)
    _looked: si.Second = math.nan
    _silent: si.Second = 0.0
    _before: si.Second = 0.0

    @property
    def damaged(self) -> int:
        """Frames from the device that were no frames."""
        return self._deframer.damaged

    def watch(self) -> None:
        """Forget how long this computer was held up."""
        self._looked, self._silent = math.nan, 0.0
        self._before = self.waited() if self.waited else 0.0

    @property
    def held_up(self) -> si.Second:
        """Time for which this computer, or a device that runs on it, was held up since `watch` (s):
        the longest time in which nobody listened, or all in which programs waited."""
        return max(self._silent, self.waited() - self._before if self.waited else 0.0)

    def excuse(self, said: m.Status | m.Reading | None) -> si.Second:
        """Time for which this computer must have been held up for a device to say nothing, or to
        have stopped by itself (s); 0 where that is no reason."""
        if said is None:
            return _ANSWERS_WITHIN
        if said.state != State.FAULT:
            return 0.0
        late = LATE_TICK * 1e-6 if self.waited else 0.0
        excuses = {Fault.WATCHDOG: WATCHDOG - KEEP_ALIVE, Fault.LATE_TICK: late}
        return excuses.get(Fault(said.fault), 0.0)

    def send(self, message: m.Message, sequence: int | None = None) -> int:
        """Send a message with the next sequence number, or one of its own; returns the number."""
        return self.send_raw(message.TYPE, message.payload(), sequence)

    def send_raw(self, kind: int, payload: bytes, sequence: int | None = None) -> int:
        """Send any payload, also one that no message would carry."""
        if sequence is None:
            self.sequence = sequence = (self.sequence + 1) & 0xFFFF
        self.stream.write(Frame(kind, sequence, payload).encoded())
        return sequence

    def listen(self) -> list[Heard]:
        """Take what has arrived."""
        now = self.clock()
        came, self._rest = self._rest, []
        if now - self._looked > self._silent:
            self._silent = now - self._looked
        self._looked = now
        for frame in self._deframer.take(self.stream.read()):
            if frame is None:
                continue
            kind = m.ANSWERS.get(frame.type)
            message = None if kind is None else kind.read(frame.payload)
            if message is None:
                self.unknown += 1
            else:
                came.append(Heard(now, message))
        return came

    def answer(self, sequence: int, timeout: si.Second = _ANSWERS_WITHIN) -> m.Status | None:
        """The status that answers a sequence number, or None if none comes in time; what came
        after it waits for `listen`."""
        end = self.clock() + timeout
        while True:
            # Looked at before listening: what has arrived in time is heard, however late.
            late = self.clock() >= end
            came = self.listen()
            for number, heard in enumerate(came):
                message = heard.message
                if isinstance(message, m.Status) and message.answered_sequence == sequence:
                    self._rest = came[number + 1 :]
                    return message
            if late:
                return None
            self.wait(_STEP)

    def ask(self, message: m.Message, timeout: si.Second = _ANSWERS_WITHIN) -> m.Status | None:
        """Send a message and wait for its answer; None if none comes."""
        return self.answer(self.send(message), timeout)

    def listen_for(self, duration: si.Second, keep_alive: si.Second = math.inf) -> list[Heard]:
        """Frames that come within a time (s), feeding the watchdog every `keep_alive` (s)."""
        start = self.clock()
        came: list[Heard] = []
        fed = start
        while (now := self.clock()) < start + duration:
            if now - fed >= keep_alive:
                self.send(m.KeepAlive())
                fed = now
            came += self.listen()
            self.wait(_STEP)
        return came + self.listen()

    def readings(self, enough: Callable[[m.Reading], bool]) -> list[m.Reading]:
        """Readings up to one that is `enough`, in silence; those of a second without one."""
        end, came = self.clock() + _SLOWEST, []
        while True:
            late = self.clock() >= end
            for heard in self.listen():
                if isinstance(heard.message, m.Reading):
                    came.append(heard.message)
                    if enough(heard.message):
                        return came
            if late:
                return came
            self.wait(_STEP)

    def ask_until(self, enough: Callable[[m.Status], bool]) -> m.Status | None:
        """A status that is `enough`, asked for again and again for a second; else the last."""
        end = self.clock() + _SLOWEST
        while True:
            late, status = self.clock() >= end, self.ask(m.KeepAlive())
            if status is None or enough(status) or late:
                return status

    def arm(self) -> None:
        """Arm the device as soon as its output is at zero."""
        status = self.ask_until(lambda status: status.level == 0)
        if status is not None:
            self.ask(m.Arm(status.token))

    def start(self, frequency: si.Hertz) -> None:
        """Begin to play in silence at a frequency (Hz)."""
        self.ask(m.Start(round(frequency * 1e3)))

    def clear(self) -> bool:
        """Clear whatever fault the device has; returns whether it is then OFF."""
        status = self.ask_until(lambda status: status.level == 0)
        if status is None:
            return False
        status = self.ask(m.ClearFault(status.fault))
        accepted = status is not None and status.reason == Reason.ACCEPTED
        return accepted and status is not None and status.state == State.OFF
