"""A session of a study on a device behind a real port, in real time; and one that dies under it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core.config.schema import text_of
from squeezefilm.core.errors import DeviceError
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.record.trace import read_trace
from squeezefilm.instruments.twin.settings import PickupModel, TwinSettings
from squeezefilm.physics.perception.stimuli import Grating, Stimulus
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ
from squeezefilm.study.conduct.played_device import SessionDevice
from squeezefilm.study.conduct.playing_process import WorkerOrders
from squeezefilm.study.conduct.run import Acknowledgement, Presentation, StudyRun
from squeezefilm.study.conduct.sessions import (
    Exposure,
    SessionConditions,
    begin_session,
    end_session,
)
from squeezefilm.study.conduct.study_device import NoDevice, StudyDevice
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.record.store import Row, StudyStore

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(sys.platform == "win32", reason="there are no ptys on Windows"),
]
DISPLAY = "biet2008-plate"
PICKUP = PickupModel(kind="sensing_patch")
EXPOSURE = Exposure(DISPLAY, 33e3, 0.5, 120.0, 60.0, None, "", "made up for this test")
DESIGN = StudyDesign(
    name="small",
    title="Small",
    displays=(DISPLAY,),
    task="match-to-sample",
    stimuli=(Stimulus("4 mm", 4e-3, "period", low=0.8), Stimulus("8 mm", 8e-3, "period", low=0.8)),
    alternatives=(Grating("4 mm", 4e-3, "period"), Grating("8 mm", 8e-3, "period")),
    familiarisation=0,
    repetitions=1,
)


class Strokes:
    """An examiner whose person feels each surface for a while; something may happen meanwhile."""

    def __init__(self, happens: object = None) -> None:
        self.happens = happens

    def rest(self, duration: float) -> None:
        pass

    def feel(self, presentation: Presentation, place: int) -> None:
        pass

    def ask(self, presentation: Presentation) -> str:
        time.sleep(1.0)
        if callable(self.happens):
            self.happens()
            time.sleep(0.5)
        return presentation.trial.alternatives[0]

    def acknowledge(self, presentation: Presentation, told: Acknowledgement) -> None:
        assert told.correct is not None


def twin_process(folder: Path, stroke: str) -> tuple[subprocess.Popen[str], str]:
    settings = folder / "twin.toml"
    settings.write_text(text_of(TwinSettings(sensor=LVDT_10_KHZ, pickup=PICKUP)), encoding="utf-8")
    command = [sys.executable, "-m", "squeezefilm.instruments.twin.pty_server", DISPLAY]
    process = subprocess.Popen(
        [*command, "--settings", str(settings), "--stroke", stroke],
        stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdout is not None
    return process, process.stdout.readline().strip()


@pytest.fixture
def store(tmp_path: Path) -> Iterator[StudyStore]:
    with StudyStore.create(tmp_path / "s.sqlite", DESIGN, 1) as one:
        yield one


def begun(store: StudyStore, device: StudyDevice) -> StudyRun:
    conditions = SessionConditions(consent=True)
    return StudyRun(
        store,
        begin_session(store, store.enrol(), device, conditions, EXPOSURE, acknowledged=True),
    )


def conducted(run: StudyRun, device: StudyDevice) -> int:
    """How many trials were answered to the end of the run."""
    before = run.remaining
    for _ in range(4):
        try:
            conduct(run, device, Strokes())
            break
        except DeviceError as error:
            # A machine that holds a process up for 50 ms is stopped by the device, as it must be;
            # then the trial comes again.
            if "heard nothing for 50 ms" not in str(error):
                raise
    return before - run.remaining


def counted(store: StudyStore) -> list[Row]:
    """The answers that count: a trial that the machine held up is set aside and comes again."""
    aside = "SELECT 1 FROM set_aside a WHERE a.trial = r.trial"
    return store.rows(f"SELECT * FROM response r WHERE NOT EXISTS ({aside})")


@pytest.mark.slow
def test_a_session_on_a_twin_behind_a_port(store: StudyStore) -> None:
    with SessionDevice(WorkerOrders(DISPLAY, "twin", store.traces)) as device:
        run = begun(store, device)
        conducted(run, device)
        assert run.state == "finished"
        after = end_session(store, run.session["uuid"], device)
    assert after.passed
    assert after.resonance_frequency == pytest.approx(after.expected_resonance_frequency, rel=2e-3)
    rows = counted(store)
    assert len(rows) == 2
    for row in rows:
        # A second of strokes of 80 mm/s on average: of all of one, or where the machine held the
        # trial up of its middle alone, in which a sine is faster by π/2.
        assert 0.04 < row["mean_speed_m_per_s"] < 0.13
        assert row["path_length_m"] > 0.04
        assert row["device_sha256"]
        assert row["calibration_sha256"]
        path, raw = json.loads(row["traces"])
        assert path.endswith(".csv")
        trace = read_trace(store.traces / raw)
        assert trace.damage.whole
        felt = json.loads(row["stimuli"])[0]
        assert trace.metadata["stimulus"] == felt
        end = next(one.fields for one in trace.events if one.kind == "end")
        assert end["device_at_zero"]
        # Both levels of the grating were played.
        friction = trace.rows[:, column.FRICTION]
        assert np.nanmin(friction) < 0.85
        assert np.nanmax(friction) > 0.95
    verified = store.rows("SELECT * FROM verification")
    assert [one["passed"] for one in verified] == [1, 1]


@pytest.mark.nightly
def test_a_device_that_dies_in_a_trial_leaves_no_answer_and_the_trial_comes_again(
    store: StudyStore, tmp_path: Path
) -> None:
    twin, port = twin_process(tmp_path, "60 mm in 0.75 s")
    with twin:
        link = tmp_path / "port"
        link.symlink_to(port)
        # Not verified here, since its finger never lifts.
        with SessionDevice(WorkerOrders(DISPLAY, f"serial:{link}", store.traces)) as device:
            who = store.enrol()
            session = begin_session(
                store, who, NoDevice(), SessionConditions(consent=True), None, acknowledged=False
            )
            run = StudyRun(store, session)

            def die() -> None:
                os.kill(twin.pid, signal.SIGKILL)

            with pytest.raises(DeviceError, match="not answered and comes again") as told:
                conduct(run, device, Strokes(die))
            print(told.value)
            assert store.rows("SELECT * FROM response") == []
            before = store.rows("SELECT * FROM presentation")
            assert len(before) == 1
            with pytest.raises(DeviceError, match="cannot be opened"):
                conduct(run, device, Strokes())
            assert store.rows("SELECT * FROM response") == []
            again, port = twin_process(tmp_path, "60 mm in 0.75 s")
            with again:
                link.unlink()
                link.symlink_to(port)
                try:
                    assert conducted(run, device) == 2
                finally:
                    again.terminate()
    found = store.rows("SELECT trial, count(*) AS n FROM presentation GROUP BY trial")
    shown = {one["trial"]: one["n"] for one in found}
    assert len(shown) >= 2
    assert shown[before[0]["trial"]] >= 3
    assert len(counted(store)) == 2
    # The record of the surface that failed is nobody's.
    assert len(store.unreferenced_traces()) >= 1


KILLED = """
import os, signal, sys, time
from pathlib import Path
from squeezefilm.study.conduct.played_device import SessionDevice
from squeezefilm.study.conduct.playing_process import WorkerOrders
from squeezefilm.physics.perception.stimuli import Stimulus
if __name__ == "__main__":
    device = SessionDevice(WorkerOrders("biet2008-plate", "twin", Path(sys.argv[1])))
    device.present(Stimulus("8 mm", 8e-3, "period", low=0.8), 1)
    time.sleep(1)
    os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.nightly
def test_a_study_that_is_killed_leaves_its_device_at_zero(tmp_path: Path) -> None:
    script, traces = tmp_path / "killed.py", tmp_path / "traces"
    script.write_text(KILLED, encoding="utf-8")
    done = subprocess.run([sys.executable, str(script), str(traces)], timeout=120, check=False)
    assert done.returncode == -signal.SIGKILL
    (raw,) = traces.iterdir()
    until = time.monotonic() + 60
    while not (trace := read_trace(raw)).damage.closed and time.monotonic() < until:
        time.sleep(0.1)
    assert trace.damage.whole
    end = next(one.fields for one in trace.events if one.kind == "end")
    assert end["device_at_zero"]
