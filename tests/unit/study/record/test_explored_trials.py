"""Measures of the paths beside a study: in exports with their units, blank where there is none."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np
import pytest
from tests.unit.study.design.test_matching import shapes

from squeezefilm.core.formats.traces import Table, csv_text
from squeezefilm.physics.display import load_display
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.study.conduct.run import Response, StudyRun
from squeezefilm.study.conduct.sessions import SessionConditions, begin_session
from squeezefilm.study.conduct.study_device import NoDevice, TrialMotion
from squeezefilm.study.record.answers import recorded_answers
from squeezefilm.study.record.exploration import MEASURES, face_of
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import csv_text as trials_csv
from squeezefilm.study.record.tables import trial_columns, trial_table

PLATE, OBSERVER = load_display("biet2008-plate"), load_observer()
FINGER = OBSERVER.median_finger()


def _line(seconds: float, length: float) -> str:
    t = np.arange(0.0, seconds + 1e-9, 0.01)
    return csv_text(Table({"time_s": t, "x_m": length * t / seconds, "y_m": 0 * t}))


def _answered(path: Path, trace: str) -> StudyStore:
    store = StudyStore.create(path, shapes(familiarisation=0), 1)
    begun = begin_session(
        store, store.enrol(), NoDevice(), SessionConditions(consent=True), None, acknowledged=False
    )
    run = StudyRun(store, begun)
    shown = run.next_trial()
    assert shown is not None
    explored = (TrialMotion(trace=trace),) if trace else ()
    run.respond(shown.token, Response(choice=shown.trial.answer, explorations=explored))
    return store


def test_a_line_is_one_pass_over_a_row_of_cells(tmp_path: Path) -> None:
    with _answered(tmp_path / "study.sqlite", _line(2.0, 0.0399)) as store:
        (row,) = trial_table(store)
        assert (row["passes"], row["along_x_share"]) == (1.0, 1.0)
        assert row["time_in_touch_s"] == pytest.approx(2.0)
        assert row["peak_speed_m_per_s"] == pytest.approx(0.0399 / 2)
        assert row["coverage"] == pytest.approx(8 * 0.005**2 / (0.083 * 0.049))
        assert (
            row["stimulus_surface_sha256"]
            == store.design.stimulus(str(row["stimulus"])).surface_sha256
        )
        found = recorded_answers(store)
        assert set(MEASURES) <= set(found.exploration)
        (cells,) = csv.DictReader(io.StringIO(trials_csv([row], trial_columns(store.design))))
        assert float(cells["coverage"]) == row["coverage"]
        # Every measure says its unit in the column's description.
        units = {one.name: one.unit for one in trial_columns(store.design)}
        assert (units["peak_speed_m_per_s"], units["time_in_touch_s"]) == ("m/s", "s")


@pytest.mark.parametrize(
    "trace", ["", "# {}\ntime_s,x_m\n0.0,0.0\n1.0,0.1\n", "# {}\ntime_s,x_m,y_m\n0,0,0\n"]
)
def test_without_a_path_everything_is_blank(tmp_path: Path, trace: str) -> None:
    with _answered(tmp_path / "study.sqlite", trace) as store:
        (row,) = trial_table(store)
        assert [row[one] for one in MEASURES] == [None] * len(MEASURES)


def test_a_path_that_went_away_is_blank_and_the_answer_stays(tmp_path: Path) -> None:
    with _answered(tmp_path / "study.sqlite", _line(2.0, 0.03)) as store:
        for path in store.traces.iterdir():
            path.unlink()
        (row,) = trial_table(store)
        assert row["coverage"] is None
        assert row["choice"]


def test_a_display_that_is_no_plane_or_nowhere_has_no_face() -> None:
    assert face_of("biet2008-plate") == (0.083, 0.049)
    assert face_of("biet2008-stator") is None
    assert face_of("nowhere.toml") is None
