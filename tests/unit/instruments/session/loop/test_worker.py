"""The loop's own process, within this one: what it prepares, when it is ready, when it ends."""

from __future__ import annotations

import ctypes
import io
import os
import pickle
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.loop import shared, worker
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.loop.shared import ring_take
from squeezefilm.instruments.session.loop.worker import Orders, main, memory_locked, run_loop

PlanOf = Callable[..., LoopPlan]
# Of no process: whoever has this parent is an orphan.
NOBODY = 2**22 + 1

needs_compiled_clock = pytest.mark.skipif(not worker.COMPILED_CLOCK, reason="no compiled clock")
BOTH_CLOCKS = [pytest.param(True, marks=needs_compiled_clock), False]


@pytest.fixture(autouse=True)
def done(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What would change this process for the tests after it is only noted."""
    noted: list[str] = []

    def granted(priority: int) -> bool:
        noted.append(f"priority {priority}")
        return priority == 10

    def locked() -> bool:
        noted.append("lock")
        return True

    monkeypatch.setattr(worker, "memory_locked", locked)
    monkeypatch.setattr(worker, "real_time_granted", granted)
    monkeypatch.setattr(worker, "collect_garbage_first", lambda: noted.append("collect"))
    return noted


def taken(memory: shared.Shared) -> Any:
    rows = np.empty((shared.ROWS, memory.rows.shape[1]))
    return rows[: ring_take(memory.row_counters, memory.rows, rows)]


@pytest.mark.parametrize("compiled", BOTH_CLOCKS)
def test_it_ticks_from_the_first_on_until_its_parent_is_gone(
    plan_of: PlanOf, compiled: bool
) -> None:
    memory = shared.private_views()
    memory.control[shared.EPOCH] = time.monotonic_ns()
    run_loop(Orders(plan_of(host_timeout=60.0), None, NOBODY, compiled), memory)
    control = memory.control
    assert control[shared.PHASE] == shared.PHASE_ENDED
    pacing = shared.PACING_COMPILED if compiled else shared.PACING_PORTABLE
    assert control[shared.PACING] == pacing
    rows = taken(memory)
    # Nothing of what was rehearsed is counted.
    assert len(rows) == memory.histogram.sum() == control[shared.NEXT] - control[shared.LOST] > 0
    assert rows[-1, column.TICK] == control[shared.NEXT] - 1
    assert np.all(rows[:, column.FLAGS].astype(int) & column.NOT_TOUCHING)
    assert not np.any(rows[:, column.FLAGS].astype(int) & column.HOST_SILENT)


@pytest.mark.parametrize("compiled", BOTH_CLOCKS)
def test_a_host_that_says_nothing_is_noticed(plan_of: PlanOf, compiled: bool) -> None:
    memory = shared.private_views()
    memory.control[shared.EPOCH] = time.monotonic_ns()
    # It looks for its parent after 5 ms.
    run_loop(Orders(plan_of(host_timeout=2e-3), None, NOBODY, compiled), memory)
    assert int(taken(memory)[-1, column.FLAGS]) & column.HOST_SILENT


@pytest.mark.parametrize(("stop", "parent"), [(1, 0), (0, NOBODY)])
def test_it_goes_no_further_than_ready_without_a_host(
    plan_of: PlanOf, stop: int, parent: int
) -> None:
    memory = shared.private_views()
    memory.control[shared.STOP] = stop
    run_loop(Orders(plan_of(), None, parent, compiled_clock=False), memory)
    assert memory.control[shared.PHASE] == shared.PHASE_READY
    assert memory.control[shared.NEXT] == 0


@pytest.mark.parametrize("parent", [0, os.getppid()])
def test_it_waits_for_the_host_to_say_when_it_begins(
    plan_of: PlanOf, monkeypatch: pytest.MonkeyPatch, parent: int
) -> None:
    memory = shared.private_views()
    waits: list[int] = []

    def slept(_: float) -> None:
        waits.append(int(memory.control[shared.PHASE]))
        if len(waits) == 3:
            memory.control[shared.STOP] = memory.control[shared.EPOCH] = 1

    monkeypatch.setattr(time, "sleep", slept)
    run_loop(Orders(plan_of(), None, parent, compiled_clock=False), memory)
    assert waits == [shared.PHASE_READY] * 3
    assert memory.control[shared.PHASE] == shared.PHASE_ENDED


def test_a_stopped_loop_ticks_no_more_and_its_own_parent_is_no_reason(plan_of: PlanOf) -> None:
    memory = shared.private_views()
    memory.control[shared.EPOCH], memory.control[shared.STOP] = time.monotonic_ns(), 1
    run_loop(Orders(plan_of(), None, os.getppid(), compiled_clock=False), memory)
    assert memory.control[shared.PHASE] == shared.PHASE_ENDED
    assert memory.control[shared.NEXT] == 0


@pytest.mark.parametrize(("priority", "given"), [(None, 0), (10, 1), (11, 0)])
def test_it_says_what_it_was_given(
    plan_of: PlanOf, done: list[str], priority: int | None, given: int
) -> None:
    memory = shared.private_views()
    memory.control[shared.STOP] = 1
    run_loop(Orders(plan_of(), priority, 0, compiled_clock=False), memory)
    assert memory.control[shared.REALTIME] == given
    assert memory.control[shared.LOCKED] == 1
    # The priority comes last: nothing that takes long is done with it.
    asked = [] if priority is None else [f"priority {priority}"]
    assert done == ["collect", "lock", *asked]


@pytest.mark.parametrize(("priority", "margin"), [(10, 50_000), (None, 0)])
def test_the_clock_gets_times_in_nanoseconds_after_a_rehearsal_elsewhere(
    plan_of: PlanOf, monkeypatch: pytest.MonkeyPatch, priority: int | None, margin: int
) -> None:
    memory = shared.private_views()
    memory.control[shared.EPOCH] = 1
    calls: list[tuple[Any, ...]] = []
    phases: list[int] = []

    def looped(arrays: Any, views: Any, timespec: Any, *rest: int) -> None:
        calls.append((views, *rest))
        phases.append(int(memory.control[shared.PHASE]))

    monkeypatch.setattr(worker, "COMPILED_CLOCK", True)
    monkeypatch.setattr(worker, "compiled_loop", looped)
    run_loop(Orders(plan_of(host_timeout=30e-3), priority, 7, compiled_clock=True), memory)
    rehearsal, real = calls
    assert rehearsal[0] is not memory
    assert rehearsal[0].control[shared.STOP] == 1
    assert rehearsal[1:] == (0, 30_000_000, 0)
    assert real[0] is memory
    assert real[1:] == (margin, 30_000_000, 7)
    assert phases == [shared.PHASE_NEW, shared.PHASE_READY]
    assert memory.control[shared.PACING] == shared.PACING_COMPILED


def test_where_the_clock_cannot_be_compiled_python_paces(
    plan_of: PlanOf, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(worker, "COMPILED_CLOCK", False)
    memory = shared.private_views()
    memory.control[shared.STOP] = 1
    run_loop(Orders(plan_of(), None, 0, compiled_clock=True), memory)
    assert memory.control[shared.PACING] == shared.PACING_PORTABLE


def test_orders_come_by_standard_input_and_memory_by_its_descriptor(
    plan_of: PlanOf, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    words = np.zeros(shared.shared_size() // 8, dtype=np.int64)
    words[shared.STOP] = 1
    file = tmp_path / "memory"
    file.write_bytes(words.tobytes())
    orders = pickle.dumps(Orders(plan_of(), None, 0, compiled_clock=False))
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(orders)))
    before = signal.getsignal(signal.SIGINT)
    try:
        with file.open("r+b") as opened:
            monkeypatch.setattr(sys, "argv", ["worker", str(opened.fileno())])
            main()
        # Ctrl-C is the host's to handle.
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)
    assert np.frombuffer(file.read_bytes(), np.int64)[shared.PHASE] == shared.PHASE_READY


class Library:
    """The C library, asked but not obeyed."""

    def __init__(self, refuses: bool) -> None:
        self.asked: list[tuple[Any, ...]] = []
        self.refuses = refuses

    def prctl(self, option: int, value: ctypes.c_ulong, *rest: int) -> int:
        self.asked.append((option, value.value, *rest))
        return 0

    def mlockall(self, flags: int) -> int:
        self.asked.append((flags,))
        return -1 if self.refuses else 0


@pytest.mark.parametrize("refuses", [False, True])
def test_linux_is_asked_to_keep_memory_and_to_wake_on_time(
    monkeypatch: pytest.MonkeyPatch, refuses: bool
) -> None:
    library = Library(refuses)
    monkeypatch.setattr(ctypes, "CDLL", lambda *_, **__: library)
    monkeypatch.setattr(sys, "platform", "linux")
    assert memory_locked() is not refuses
    # PR_SET_TIMERSLACK of 1 ns; MCL_CURRENT | MCL_ONFAULT.
    assert library.asked == [(29, 1, 0, 0, 0), (5,)]


def test_no_other_system_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "darwin")
    monkeypatch.setattr(ctypes, "CDLL", None)
    assert memory_locked() is False
