"""A search's own process, within this one: what it tells the server, how it stops and ends."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.design.search import run
from squeezefilm.design.search.run import SearchRequest
from squeezefilm.lab import own_process
from squeezefilm.lab import search_process as process
from squeezefilm.lab import search_process as shown
from squeezefilm.lab.search_process import SearchProcess, search

from .small import TEXT

HOW = {"screened": 40, "solved": 6, "seed": 3, "jobs": 2}


class Pipe:
    def __init__(self) -> None:
        self.said: list[dict[str, Any]] = []

    def send(self, message: dict[str, Any]) -> None:
        self.said.append(message)


Searched = Callable[[Callable[[SearchRequest], Any]], list[dict[str, Any]]]


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    made = SimpleNamespace(now=100.0)
    monkeypatch.setattr(process, "time", SimpleNamespace(monotonic=lambda: made.now))
    return made


@pytest.fixture
def searched(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Searched]:
    """What is said over the pipe by a search that goes so."""
    before = signal.getsignal(signal.SIGINT)
    # This process is no worker: it keeps its memory and its signals.
    monkeypatch.setattr(process, "prepare", lambda: None)
    monkeypatch.setattr(shown, "result", lambda found: {"found": found.of})
    monkeypatch.setattr(
        shown, "glimpse", lambda seen: {"stage": seen.stage, "screened": len(seen.screened)}
    )

    def search_of(how: Callable[[SearchRequest], Any]) -> list[dict[str, Any]]:
        monkeypatch.setattr(run, "search_until_stopped", how)
        pipe: Any = Pipe()
        search(pipe, TEXT, tmp_path, tmp_path / "out", **HOW)
        return pipe.said  # type: ignore[no-any-return]

    yield search_of
    signal.signal(signal.SIGINT, before)


def glimpse(stage: str, screened: int = 0, solved: int = 0, front: int = 0) -> Any:
    return SimpleNamespace(
        stage=stage, screened=(None,) * screened, plates_solved=solved, front=(None,) * front
    )


def test_a_search_is_made_as_it_was_asked_for_and_its_result_told(
    searched: Searched, tmp_path: Path
) -> None:
    asked: list[SearchRequest] = []

    def how(one: SearchRequest) -> Any:
        asked.append(one)
        return SimpleNamespace(of="all"), ""

    said = searched(how)
    assert said == [
        {"type": "search ended", "failed": False, "message": "finished", "result": {"found": "all"}}
    ]
    (one,) = asked
    assert one.requirements.name == "biet2008-plate"
    assert (one.screened, one.solved, one.seed, one.jobs) == (40, 6, 3, 2)
    assert one.out == tmp_path / "out"
    # What comes after the search is not cut short.
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


def test_what_is_seen_is_told_a_few_times_a_second_and_each_stage_at_once(
    searched: Searched, clock: SimpleNamespace
) -> None:
    def how(one: SearchRequest) -> Any:
        assert one.watch is not None
        assert one.progress is not None
        one.progress("begins")
        for stage, after, screened in (
            ("screening strips", 0.0, 8), ("screening strips", 0.1, 16),
            ("screening strips", 0.2, 24),
            ("solving", 0.01, 40), ("solving", 0.01, 40),
        ):  # fmt: skip
            clock.now += after
            one.watch(glimpse(stage, screened))
        return SimpleNamespace(of=""), ""

    said = searched(how)
    assert said[0] == {"type": "search says", "text": "begins"}
    told = [one for one in said if one["type"] == "search found"]
    assert [(one["stage"], one["screened"]) for one in told] == [
        ("screening strips", 8), ("screening strips", 24), ("solving", 40),
    ]  # fmt: skip


def test_a_long_front_is_told_less_often(
    searched: Searched, clock: SimpleNamespace, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shown, "glimpse", lambda seen: {"solved": seen.plates_solved})

    def how(one: SearchRequest) -> Any:
        assert one.watch is not None
        for solved in range(9):
            one.watch(glimpse("solving", 0, solved, 300))
            clock.now += 0.5
        return SimpleNamespace(of=""), ""

    told = [one["solved"] for one in searched(how) if one["type"] == "search found"]
    assert told == [0, 2, 4, 6, 8]


@pytest.mark.parametrize(
    ("error", "failed", "message"),
    [
        (InputError("none can be built"), True, "none can be built"),
        (
            MemoryError(), True,
            "the search needs more than 2 GiB of memory and was ended; screen or solve fewer "
            "designs",
        ),
        (ZeroDivisionError("by nothing"), True, "not foreseen: ZeroDivisionError: by nothing"),
        (KeyboardInterrupt(), False, "stopped"),
    ],
)  # fmt: skip
def test_a_search_that_fails_says_why(
    searched: Searched, error: BaseException, failed: bool, message: str
) -> None:
    def how(_: SearchRequest) -> Any:
        raise error

    assert searched(how) == [{"type": "search ended", "failed": failed, "message": message}]


def test_requirements_that_cannot_be_are_said_with_their_line(tmp_path: Path) -> None:
    before = signal.getsignal(signal.SIGINT)
    pipe: Any = Pipe()
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(process, "prepare", lambda: None)
        wrong = TEXT.replace('length = "73 mm"', 'length = "73"')
        search(pipe, wrong, tmp_path, tmp_path / "out", **HOW)
    signal.signal(signal.SIGINT, before)
    (said,) = pipe.said
    assert said["failed"]
    assert "line 11" in said["message"]
    assert not (tmp_path / "out").exists()


def test_a_stop_is_heard_once_and_never_within_what_is_told(searched: Searched) -> None:
    """A message that is cut off would leave the server waiting for the rest of it."""
    order: list[str] = []

    class Slow(Pipe):
        def send(self, message: dict[str, Any]) -> None:
            if message["type"] == "search says":
                os.kill(os.getpid(), signal.SIGINT)
                for _ in range(1000):
                    pass
                order.append("told")
            super().send(message)

    def how(one: SearchRequest) -> Any:
        assert one.progress is not None
        try:
            one.progress("now")
        except KeyboardInterrupt:
            order.append("stopped")
        # A second one changes nothing: what was found is being put together.
        os.kill(os.getpid(), signal.SIGINT)
        order.append("put together")
        return SimpleNamespace(of="some"), "stopped"

    said: Any = Slow()
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(sys.modules[__name__], "Pipe", lambda: said)
        searched(how)
    assert order == ["told", "stopped", "put together"]
    assert said.said[-1]["message"] == "stopped; what is shown is what was found until then"
    assert said.said[-1]["result"] == {"found": "some"}


@pytest.mark.parametrize("stopped", [False, True])
def test_a_process_that_says_nothing_at_its_end_is_spoken_for(stopped: bool) -> None:
    heard: list[dict[str, Any]] = []
    one = SearchProcess(heard.append)
    if stopped:
        one._stopped = True
    ended: Any = SimpleNamespace(join=lambda: None)

    def recv() -> Any:
        raise EOFError

    one._read(SimpleNamespace(recv=recv), ended)  # type: ignore[arg-type]
    (said,) = heard
    assert (said["type"], said["failed"]) == ("search ended", not stopped)
    assert ("stopped" if stopped else "without a word") in said["message"]


def test_a_process_that_does_not_stop_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[str] = []
    one = SearchProcess(lambda _: None)
    one.kill()
    one._process = SimpleNamespace(is_alive=lambda: True, kill=lambda: done.append("killed"), pid=1)
    one.kill()
    assert done == ["killed"]
    assert one._stopped
    assert own_process.ToldProcess in SearchProcess.__mro__
