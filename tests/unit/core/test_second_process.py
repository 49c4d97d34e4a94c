"""A second process that takes its share: what comes of work is the same with it and without, and
whatever becomes of it, nothing is lost or left."""

from __future__ import annotations

import math
import multiprocessing.context
import operator
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
import warnings
from types import SimpleNamespace

import numpy as np
import pytest

from squeezefilm.core import second_process as room
from squeezefilm.core.second_process import (
    Piece,
    SecondProcess,
    is_present,
    later,
    second_process,
    values,
)

# Work must be functions of a module that another process can import: these are the library's.
ADD, ROOT = operator.add, math.sqrt


def nothing() -> None:
    """Prepares nothing."""


def ready(process: SecondProcess) -> SecondProcess:
    """The process, started, once it has loaded what it needs."""
    process.start()
    with process._change:
        assert process._is_lost or process._change.wait_for(lambda: process._is_ready, 30)
    return process


@pytest.fixture
def process() -> SecondProcess:
    return ready(SecondProcess(time.time))


def done(process: SecondProcess, *pieces: Piece) -> list[object]:
    """What comes of pieces that a process was asked for."""
    for one in pieces:
        process.ask(one)
    process.wait(pieces)
    return [one.value for one in pieces]


def test_pieces_are_answered_in_their_order(process: SecondProcess) -> None:
    pieces = [Piece(ADD, (k, 1)) for k in range(40)]
    assert done(process, *pieces) == list(range(1, 41))
    process.end()
    assert process._process.exitcode == 0


def test_both_processes_work(process: SecondProcess) -> None:
    # It is there once it has answered; one piece is then done there and one here.
    (there,) = done(process, Piece(os.getpid, ()))
    pieces = [Piece(os.getpid, ()) for _ in range(4)]
    for one in pieces:
        process.ask(one)
    process.wait(pieces)
    assert {one.value for one in pieces} <= {there, os.getpid()}
    asked = Piece(os.getpid, ())
    process.ask(asked)
    while not asked.is_done:
        time.sleep(0.01)
    assert asked.value == process._process.pid
    process.end()


def test_a_record_is_sent_once(process: SecondProcess) -> None:
    record = SimpleNamespace(one=1)
    there = [Piece(id, (record,)) for _ in range(3)]
    for one in there:
        process.ask(one)
        while not one.is_done:
            time.sleep(0.01)
    assert len({one.value for one in there}) == 1
    # An array is no record: it is sent each time.
    assert done(process, Piece(len, (np.zeros(3),))) == [3]
    process.end()


def test_what_fails_there_fails_here_where_it_is_asked_for(process: SecondProcess) -> None:
    good, bad = Piece(ROOT, (4.0,)), Piece(ROOT, (-4.0,))
    process.ask(bad)
    process.ask(good)
    process.wait([good])
    assert good.value == 2.0
    with pytest.raises(ValueError, match="math domain"):
        process.wait([bad])
    process.end()


def test_what_cannot_be_sent_is_done_here(process: SecondProcess) -> None:
    assert done(process, Piece(lambda: 3, ()), Piece(ROOT, (9.0,))) == [3, 3.0]
    # And what cannot be sent back.
    assert callable(done(process, Piece(operator.attrgetter, ("real",)))[0])
    process.end()


def test_its_warnings_are_heard_here(process: SecondProcess) -> None:
    asked = Piece(warnings.warn, ("beyond its range", RuntimeWarning))
    process.ask(asked)
    while not asked.is_done:
        time.sleep(0.01)
    with pytest.warns(RuntimeWarning, match="beyond its range"):
        process.wait([asked])
    process.end()


def test_an_interrupt_is_for_the_process_that_waits() -> None:
    before = signal.getsignal(signal.SIGINT)
    process = SecondProcess(time.time)
    process.start()
    assert process._process.pid is not None
    os.kill(process._process.pid, signal.SIGINT)
    assert done(process, Piece(ROOT, (4.0,))) == [2.0]
    process.end()
    assert signal.getsignal(signal.SIGINT) is before


def test_what_one_that_died_was_to_do_is_done_here(process: SecondProcess) -> None:
    pieces = [Piece(ROOT, (float(k**2),)) for k in range(5)]
    for one in pieces[:3]:
        process.ask(one)
    process._process.kill()
    process._process.join()
    for one in pieces[3:]:
        process.ask(one)
    process.wait(pieces)
    assert [one.value for one in pieces] == [0.0, 1.0, 2.0, 3.0, 4.0]
    process.end()


def test_one_that_takes_too_long_is_not_waited_for(
    process: SecondProcess, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(room, "_PATIENCE", 0.2)
    monkeypatch.setattr(room, "_LEAVE", 0.2)
    os.kill(process._process.pid or 0, signal.SIGSTOP)
    assert done(process, Piece(ROOT, (4.0,))) == [2.0]
    process.end()
    assert not process._process.is_alive()


def test_where_no_process_can_be_started_all_is_done_here(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_: object) -> None:
        raise OSError("no room")

    monkeypatch.setattr(multiprocessing.process.BaseProcess, "start", refuse)
    with second_process(nothing):
        assert values(later(ADD, 1, 2), later(ROOT, 4.0)) == [3, 2.0]


def test_one_processor_has_none_to_spare(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "_processors", lambda: 1)
    with second_process(nothing) as process:
        assert process is None
        assert not is_present()
        assert values(later(ADD, 1, 2)) == [3]


def test_a_process_that_must_not_have_children_has_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """As the lab's workers are."""
    monkeypatch.setattr(room, "_processors", lambda: 2)
    monkeypatch.setattr(multiprocessing, "current_process", lambda: SimpleNamespace(daemon=True))
    with second_process(nothing) as process:
        assert process is None
        assert values(later(ADD, 1, 2)) == [3]


def test_it_is_there_for_the_block_only() -> None:
    assert not is_present()
    with second_process(time.time) as process:
        if process is None:
            pytest.skip("there is one processor")
        assert is_present()
        assert values(*(later(ADD, k, k) for k in range(6))) == [0, 2, 4, 6, 8, 10]
    assert not is_present()
    assert not process._process.is_alive()


@pytest.mark.skipif(sys.platform != "linux", reason="copies are made on Linux")
def test_a_copy_has_what_was_loaded_and_a_thread_gets_a_new_one() -> None:
    loaded: list[int] = []
    copy = ready(SecondProcess(lambda: loaded.append(os.getpid())))
    assert loaded == [os.getpid()]
    # It has no second process of its own, though it was made while this one had it.
    with second_process(time.time):
        inner = ready(SecondProcess(time.time))
    asked = Piece(is_present, ())
    inner.ask(asked)
    while not asked.is_done:
        time.sleep(0.01)
    assert asked.value is False
    copy.end()
    inner.end()
    new = SecondProcess(time.time)
    thread = threading.Thread(target=new.start)
    thread.start()
    thread.join()
    assert isinstance(new._process, multiprocessing.context.SpawnProcess)
    assert isinstance(copy._process, multiprocessing.context.ForkProcess)
    new.end()


def test_without_one_work_is_done_when_it_is_asked_for() -> None:
    told: list[int] = []
    piece = later(told.append, 1)
    assert told == []
    values(piece)
    values(piece)
    assert told == [1]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="asks a process by its number")
def test_it_does_not_outlive_the_one_that_asks() -> None:
    code = """
    import os, signal, time
    from squeezefilm.core.second_process import SecondProcess
    if __name__ == "__main__":
        process = SecondProcess(time.time)
        process.start()
        print(process._process.pid, flush=True)
        os.kill(os.getpid(), signal.SIGKILL)
    """
    # It holds the standard error, which is read until the last that holds it has ended.
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], check=False, capture_output=True, text=True
    )
    assert int(done.stdout) > 0
    assert done.stderr == ""
    assert done.returncode == -signal.SIGKILL
