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

from squeezefilm.instruments.device.wire.frames import Fault
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.record.trace import read_trace

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(
        sys.platform == "win32", reason="pseudo-terminals and SIGSTOP need a POSIX system"
    ),
]
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


def require_zero_in_time(faults: list[dict[str, int]], levels: np.ndarray) -> None:
    """The output was at zero 60 ms after the last frame accepted before the fault, and stayed."""
    assert [one["fault"] for one in faults] == [Fault.WATCHDOG]
    heard = faults[0]["heard_us"] * 1e-6
    assert np.any(levels[np.abs(levels[:, 0] - heard) < 5e-3, 1] > 0.0), "it was playing then"
    after = levels[levels[:, 0] > heard]
    zero = float(after[after[:, 1] == 0.0][0, 0])
    print(f"output at zero {1e3 * (zero - heard):.1f} ms after the last accepted frame")
    assert zero - heard <= ZERO_WITHIN
    assert not np.any(after[(after[:, 0] >= zero) & (after[:, 0] < zero + 0.2), 1])


@pytest.mark.slow
def test_a_host_that_is_interrupted_and_one_that_is_killed(tmp_path: Path) -> None:
    with observed_twin(tmp_path) as twin:
        with playing_host(twin, tmp_path / "interrupted.sqft") as host:
            host.send_signal(signal.SIGINT)
            out, error = host.communicate(timeout=_PATIENCE)
        assert host.returncode == 0, error
        assert json.loads(out)["ending"] == "INTERRUPTED"
        with playing_host(twin, tmp_path / "killed.sqft") as host:
            before = len(read_trace(tmp_path / "killed.sqft").rows)
            os.kill(host.pid, signal.SIGKILL)
            host.wait()
            time.sleep(0.5)
        # One fault only: the interrupted host had disarmed the device.
        require_zero_in_time(*twin.observed())
    trace = read_trace(tmp_path / "interrupted.sqft")
    assert trace.damage.whole
    end = next(event.fields for event in trace.events if event.kind == "end")
    assert end["device_at_zero"]
    trace = read_trace(tmp_path / "killed.sqft")
    assert not trace.damage.closed
    assert not trace.damage.lost_blocks
    assert len(trace.rows) >= before


@pytest.mark.slow
def test_a_host_that_is_stopped_for_5_s_with_its_children_was_not_usable(tmp_path: Path) -> None:
    """As by a computer that is put to sleep: `play` ends with exit code 1 then."""
    with observed_twin(tmp_path) as twin, playing_host(twin, tmp_path / "a.sqft") as host:
        listed = subprocess.run(
            ["ps", "-o", "pid=", "--ppid", str(host.pid)],
            capture_output=True,
            text=True,
            check=True,
        )  # fmt: skip
        children = [int(pid) for pid in listed.stdout.split()]
        assert children, "the loop runs in a process of its own"
        for pid in (host.pid, *children):
            os.kill(pid, signal.SIGSTOP)
        time.sleep(5.0)
        for pid in (*children, host.pid):
            os.kill(pid, signal.SIGCONT)
        out, error = host.communicate(timeout=_PATIENCE)
        assert host.returncode == 0, error
    said = json.loads(out)
    assert not said["usable"]
    assert said["message"] or said["ticks"]


@pytest.mark.slow
def test_a_host_that_is_stopped_for_5_s_and_one_that_is_unplugged(tmp_path: Path) -> None:
    with observed_twin(tmp_path) as twin:
        with playing_host(twin, tmp_path / "stopped.sqft") as host:
            os.kill(host.pid, signal.SIGSTOP)
            time.sleep(5.0)
            os.kill(host.pid, signal.SIGCONT)
            out, error = host.communicate(timeout=_PATIENCE)
        assert host.returncode == 0, error
        said = json.loads(out)
        assert said["ending"] == "FAULT"
        assert "watchdog" in said["message"]
        # The next session clears that fault; the twin's end is the cable being pulled.
        with playing_host(twin, tmp_path / "unplugged.sqft") as host:
            faults, levels = twin.observed()
            out, error = host.communicate(timeout=_PATIENCE)
        assert host.returncode == 0, error
    require_zero_in_time(faults, levels)
    trace = read_trace(tmp_path / "stopped.sqft")
    assert trace.damage.whole
    seen = [event.fields["fault"] for event in trace.events if event.kind == "device"]
    assert "watchdog" in seen
    said = json.loads(out)
    assert said["ending"] == "LINK"
    assert "unplugged" in said["message"] or "said nothing" in said["message"]
    trace = read_trace(tmp_path / "unplugged.sqft")
    assert trace.damage.whole
    assert len(trace.rows) == said["rows"]
