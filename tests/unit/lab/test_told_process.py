"""Work in a process of its own, with a thread in the process's place."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.lab import own_process
from squeezefilm.lab.own_process import ToldProcess
from squeezefilm.lab.search_process import _Stop


class Work(ToldProcess):
    """Work of a kind."""

    ended, in_use, stopped, died, patience = "ended", "one runs", "stopped", "died", 0.25


class Thread:
    """A process without a process: it dies with its pipe closed, as one does."""

    every: list[Thread]

    def __init__(
        self, target: Callable[..., None], args: tuple[Any, ...], kwargs: Any, daemon: bool
    ) -> None:
        assert not daemon
        self.pid, self.killed = 4711, 0
        self.waited: list[float | None] = []
        self._end = threading.Event()
        (pipe,) = args
        # The server closes its own copy of the end that it gives away.
        self._pipe = Connection(os.dup(pipe.fileno()))
        self._work = threading.Thread(target=self._run, args=(target, kwargs))
        self.every.append(self)

    def _run(self, target: Callable[..., None], kwargs: Any) -> None:
        target(self._pipe, end=self._end, **kwargs)
        self._pipe.close()

    def start(self) -> None:
        """Begin."""
        self._work.start()

    def is_alive(self) -> bool:
        """True where it is at work."""
        return self._work.is_alive()

    def join(self, limit: float | None = None) -> None:
        """Wait for it."""
        self.waited.append(limit)
        self._work.join(limit)

    def kill(self) -> None:
        """End it."""
        self.killed += 1
        self._end.set()


@pytest.fixture
def signalled(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, int]]:
    """The signals that are sent; one that stops has the work end."""
    sent: list[tuple[int, int]] = []
    Thread.every = []

    class Context:
        Process = Thread
        Pipe = staticmethod(multiprocessing.Pipe)

    def context(kind: str) -> Any:
        assert kind == "spawn"
        return Context

    monkeypatch.setattr(own_process.multiprocessing, "get_context", context)
    monkeypatch.setattr(own_process.os, "kill", lambda *said: sent.append(said))
    return sent


def says(connection: Any, end: threading.Event, words: list[Any], waits: bool = False) -> None:
    """Say these messages, and wait for the end."""
    for message in words:
        connection.send(message)
    if waits:
        end.wait(30)


def heard(**how: Any) -> tuple[Work, list[Any], threading.Event]:
    told: list[Any] = []
    over = threading.Event()

    def tell(message: Any) -> None:
        told.append(message)
        if message["type"] == "ended":
            over.set()

    work = Work(tell)
    work.start(says, **how)
    return work, told, over


@pytest.mark.usefixtures("signalled")
def test_what_it_tells_is_told_and_its_end_last_when_it_is_gone() -> None:
    words = [{"type": "a"}, {"type": "ended", "found": 1}, {"type": "b"}]
    work, told, over = heard(words=words)
    assert over.wait(30)
    assert told == [{"type": "a"}, {"type": "b"}, {"type": "ended", "found": 1}]
    assert not work.running
    # It may begin again.
    work.start(says, words=[])
    assert len(Thread.every) == 2


@pytest.mark.usefixtures("signalled")
def test_one_that_ends_without_a_word_died() -> None:
    _, told, over = heard(words=[])
    assert over.wait(30)
    assert told == [{"type": "ended", "failed": True, "message": "died"}]


def test_a_second_one_is_refused_and_a_stop_is_asked_as_by_ctrl_c(
    signalled: list[tuple[int, int]],
) -> None:
    work, told, over = heard(words=[], waits=True)
    assert work.running
    with pytest.raises(InputError, match="one runs"):
        work.start(says, words=[])
    work.stop()
    assert signalled == [(4711, signal.SIGINT)]
    # The end of the lab waits as long as this kind may take, and no longer.
    work.close()
    assert Thread.every[0].waited[0] == 0.25
    assert Thread.every[0].killed == 1
    assert over.wait(30)
    assert told == [{"type": "ended", "failed": False, "message": "stopped"}]
    work.stop()
    work.close()
    assert len(signalled) == 2


def test_a_search_is_stopped_once_and_not_in_the_middle_of_a_message() -> None:
    before = signal.getsignal(signal.SIGINT)
    try:
        stop = _Stop()
        with pytest.raises(KeyboardInterrupt):
            stop._hear()
        # A second one changes nothing: what is kept is being kept.
        stop._hear()
        did: list[str] = []

        def whole(stop: _Stop) -> None:
            with stop.held():
                stop._hear()
                did.append("whole")

        late = _Stop()
        with pytest.raises(KeyboardInterrupt):
            whole(late)
        assert did == ["whole"]
        with late.held():
            did.append("again")
        assert did == ["whole", "again"]
    finally:
        signal.signal(signal.SIGINT, before)
