"""Files of simulated participants: every answer, what is confused, and that nobody answered."""

from __future__ import annotations

import csv
import dataclasses
import functools
import html
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.kit import style
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.perception.percepts import Apparatus
from squeezefilm.physics.perception.senses import Candidates
from squeezefilm.study.design.study_design import load_design
from squeezefilm.study.report.answer_tables import confusion_rows
from squeezefilm.study.report.page import (
    REMARK,
    evidence_rows,
    evidence_said,
    simulated_columns,
    write_simulated,
)
from squeezefilm.study.simulated.answers import SimulatedStudy
from squeezefilm.study.simulated.chain_tables import ChainTables
from squeezefilm.study.tasks import analyze

from ..scripted import matched

PAPER = load_design("biet2008-gratings")
# Answers in another order than what is presented; the second display's name tries to be markup.
DESIGN = dataclasses.replace(
    PAPER, name="two-gratings", displays=("biet2008-stator", "<b>plate"),
    stimuli=PAPER.stimuli[1:3], alternatives=PAPER.alternatives[2:0:-1],
)  # fmt: skip
PERIODS = np.array([[[[[2e-3]], [[3.98e-3]]]], [[[[4e-3]], [[2e-3]]]]])
STRENGTHS = np.array([[[[[3.456]], [[-0.2]]]], [[[[1.0]], [[2.0]]]]])


def study(design: Any = DESIGN) -> SimulatedStudy:
    """Two people, each asked two gratings on two displays; on the first one answer is wrong."""
    observer = dataclasses.replace(load_observer(), finger_classes=1, name="<i>made up</i>")
    tables = ChainTables(
        design=design, observer=observer, fingers=observer.fingers(), apparatus=(Apparatus(),) * 2,
        virtual=Candidates(PERIODS, STRENGTHS),
        real=Candidates(np.full((1, 2, 1), 2e-3), np.full((1, 2, 1), 3.0)),
    )  # fmt: skip
    answers = matched(
        design,
        display=np.array([[0, 0, 1, 1], [1, 1, 0, 0]]),
        stimulus=np.array([[0, 1, 0, 1], [1, 0, 1, 0]]),
        # Alternative 1 is the 2 mm of stimulus 0: only the very first answer is wrong.
        choice=np.array([[0, 0, 1, 0], [0, 1, 0, 1]]),
        number=np.array([[0, 1, 2, 3], [0, 1, 2, 3]]),
        times=np.array([[1.5, 2.0, 2.5, 3.0], [0.5, 0.75, 1.0, 1.25]]),
    )
    return SimulatedStudy(tables, answers, 5)


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Any], list[str]]:
    """The folder, the analyses handed on, and what was told meanwhile."""
    folder, handed, told = tmp_path_factory.mktemp("simulated") / "deep", [], []

    def write_study(analysis: Any, to: Path, **_: Any) -> Path:
        handed.append((analysis, to))
        return to / "index.html"

    quick = functools.partial(analyze.analyze_answers, resamples=10)
    with pytest.MonkeyPatch.context() as patch:
        # Reports of real answers have tests of their own, and pictures are slow.
        patch.setattr("squeezefilm.study.report.page.write_study", write_study)
        patch.setattr(analyze, "analyze_answers", quick)
        patch.setattr(style, "png", lambda one: one.get_suptitle().encode())
        assert write_simulated(study(), folder, told.append) == folder / "index.html"
    return folder, handed, told


@pytest.mark.slow
def test_every_answer_is_a_row(written: tuple[Path, list[Any], list[str]]) -> None:
    with (written[0] / "trials.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    assert rows[0] == [column.name for column in simulated_columns(DESIGN)]
    assert len(rows) == 9
    kept = [(*row[:6], row[10], row[12], row[13]) for row in rows]
    assert kept[1:3] == [
        ("simulated", "0", "biet2008-stator", "1", "main", "2 mm", "4 mm", "0.0", "1.5"),
        ("simulated", "0", "biet2008-stator", "2", "main", "4 mm", "4 mm", "1.0", "2.0"),
    ]
    assert kept[6] == ("simulated", "1", "<b>plate", "2", "main", "2 mm", "2 mm", "1.0", "0.75")


def test_confusions_are_shares_of_a_column_with_their_counts() -> None:
    head, rows = confusion_rows(study().confusion(0))
    assert head == ("Answered \\ presented", "2 mm", "4 mm")
    assert rows == [("4 mm", "50 % (1)", "100 % (2)"), ("2 mm", "50 % (1)", "0 % (0)")]
    assert confusion_rows(study().confusion(1))[1] == [
        ("4 mm", "0 % (0)", "100 % (2)"),
        ("2 mm", "100 % (2)", "0 % (0)"),
    ]


def test_what_is_felt_has_its_period_and_a_dash_for_none() -> None:
    tables = study().tables
    head, rows = evidence_rows(tables, 0)
    assert head == ("Stimulus", "d′", "Clearest rhythm")
    assert rows == [("2 mm", "3.46", "2 mm"), ("4 mm", "0", "–")]
    both = Candidates(np.repeat(PERIODS, 2, axis=3), np.repeat(STRENGTHS, 2, axis=3))
    head, rows = evidence_rows(dataclasses.replace(tables, virtual=both), 1)
    assert head[1:] == (
        "d′ along x",
        "Clearest rhythm along x",
        "d′ along y",
        "Clearest rhythm along y",
    )
    assert rows[0] == ("2 mm", "1.00", "4 mm", "1.00", "4 mm")


def test_each_display_is_analysed_with_the_answer_that_is_right_on_the_diagonal(
    written: tuple[Path, list[Any], list[str]],
) -> None:
    folder, handed, told = written
    (first, one), (second, other) = handed
    assert (one, other) == (folder / "biet2008-stator", folder / "<b>plate")
    # Rows are answers by the stimulus they stand for.
    assert first.matrix.counts.tolist() == [[1, 0], [1, 2]]
    assert second.matrix.counts.tolist() == [[2, 0], [0, 2]]
    assert first.name == "two-gratings, biet2008-stator"
    assert first.origin == "simulated"
    assert told[-1] == "writing the report"


def test_numbers_and_figures_are_beside_the_page(
    written: tuple[Path, list[Any], list[str]],
) -> None:
    folder = written[0]
    assert sorted(one.name for one in folder.iterdir()) == [
        "index.html", "simulated.json", "trials.csv",
    ]  # fmt: skip
    text = (folder / "simulated.json").read_text(encoding="utf-8")
    assert text.endswith("}\n")
    data = json.loads(text)
    assert data["participants"] == 2
    assert data["proportion_correct"] == {"biet2008-stator": 0.75, "<b>plate": 1.0}


def test_the_page_says_that_nobody_answered_and_shows_names_as_text(
    written: tuple[Path, list[Any], list[str]],
) -> None:
    # A number and its unit stay in one line of the page.
    page = (written[0] / "index.html").read_text(encoding="utf-8").replace("\u00a0", " ")
    assert "<b>plate" not in page
    assert "<i>made" not in page
    assert page.count("<h1>two-gratings</h1>") == 1
    assert "<title>two-gratings: what to read first</title>" in page
    assert "<b>simulated answers</b>" in page
    said = page.replace("\n", " ")
    assert (
        "2 <b>simulated</b> participants, observer &lt;i&gt;made up&lt;/i&gt;, seed 5, "
        "finger: ; no person answered" in said
    )
    assert REMARK in page
    assert "<h2>What is felt on biet2008-stator: 75.0 % right</h2>" in page
    assert "<h2>What is felt on &lt;b&gt;plate: 100.0 % right</h2>" in page
    assert (
        '<thead><tr><th scope="col">Answered \\ presented</th><th scope="col">2 mm</th>'
        '<th scope="col">4 mm</th></tr></thead>\n<tbody>\n'
        '<tr><th scope="row">4 mm</th><td>50 % (1)</td><td>100 % (2)</td></tr>\n'
        '<tr><th scope="row">2 mm</th><td>50 % (1)</td><td>0 % (0)</td></tr>\n</tbody>' in page
    )
    assert page.count(f"<caption>{html.escape(evidence_said(study().tables))}</caption>") == 2
    assert '<tr><th scope="row">2 mm</th><td>3.46</td><td>2 mm</td></tr>' in page
    for place in ("biet2008-stator", "&lt;b&gt;plate"):
        link = f'<p><a href="{place}/index.html">All numbers and figures</a></p>'
        assert page.count(link) == 1


@pytest.mark.parametrize(
    "alternatives",
    [PAPER.alternatives[:3], (PAPER.alternatives[1], PAPER.alternatives[0])],
    ids=["more answers than gratings", "a grating without a right answer"],
)
def test_gratings_that_do_not_pair_up_get_no_analysis_of_right_answers(
    alternatives: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(style, "png", lambda _: b"")
    design = dataclasses.replace(DESIGN, alternatives=alternatives)
    page = write_simulated(study(design), tmp_path).read_text(encoding="utf-8")
    assert "All numbers and figures" not in page
    assert page.count("</table>") == 4
    assert not [one for one in tmp_path.iterdir() if one.is_dir()]


def test_a_file_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("x")
    with pytest.raises(InputError, match="is a file, not a folder; choose another"):
        write_simulated(study(), tmp_path / "taken")
