"""The loop's compiled clock: the same times as Python's, and a sleep to a point in time."""

from __future__ import annotations

import os
import sys
import time

import numpy as np
import pytest

from squeezefilm.instruments.session.loop import worker
from squeezefilm.instruments.session.loop.worker import (
    monotonic_ns,
    new_timespec,
    parent_id,
    sleep_until_ns,
    thread_cpu_ns,
)

needs_compiled_clock = pytest.mark.skipif(not worker.COMPILED_CLOCK, reason="no compiled clock")


def test_linux_has_a_compiled_clock() -> None:
    assert worker.COMPILED_CLOCK is (sys.platform == "linux" and sys.maxsize > 2**32)


def test_every_symbol_must_be_there() -> None:
    assert worker._has_symbols("malloc", "free")
    assert not worker._has_symbols("malloc", "no_such_function_anywhere")
    assert not worker._has_symbols("no_such_function_anywhere", "malloc")


def test_a_timespec_is_two_words() -> None:
    timespec = new_timespec()
    assert (timespec.shape, timespec.dtype) == ((2,), np.int64)
    assert new_timespec() is not timespec


@needs_compiled_clock
def test_it_lies_between_two_readings_of_pythons_clock() -> None:
    timespec = new_timespec()
    monotonic_ns(timespec), thread_cpu_ns(timespec)  # compiled by now
    for compiled, python in (
        (monotonic_ns, time.monotonic_ns),
        (thread_cpu_ns, time.thread_time_ns),
    ):
        before = python()
        found = compiled(timespec)
        assert before <= found <= python()
        # What the system wrote, as the C library lays it out.
        assert divmod(found, 10**9) == tuple(timespec)


@needs_compiled_clock
def test_a_sleep_ends_at_its_time_and_not_before() -> None:
    timespec = new_timespec()
    until = monotonic_ns(timespec) + 200_000
    sleep_until_ns(timespec, until)
    assert time.monotonic_ns() >= until


@needs_compiled_clock
def test_a_time_that_has_passed_is_not_slept_for() -> None:
    timespec = new_timespec()
    sleep_until_ns(timespec, 5)
    assert tuple(timespec) == (0, 5)
    # A moment ago: relative to now it would be as long as this computer runs.
    moment = monotonic_ns(timespec) - 1
    sleep_until_ns(timespec, moment)
    assert tuple(timespec) == divmod(moment, 10**9)


@needs_compiled_clock
def test_the_parent_is_the_one_python_knows() -> None:
    assert parent_id() == os.getppid()
