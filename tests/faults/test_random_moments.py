"""Processes that play on a device, each killed or stopped for 10 s at any moment of its life.

What runs here is what the lab and a study run as their device's process (`session.run_play`).
tests/protocol/test_host_that_ends.py does it on a simulated clock, in the default run too.
"""

from __future__ import annotations

import os
import random
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.faults.forked import Forked
from tests.faults.playing_host import tell_ending

from squeezefilm.instruments.device.machine.playing import CLOCK
from squeezefilm.instruments.device.wire.frames import Fault
from squeezefilm.instruments.session.record.trace import read_trace

from .test_play_faults import observed_twin

pytestmark = [
    pytest.mark.nightly,
    pytest.mark.realtime,
    pytest.mark.skipif(
        sys.platform == "win32", reason="pseudo-terminals and SIGSTOP need a POSIX system"
    ),
]
MOMENTS = 80  # and twenty of the lab and its worker, in test_lab_killed.py
_PATIENCE = 120.0


def until(happened: Callable[[], bool], what: str) -> None:
    end = time.monotonic() + _PATIENCE
    while not happened():
        assert time.monotonic() < end, f"waited {_PATIENCE:g} s for {what}"
        time.sleep(0.01)


def rows(trace: Path) -> int:
    """How many the record has; -1 before there is one."""
    return len(read_trace(trace).rows) if trace.exists() else -1


def ended(host: Forked) -> str:
    """How a host ended that was left to."""
    found = host.hear(_PATIENCE)
    host.process.join(_PATIENCE)
    assert host.process.exitcode == 0
    return str(found)


def hit(host: Forked, trace: Path, pick: random.Random) -> str:
    """Kill or stop a host at a random moment from its opening the port on; returns how it ended."""
    least = pick.choice((0, 0, 1, 100))  # rows of the record: before it plays, and while it does
    until(lambda: rows(trace) >= least or host.has_ended(), "the record")
    time.sleep(pick.uniform(0.0, 0.5))
    if host.has_ended():  # a computer that is too busy ends it before
        return ended(host)
    if pick.random() < 0.95:
        before = len(read_trace(trace).rows)
        host.kill()
        after = read_trace(trace)
        assert len(after.rows) >= before
        assert not after.damage.lost_blocks
        return "killed"
    send(host, signal.SIGSTOP)
    time.sleep(10.0)
    send(host, signal.SIGCONT)
    time.sleep(1.0)
    if not host.has_ended():  # it had not armed the device yet, and plays now
        send(host, signal.SIGINT)
    found = ended(host)
    assert found in ("FAULT", "LINK", "LOOP", "INTERRUPTED")
    assert read_trace(trace).damage.whole
    return found


def send(host: Forked, number: int) -> None:
    assert host.process.pid is not None
    os.kill(host.process.pid, number)


def plays(host: Forked, trace: Path) -> bool:
    """Whether a host that is let alone plays; a computer that is too busy may end it before."""
    until(lambda: rows(trace) > 100 or host.has_ended(), "rows")
    send(host, signal.SIGINT)
    return ended(host) == "INTERRUPTED"


def test_hosts_killed_and_stopped_at_random_moments(tmp_path: Path) -> None:
    seed = random.SystemRandom().randrange(2**31)
    print(f"seed {seed}")
    pick = random.Random(seed)
    endings: list[str] = []
    played = False
    with observed_twin(tmp_path) as twin:
        for number in range(MOMENTS + 10):
            trace = tmp_path / f"{number}.sqft"
            host = Forked(tell_ending, twin.port, trace, 60.0)
            try:
                if number < MOMENTS:
                    endings.append(hit(host, trace, pick))
                elif plays(host, trace):  # what follows finds a device that plays
                    played = True
                    break
            finally:
                host.kill()
        faults, _ = twin.observed()
    counts = {name: endings.count(name) for name in sorted(set(endings))}
    print(f"{counts}, {len(faults)} of them while the device was armed")
    assert played
    assert counts["killed"] > 0.5 * MOMENTS
    assert len(faults) > 0.2 * MOMENTS
    for fault in faults:
        assert fault["fault"] == Fault.WATCHDOG
        assert (fault["zero_us"] - fault["heard_us"]) & CLOCK <= 60_000, fault
