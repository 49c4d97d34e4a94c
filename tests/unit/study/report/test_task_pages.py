"""Pages, figures and words of two-interval, same-different and magnitude studies."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.recovery.task_people import DESIGNS, analysed, somebody
from tests.unit.drawn import words
from tests.unit.printed import printed

from squeezefilm.core.kit import style
from squeezefilm.study.report import page as report
from squeezefilm.study.report.answer_tables import condition_head, condition_rows, person_rows
from squeezefilm.study.report.page import TASK_FIGURES, study_figures, write_overview, write_study
from squeezefilm.study.report.task_figures import answers, persons
from squeezefilm.study.report.terminal_analysis import show_analyses
from squeezefilm.study.report.words import key_rows, read_first
from squeezefilm.study.tasks.findings import TaskAnalysis

pytestmark = pytest.mark.usefixtures("figures_as_described")


@pytest.fixture(scope="module", params=[*DESIGNS, "direction, adaptive"])
def found(request: pytest.FixtureRequest) -> TaskAnalysis:
    random = np.random.default_rng(4)
    return analysed(request.param, [somebody(random) for _ in range(4)], random)


def test_what_to_read_first_is_in_sentences(found: TaskAnalysis) -> None:
    said = read_first(found)
    assert said[0].startswith("4 participants answered ")
    assert all(one.endswith(".") for one in said)
    assert any(
        str(found.measure).split()[0].lower() in one.lower() or "power" in one for one in said
    )


def test_numbers_are_those_of_the_analysis(found: TaskAnalysis) -> None:
    rows = {name: value for name, value, _ in key_rows(found)}
    assert rows["Participants"] == "4"
    assert found.pooled is not None
    scale = 100 if found.measure == "Weber fraction" else 1
    name = found.measure[0].upper() + found.measure[1:]
    assert float(rows[name].split()[0]) == pytest.approx(scale * found.pooled.value, rel=0.01)
    assert len(person_rows(found)[1]) == 4
    assert len(condition_rows(found)) == len(found.conditions)


def test_the_page_holds_everything(
    found: TaskAnalysis, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(style, "png", lambda one: one.get_suptitle().encode())
    page = write_study(found, tmp_path / "one").read_text(encoding="utf-8")
    for heading in ("Read first", "Numbers", "People in numbers", "Methods, for a paper"):
        assert heading in page
    assert (tmp_path / "one" / "analysis.json").exists()
    text = write_overview({"plate": found}, tmp_path / "all").read_text(encoding="utf-8")
    assert read_first(found)[0] in text
    assert (tmp_path / "all" / "plate" / "index.html").exists()


def test_a_series_about_a_reference_counts_answers_on_both_sides() -> None:
    random = np.random.default_rng(6)
    found = analysed("direction, adaptive", [somebody(random) for _ in range(3)], random)
    assert condition_head(found)[4] == "More"
    shares = [one.share.value for one in found.conditions if one.share is not None]
    assert found.conditions[0].value < 0 < found.conditions[-1].value
    assert shares[0] < 0.1 < 0.9 < shares[-1]


def test_displays_of_one_name_have_folders_of_their_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[str] = []
    monkeypatch.setattr(report, "write_study", lambda _, folder, **__: written.append(folder.name))
    monkeypatch.setattr(report, "read_first", lambda _: [])
    analysis: Any = SimpleNamespace(name="mine", origin="people")
    displays = ("old/plate.toml", "new/plate.toml", "biet2008-plate")
    page = write_overview(dict.fromkeys(displays, analysis), tmp_path / "all")
    assert written == ["plate-1", "plate-2", "biet2008-plate"]
    assert 'href="plate-2/index.html"' in page.read_text(encoding="utf-8")


def test_figures_say_their_message(found: TaskAnalysis) -> None:
    drawn = study_figures(found)
    assert set(drawn) <= {one.key for one in TASK_FIGURES}
    assert f"The {found.measure} is" in words(answers(found).get_suptitle())
    (axes,) = persons(found).axes
    assert len([line for line in axes.get_lines() if len(line.get_xdata()) == 1]) == 4


def test_the_terminal_reads_the_same(found: TaskAnalysis) -> None:
    lines = " ".join(printed(lambda: show_analyses({"plate": found})))
    assert "plate: made up answers" in lines
    assert "Participant Estimate Interval Trials Remark" in lines
