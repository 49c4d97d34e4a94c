"""The loop's process and its host, each killed or stopped; nothing here measures performance."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core.errors import InputError, LoopError, SqueezefilmWarning
from squeezefilm.core.quantities import FloatArray
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.loop.process import LoopProcess
from squeezefilm.instruments.session.loop.shared import ring_waiting
from squeezefilm.instruments.session.loop.worker import MARGIN
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ, MotionEstimator
from squeezefilm.physics.render.program.lowering import lower
from squeezefilm.physics.render.resonator.envelope import DrivenEnvelope
from squeezefilm.physics.render.texture.levels import Amplitude
from squeezefilm.physics.render.texture.shapes import SquareWave

pytestmark = pytest.mark.realtime
# Far beyond what any of it takes; a limit for a test that hangs.
PATIENCE = 60.0
RATE = 1e3
PLAN = LoopPlan(
    program=lower(Amplitude(SquareWave(2e-3), 0.1e-6, 0.8e-6), largest_amplitude=1e-6),
    rate=RATE,
    envelope=DrivenEnvelope(1e-3, 1e-3, 1e-6),
    amplitude_per_volt=1e-8,
    estimator=MotionEstimator.for_sensor(LVDT_10_KHZ),
    host_timeout=1.0,
)


def _until(condition: Callable[[], bool], what: str) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, f"waited {PATIENCE:g} s for {what}"
        time.sleep(2e-3)


def _ticked(loop: LoopProcess, ticks: int) -> FloatArray:
    """Rows of at least so many ticks, the finger led along meanwhile."""
    found: list[FloatArray] = []

    def enough() -> bool:
        now = loop.time
        loop.feed(np.array([[now, 0.06 * now, 0.0, 1.0, math.nan, math.nan]]))
        loop.take_commands()
        found.append(loop.take_rows())
        return sum(map(len, found)) >= ticks

    _until(enough, f"{ticks} ticks")
    return np.concatenate(found)


def test_a_loop_runs_in_its_own_process_and_reports() -> None:
    with LoopProcess(PLAN, priority=None) as loop:
        rows = _ticked(loop, 300)
        before = loop.silence
        report = loop.stop()
    assert before >= 0.0
    numbers = rows[:, column.TICK]
    assert numbers[0] >= 0
    assert np.all(np.diff(numbers) >= 1)
    np.testing.assert_array_equal(rows[:, column.TIME], numbers * PLAN.period)
    assert np.all(rows[:, column.LATENESS] < 1 / RATE)
    # Every tick that was due up to the last is accounted for.
    late = report.lateness
    assert late.made + late.lost >= numbers[-1] + 1
    assert late.made >= len(rows)
    assert np.any(rows[:, column.VOLTAGE] > 0)
    assert not report.real_time_priority
    assert report.refused_commands == report.dropped_rows == report.dropped_samples == 0
    assert report.spin_share == 0.0
    assert loop.stop() is report
    loop.check()


@pytest.mark.slow
def test_paced_by_python_it_is_the_same_loop_and_says_so() -> None:
    with LoopProcess(PLAN, priority=None, compiled_clock=False) as loop:
        rows = _ticked(loop, 100)
        report = loop.stop()
    assert not report.compiled_clock
    assert np.all(np.diff(rows[:, column.TICK]) >= 1)
    assert report.spin_share == 0.0


@pytest.mark.slow
def test_muted_and_unheard_it_plays_nothing() -> None:
    with LoopProcess(PLAN, priority=None) as loop:
        _ticked(loop, 50)
        loop.mute()
        seen: list[FloatArray] = []

        def muted() -> bool:
            seen.append(_ticked(loop, 1))
            return int(seen[-1][-1, column.FLAGS]) & column.MUTED > 0

        _until(muted, "a muted tick")
        rows = np.concatenate([*seen, _ticked(loop, 20)])
        flagged = rows[:, column.FLAGS].astype(int) & column.MUTED > 0
        # From the first muted tick on, all are.
        assert np.all(flagged[np.argmax(flagged) :])
        assert np.all(rows[flagged, column.VOLTAGE] == 0)
        loop.mute(False)
        # For longer than the timeout nothing is said; rows of that time wait.
        time.sleep(PLAN.host_timeout + 0.2)
        rows = loop.take_rows()
        silent = rows[:, column.FLAGS].astype(int) & column.HOST_SILENT > 0
        assert np.any(silent)
        assert np.all(rows[silent, column.VOLTAGE] == 0)
        # Commands from before are too old to be played.
        oldest = loop.time - PLAN.host_timeout
        assert np.all(loop.take_commands()[:, column.COMMAND_TIME] >= oldest)
        assert loop.report().stale_commands > 0


@pytest.mark.slow
def test_a_stopped_loop_loses_ticks_and_goes_on_without_a_burst() -> None:
    with LoopProcess(PLAN, priority=None) as loop:
        before = _ticked(loop, 100)
        worker = loop._running()[0].pid
        os.kill(worker, signal.SIGSTOP)
        os.waitpid(worker, os.WUNTRACED)
        time.sleep(1.0)
        assert loop.silence > 0.9
        os.kill(worker, signal.SIGCONT)
        rows = np.concatenate([before, _ticked(loop, 200)])
        report = loop.stop()
    numbers = rows[:, column.TICK]
    gaps = np.diff(numbers)
    assert gaps.max() >= 0.9 * RATE
    stop = int(np.argmax(gaps))
    assert int(rows[stop + 1, column.FLAGS]) & column.AFTER_LOST_TICKS
    # No tick is made twice or made up for: each one is the latest due.
    assert np.all(gaps >= 1)
    assert np.all(rows[:, column.LATENESS] < 1 / RATE)
    assert report.lateness.lost >= gaps.max() - 1
    assert report.lateness.longest >= 0.9


def test_a_killed_loop_is_noticed_and_what_it_wrote_is_kept() -> None:
    loop = LoopProcess(PLAN, priority=None)
    loop.start()
    _ticked(loop, 50)
    process, memory = loop._running()
    _until(lambda: ring_waiting(memory.row_counters) >= 10, "rows that nobody took")
    process.kill()
    process.wait()
    with pytest.raises(LoopError, match=r"killed by signal 9; the device stops by its own"):
        loop.feed(np.zeros((1, 6)))
    with pytest.raises(LoopError, match="killed by signal 9"):
        loop.take_commands()
    rows = loop.take_rows()
    assert len(rows) >= 10
    assert np.all(np.diff(rows[:, column.TICK]) >= 1)
    assert loop.stop().lateness.made >= len(rows)


HOST = """
import os, sys, time
from squeezefilm.instruments.session.loop.process import LoopProcess
sys.path.insert(0, sys.argv[1])
from test_loop_process import PLAN
loop = LoopProcess(PLAN, priority=None)
loop.start()
print(loop._running()[0].pid, flush=True)
time.sleep(600)
"""


def _alive(process: int) -> bool:
    try:
        os.kill(process, 0)
        state = Path(f"/proc/{process}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
    except (ProcessLookupError, FileNotFoundError):
        return False
    return state[0] != "Z"


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
def test_a_loop_whose_host_was_killed_ends_by_itself() -> None:
    here = str(Path(__file__).parent)
    with subprocess.Popen([sys.executable, "-c", HOST, here], stdout=subprocess.PIPE) as host:
        assert host.stdout is not None
        worker = int(host.stdout.readline())
        assert _alive(worker)
        host.kill()
    _until(lambda: not _alive(worker), "the loop to end")


UNPRIVILEGED = """
import ctypes, resource, sys, warnings
# Neither a capability (24: drop from the bounding set, 23: CAP_SYS_NICE) nor a limit allows it.
ctypes.CDLL(None).prctl(24, 23, 0, 0, 0)
resource.setrlimit(resource.RLIMIT_RTPRIO, (0, 0))
from squeezefilm.instruments.session.loop.process import LoopProcess
sys.path.insert(0, sys.argv[1])
from test_loop_process import PLAN
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    with LoopProcess(PLAN) as loop:
        report = loop.stop()
print(report.real_time_priority, *(str(one.message) for one in caught))
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="takes Linux's capabilities away")
def test_without_real_time_priority_it_runs_and_warns() -> None:
    here = str(Path(__file__).parent)
    done = subprocess.run(
        [sys.executable, "-c", UNPRIVILEGED, here], capture_output=True, text=True, check=True
    )
    assert done.stdout.startswith("False the loop runs without real-time priority"), done.stdout
    assert "rtprio limit" in done.stdout


@pytest.mark.slow
def test_where_priority_is_granted_nothing_is_said_and_elsewhere_it_is() -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        with LoopProcess(PLAN) as loop:
            report = loop.stop()
    assert 0 <= report.spin_share <= MARGIN * RATE * 1.01
    kinds = [one.category for one in caught]
    assert kinds == ([] if report.real_time_priority else [SqueezefilmWarning])


def test_a_worker_that_cannot_run_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", "")
    monkeypatch.setenv("PYTHONSAFEPATH", "1")
    monkeypatch.setattr(sys, "executable", "/bin/false")
    with pytest.raises(LoopError, match="ended with exit code 1"):
        LoopProcess(PLAN, priority=None).start()


def test_calls_out_of_order_are_refused_in_words() -> None:
    loop = LoopProcess(PLAN, priority=None)
    with pytest.raises(LoopError, match="was not started"):
        loop.take_rows()
    with pytest.raises(LoopError, match="was not started"):
        loop.stop()
    with pytest.raises(InputError, match="priority = 100"):
        LoopProcess(PLAN, priority=100)
    with loop, pytest.raises(LoopError, match="started before"):
        loop.start()
