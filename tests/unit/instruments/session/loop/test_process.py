"""What the host's side of a loop does with its process, whose part a script plays that compiles
nothing; tests/faults plays with a real one."""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from squeezefilm.core.errors import InputError, LoopError, SqueezefilmWarning
from squeezefilm.instruments.session.loop import process, shared
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.loop.process import LoopProcess
from squeezefilm.instruments.session.loop.shared import ring_put_all, ring_take

Plans = Callable[..., LoopPlan]
# Called as the worker is: -c CODE DESCRIPTOR, with the orders on standard input.
WORKER = f"""#!{sys.executable} -SE
import mmap, sys, time
words = memoryview(mmap.mmap(int(sys.argv[3]), 0)).cast("q")
orders = sys.stdin.buffer.read()
def until_stopped():
    while not words[{shared.STOP}]:
        time.sleep(1e-3)
"""
READY = f"words[{shared.PHASE}] = {shared.PHASE_READY}\n"


@pytest.fixture
def played(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Let a script play the worker of the loops that follow."""

    def play(script: str) -> None:
        worker = tmp_path / "worker"
        worker.write_text(WORKER + script, encoding="utf-8")
        worker.chmod(0o700)
        monkeypatch.setattr(sys, "executable", str(worker))

    return play


@contextmanager
def told(*expected: str) -> Iterator[None]:
    """Warnings that begin so are given, and no others."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield
    assert [warning.category for warning in caught] == [SqueezefilmWarning] * len(expected)
    for warning, begins in zip(caught, expected, strict=True):
        assert str(warning.message).startswith(begins)


def test_a_system_without_posix_processes_is_told_so(
    plan_of: Plans, monkeypatch: pytest.MonkeyPatch
) -> None:
    loop = LoopProcess(plan_of(), priority=None)
    monkeypatch.setattr(process, "os", SimpleNamespace(name="nt"))
    with pytest.raises(LoopError, match="shares memory by file descriptor"):
        loop.start()


@pytest.mark.parametrize("priority", [0, 100])
def test_a_priority_is_one_of_the_systems(plan_of: Plans, priority: int) -> None:
    with pytest.raises(InputError, match=f"priority = {priority} cannot be used"):
        LoopProcess(plan_of(), priority=priority)


@pytest.mark.parametrize("priority", [None, 1, 99])
def test_before_it_is_started_it_has_no_process(plan_of: Plans, priority: int | None) -> None:
    loop = LoopProcess(plan_of(), priority=priority)
    assert loop.time == 0.0
    for call in (loop.take_rows, loop.take_commands, loop.mute, loop.check, loop.report, loop.stop):
        with pytest.raises(LoopError, match="was not started; call start"):
            call()


def test_host_and_loop_meet_in_their_memory(plan_of: Plans, played: Callable[[str], None]) -> None:
    played(READY + "until_stopped()")
    with LoopProcess(plan_of(host_timeout=1.0), priority=None, compiled_clock=False) as loop:
        with pytest.raises(LoopError, match="was started before"):
            loop.start()
        _, memory = loop._running()
        control = memory.control
        # Tick 0 comes soon after the start.
        assert control[shared.EPOCH] * 1e-9 == pytest.approx(time.monotonic() - loop.time, abs=1e-3)
        assert -0.01 < loop.time < 5.0

        heard = [control[shared.HOST_BEAT]]
        samples = np.arange(18.0).reshape(3, 6)
        assert loop.feed(samples) == 3
        heard.append(control[shared.HOST_BEAT])
        received = np.empty((9, 6))
        assert ring_take(memory.sample_counters, memory.samples, received) == 3
        np.testing.assert_array_equal(received[:3], samples)

        for muted in (True, False):
            loop.mute(muted)
            assert control[shared.MUTE] == muted
            heard.append(control[shared.HOST_BEAT])

        commands = np.array([[5.0, loop.time + ahead, 1e-6, 2.0] for ahead in (-9.0, -8.0, 9.0)])
        ring_put_all(memory.command_counters, memory.commands, commands)
        np.testing.assert_array_equal(loop.take_commands(), commands[2:])
        assert loop.report().stale_commands == 2
        heard.append(control[shared.HOST_BEAT])

        rows = np.ones((2, len(column.COLUMNS)))
        ring_put_all(memory.row_counters, memory.rows, rows)
        np.testing.assert_array_equal(loop.take_rows(), rows)
        assert loop.take_rows().shape == (0, len(column.COLUMNS))
        heard.append(control[shared.HOST_BEAT])
        assert heard == sorted(set(heard))
        assert heard[-1] * 1e-9 == pytest.approx(loop.time, abs=0.5)

        control[shared.BEAT] = round((loop.time - 7.0) * 1e9)
        assert loop.silence == pytest.approx(7.0, abs=0.5)
    ring_put_all(memory.row_counters, memory.rows, rows[:1])
    assert len(loop.take_rows()) == 1
    loop.check()
    assert loop.stop() is loop.stop()


def test_its_report_says_what_the_loop_wrote(plan_of: Plans, played: Callable[[str], None]) -> None:
    control = {
        shared.REALTIME: 1,
        shared.PACING: shared.PACING_COMPILED,
        shared.BEAT: 4_000,
        shared.CPU: 1_000,
        shared.SPUN: 3_000,
        shared.REFUSED: 5,
    }
    words = "".join(f"words[{place}] = {value}\n" for place, value in control.items())
    played(words + READY + "until_stopped()")
    with told():
        loop = LoopProcess(plan_of())
        loop.start()
    _, memory = loop._running()
    loop.feed(np.zeros((shared.SAMPLES + 2, 6)))
    ring_put_all(memory.command_counters, memory.commands, np.zeros((shared.COMMANDS + 3, 4)))
    ring_put_all(memory.row_counters, memory.rows, np.zeros((shared.ROWS + 4, 14)))
    report = loop.stop()
    assert report.real_time_priority
    assert report.compiled_clock
    assert not report.memory_locked
    assert (report.processor_share, report.spin_share) == (0.25, 0.75)
    assert report.refused_commands == 5
    assert (report.dropped_samples, report.dropped_commands, report.dropped_rows) == (2, 3, 4)
    assert (report.lateness.made, report.stale_commands) == (0, 0)


@pytest.mark.parametrize(
    ("priority", "compiled_clock", "expected"),
    [
        (7, True, ["the loop runs without real-time priority", "the loop is paced by Python"]),
        (None, True, ["the loop is paced by Python"]),
        (None, False, []),
    ],
)
def test_what_was_asked_and_not_granted_is_said(
    plan_of: Plans,
    played: Callable[[str], None],
    priority: int | None,
    compiled_clock: bool,
    expected: list[str],
) -> None:
    played(f"words[{shared.PACING}] = {shared.PACING_PORTABLE}\n{READY}until_stopped()")
    with (
        told(*expected),
        LoopProcess(plan_of(), priority=priority, compiled_clock=compiled_clock) as loop,
    ):
        report = loop.report()
    assert not report.compiled_clock
    assert (report.processor_share, report.spin_share) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("script", "how"),
    [
        (
            "sys.exit('no memory was left')",
            r"ended with exit code 1; .* It said: no memory was lef",
        ),
        ("sys.exit(3)", r"ended with exit code 3; .*start a new loop\.$"),
        ("import os; os.kill(os.getpid(), 9)", "was killed by signal 9"),
    ],
)
def test_a_worker_that_dies_is_told_with_its_last_words(
    plan_of: Plans, played: Callable[[str], None], script: str, how: str
) -> None:
    played(script)
    loop = LoopProcess(plan_of(), priority=None)
    with pytest.raises(LoopError, match=how):
        loop.start()
    # It was cleared away already; asked again it is the same.
    assert loop.stop() is loop.stop()
    assert loop._running()[0].returncode is not None


def test_one_that_dies_in_the_midst_is_noticed_at_the_next_call(
    plan_of: Plans, played: Callable[[str], None]
) -> None:
    played(READY + "until_stopped()")
    loop = LoopProcess(plan_of(), priority=None, compiled_clock=False)
    loop.start()
    loop._running()[0].kill()
    loop._running()[0].wait()
    for call in (loop.check, loop.take_commands, loop.mute):
        with pytest.raises(LoopError, match="killed by signal 9"):
            call()
    loop.stop()
    loop.check()


def test_one_that_never_gets_ready_is_ended(
    plan_of: Plans, played: Callable[[str], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(process, "_START_LIMIT", 0.05)
    played("until_stopped()")
    loop = LoopProcess(plan_of(), priority=None)
    with pytest.raises(LoopError, match=r"was not ready after 0\.05 s"):
        loop.start()
    assert loop._running()[0].returncode is not None


def test_one_that_does_not_heed_the_stop_is_killed(
    plan_of: Plans, played: Callable[[str], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(process, "_STOP_LIMIT", 0.05)
    played(READY + "time.sleep(60)")
    loop = LoopProcess(plan_of(), priority=None)
    loop.start()
    loop.stop()
    assert loop._running()[0].returncode == -9
