"""Trials that come again: nothing is lost, and nothing counts twice."""

from __future__ import annotations

import dataclasses
import sqlite3
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.study.adaptive.series import adaptive_method
from squeezefilm.study.conduct.again import (
    practise_again,
    restart_block,
    set_aside,
    spoiled_by,
    why_begun_again,
)
from squeezefilm.study.conduct.run import Response, StudyRun
from squeezefilm.study.conduct.sessions import begin_session, next_planned
from squeezefilm.study.conduct.study_device import ByHand, NoDevice, TrialMotion
from squeezefilm.study.design.rules import TrialRules
from squeezefilm.study.design.study_design import StudyDesign, load_design
from squeezefilm.study.record.answers import recorded_answers
from squeezefilm.study.record.exports import export_study
from squeezefilm.study.record.merge import merge
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import trial_table

from ..scripted import CONSENT, gratings, staircase

FAST = TrialRules(fastest=0.2)


def begun(path: Path, design: StudyDesign) -> tuple[StudyStore, StudyRun]:
    store = StudyStore.create(path, design, 3)
    who = store.enrol()
    session = begin_session(store, who, NoDevice(), CONSENT, None, acknowledged=False)
    return store, StudyRun(store, session)


def answer(run: StudyRun, speed: float = 0.1, right: bool = True) -> str:
    """Answer the next trial; returns why it was spoiled."""
    shown = run.next_trial()
    assert shown is not None
    names = shown.trial.alternatives
    choice = ""
    if shown.trial.asks:
        wrong = next(one for one in names if one != shown.trial.answer)
        choice = shown.trial.answer if right else wrong
    told = run.respond(
        shown.token, Response(choice=choice, explorations=(TrialMotion(0.1, speed),))
    )
    return told.spoiled


def test_a_spoiled_trial_keeps_its_answer_and_comes_again_at_the_end_of_its_block(
    tmp_path: Path,
) -> None:
    design = dataclasses.replace(gratings(2), rules=FAST, familiarisation=0, blocks=2)
    store, run = begun(tmp_path / "a.sqlite", design)
    order = [row["stimuli"] for row in store.rows("SELECT stimuli FROM trial ORDER BY number")]
    assert "too fast" in answer(run, 0.5)
    shown = []
    while (trial := run.next_trial()) is not None:
        shown.append((trial.trial.block, trial.trial.stimuli[0]))
        assert answer(run) == ""
    # The first of block 1 comes after the other five of it.
    first = order[0][2:-2]
    assert [block for block, _ in shown] == [1] * 6 + [2] * 6
    assert shown[5] == (1, first)
    (person,) = store.participants()
    assert (person["planned"], person["answered"], person["set_aside"]) == (12, 12, 1)
    rows = trial_table(store)
    assert len(rows) == 13
    assert [bool(row["set_aside"]) for row in rows].count(True) == 1
    assert recorded_answers(store).trials == 12
    [file] = export_study(store, "csv").glob("*_trials.csv")
    assert "too fast" in file.read_text(encoding="utf-8")
    store.close()
    StudyStore.open(tmp_path / "a.sqlite").close()


def test_a_surface_that_was_not_played_as_planned_comes_again(tmp_path: Path) -> None:
    store, run = begun(tmp_path / "u.sqlite", dataclasses.replace(gratings(1), familiarisation=0))
    shown = run.next_trial()
    assert shown is not None
    felt = TrialMotion(unusable="9 % of 1000 ticks were made")
    choice = shown.trial.alternatives[0]
    told = run.respond(shown.token, Response(choice=choice, explorations=(felt,)))
    assert told.spoiled == ("the surface was not played as planned: 9 % of 1000 ticks were made")
    (person,) = store.participants()
    assert (person["answered"], person["set_aside"]) == (0, 1)


def test_an_adaptive_series_asks_again_at_the_same_level(tmp_path: Path) -> None:
    design = dataclasses.replace(staircase(6), rules=FAST)
    store, run = begun(tmp_path / "s.sqlite", design)
    levels: dict[str, list[float]] = {"stairs": [], "bayes": []}
    spoil = True
    while (shown := run.next_trial()) is not None:
        series = shown.trial.adaptive
        assert shown.intensity is not None
        if spoil:
            before = shown.intensity
            assert "too fast" in answer(run, 0.5)
            after = run.next_trial()
            assert after is not None
            if after.trial.adaptive == series:
                assert after.intensity == before
        else:
            levels[series].append(shown.intensity)
            answer(run)
        spoil = not spoil
    assert {name: len(found) for name, found in levels.items()} == {"stairs": 6, "bayes": 6}
    counted = recorded_answers(store)
    assert counted.trials == 12


def test_a_series_goes_on_from_the_answers_in_the_order_in_which_they_were_given(
    tmp_path: Path,
) -> None:
    """A trial of the first block that comes again has a later number than all of the second."""
    plain = staircase(12)
    design = dataclasses.replace(plain, adaptive=plain.adaptive[:1], rules=FAST, blocks=2)
    store, run = begun(tmp_path / "b.sqlite", design)
    given: list[tuple[float, bool]] = []
    while (shown := run.next_trial()) is not None:
        level, count = shown.intensity, len(given)
        assert level is not None
        assert level == adaptive_method(design.adaptive[0], given, design.task).next_stimulus()
        if count == 1 and not store.rows("SELECT * FROM set_aside"):
            assert "too fast" in answer(run, 0.5)
            continue
        right = count % 3 != 2
        answer(run, right=right)
        given.append((level, right))
    assert len(given) == 12
    recorded = recorded_answers(store)
    assert recorded.intensity.tolist() == [level for level, _ in given]
    assert (recorded.correct == 1).tolist() == [right for _, right in given]


def test_practice_below_the_criterion_comes_again_so_often_and_no_more(tmp_path: Path) -> None:
    design = dataclasses.replace(
        gratings(1), familiarisation=0, practice=3, practice_criterion=0.9, practice_rounds=2
    )
    _, run = begun(tmp_path / "p.sqlite", design)
    phases = []
    while (shown := run.next_trial()) is not None:
        phases.append(shown.trial.phase)
        told = run.respond(
            shown.token,
            Response(choice=next(n for n in shown.trial.alternatives if n != shown.trial.answer)),
        )
        if len(phases) == 3:
            assert "practice again, round 2 of 2" in told.practice
        if len(phases) == 6:
            assert "were not reached in 2 rounds; the study goes on" in told.practice
    assert phases == ["practice"] * 6 + ["main"] * 3
    good, second = begun(tmp_path / "g.sqlite", design)
    for _ in range(3):
        answer(second)
    assert good.participants()[0]["planned"] == 6
    with pytest.raises(InputError, match="practice_criterion"):
        dataclasses.replace(design, practice=0)


def test_a_block_left_for_too_long_begins_again(tmp_path: Path) -> None:
    design = dataclasses.replace(gratings(2), familiarisation=0, blocks=2, resume_within=3600.0)
    store, run = begun(tmp_path / "r.sqlite", design)
    for _ in range(8):
        answer(run)
    planned = next_planned(store, run.participant)
    assert planned is not None
    session = str(run.session["uuid"])
    restart_block(store, run.participant, session, planned)
    assert why_begun_again(store, session) == ""
    late = (datetime.now(UTC) - timedelta(hours=30)).isoformat(timespec="milliseconds")
    with store.transaction() as write:
        write.execute("UPDATE response SET ended_utc = ?", [late])
    again = begin_session(store, run.participant, NoDevice(), CONSENT, None, acknowledged=False)
    said = why_begun_again(store, again)
    assert "left for about 30 h, and may be for 60 min" in said
    assert said.endswith("2 answers are set aside")
    asked = []
    second = StudyRun(store, again)
    while (shown := second.next_trial()) is not None:
        asked.append((shown.trial.block, shown.trial.stimuli[0]))
        answer(second)
    # All six of the second block, in the order that was planned; the first block stands.
    rows = store.rows("SELECT block, stimuli FROM trial ORDER BY number")[6:12]
    assert asked == [(row["block"], row["stimuli"][2:-2]) for row in rows]
    (person,) = store.participants()
    assert (person["planned"], person["answered"], person["set_aside"]) == (12, 12, 6)
    assert recorded_answers(store).trials == 12


def test_a_token_that_was_set_aside_is_answered_with_what_was_recorded(tmp_path: Path) -> None:
    store, run = begun(tmp_path / "t.sqlite", dataclasses.replace(gratings(1), rules=FAST))
    for _ in range(3):
        answer(run)
    shown = run.next_trial()
    assert shown is not None
    given = Response(choice=shown.trial.answer, explorations=(TrialMotion(0.1, 0.5),))
    told, repeated = run.respond(shown.token, given), run.respond(shown.token, given)
    assert told.spoiled
    assert repeated == dataclasses.replace(told, repeated=True)
    assert len(store.rows("SELECT * FROM set_aside")) == 1


def test_what_was_set_aside_merges_and_is_deleted_with_its_person(tmp_path: Path) -> None:
    design = dataclasses.replace(gratings(1), rules=FAST, familiarisation=0)
    one, run = begun(tmp_path / "a.sqlite", design)
    answer(run, 0.5)
    one.close()
    other = StudyStore.create(tmp_path / "b.sqlite", design, 3, station=0)
    assert merge(other, tmp_path / "a.sqlite").added["set_aside"] == 1
    assert merge(other, tmp_path / "a.sqlite").added["set_aside"] == 0


def test_a_file_of_version_1_gets_the_table_that_it_lacks(tmp_path: Path) -> None:
    store, run = begun(tmp_path / "v.sqlite", dataclasses.replace(gratings(1), familiarisation=0))
    answer(run)
    store.close()
    with sqlite3.connect(tmp_path / "v.sqlite") as old:
        old.execute("DROP TABLE set_aside")
        old.execute("PRAGMA user_version = 1")
    with StudyStore.open(tmp_path / "v.sqlite") as found:
        assert found.rows("PRAGMA user_version")[0]["user_version"] == 2
        assert recorded_answers(found).trials == 1
        assert found.rows("SELECT * FROM set_aside") == []


def test_nothing_is_planned_twice_without_a_reason(tmp_path: Path) -> None:
    store, run = begun(tmp_path / "n.sqlite", gratings(1))
    with store.transaction() as write:
        set_aside(write, [], str(run.session["uuid"]), "nothing")
        assert practise_again(store, write, run.participant, "biet2008-plate") == ""
    assert store.rows("SELECT * FROM set_aside") == []
    assert spoiled_by(load_design("period-jnd"), ()) == ""


def test_by_hand_says_what_to_put_there() -> None:
    said: list[str] = []
    device = ByHand(said.append)
    device.present(gratings().stimuli[1], 0)
    device.stop()
    assert said == [
        "put '4 mm' under the finger: period 4 mm, 30 % change of friction",
        "take it away",
    ]
