"""A conversation with a device frame by frame, for checks that must send what no host would send.

`instruments.device.wire.link` is what plays; this sends damaged, stale and refused frames on
purpose and looks at each answer. Time is passed in, so that it also runs on a simulated clock.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Deframer, Frame

if TYPE_CHECKING:
    from squeezefilm.instruments.device.wire.streams import ByteStream

_STEP: si.Second = 0.2e-3


@dataclass(frozen=True, slots=True)
class Heard:
    """A message that came from the device, and when (s, host clock)."""

    time: si.Second
    message: m.Message


@dataclass(slots=True)
class Conversation:
    """Frames to a device and what comes back. Not thread-safe.

    `clock` gives the time (s), `wait` lets some pass (s). `heard` keeps everything that came, in
    order, and `answered` counts statuses by the sequence number they answer.
    """

    stream: ByteStream
    clock: Callable[[], si.Second]
    wait: Callable[[si.Second], None]
    sequence: int = 0
    heard: list[Heard] = field(default_factory=list)
    unknown: int = 0
    _deframer: Deframer = field(default_factory=Deframer)

    @property
    def damaged(self) -> int:
        """Frames from the device that were no frames."""
        return self._deframer.damaged

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
        now, came = self.clock(), []
        for frame in self._deframer.take(self.stream.read()):
            if frame is None:
                continue
            kind = m.ANSWERS.get(frame.type)
            message = None if kind is None else kind.read(frame.payload)
            if message is None:
                self.unknown += 1
            else:
                came.append(Heard(now, message))
        self.heard += came
        return came

    def answer(self, sequence: int, timeout: si.Second = 0.5) -> m.Status | None:
        """The status that answers a sequence number, or None if none comes in time."""
        end = self.clock() + timeout
        while True:
            for heard in self.listen():
                message = heard.message
                if isinstance(message, m.Status) and message.answered_sequence == sequence:
                    return message
            if self.clock() >= end:
                return None
            self.wait(_STEP)

    def ask(self, message: m.Message, timeout: si.Second = 0.5) -> m.Status | None:
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
