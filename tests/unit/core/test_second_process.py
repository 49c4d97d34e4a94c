"""A second process that takes its share: what comes of work is the same with it and without, and
whatever becomes of it, nothing is lost or left."""

from __future__ import annotations

import math
import multiprocessing
import operator
import os
import signal
import subprocess
import sys
import textwrap
import time
import warnings
from collections.abc import Iterator
from types import SimpleNamespace

import pytest
from tests.children import children_left

from squeezefilm.core import second_process as room
from squeezefilm.core.second_process import Piece, is_present, later, second_process, values

# Work must be functions of a module that another process can import: these are the library's.
ADD, ROOT = operator.add, math.sqrt


@pytest.fixture
def present(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(room, "_processors", lambda: 2)
    # Other tests of this process may have children that are about to end.
    others = set(multiprocessing.active_children())
    with second_process(time.time) as is_there:
        assert is_there
        assert is_present()
        yield
    assert not is_present()
    assert not children_left(others)


def elsewhere(function: object, *arguments: object) -> Piece:
    """A piece that the other process has done."""
    piece = later(function, *arguments)  # type: ignore[arg-type]
    while piece.elsewhere is None or not piece.elsewhere.done():
        time.sleep(0.01)
    return piece


@pytest.mark.usefixtures("present")
def test_pieces_are_answered_in_their_order() -> None:
    assert values(*(later(ADD, number, 1) for number in range(40))) == list(range(1, 41))


@pytest.mark.usefixtures("present")
def test_the_other_process_works_and_has_no_other() -> None:
    assert elsewhere(os.getpid).value() != os.getpid()
    assert elsewhere(is_present).value() is False


@pytest.mark.usefixtures("present")
def test_what_fails_there_fails_here_where_it_is_asked_for() -> None:
    bad, good = later(ROOT, -4.0), later(ROOT, 4.0)
    assert values(good) == [2.0]
    with pytest.raises(ValueError, match="math domain"):
        values(bad)


@pytest.mark.usefixtures("present")
def test_what_cannot_be_sent_is_done_here() -> None:
    assert values(later(lambda: 3), later(ROOT, 9.0)) == [3, 3.0]
    # And what cannot be sent back.
    assert callable(elsewhere(operator.attrgetter, "real").value())


@pytest.mark.usefixtures("present")
def test_its_warnings_are_heard_here() -> None:
    asked = elsewhere(warnings.warn, "beyond its range", RuntimeWarning)
    with pytest.warns(RuntimeWarning, match="beyond its range"):
        values(asked)


@pytest.mark.usefixtures("present")
def test_an_interrupt_is_for_the_process_that_waits() -> None:
    before = signal.getsignal(signal.SIGINT)
    os.kill(elsewhere(os.getpid).value(), signal.SIGINT)
    assert elsewhere(ROOT, 4.0).value() == 2.0
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.usefixtures("present")
def test_what_one_that_died_was_to_do_is_done_here() -> None:
    other = elsewhere(os.getpid).value()
    begun = [later(ROOT, float(number**2)) for number in range(3)]
    os.kill(other, signal.SIGTERM)
    assert values(*begun, later(ROOT, 9.0)) == [0.0, 1.0, 2.0, 3.0]


@pytest.mark.usefixtures("present")
@pytest.mark.skipif(sys.platform == "win32", reason="stops a process by a signal")
def test_one_that_takes_too_long_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "_PATIENCE", 0.2)
    monkeypatch.setattr(room, "_LEAVE", 0.2)
    os.kill(elsewhere(os.getpid).value(), signal.SIGSTOP)
    assert values(later(ROOT, 4.0), later(ROOT, 9.0)) == [2.0, 3.0]


def test_where_no_process_can_be_started_all_is_done_here(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_: object) -> None:
        raise OSError("no room")

    monkeypatch.setattr(room, "_processors", lambda: 2)
    monkeypatch.setattr(multiprocessing.process.BaseProcess, "start", refuse)
    with second_process(time.time) as is_there:
        assert not is_there
        assert values(later(ADD, 1, 2), later(ROOT, 4.0)) == [3, 2.0]


@pytest.mark.parametrize(("processors", "daemon"), [(1, False), (2, True)])
def test_one_processor_and_the_labs_workers_have_none_to_spare(
    processors: int, daemon: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(room, "_processors", lambda: processors)
    monkeypatch.setattr(multiprocessing, "current_process", lambda: SimpleNamespace(daemon=daemon))
    with second_process(time.time) as is_there:
        assert not is_there
        assert not is_present()
        assert values(later(ADD, 1, 2)) == [3]


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
    from squeezefilm.core import second_process as room
    if __name__ == "__main__":
        room._processors = lambda: 2
        with room.second_process(time.time):
            asked = room.later(os.getpid)
            while asked.elsewhere is None:
                time.sleep(0.01)
            print(asked.elsewhere.result()[0], flush=True)
            os.kill(os.getpid(), signal.SIGKILL)
    """
    # It holds the standard error, which is read until the last that holds it has ended.
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], check=False, capture_output=True, text=True
    )
    assert int(done.stdout) > 0
    assert done.stderr == ""
    assert done.returncode == -signal.SIGKILL
