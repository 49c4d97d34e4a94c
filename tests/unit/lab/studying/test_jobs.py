"""What takes seconds of a study's file: its analysis for the page, its report, its rehearsal."""

from __future__ import annotations

import base64
import functools
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.kit import style
from squeezefilm.lab.studying import jobs
from squeezefilm.lab.studying.jobs import analysis_of, rehearsed, report_of
from squeezefilm.physics.perception.observer import Observer, load_observer
from squeezefilm.study.conduct import rehearsal
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import trial_table
from squeezefilm.study.report import page
from squeezefilm.study.report.page import key_rows
from squeezefilm.study.tasks.analyze import analyze_study

from ...study.scripted import gratings, run_through

DISPLAYS = ("biet2008-plate", "biet2008-stator")
# Fewer than the page has: the bootstrap is tested where it is made.
quickly = functools.partial(analyze_study, resamples=50)


def named(figure: Any) -> bytes:
    """In place of a figure's picture, which takes a second each: what stands above it."""
    return str(figure.get_suptitle()).encode()


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A lab's study of two people on two displays, all answered."""
    file = tmp_path_factory.mktemp("lab") / "studies" / "one.sqlite"
    file.parent.mkdir()
    run_through(file, gratings(displays=DISPLAYS)).close()
    return file


@pytest.fixture(scope="module")
def found(study: Path) -> dict[str, Any]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(jobs, "analyze_study", quickly)
        patch.setattr(style, "png", named)
        return analysis_of(study)


def test_the_page_gets_numbers_and_confusions_display_by_display(
    study: Path, found: dict[str, Any]
) -> None:
    with StudyStore.open(study) as store:
        whole, rows = quickly(store), trial_table(store)
    # Two people, three gratings felt once to begin with and twice to count, on two displays.
    assert found["answers"] == 2 * 2 * (3 + 3 * 2)
    assert [one["display"] for one in found["displays"]] == list(DISPLAYS)
    for one in found["displays"]:
        there = whole[one["display"]]
        assert one["numbers"] == [list(row) for row in key_rows(there)]
        assert one["notes"] == list(there.notes)
        confusion = one["confusion"]
        assert confusion["display"] == one["display"]
        assert confusion["rows"] == confusion["columns"] == ["2 mm", "4 mm", "8 mm"]
        counts = np.zeros((3, 3), dtype=int)
        for row in rows:
            if row["display"] == one["display"] and row["phase"] == "main":
                at = (confusion["rows"].index(row["choice"]),
                      confusion["columns"].index(row["stimulus"]))  # fmt: skip
                counts[at] += 1
        assert confusion["counts"] == counts.tolist()
        assert counts.sum() == 12
    # It goes to the page as it is.
    assert json.loads(json.dumps(found)) == found


def test_every_figure_but_the_confusion_comes_with_its_title(
    study: Path, found: dict[str, Any]
) -> None:
    whole = quickly(study)
    for one in found["displays"]:
        drawn = dict(page.study_figures(whole[one["display"]]).values())
        # The page draws that itself.
        drawn.pop("Confusion matrix")
        pictures = {
            figure["title"]: base64.b64decode(figure["png"], validate=True)
            for figure in one["figures"]
        }
        assert pictures == {title: named(figure) for title, figure in drawn.items()}
        assert len(pictures) == 2


def test_a_report_lies_beside_the_study_and_is_named_from_the_labs_folder(
    study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(jobs, "analyze_study", quickly)
    monkeypatch.setattr(style, "png", named)
    pages = report_of(study)["pages"]
    assert pages == ["studies/one.results/index.html"]
    folder = (study.parent.parent / pages[0]).parent
    for display in DISPLAYS:
        assert display in (folder / "index.html").read_text(encoding="utf-8")
        assert display in (folder / display / "index.html").read_text(encoding="utf-8")


def test_a_study_without_answers_is_said_to_have_none(tmp_path: Path) -> None:
    file = tmp_path / "empty.sqlite"
    StudyStore.create(file, gratings(), 4).close()
    for job in (analysis_of, report_of):
        with pytest.raises(InputError, match="has no answered main trial yet"):
            job(file)


def test_as_many_rehearse_as_are_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "r.sqlite"
    StudyStore.create(file, gratings(), 4).close()

    # What they feel takes seconds, and is tested where it is computed.
    def enrolled(store: StudyStore, observer: Observer, people: int) -> list[str]:
        assert observer == load_observer()
        return [store.enrol() for _ in range(people)]

    monkeypatch.setattr(rehearsal, "rehearse", enrolled)
    assert rehearsed(file, 3) == {"people": 3}
    with StudyStore.open(file) as store:
        assert len(store.participants()) == 3
