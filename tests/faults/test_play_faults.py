"""A host that dies, is stopped or is unplugged while it plays on a device behind a real port.

What the device's output did is judged on the device's own clock.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.device.machine import Fault
from squeezefilm.session import rows as column
from squeezefilm.session.record import read_trace

pytestmark = pytest.mark.skipif(
    sys.platform == "win32", reason="pseudo-terminals and SIGSTOP need a POSIX system"
)
HERE = Path(__file__).parent
ZERO_WITHIN = 60e-3
_PATIENCE = 120.0


@dataclass
class Twin:
    process: subprocess.Popen[str]
    port: str
    said: Path
    levels: Path

    def observed(self) -> tuple[list[dict[str, int]], np.ndarray]:
        self.process.terminate()
        self.process.wait(30)
        return json.loads(self.said.read_text()), np.load(self.levels)


@contextlib.contextmanager
def observed_twin(folder: Path) -> Iterator[Twin]:
    said, levels = folder / "faults.json", folder / "levels.npy"
    process = subprocess.Popen(
        [sys.executable, str(HERE / "observed_twin.py"), str(said), str(levels)],
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    try:
        yield Twin(process, process.stdout.readline().strip(), said, levels)
    finally:
        process.kill()
        process.wait()
        process.stdout.close()


@contextlib.contextmanager
def playing_host(twin: Twin, trace: Path) -> Iterator[subprocess.Popen[str]]:
    """A host that has played for a while: its record shows the device's output above zero."""
    host = subprocess.Popen(
        [sys.executable, str(HERE / "playing_host.py"), twin.port, str(trace), "60"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        end = time.monotonic() + _PATIENCE
        while time.monotonic() < end:
            if host.poll() is not None:
                _, error = host.communicate()
                raise AssertionError(f"the host ended before it played: {error}")
            if trace.exists():
                rows = read_trace(trace).rows
                if len(rows) and np.count_nonzero(rows[:, column.LEVEL] > 0) > 500:
                    break
            time.sleep(0.05)
        else:
            raise AssertionError("the host never played")
        yield host
    finally:
        host.kill()
        host.communicate()


def require_zero_in_time(twin: Twin) -> float:
    """The device's output was at zero 60 ms after the frame it last accepted before its fault."""
    faults, levels = twin.observed()
    assert [one["fault"] for one in faults] == [Fault.WATCHDOG]
    heard = faults[0]["heard_us"] * 1e-6
    playing = levels[levels[:, 1] > 0.0, 0]
    assert np.any(playing > heard - 5e-3), "it was playing when the host fell silent"
    zero = float(playing[-1]) - heard
    print(f"output at zero {1e3 * zero:.1f} ms after the last accepted frame")
    assert zero <= ZERO_WITHIN
    return zero


def test_a_killed_host_leaves_the_output_at_zero_within_60_ms(tmp_path: Path) -> None:
    with observed_twin(tmp_path) as twin:
        with playing_host(twin, tmp_path / "killed.sqft") as host:
            before = len(read_trace(tmp_path / "killed.sqft").rows)
            os.kill(host.pid, signal.SIGKILL)
            host.wait()
            time.sleep(0.3)
        require_zero_in_time(twin)
    trace = read_trace(tmp_path / "killed.sqft")
    assert not trace.damage.closed
    assert not trace.damage.lost_blocks
    assert len(trace.rows) >= before


def test_a_stopped_host_says_what_happened_when_it_goes_on(tmp_path: Path) -> None:
    with observed_twin(tmp_path) as twin:
        with playing_host(twin, tmp_path / "stopped.sqft") as host:
            os.kill(host.pid, signal.SIGSTOP)
            time.sleep(5.0)
            os.kill(host.pid, signal.SIGCONT)
            out, error = host.communicate(timeout=_PATIENCE)
        require_zero_in_time(twin)
    assert host.returncode == 0, error
    said = json.loads(out)
    assert said["ending"] == "FAULT"
    assert "watchdog" in said["message"]
    trace = read_trace(tmp_path / "stopped.sqft")
    assert trace.damage.whole
    faults = [event.fields["fault"] for event in trace.events if event.kind == "device"]
    assert "watchdog" in faults


def test_an_unplugged_device_is_told_and_the_record_kept(tmp_path: Path) -> None:
    with observed_twin(tmp_path) as twin:
        with playing_host(twin, tmp_path / "unplugged.sqft") as host:
            twin.process.kill()
            out, error = host.communicate(timeout=_PATIENCE)
        assert host.returncode == 0, error
    said = json.loads(out)
    assert said["ending"] == "LINK"
    assert "unplugged" in said["message"] or "nothing" in said["message"]
    trace = read_trace(tmp_path / "unplugged.sqft")
    assert trace.damage.whole
    assert len(trace.rows) == said["rows"]


def test_an_interrupt_ramps_to_zero_and_closes_the_record(tmp_path: Path) -> None:
    with observed_twin(tmp_path) as twin:
        with playing_host(twin, tmp_path / "interrupted.sqft") as host:
            host.send_signal(signal.SIGINT)
            out, error = host.communicate(timeout=_PATIENCE)
        faults, levels = twin.observed()
    assert host.returncode == 0, error
    assert json.loads(out)["ending"] == "INTERRUPTED"
    assert faults == []
    assert levels[-1, 1] == 0.0
    trace = read_trace(tmp_path / "interrupted.sqft")
    assert trace.damage.whole
    end = next(event.fields for event in trace.events if event.kind == "end")
    assert end["device_at_zero"]
