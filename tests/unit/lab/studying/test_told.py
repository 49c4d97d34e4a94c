"""What the experimenter's page is told of a study."""

from __future__ import annotations

from pathlib import Path

from tests.unit.study.scripted import Script, gratings, magnitudes, session

from squeezefilm.lab.studying.sittings import confusion_counts, described
from squeezefilm.study.conduct.study_device import NoDevice
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.record.store import StudyStore


def test_confusions_count_main_trials_by_display(tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "a.sqlite", gratings(2), 7) as store:
        (empty,) = confusion_counts(store)
        assert sum(map(sum, empty["counts"])) == 0
        conduct(session(store, store.enrol()), NoDevice(), Script())
        (found,) = confusion_counts(store)
    assert found["display"] == "biet2008-plate"
    assert found["rows"] == found["columns"] == ["2 mm", "4 mm", "8 mm"]
    # Two of each stimulus; three that were only felt do not count.
    assert [sum(column) for column in zip(*found["counts"], strict=True)] == [2, 2, 2]


def test_another_task_has_no_confusions(tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "m.sqlite", magnitudes(), 7) as store:
        assert confusion_counts(store) == []
    assert described(magnitudes())["task"] == "magnitude-estimation"
