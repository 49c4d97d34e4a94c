"""What a conversation hears in time, what it holds back, and what it excuses."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.core.drive_limits import WATCHDOG
from squeezefilm.instruments.bench.conversation import KEEP_ALIVE, Conversation
from squeezefilm.instruments.device.machine.device import LATE_TICK
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Fault, State


class Stream:
    """A device that says what it was given to say."""

    def __init__(self) -> None:
        self.said = b""
        self.written: list[bytes] = []

    def read(self) -> bytes:
        """What it says, once."""
        said, self.said = self.said, b""
        return said

    def write(self, data: bytes) -> None:
        """Keep it."""
        self.written.append(data)


def never(_: float) -> None:
    raise AssertionError("nothing is waited for")


def test_a_time_of_nothing_is_one_look() -> None:
    talk = Conversation(Stream(), lambda: 3.0, never)
    assert talk.answer(5, 0.0) is None


def test_an_answer_that_does_not_come_is_waited_for_as_long_as_was_said() -> None:
    now = 0.0

    def wait(duration: float) -> None:
        nonlocal now
        now += duration

    talk = Conversation(Stream(), lambda: now, wait)
    assert talk.ask(m.Stop(), 0.25) is None
    assert 0.25 <= now < 0.26
    stream: Any = talk.stream
    (sent,) = stream.written
    assert sent == m.Stop().frame(1).encoded()


def test_nobody_is_held_up_who_listens_often() -> None:
    times = iter([0.0, 0.1, 0.5, 0.6])
    waited = iter([2.0, 2.25])
    talk = Conversation(Stream(), lambda: next(times), never, lambda: next(waited))
    talk.watch()
    for _ in range(4):
        talk.listen()
    # The longest silence is 0.4 s, all that programs waited 0.25 s.
    assert talk.held_up == pytest.approx(0.4)
    alone = Conversation(Stream(), lambda: 0.0, never)
    alone.watch()
    alone.listen()
    assert alone.held_up == 0.0


@pytest.mark.parametrize(
    ("state", "fault", "here", "excused"),
    [
        (State.OFF, Fault.WATCHDOG, True, 0.0),
        # Fed every 20 ms, a watchdog of 50 ms leaves 30.
        (State.FAULT, Fault.WATCHDOG, False, WATCHDOG - KEEP_ALIVE),
        # Only a device that runs on this computer is late because of it.
        (State.FAULT, Fault.LATE_TICK, True, LATE_TICK * 1e-6),
        (State.FAULT, Fault.LATE_TICK, False, 0.0),
        (
            State.FAULT,
            next(f for f in Fault if f not in (Fault.WATCHDOG, Fault.LATE_TICK)),
            True,
            0,
        ),
    ],
)
def test_a_stop_is_excused_by_what_a_busy_computer_does(
    state: State, fault: Fault, here: bool, excused: float
) -> None:
    talk = Conversation(Stream(), lambda: 0.0, never, (lambda: 0.0) if here else None)
    said: Any = SimpleNamespace(state=state, fault=fault.value)
    assert talk.excuse(said) == pytest.approx(excused, abs=1e-12)
    assert talk.excuse(None) == 0.5
