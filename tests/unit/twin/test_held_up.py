"""What a patient twin leaves out of its watchdog's time: the way through a pseudo-terminal, and a
host's waiting for a processor."""

from __future__ import annotations

import contextlib
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Iterator

import pytest

from squeezefilm.twin.held_up import Waiting, Way

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs pseudo-terminals")

counted = pytest.mark.skipif(sys.platform != "linux", reason="only Linux counts how long one waits")
LOOK = 20_000
"""µs, far enough apart for two looks."""
SPINS = "import os, sys; os.sched_setaffinity(0, [min(os.sched_getaffinity(0))]); print(flush=True)"
SPINS += "\nwhile True: pass"
SLEEPS = "import time; print(flush=True); time.sleep(600)"
STARTS = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {SPINS!r}])"


def test_a_byte_on_its_way_says_since_when_until_it_is_there() -> None:
    with contextlib.closing(Way()) as way:
        assert way.held_up_since(100) == 100
        # Taken away as it arrives, it is still on its way for all that the twin knows.
        assert select.select([way._near], [], [], 30)[0]
        os.read(way._near, 1)
        assert way.held_up_since(200) == 100
        assert way.held_up_since(300) == 100
        os.write(way._far, bytes(1))
        assert select.select([way._near], [], [], 30)[0]
        # There; and the next is sent.
        assert way.held_up_since(400) == 400
        assert select.select([way._near], [], [], 30)[0]
        assert way.held_up_since(500) == 500


@pytest.fixture
def started() -> Iterator[list[subprocess.Popen[bytes]]]:
    """Programs that end with the test, and whatever they started."""
    running: list[subprocess.Popen[bytes]] = []
    yield running
    for one in running:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(one.pid, signal.SIGKILL)
        one.wait()
        assert one.stdout is not None
        one.stdout.close()


def start(running: list[subprocess.Popen[bytes]], program: str) -> int:
    one = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, start_new_session=True
    )
    running.append(one)
    assert one.stdout is not None
    one.stdout.readline()
    return one.pid


def waits(host: int, looks: int) -> Iterator[int]:
    """What `looks` find after the first."""
    waiting = Waiting(host)
    began = time.monotonic_ns() // 1000
    for number in range(looks):
        now = time.monotonic_ns() // 1000
        found = waiting.waited_since(began, now)
        assert 0 <= found <= now - began
        if number:
            yield found
        time.sleep(LOOK * 1e-6)


@counted
@pytest.mark.parametrize("program", [SPINS, STARTS], ids=["itself", "one that it started"])
def test_who_shares_a_processor_waits_for_it(
    program: str, started: list[subprocess.Popen[bytes]]
) -> None:
    start(started, SPINS)
    host = start(started, program)
    assert any(found > 0 for found in waits(host, 500))


@counted
def test_who_sleeps_or_is_stopped_does_not_wait(started: list[subprocess.Popen[bytes]]) -> None:
    start(started, SPINS)
    stopped = start(started, SPINS)
    os.kill(stopped, signal.SIGSTOP)
    os.waitpid(stopped, os.WUNTRACED)
    for host in (stopped, start(started, SLEEPS)):
        # The first two looks may find what went before.
        assert not any(list(waits(host, 10))[2:])


@counted
def test_a_silences_first_look_and_one_too_soon_find_nothing(
    started: list[subprocess.Popen[bytes]],
) -> None:
    start(started, SPINS)
    waiting = Waiting(start(started, SPINS))
    for begin in range(1_000_000, 1_500_000, 50_000):
        time.sleep(LOOK * 1e-6)
        assert waiting.waited_since(begin, begin + 20_000) == 0
        time.sleep(LOOK * 1e-6)
        assert waiting.waited_since(begin, begin + 21_000) == 0


def test_who_is_not_there_does_not_wait(started: list[subprocess.Popen[bytes]]) -> None:
    host = start(started, SLEEPS)
    os.kill(host, signal.SIGKILL)
    started[0].wait()
    assert not any(waits(host, 3))
