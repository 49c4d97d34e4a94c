"""What a session on a device leaves in a study: path, raw trace, verification."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.record.trace import Damage, Trace
from squeezefilm.study.conduct.played_device import SessionDevice, require_study_drive
from squeezefilm.study.conduct.playing_process import WorkerOrders, explored
from squeezefilm.study.conduct.run import Response, StudyRun
from squeezefilm.study.conduct.sessions import begin_session
from squeezefilm.study.conduct.study_device import DeviceVerification, NoDevice, TrialMotion
from squeezefilm.study.record.deletion import delete_participant
from squeezefilm.study.record.store import StudyStore

from ..scripted import CONSENT, gratings


def record(time: np.ndarray, x: np.ndarray, flags: np.ndarray) -> Trace:
    rows = np.full((len(time), len(column.COLUMNS)), math.nan)
    rows[:, column.TIME], rows[:, column.X], rows[:, column.Y] = time, x, 0.0
    rows[:, column.FLAGS] = flags
    about = {"display": "plate", "columns": list(column.COLUMNS)}
    return Trace(column.COLUMNS, rows, (), about, Damage(0, 0, True, ()))


def test_the_way_and_speed_of_a_finger_leave_out_what_it_did_in_the_air() -> None:
    time = np.arange(0.0, 3.0, 1e-3)
    x = 0.05 * time
    lifted = (time > 0.9995) & (time < 1.9995)
    # In the air it goes back to where it began.
    x[time > 1.9995] -= 0.1
    found = explored(record(time, x, np.where(lifted, column.NOT_TOUCHING, 0)), "a.sqft")
    assert found.path_length == pytest.approx(0.05 * 2.0, rel=0.02)
    assert found.mean_speed == pytest.approx(0.05, rel=1e-6)
    assert math.isnan(found.mean_normal_force)
    assert found.raw_trace == "a.sqft"
    lines = found.trace.splitlines()
    assert json.loads(lines[0][1:]) == {"display": "plate"}
    assert lines[1].startswith("time_s,x_m,y_m")
    assert len(lines) == 2 + 200


def test_a_finger_that_never_touched_has_no_speed() -> None:
    time = np.arange(0.0, 1.0, 1e-3)
    found = explored(record(time, time, np.full(1000, column.NOT_TOUCHING)), "a.sqft")
    assert math.isnan(found.mean_speed)
    assert math.isnan(found.path_length)
    assert found.trace == ""


def test_a_pickup_that_was_never_calibrated_is_judged_by_its_resonance_alone() -> None:
    good = DeviceVerification(resonance_frequency=33e3, expected_resonance_frequency=33.1e3)
    assert good.passed
    off = DeviceVerification(resonance_frequency=30e3, expected_resonance_frequency=33.1e3)
    assert [one.split()[0] for one in off.problems] == ["resonance"]
    lost = DeviceVerification(
        expected_amplitude=1e-6, resonance_frequency=33e3, expected_resonance_frequency=33e3
    )
    assert [one.split()[0] for one in lost.problems] == ["amplitude"]


@pytest.mark.parametrize("drive", ["sound", "sound:0", "serial:", "serial: ", "twin2", ""])
def test_a_drive_that_no_study_may_use_is_refused(drive: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not stop by itself"):
        SessionDevice(WorkerOrders("biet2008-plate", drive, tmp_path))


def test_a_display_that_a_device_may_not_play_is_refused_before_a_session(tmp_path: Path) -> None:
    SessionDevice(WorkerOrders("biet2008-stator", "twin", tmp_path)).close()
    with pytest.raises(InputError, match="touch-side insulation"):
        SessionDevice(WorkerOrders("biet2008-stator", "serial:/dev/ttyACM0", tmp_path))


def test_a_device_is_told_apart_by_display_and_calibration_and_not_by_its_port(
    tmp_path: Path,
) -> None:
    require_study_drive("twin", "biet2008-stator")
    made = {
        name: SessionDevice(WorkerOrders("biet2008-plate", drive, tmp_path, **how)).identity()
        for name, drive, how in (
            ("twin", "twin", {}),
            ("bare", "serial:/dev/ttyACM0", {}),
            ("known", "serial:/dev/ttyACM1", {"amplitude_per_pickup": 2e-6}),
        )
    }
    assert [one.name for one in made.values()] == ["twin", "serial", "serial"]
    assert len({one.device_sha256 for one in made.values()}) == 1
    assert made["bare"].calibration_sha256 == ""
    assert len({one.calibration_sha256 for one in made.values()}) == 3


def test_a_device_that_does_nothing_yet_is_stopped_halted_and_closed_at_no_cost(
    tmp_path: Path,
) -> None:
    with SessionDevice(WorkerOrders("biet2008-plate", "twin", tmp_path)) as device:
        device.halt()
        assert device.stop().trace == ""
        device.close()
    assert list(tmp_path.iterdir()) == []


def test_a_raw_trace_belongs_to_its_answer_and_goes_with_the_participant(tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "s.sqlite", gratings(), 1) as store:
        who = store.enrol()
        session = begin_session(store, who, NoDevice(), CONSENT, None, acknowledged=False)
        run = StudyRun(store, session)
        while (shown := run.next_trial()) is not None and not shown.trial.asks:
            run.respond(shown.token, Response())
        assert shown is not None
        store.traces.mkdir()
        raw, lost = store.traces / f"{'ab' * 16}.sqft", store.traces / f"{'cd' * 16}.sqft"
        raw.write_bytes(b"rows")
        lost.write_bytes(b"rows of a surface that failed")
        felt = TrialMotion(0.1, 0.08, trace="time_s\n0\n", raw_trace=raw.name)
        assert run.presented(shown.token).trial == shown.trial
        assert not run.recorded(shown.token)
        run.respond(shown.token, Response(shown.trial.alternatives[0], explorations=(felt,)))
        assert run.recorded(shown.token)
        with pytest.raises(InputError, match="is not being presented"):
            run.presented(shown.token)
        names = json.loads(
            store.rows("SELECT traces FROM response WHERE choice != ''")[0]["traces"]
        )
        assert names[1] == raw.name
        assert store.unreferenced_traces() == [lost]
        delete_participant(store, who)
        assert list(store.traces.iterdir()) == []
