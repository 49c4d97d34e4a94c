"""What the process that computes does, here in this one: answers, limits, how far it is."""

from __future__ import annotations

import os
import signal
import sys
import warnings
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.core import interrupts
from squeezefilm.core.errors import SqueezefilmError, SqueezefilmWarning
from squeezefilm.lab import worker
from squeezefilm.lab.guard import Keys, Places
from squeezefilm.lab.server import Lab


class Line:
    """A pipe's end: gives what is asked, keeps what is said."""

    def __init__(self, *asked: Any) -> None:
        self.asked, self.said = list(asked), []  # type: ignore[var-annotated]

    def recv(self) -> Any:
        if not self.asked:
            raise EOFError
        found = self.asked.pop(0)
        if isinstance(found, Exception):
            raise found
        return found

    def send(self, what: Any) -> None:
        self.said.append(what)


def needs_too_much() -> None:
    raise MemoryError


def fails(text: str) -> None:
    raise ValueError(text)


def test_what_worked_is_answered_and_what_failed_too() -> None:
    assert worker._answered(max, (2, 5)) == (True, 5)
    worked, found = worker._answered(fails, ("odd",))
    assert not worked
    assert isinstance(found, ValueError)
    assert str(found) == "odd"
    worked, found = worker._answered(needs_too_much, ())
    assert not worked
    assert isinstance(found, SqueezefilmError)
    assert "needs more than 2 GiB of memory" in str(found)


@pytest.mark.parametrize("end", [EOFError(), OSError()])
def test_one_piece_is_answered_after_the_other_until_the_line_is_closed(
    monkeypatch: pytest.MonkeyPatch, end: Exception
) -> None:
    prepared: list[Any] = []
    monkeypatch.setattr(worker, "prepare", lambda: prepared.append(worker._line))
    monkeypatch.setattr(worker, "_line", None)
    ignored: list[Any] = []
    monkeypatch.setattr(worker.signal, "signal", lambda *given: ignored.append(given))
    line: Any = Line((max, (1, 2)), (min, (1, 2)), end)
    worker._work(line)
    assert ignored == [(signal.SIGINT, signal.SIG_IGN)]
    assert line.said == [(True, 2), (True, 1)]
    # Whoever tells how far it is does so over this line, once the process is ready.
    assert prepared == [None]
    assert worker._line is line


def test_how_far_it_is_is_told_ten_times_a_second_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    clock, line = SimpleNamespace(now=50.0), Line()
    monkeypatch.setattr(worker, "time", SimpleNamespace(monotonic=lambda: clock.now))
    monkeypatch.setattr(worker, "_told_last", 0.0)
    monkeypatch.setattr(worker, "_line", None)
    worker.tell("nobody hears", 0.1)
    monkeypatch.setattr(worker, "_line", line)
    for after in (0.0, 0.05, 0.04, 0.02, 0.05, 0.06):
        clock.now += after
        worker.tell("solving", clock.now)
    told = [(one.text, one.share) for one in line.said]
    assert told == [
        ("solving", pytest.approx(50.0)), ("solving", pytest.approx(50.11)),
        ("solving", pytest.approx(50.22)),
    ]  # fmt: skip


def test_who_asks_hears_how_far_it_is_and_then_the_answer() -> None:
    line: Any = Line(worker._HowFar("a", 0.25), worker._HowFar("b", 0.5), (True, 7))
    heard: list[tuple[str, float]] = []
    process = worker._Process(SimpleNamespace(), line)  # type: ignore[arg-type]
    assert process.ask(max, (1, 2), lambda *said: heard.append(said)) == (True, 7)
    assert line.said == [(max, (1, 2))]
    assert heard == [("a", 0.25), ("b", 0.5)]
    quiet = worker._Process(SimpleNamespace(), Line(worker._HowFar("a", 0.25), (False, 8)))  # type: ignore[arg-type]
    assert quiet.ask(max, (1, 2), None) == (False, 8)
    for broken in (EOFError(), OSError(), BrokenPipeError()):
        dead = worker._Process(SimpleNamespace(), Line(broken))  # type: ignore[arg-type]
        with pytest.raises(EOFError):
            dead.ask(max, (1, 2), None)


def test_a_process_is_prepared_for_a_server_that_may_be_killed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    threads: list[Any] = []
    limited: list[str] = []

    def thread(**how: Any) -> Any:
        threads.append(how)
        return SimpleNamespace(start=lambda: threads.append("started"))

    monkeypatch.setattr(interrupts, "threading", SimpleNamespace(Thread=thread))
    monkeypatch.setattr(worker, "_limit_memory", lambda: limited.append("memory"))
    for name in ("OMP", "OPENBLAS", "MKL"):
        monkeypatch.delenv(f"{name}_NUM_THREADS", raising=False)
    monkeypatch.setenv("MKL_NUM_THREADS", "3")
    with warnings.catch_warnings():
        worker.prepare()
        with warnings.catch_warnings(record=True) as seen:
            warnings.warn("answers carry it", SqueezefilmWarning, stacklevel=1)
        assert seen == []
    assert threads == [{"target": interrupts._wait_for_parent, "daemon": True}, "started"]
    assert limited == ["memory"]
    assert os.environ["OMP_NUM_THREADS"] == os.environ["OPENBLAS_NUM_THREADS"] == "1"
    # What somebody chose stays.
    assert os.environ["MKL_NUM_THREADS"] == "3"
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "1")


def test_a_process_ends_with_its_parent_if_it_has_one(monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[Any] = []
    parent = SimpleNamespace(join=lambda: done.append("joined"))
    monkeypatch.setattr(interrupts.os, "_exit", lambda status: done.append(status))
    for found in (None, parent):
        mine = SimpleNamespace(parent_process=lambda found=found: found)
        monkeypatch.setattr(interrupts, "multiprocessing", mine)
        interrupts._wait_for_parent()
    assert done == ["joined", 1]


@pytest.mark.parametrize(
    ("hard", "limited"),
    [(-1, True), (4 * 1024**3, True), (2 * 1024**3, False), (1024**3, False)],
)
def test_memory_is_limited_where_it_is_not_narrower_already(
    monkeypatch: pytest.MonkeyPatch, hard: int, limited: bool
) -> None:
    set_to: list[Any] = []
    fake = SimpleNamespace(
        RLIMIT_DATA=2, RLIM_INFINITY=-1, getrlimit=lambda _: (-1, hard),
        setrlimit=lambda *given: set_to.append(given),
    )  # fmt: skip
    monkeypatch.setitem(sys.modules, "resource", fake)
    worker._limit_memory()
    assert set_to == ([(2, (2 * 1024**3, hard))] if limited else [])


def test_a_system_without_such_limits_has_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "resource", None)
    worker._limit_memory()


def test_two_lines_of_work_are_cancelled_and_closed_together(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done: list[Any] = []
    monkeypatch.setattr(worker.Busy, "cancel", lambda self, page: done.append((self, page)))
    monkeypatch.setattr(worker.Busy, "close", lambda self: done.append((self, "closed")))
    lab = Lab(tmp_path, Keys(), Places(frozenset(), cookie="c"))
    assert lab.quick is not lab.slow
    page: Any = object()
    lab.cancel(page)
    lab.close()
    assert done == [
        (lab.quick, page), (lab.slow, page),
        (lab.quick, "closed"), (lab.slow, "closed"),
    ]  # fmt: skip
    assert (lab.quick._longest, lab.slow._longest) == (120.0, 600.0)
