"""What a study's device says to the process that plays, and what it makes of each answer.

Nothing is played: both ends of the pipe and the process are made up.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.conduct import played_device
from squeezefilm.study.conduct.played_device import (
    START_LIMIT,
    STOP_LIMIT,
    SessionDevice,
    require_study_drive,
)
from squeezefilm.study.conduct.playing_process import WorkerOrders, serve
from squeezefilm.study.conduct.study_device import DeviceVerification, TrialMotion

GRATING = Stimulus("4 mm", 4e-3, "period")
FELT = TrialMotion(0.1, 0.08, trace="time_s\n0\n", raw_trace="a.sqft")


class Pipe:
    """One end of a pipe: it keeps what is sent, and answers what it was given to say."""

    def __init__(self, *answers: Any) -> None:
        self.answers = list(answers)
        self.sent: list[tuple[Any, ...]] = []
        self.waited: list[float] = []
        self.broken = self.closed = False

    def send(self, order: tuple[Any, ...]) -> None:
        """Keep it."""
        if self.broken:
            raise BrokenPipeError("nobody reads")
        self.sent.append(order)

    def poll(self, limit: float) -> bool:
        """Whether there is another answer."""
        self.waited.append(limit)
        return bool(self.answers)

    def recv(self) -> Any:
        """The next answer."""
        answer = self.answers.pop(0)
        if isinstance(answer, BaseException):
            raise answer
        return answer

    def close(self) -> None:
        """Keep that it was."""
        self.closed = True


class Process:
    """A process that never was, and ends when it is asked to, or only when it is killed."""

    stubborn = False

    def __init__(self, *, target: object, args: tuple[Any, ...], daemon: bool) -> None:
        self.target, self.args, self.daemon = target, args, daemon
        self.alive = self.killed = False
        self.joined: list[float | None] = []

    def start(self) -> None:
        """Alive."""
        self.alive = True

    def is_alive(self) -> bool:
        """As said."""
        return self.alive

    def join(self, limit: float | None = None) -> None:
        """It ends, unless it is stubborn."""
        self.joined.append(limit)
        self.alive = self.alive and self.stubborn

    def kill(self) -> None:
        """It ends."""
        self.killed, self.alive = True, False


class Context:
    """What `multiprocessing` gives: one pipe after another of those prepared."""

    def __init__(self, *pipes: Pipe) -> None:
        self.pipes, self.theirs = list(pipes), [Pipe() for _ in pipes]
        self.made: list[Process] = []

    def Pipe(self) -> tuple[Pipe, Pipe]:
        """The next one, and its other end."""
        return self.pipes[len(self.made)], self.theirs[len(self.made)]

    def Process(self, **how: Any) -> Process:
        """One more."""
        self.made.append(Process(**how))
        return self.made[-1]


Playing = Callable[..., tuple[SessionDevice, Context]]


@pytest.fixture
def playing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Playing:
    """A device on a made-up port whose processes answer as the pipes given do."""

    def made(*pipes: Pipe, **how: Any) -> tuple[SessionDevice, Context]:
        context = Context(*pipes)
        ways: list[str] = []
        monkeypatch.setattr(
            played_device.multiprocessing,
            "get_context",
            lambda way: (ways.append(way), context)[1] if way == "spawn" else None,
        )
        orders = WorkerOrders("biet2008-plate", "serial:/dev/ttyACM0", tmp_path, **how)
        return SessionDevice(orders), context

    return made


def test_a_port_of_one_letter_is_a_port_and_a_long_drive_is_quoted_in_part() -> None:
    require_study_drive("serial:a", "biet2008-plate")
    with pytest.raises(InputError) as refused:
        require_study_drive("serial" * 50, "biet2008-plate")
    assert refused.value.quantity == "drive"
    assert f"'{('serial' * 50)[:80]}'" in str(refused.value)


def test_a_surface_is_presented_felt_and_stopped(playing: Playing, tmp_path: Path) -> None:
    pipe = Pipe(
        ("playing", 1.0), ("ended", "", FELT), ("playing", 1.0), ("ended", "", TrialMotion())
    )
    device, context = playing(pipe, amplitude_per_pickup=2e-6, rate=4e3, stroke="0.08 m")
    assert not device.presenting
    device.present(GRATING, 11)
    assert device.presenting
    (process,) = context.made
    assert process.target is serve
    assert process.daemon
    assert process.alive
    theirs, orders = process.args
    # The other end is the process's alone, so that a process that is gone breaks the pipe.
    assert theirs is context.theirs[0]
    assert theirs.closed
    assert isinstance(orders, WorkerOrders)
    assert (orders.target, orders.drive) == ("biet2008-plate", "serial:/dev/ttyACM0")
    assert orders.traces == tmp_path
    assert (orders.stroke, orders.rate, orders.amplitude_per_pickup) == ("0.08 m", 4e3, 2e-6)
    with pytest.raises(InputError, match="is being presented; stop it first"):
        device.present(GRATING, 12)
    with pytest.raises(InputError, match="is being presented; stop it first"):
        device.verify_device()
    assert device.stop() == FELT
    assert not device.presenting
    # Nothing plays any more: nothing is said and nothing known.
    assert device.stop().trace == ""
    device.present(GRATING, 12)
    device.stop()
    assert context.made == [process]
    assert pipe.waited == [START_LIMIT, STOP_LIMIT] * 2
    first, halted, second, _ = pipe.sent
    assert first[:3] == ("present", GRATING, 11)
    assert second[:3] == ("present", GRATING, 12)
    assert halted == ("stop",)
    assert re.fullmatch(r"[0-9a-f]{32}\.sqft", first[3])
    assert re.fullmatch(r"[0-9a-f]{32}\.sqft", second[3])
    assert first[3] != second[3]


def test_a_first_start_is_waited_for_longer_than_a_stop() -> None:
    assert (START_LIMIT, STOP_LIMIT) == (300.0, 20.0)


def test_a_verification_is_what_the_process_measured(playing: Playing) -> None:
    measured = DeviceVerification(resonance_frequency=33e3, expected_resonance_frequency=33.1e3)
    pipe = Pipe(("verified", measured))
    device, _ = playing(pipe)
    assert device.verify_device() is measured
    assert pipe.sent == [("verify",)]
    assert not device.presenting


@pytest.mark.parametrize(
    ("why", "says"), [("the plate is wet", "the plate is wet"), ("", "it was stopped before it")]
)
def test_what_ended_before_it_played_was_not_presented(
    playing: Playing, why: str, says: str
) -> None:
    device, context = playing(Pipe(("ended", why, TrialMotion()), ("playing", 1.0)))
    with pytest.raises(DeviceError, match=f"could not be presented: {says}.*It comes again"):
        device.present(GRATING, 1)
    assert not device.presenting
    # The process is well, and plays the next.
    device.present(GRATING, 1)
    assert len(context.made) == 1


def test_after_a_failure_comes_a_new_process(playing: Playing) -> None:
    first, second = Pipe(("failed", "the port is not there")), Pipe(("playing", 1.0))
    device, context = playing(first, second)
    with pytest.raises(DeviceError, match=r"^the port is not there$"):
        device.present(GRATING, 1)
    assert first.closed
    assert not device.presenting
    assert context.made[0].joined == [STOP_LIMIT]
    device.present(GRATING, 1)
    assert device.presenting
    assert len(context.made) == 2


def test_a_process_that_died_meanwhile_is_replaced(playing: Playing) -> None:
    first, second = Pipe(("playing", 1.0), ("ended", "", FELT)), Pipe(("playing", 1.0))
    device, context = playing(first, second)
    device.present(GRATING, 1)
    device.stop()
    context.made[0].alive = False
    device.present(GRATING, 2)
    assert first.closed
    assert [order[2] for order in second.sent] == [2]


@pytest.mark.parametrize(
    ("pipe", "says"),
    [
        (Pipe(), "said nothing for 300 s and is ended; the device stops by its own watchdog"),
        (Pipe(EOFError()), "ended without a word; the device stops by its own watchdog"),
        (Pipe(ConnectionResetError()), "ended without a word"),
    ],
)
def test_a_process_that_does_not_answer_is_ended(playing: Playing, pipe: Pipe, says: str) -> None:
    device, context = playing(pipe)
    with pytest.raises(DeviceError, match=says):
        device.present(GRATING, 1)
    assert pipe.closed
    assert not device.presenting
    assert context.made[0].joined == [STOP_LIMIT]


def test_an_order_that_nobody_takes_says_that_the_process_is_gone(playing: Playing) -> None:
    pipe = Pipe()
    pipe.broken = True
    device, _ = playing(pipe)
    with pytest.raises(DeviceError, match=r"is gone \(nobody reads\); try again"):
        device.verify_device()
    assert pipe.closed


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        (("ended", "the finger stayed away.", FELT), "presented: the finger stayed away. This"),
        (EOFError(), "presented: the process that plays ended without a word"),
    ],
)
def test_a_trial_that_failed_is_not_answered(playing: Playing, answer: Any, says: str) -> None:
    first, second = Pipe(("playing", 1.0), answer), Pipe(("playing", 1.0))
    device, context = playing(first, second)
    device.present(GRATING, 1)
    with pytest.raises(DeviceError, match=says) as failed:
        device.stop()
    assert "not answered and comes again" in str(failed.value)
    assert not device.presenting
    # The next surface begins with a new process.
    assert first.closed
    device.present(GRATING, 1)
    assert len(context.made) == 2


def test_who_halts_a_process_that_is_gone_is_not_bothered(playing: Playing) -> None:
    pipe = Pipe(("playing", 1.0), EOFError())
    device, _ = playing(pipe)
    device.present(GRATING, 1)
    device.halt()
    assert pipe.sent[1:] == [("stop",)]
    pipe.broken = True
    device.halt()
    with pytest.raises(DeviceError, match="not answered"):
        device.stop()


def test_what_was_closed_by_another_thread_is_presented_again(
    playing: Playing, monkeypatch: pytest.MonkeyPatch
) -> None:
    device, _ = playing(Pipe(("playing", 1.0)))
    device.present(GRATING, 1)
    # The other thread comes just between the order to stop and its answer.
    monkeypatch.setattr(device, "halt", device.close)
    with pytest.raises(DeviceError, match="was closed; present the surface again"):
        device.stop()


def test_a_process_that_does_not_end_is_killed(
    playing: Playing, monkeypatch: pytest.MonkeyPatch
) -> None:
    pipe = Pipe(("playing", 1.0))
    device, context = playing(pipe)
    with device as entered:
        assert entered is device
        device.present(GRATING, 1)
        monkeypatch.setattr(Process, "stubborn", True)
    (process,) = context.made
    assert pipe.closed
    assert not device.presenting
    assert process.killed
    assert process.joined == [STOP_LIMIT, None]
    device.close()
    assert len(process.joined) == 2
