"""Deadlines, what is late and what is lost, and both loops on a clock that the test moves."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from squeezefilm.instruments.session.loop import plan as at
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.loop import shared, worker
from squeezefilm.instruments.session.loop.plan import LoopPlan, tick_arrays
from squeezefilm.instruments.session.loop.shared import lateness_class, ring_take
from squeezefilm.instruments.session.loop.worker import (
    compiled_loop,
    due_ns,
    make_due_tick,
    margin_ns,
    portable_loop,
    silence,
)
from squeezefilm.physics.render.resonator import kernel as compensation_kernel

PlanOf = Callable[..., LoopPlan]
# A period that is no whole number of nanoseconds.
RATE = 7e3
PERIOD = 1 / RATE


def due(number: int) -> int:
    """To the nearest nanosecond."""
    return math.floor(number * PERIOD * 1e9 + 0.5)


def rows_of(memory: Any) -> Any:
    out = np.empty((shared.ROWS, len(column.COLUMNS)))
    return out[: ring_take(memory.row_counters, memory.rows, out)]


def test_a_tick_is_due_at_the_nearest_nanosecond() -> None:
    assert [due_ns(k, PERIOD) for k in (0, 1, 2, 3, 10**6)] == [
        0, 142_857, 285_714, 428_571, 142_857_142_857,
    ]  # fmt: skip


def test_the_latest_tick_that_is_due_is_made_and_the_others_are_counted(plan_of: PlanOf) -> None:
    arrays, memory = tick_arrays(plan_of(rate=RATE)), shared.private_views()
    wakes = [due(0), due(1) + 17, due(2), due(3) - 1, due(3), due(5) - 1, due(5), due(6) + 90_000]
    wakes += [due(8), due(11) + 5, due(12), due(16) - 1, due(500), due(5_000) - 1]
    following, lost, longest = 0, 0, 0
    counts = np.zeros_like(memory.histogram)
    expected = []
    for now in wakes:
        made = make_due_tick(arrays, memory, now)
        if now < due(following):
            assert made == 0
            continue
        assert made == 1
        number = max(k for k in range(following, 5_001) if due(k) <= now)
        longest = max(longest, now - due(following))
        lost += number - following
        expected.append((number, (now - due(number)) * 1e-9, number > following))
        counts[lateness_class(float(now - due(number)))] += 1
        following = number + 1
        control = memory.control
        assert control[shared.NEXT] == following
        assert (control[shared.LOST], control[shared.LONGEST]) == (lost, longest)
        assert control[shared.BEAT] == now
        assert control[shared.REFUSED] == 0
    np.testing.assert_array_equal(memory.histogram, counts)
    rows = rows_of(memory)
    assert len(rows) == len(expected)
    for row, (number, late, after_lost) in zip(rows, expected, strict=True):
        assert row[column.TICK] == number
        assert row[column.TIME] == pytest.approx(number * PERIOD)
        assert row[column.LATENESS] == pytest.approx(late, abs=1e-15)
        assert 0.0 <= row[column.LATENESS] < PERIOD
        assert bool(int(row[column.FLAGS]) & column.AFTER_LOST_TICKS) == after_lost


def test_a_command_that_was_refused_is_counted(plan_of: PlanOf) -> None:
    arrays, memory = tick_arrays(plan_of(rate=RATE, compensation="inverse")), shared.private_views()
    arrays.compensator[compensation_kernel.AMPLITUDE] = math.nan
    make_due_tick(arrays, memory, 0)
    assert memory.control[shared.REFUSED] == 1
    make_due_tick(arrays, memory, due(1))
    assert memory.control[shared.REFUSED] == 1


def test_the_next_tick_hears_of_mute_and_of_a_silent_host(plan_of: PlanOf) -> None:
    arrays, control = tick_arrays(plan_of()), shared.private_views().control
    control[shared.HOST_BEAT] = 1_000

    def said(now: int) -> int:
        silence(arrays, control, now, 500)
        return int(arrays.memory[at.SILENCED])

    assert said(1_000) == said(1_500) == 0
    assert said(1_501) == column.HOST_SILENT
    control[shared.MUTE] = 1
    assert said(1_500) == column.MUTED
    assert said(1_501) == column.MUTED | column.HOST_SILENT
    control[shared.MUTE], control[shared.HOST_BEAT] = 0, 1_400
    assert said(1_501) == 0


def test_the_margin_is_half_a_period_at_most_and_none_without_priority() -> None:
    assert margin_ns(1e-3, True) == 50_000
    assert margin_ns(1e-4, True) == 50_000
    assert margin_ns(20e-6, True) == 10_000
    assert margin_ns(1e-3, False) == 0


class Clock:
    """Time in nanoseconds that goes on by a microsecond when it is read; sleeps end late."""

    def __init__(self, late: int) -> None:
        self.now, self.late = 10**12, late
        self.slept: list[int] = []
        self.parent, self.asked_parent = 77, 0
        self.end: Callable[[], None] | None = None
        self.ends_at = math.inf

    def monotonic_ns(self, *_: Any) -> int:
        self.now += 1_000
        if self.now >= self.ends_at and self.end is not None:
            self.end()
        return self.now

    def sleep(self, duration: float) -> None:
        self.slept.append(round(duration * 1e9))
        self.now += self.slept[-1] + self.late

    def sleep_until_ns(self, _: Any, when: int) -> None:
        self.slept.append(when - self.now)
        self.now = max(self.now, when) + self.late

    def thread_time_ns(self, *_: Any) -> int:
        return self.now // 10

    def getppid(self) -> int:
        self.asked_parent += 1
        return self.parent


def begun(clock: Clock, duration: int) -> Any:
    """Memory whose tick 0 is now, and that is told to stop after so many ns: in the sleep before a
    tick, which is still made."""
    memory = shared.private_views()
    memory.control[shared.EPOCH] = clock.now
    memory.control[shared.HOST_BEAT] = 2_000_000

    def stop() -> None:
        memory.control[shared.STOP] = 1

    clock.end, clock.ends_at = stop, clock.now + duration
    return memory


def looped(
    monkeypatch: pytest.MonkeyPatch, which: str, clock: Clock, plan: LoopPlan, memory: Any,
    margin: int = 0, parent: int = 0,
) -> None:  # fmt: skip
    """One of the loops, interpreted, on that clock; it takes a host silent for 3 ms for gone."""
    arrays, timeout = tick_arrays(plan), 3_000_000
    if which == "portable":
        monkeypatch.setattr(worker, "time", clock)
        monkeypatch.setattr(worker, "os", clock)
        portable_loop(arrays, memory, timeout, parent)
        return
    monkeypatch.setattr(worker, "monotonic_ns", clock.monotonic_ns)
    monkeypatch.setattr(worker, "thread_cpu_ns", clock.thread_time_ns)
    monkeypatch.setattr(worker, "sleep_until_ns", clock.sleep_until_ns)
    monkeypatch.setattr(worker, "parent_id", clock.getppid)
    compiled_loop.py_func(arrays, memory, None, margin, timeout, parent)  # type: ignore[attr-defined]


@pytest.mark.parametrize("which", ["portable", "compiled"])
def test_a_loop_sleeps_until_each_tick_is_due(
    monkeypatch: pytest.MonkeyPatch, plan_of: PlanOf, which: str
) -> None:
    clock = Clock(late=20_000)
    began = clock.now
    memory = begun(clock, 20_500_000)
    looped(monkeypatch, which, clock, plan_of(rate=1e3), memory)
    control, rows = memory.control, rows_of(memory)
    assert rows[:, column.TICK].tolist() == list(range(22))
    assert control[shared.LOST] == control[shared.SPUN] == 0
    # What the clock takes to be read included; tick 0 was due as it began.
    assert np.all(rows[1:, column.LATENESS] >= 20e-6)
    assert np.all(rows[:, column.LATENESS] < 25e-6)
    assert len(clock.slept) >= 21
    assert all(0 < one <= 1_000_000 for one in clock.slept)
    # The host's last word was at 2 ms.
    silent = (rows[:, column.FLAGS].astype(int) & column.HOST_SILENT) != 0
    assert silent.tolist() == [k >= 5 for k in range(22)]
    used = (clock.now - began) // 10
    assert control[shared.CPU] == pytest.approx(used, abs=1_000)
    assert clock.asked_parent == 0


@pytest.mark.parametrize("which", ["portable", "compiled"])
def test_a_loop_that_sleeps_too_long_loses_ticks_and_makes_none_up(
    monkeypatch: pytest.MonkeyPatch, plan_of: PlanOf, which: str
) -> None:
    clock = Clock(late=2_400_000)
    memory = begun(clock, 30_000_000)
    looped(monkeypatch, which, clock, plan_of(rate=1e3), memory)
    made = rows_of(memory)[:, column.TICK]
    # Woken 2.4 ms late for the tick it waits for, it makes the one after the next.
    assert made[:5].tolist() == [0, 3, 6, 9, 12]
    assert memory.control[shared.LOST] == made[-1] + 1 - made.size
    assert 2_400_000 <= memory.control[shared.LONGEST] < 2_410_000


@pytest.mark.parametrize("which", ["portable", "compiled"])
def test_a_loop_ends_with_its_parent_at_whom_it_looks_each_five_milliseconds(
    monkeypatch: pytest.MonkeyPatch, plan_of: PlanOf, which: str
) -> None:
    clock = Clock(late=0)
    memory = begun(clock, 10**9)
    looped(monkeypatch, which, clock, plan_of(rate=1e3), memory, parent=78)
    # Not before 5 ms, and at the tick after that.
    assert memory.control[shared.NEXT] in (6, 7)
    assert clock.asked_parent == 1
    clock = Clock(late=0)
    memory = begun(clock, 50_500_000)
    looped(monkeypatch, which, clock, plan_of(rate=1e3), memory, parent=77)
    assert memory.control[shared.NEXT] == 52
    assert 8 <= clock.asked_parent <= 10


def test_the_compiled_loop_spins_through_its_margin_only(
    monkeypatch: pytest.MonkeyPatch, plan_of: PlanOf
) -> None:
    clock = Clock(late=20_000)
    memory = begun(clock, 10_500_000)
    looped(monkeypatch, "compiled", clock, plan_of(rate=1e3), memory, margin=50_000)
    control, rows = memory.control, rows_of(memory)
    assert rows[:, column.TICK].tolist() == list(range(12))
    # A sleep that ends late by less than the margin costs nothing.
    assert np.all(rows[:, column.LATENESS] < 3e-6)
    # It woke 20 us into a margin of 50 us, before each of eleven ticks.
    assert control[shared.SPUN] == pytest.approx(11 * 29_000, abs=11 * 1_000)


def test_a_sleep_that_a_signal_ends_is_not_made_up_by_spinning(
    monkeypatch: pytest.MonkeyPatch, plan_of: PlanOf
) -> None:
    clock = Clock(late=0)
    memory = begun(clock, 5_500_000)

    def short(_: Any, when: int) -> None:
        clock.slept.append(when - clock.now)
        clock.now += max(1, (when - clock.now) // 2)

    monkeypatch.setattr(clock, "sleep_until_ns", short)
    looped(monkeypatch, "compiled", clock, plan_of(rate=1e3), memory, margin=50_000)
    assert rows_of(memory)[:, column.TICK].tolist() == list(range(6))
    assert len(clock.slept) > 5 * 4
    assert memory.control[shared.SPUN] <= 5 * 50_000
