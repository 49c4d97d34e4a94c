"""Answers of another program: read as the study's own, or refused with line and column."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.study.conduct.rehearsal import rehearse
from squeezefilm.study.design.rules import AdaptiveCondition
from squeezefilm.study.design.study_design import StudyDesign, load_design
from squeezefilm.study.record import foreign
from squeezefilm.study.record.answers import recorded_answers
from squeezefilm.study.record.exports import export_study
from squeezefilm.study.record.foreign import PEOPLE, columns_of, read_answers
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import csv_text
from squeezefilm.study.report.page import simulated_columns
from squeezefilm.study.simulated.answers import simulate_participants
from squeezefilm.study.tasks.analyze import analyze_study
from squeezefilm.study.tasks.findings import TaskAnalysis

Given = Callable[[str], Path]
DESIGN = load_design("friction-jnd")
HEAD = "participant_id,stimulus,second_stimulus,choice"


@pytest.fixture
def given(tmp_path: Path) -> Given:
    """A file with a text in it."""

    def made(text: str) -> Path:
        path = tmp_path / "answers.csv"
        path.write_text(text, encoding="utf-8")
        return path

    return made


def short(design: StudyDesign) -> StudyDesign:
    """A study with every kind of its trials, and few of each."""
    return dataclasses.replace(
        design,
        blocks=1,
        repetitions=1,
        practice=min(design.practice, 2),
        catch=tuple(dataclasses.replace(trial, count=1) for trial in design.catch),
        adaptive=tuple(dataclasses.replace(series, count=8) for series in design.adaptive),
    )


@pytest.mark.parametrize(
    "name",
    [
        pytest.param("period-jnd", marks=pytest.mark.slow),
        pytest.param("period-same-different", marks=pytest.mark.slow),
        "coarseness-magnitude",
        pytest.param("biet2008-gratings", marks=pytest.mark.slow),
    ],
)
def test_what_a_study_exports_is_read_as_what_it_recorded(name: str, tmp_path: Path) -> None:
    design = short(load_design(name))
    with StudyStore.create(tmp_path / "s.sqlite", design, 3) as store:
        rehearse(store, load_observer("fingertip"), 2)
        own = recorded_answers(store)
        export_study(store, "csv", tmp_path / "out")
    (path,) = (tmp_path / "out").glob("*trials.csv")
    found = read_answers(path, design)
    assert found.origin == PEOPLE
    assert (found.people, found.surfaces) == (own.people, own.surfaces)
    for key in (
        "participant", "number", "phase", "display", "series", "presented", "choice", "right",
        "intensity", "estimate", "response_time",
    ):  # fmt: skip
        np.testing.assert_array_equal(getattr(found, key), getattr(own, key), err_msg=key)
    assert set(found.exploration) == set(own.exploration)


@pytest.mark.slow
def test_what_simulated_people_answered_is_analysed_as_by_the_verb_itself(tmp_path: Path) -> None:
    simulated = simulate_participants(DESIGN, load_observer("fingertip"), 3, 7)
    rows = [{"origin": "simulated", **row} for row in simulated.rows()]
    path = tmp_path / "trials.csv"
    path.write_text(csv_text(rows, simulated_columns(DESIGN)), encoding="utf-8", newline="")
    # Everything else is the design's or the file's; people are numbers there.
    found = analyze_study(path, design=DESIGN, columns={"participant_id": "participant"}, seed=7)
    for display, one in simulated.analyses.items():
        own, again = one.summary(), found[display].summary()
        for key in ("pooled", "spread_over_people", "more", "trials"):
            assert again[key] == own[key]
        for key in ("conditions", "response_times"):
            assert sorted(map(repr, again[key])) == sorted(map(repr, own[key]))


def test_columns_may_be_called_otherwise_and_what_is_right_follows(given: Given) -> None:
    path = given(
        "\ufeffwho;left one;right one;key_resp.keys;rt;remark\n"
        "anna;30 %;42 %;second;0.8;\n"
        "anna;18 %;30 %;first;n/a;\n"
        ";;;;;\n"
        "anna;18 %;30 %;;;a pause\n"
        "bert;30 %;30 %;first;1.5;\n"
    )
    found = read_answers(
        path,
        DESIGN,
        columns_of(
            "participant_id=who, stimulus=left one, second_stimulus=right one,"
            "choice=key_resp.keys, response_time_s=rt"
        ),
    )
    assert found.people == ("anna", "bert")
    assert list(found.number) == [1, 2, 1]
    assert [found.surfaces[one].name for one in found.presented[0]] == ["30 %", "18 %", "30 %"]
    # More is right; nothing is where both are the same.
    assert list(found.right) == [1, 1, -1]
    assert list(found.choice) == [1, 0, 0]
    np.testing.assert_array_equal(found.response_time, [0.8, np.nan, 1.5])
    assert set(found.phase) == {"main"}


def test_the_head_says_what_stands_between_columns(given: Given) -> None:
    answers = read_answers(
        given(f"{HEAD},remark\na,30 %,42 %,second,one;two;three;four;five\n"), DESIGN
    )
    assert answers.trials == 1


def test_a_row_may_stand_for_many_trials(given: Given) -> None:
    found = read_answers(
        given(f"{HEAD},count\na,30 %,42 %,second,17\na,30 %,42 %,first,3\na,30 %,18 %,first,0\n"),
        DESIGN,
    )
    assert found.trials == 20
    assert found.correct.mean() == 17 / 20
    assert list(found.number) == list(range(1, 21))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (f"{HEAD}\na,30 %,42 %,left\n", r"line 2: choice: 'left' is none of: first, second"),
        (f"{HEAD}\na,30 %,43 %,first\n", r"line 2.*no stimulus '43 %'"),
        (f"{HEAD}\na,30 %\n", "line 2: has 2 cells where the header has 4"),
        (f"{HEAD},display\na,30 %,42 %,first,mine\n", "display: 'mine' is none of: biet2008"),
        (f"{HEAD},response_time_s\na,30 %,42 %,first,1s\n", "response_time_s: '1s' is no number"),
        (f"{HEAD},count\na,30 %,42 %,first,1.5\n", "'1.5' is no count"),
        (f"{HEAD},count\na,30 %,42 %,first,-1\n", "'-1' is no count"),
        (f"{HEAD},count\na,30 %,42 %,first,\n", "'' is no count"),
    ],
)
def test_what_is_not_understood_is_told_with_its_line(given: Given, text: str, says: str) -> None:
    with pytest.raises(ConfigError, match=says):
        read_answers(given(text), DESIGN)


@pytest.mark.parametrize(
    ("text", "columns", "says"),
    [
        ("", {}, "no column participant_id, stimulus, choice, second_stimulus; .*it has none"),
        ("participant_id,stimulus,choice\n", {}, "no column second_stimulus"),
        (f"{HEAD}\n", {"choice": "key"}, "no column 'key'; it has participant_id, stimulus"),
        (f"{HEAD}\n", {"chosen": "choice"}, "there is no 'chosen'; columns may be told of"),
        (f"{HEAD}\n", {}, "no row with an answer"),
    ],
)
def test_what_is_lacking_is_told(
    given: Given, text: str, columns: dict[str, str], says: str
) -> None:
    with pytest.raises(InputError, match=says):
        read_answers(given(text), DESIGN, columns)


def test_a_count_that_no_memory_holds_is_refused(
    given: Given, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InputError, match="trials in a file of another program"):
        read_answers(given(f"{HEAD},count\na,30 %,42 %,first,1e12\n"), DESIGN)


def test_a_task_of_one_surface_needs_no_second_and_of_numbers_no_choice(given: Given) -> None:
    design: StudyDesign = load_design("coarseness-magnitude")
    one = design.stimuli[0].name
    found = read_answers(given(f"participant_id,stimulus,estimate\na,{one},12\n"), design)
    assert (found.estimate[0], found.choice[0]) == (12.0, -1)
    assert found.presented.tolist() == [[0]]


def test_columns_are_told_as_pairs() -> None:
    assert columns_of(" choice = key_resp.keys , participant_id=who,") == {
        "choice": "key_resp.keys", "participant_id": "who",
    }  # fmt: skip
    assert columns_of("") == {}
    for wrong in ("choice", "choice=", "=who"):
        with pytest.raises(InputError, match="says no column and no word; write NAME=COLUMN"):
            columns_of(wrong)
    assert foreign.COUNT == "count"


@pytest.mark.slow
def test_a_recorded_series_of_same_different_has_weber_fractions(tmp_path: Path) -> None:
    """From its file and from its export, in which series' comparisons are known by intensity."""
    plain = load_design("period-same-different")
    design = dataclasses.replace(
        short(plain),
        adaptive=(AdaptiveCondition("bayes", "bayesian", count=24),),
        displays=plain.displays[:1],
    )
    with StudyStore.create(tmp_path / "s.sqlite", design, 3) as store:
        rehearse(store, load_observer("fingertip"), 2)
        (own,) = analyze_study(store).values()
        recorded = recorded_answers(store)
        export_study(store, "csv", tmp_path / "out")
    names = [one.name for one in recorded.surfaces]
    assert len(set(names)) == len(names)
    assert isinstance(own, TaskAnalysis)
    assert own.measure == "Weber fraction"
    assert "Weber fraction" in own.methods
    assert own.conditions[0].name == "the same"
    (path,) = (tmp_path / "out").glob("*trials.csv")
    again = read_answers(path, design)
    assert again.surfaces == recorded.surfaces
    # What is right follows from the intensity where a file does not say it.
    header, *lines = path.read_text(encoding="utf-8").splitlines()
    path.write_text("\n".join([header.replace(",answer,", ",told,"), *lines]), encoding="utf-8")
    np.testing.assert_array_equal(read_answers(path, design).right, recorded.right)


SERIES = "participant_id,stimulus,second_stimulus,choice,adaptive_series,intensity"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (f"{SERIES}\na,4 mm,x,first,stairs,0.2\n", "line 2: adaptive_series: 'stairs' is none of"),
        (f"{SERIES}\na,4 mm,x,first,staircase,\n", "line 2: intensity: .*say how much more"),
        (f"{HEAD},trial\na,4 mm,6 mm,first,T1\n", "line 2: trial: 'T1' is no number"),
        (f"{HEAD},trial\na,4 mm,6 mm,first,1.5\n", "line 2: trial: '1.5' is no whole number"),
    ],
)
def test_a_series_or_trial_that_is_not_understood_is_told_with_its_line(
    given: Given, text: str, says: str
) -> None:
    with pytest.raises(ConfigError, match=says):
        read_answers(given(text), load_design("period-jnd"))


def test_an_estimate_without_a_logarithm_is_told_with_its_line(given: Given) -> None:
    design = load_design("coarseness-magnitude")
    text = f"participant_id,stimulus,estimate\na,{design.stimuli[0].name},0\n"
    with pytest.raises(ConfigError, match="line 2: estimate: '0' is not above 0"):
        read_answers(given(text), design)


def test_a_folder_holds_a_file_for_each_person(tmp_path: Path) -> None:
    """As PsychoPy saves CSV and jsPsych JSON, with rows and columns that are no trials."""
    folder = tmp_path / "data"
    folder.mkdir()
    csv = "participant,a,b,key,rt\nwho1,30 %,22 %,left,0.8\nwho1,42 %,30 %,left,0.7\n,,,,\n"
    (folder / "1_friction.csv").write_text(csv, encoding="utf-8")
    (folder / "2_friction.csv").write_text(csv.replace("0.", "1."), encoding="utf-8")
    trials = [
        {"trial_type": "instructions", "rt": 5301},
        {"trial_type": "keyboard", "participant": "who2", "a": "18 %", "b": "30 %", "key": "right"},
    ]
    (folder / "who2.json").write_text(json.dumps(trials), encoding="utf-8")
    (folder / "notes.txt").write_text("none", encoding="utf-8")
    columns = columns_of("participant_id=participant, stimulus=a, second_stimulus=b, choice=key")
    values = {"left": "first", "right": "second"}
    answers = read_answers(folder, DESIGN, columns, values)
    people = [answers.people[number] for number in answers.participant]
    assert people == ["who1"] * 4 + ["who2"]
    # A file that was copied holds the same answers at the same times.
    again = "participant,a,b,key,rt\n" + "".join(
        f"who1,30 %,22 %,left,0.{number}\n" for number in (*range(25, 40), *range(11, 25))
    )
    for name in ("3.csv", "3 (1).csv"):
        (folder / name).write_text(again, encoding="utf-8")
    with pytest.raises(ConfigError, match=r"3\.csv.*same answers and times.*keep one"):
        read_answers(folder, DESIGN, {**columns, "response_time_s": "rt"}, values)


def test_in_a_folder_a_files_name_may_be_the_person(tmp_path: Path) -> None:
    row = [{"stimulus": "30 %", "second_stimulus": "22 %", "choice": "first"}]
    for name in ("ann", "ben"):
        (tmp_path / f"{name}.json").write_text(json.dumps(row), encoding="utf-8")
    assert sorted(read_answers(tmp_path, DESIGN).people) == ["ann", "ben"]
    with pytest.raises(InputError, match="no column participant_id"):
        read_answers(tmp_path / "ann.json", DESIGN)
    (tmp_path / "cat.json").write_text('{"choice": 1}', encoding="utf-8")
    with pytest.raises(ConfigError, match="no list of trials"):
        read_answers(tmp_path, DESIGN)


def test_an_empty_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no file that ends in \.csv, \.tsv, \.json"):
        read_answers(tmp_path, DESIGN)
