"""A second process that draws: it answers, and whatever becomes of it, nothing is lost or left."""

from __future__ import annotations

import json
import multiprocessing.context
import os
import signal
import subprocess
import sys
import textwrap
import time
from types import SimpleNamespace

import pytest

from squeezefilm.report.kit import drawing_process as room
from squeezefilm.report.kit.drawing_process import DrawingProcess, drawing_process

# What draws must be a function of a module: this one says what an attribute holds.
DRAW, PREPARE = getattr, time.time
SUBJECT = SimpleNamespace(one="first", two="second")


def asked(process: DrawingProcess) -> dict[str, str]:
    """What comes of three figures, of which the last cannot be drawn."""
    process.begin(SUBJECT)
    process.ask("one", {})
    process.ask("three", {"three": "third"})
    process.ask("none", {})
    return process.drawings()


def test_it_draws_what_can_be_drawn_and_ends() -> None:
    with drawing_process(True, PREPARE, DRAW) as process:
        if process is None:
            pytest.skip("there is one processor")
        assert asked(process) == {"one": "first", "three": "third"}
        running = process._process
    assert running.exitcode == 0
    # What was asked too late is not an error.
    assert asked(process) == {}


def test_what_is_prepared_in_vain_is_drawn_all_the_same() -> None:
    process = DrawingProcess(json.loads, DRAW)
    assert asked(process) == {"one": "first", "three": "third"}
    process.end()


def test_an_interrupt_is_for_the_process_that_waits() -> None:
    before = signal.getsignal(signal.SIGINT)
    process = DrawingProcess(PREPARE, DRAW)
    assert process._process.pid is not None
    os.kill(process._process.pid, signal.SIGINT)
    assert asked(process) == {"one": "first", "three": "third"}
    process.end()
    assert signal.getsignal(signal.SIGINT) is before


def test_one_that_died_has_drawn_nothing() -> None:
    process = DrawingProcess(PREPARE, DRAW)
    process._process.kill()
    process._process.join()
    assert asked(process) == {}
    process.end()


def test_where_no_process_can_be_started_there_is_nothing_to_wait_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse(_: object) -> None:
        raise OSError("no room")

    monkeypatch.setattr(multiprocessing.context.SpawnProcess, "start", refuse)
    with drawing_process(True, PREPARE, DRAW) as process:
        assert process is None or asked(process) == {}


def test_one_processor_has_none_to_spare(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "_processors", lambda: 1)
    with drawing_process(True, PREPARE, DRAW) as process:
        assert process is None
    with drawing_process(False, PREPARE, DRAW) as process:
        assert process is None


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="asks a process by its number")
def test_it_does_not_outlive_the_one_that_asks() -> None:
    code = """
    import os, signal, time
    from squeezefilm.report.kit.drawing_process import DrawingProcess
    if __name__ == "__main__":
        process = DrawingProcess(time.time, getattr)
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
