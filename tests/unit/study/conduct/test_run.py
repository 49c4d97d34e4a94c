"""The state machine: one trial at a time, committed, idempotent, resumed where it stopped."""

from __future__ import annotations

import dataclasses
import json
import sqlite3
from datetime import datetime, timedelta
from pathlib import Path

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.study.conduct.run import Presentation, Response, StudyRun
from squeezefilm.study.conduct.sessions import display_wanted
from squeezefilm.study.conduct.study_device import NoDevice, TrialMotion
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.design.trials import trials
from squeezefilm.study.record.exports import export_study
from squeezefilm.study.record.store import StudyStore

from ..scripted import TRACE, Bench, Script, gratings, magnitudes, run_through, session, staircase

WHERE = "SELECT t.number, r.* FROM response r JOIN trial t ON t.uuid = r.trial ORDER BY t.number"


def test_trials_come_in_the_planned_order_and_every_row_says_where_it_is_from(
    tmp_path: Path,
) -> None:
    with StudyStore.create(tmp_path / "a.sqlite", gratings(), 7) as store:
        run = session(store, store.enrol())
        script = Script()
        assert conduct(run, NoDevice(), script) == 9
        assert run.state == "finished"
        assert run.next_trial() is None
        planned = trials(gratings(), 0, 7)
        assert [one.trial for one in script.seen] == list(planned)
        rows = store.rows(WHERE)
        assert [row["number"] for row in rows] == list(range(1, 10))
        assert [row["seed"] for row in rows] == [one.seed for one in planned]
        for row in rows:
            assert row["squeezefilm_version"]
            assert row["ended_monotonic_s"] >= row["started_monotonic_s"] > 0
            assert row["ended_utc"] >= row["started_utc"] > "2020"
        asked = [row for row in rows if row["choice"]]
        assert len(asked) == 6
        assert all(row["response_time_s"] >= 0 for row in asked)
        for row, one in zip(rows, planned, strict=True):
            assert row["correct"] == (int(row["choice"] == one.answer) if one.asks else None)


def test_the_same_token_twice_is_one_row_and_the_first_answer(tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "a.sqlite", gratings(), 7) as store:
        run = session(store, store.enrol())
        for _ in range(3):
            shown = run.next_trial()
            assert shown is not None
            run.respond(shown.token, Response())
        shown = run.next_trial()
        assert shown is not None
        with pytest.raises(InputError, match=r"'5 mm' is no answer to trial 4; answers: .*4 mm"):
            run.respond(shown.token, Response(choice="5 mm"))
        first = run.respond(shown.token, Response(choice="4 mm"))
        assert not first.repeated
        for choice in ("4 mm", "8 mm"):
            again = run.respond(shown.token, Response(choice=choice))
            assert again == dataclasses.replace(first, repeated=True)
        assert len(store.rows("SELECT * FROM response")) == 4


def test_a_trial_waits_for_its_answer_and_then_nothing_does(tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "a.sqlite", gratings(1), 7) as store:
        run = session(store, store.enrol())
        assert run.state == "ready"
        states = []
        while (shown := run.next_trial()) is not None:
            states.append(run.state)
            assert not run.recorded(shown.token)
            choice = shown.trial.alternatives[0] if shown.trial.asks else ""
            run.respond(shown.token, Response(choice=choice))
            states.append(run.state)
            assert run.recorded(shown.token)
        assert states == ["presented", "ready"] * 5 + ["presented", "finished"]


def test_a_reload_shows_the_same_trial_again_and_is_counted(tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "a.sqlite", gratings(), 7) as store:
        run = session(store, store.enrol())
        first, again = run.next_trial(), run.next_trial()
        assert first is not None
        assert again is not None
        assert (first.trial, first.token) == (again.trial, again.token)
        assert (first.times_presented, again.times_presented) == (1, 2)
        assert run.state == "presented"


def test_an_interrupted_run_goes_on_where_it_stopped_in_the_same_order(tmp_path: Path) -> None:
    whole = run_through(tmp_path / "whole.sqlite", gratings(4), people=1)
    expected = [(r["number"], r["choice"]) for r in whole.rows(WHERE)]
    whole.close()
    path = tmp_path / "broken.sqlite"
    with StudyStore.create(path, gratings(4), 7) as store:
        who = store.enrol()
    for _ in range(20):
        with StudyStore.open(path) as store:
            if display_wanted(store, who) is None:
                break
            device = Bench()
            run = session(store, who)
            if run.remaining > 4:
                with pytest.raises(KeyboardInterrupt):
                    conduct(run, device, Script(most=3))
            else:
                conduct(run, device, Script())
            assert device.silent
    with StudyStore.open(path) as store:
        assert [(r["number"], r["choice"]) for r in store.rows(WHERE)] == expected
        presented = store.rows("SELECT count(*) AS n FROM presentation")[0]["n"]
        assert presented > len(expected)


@pytest.mark.slow
def test_a_resumed_adaptive_series_is_the_one_that_was_interrupted(tmp_path: Path) -> None:
    whole = run_through(tmp_path / "whole.sqlite", staircase(), people=1)
    expected = [(r["stimuli"], r["intensity"], r["correct"]) for r in whole.rows(WHERE)]
    whole.close()
    assert len({one[1] for one in expected}) > 5
    path = tmp_path / "broken.sqlite"
    with StudyStore.create(path, staircase(), 7) as store:
        who = store.enrol()
    while True:
        with StudyStore.open(path) as store:
            if display_wanted(store, who) is None:
                break
            try:
                conduct(session(store, who), NoDevice(), Script(most=13))
            except KeyboardInterrupt:
                continue
    with StudyStore.open(path) as store:
        found = [(r["stimuli"], r["intensity"], r["correct"]) for r in store.rows(WHERE)]
    assert found == expected
    for stimuli, intensity, _ in found:
        assert any(name.endswith(" %") for name in json.loads(stimuli))
        assert 0.005 <= intensity <= 0.9


def test_another_display_needs_another_session(tmp_path: Path) -> None:
    design = gratings(displays=("biet2008-plate", "biet2008-stator"))
    with StudyStore.create(tmp_path / "a.sqlite", design, 7) as store:
        who = store.enrol()
        first = display_wanted(store, who)
        run = session(store, who)
        assert conduct(run, NoDevice(), Script()) == 9
        assert run.state == "display changes"
        assert display_wanted(store, who) != first
        assert conduct(session(store, who), NoDevice(), Script()) == 9
        assert display_wanted(store, who) is None


def test_traces_and_exploration_are_kept_and_no_name_is_in_the_files(tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "a.sqlite", gratings(), 7) as store:
        who = store.enrol()
        device = Bench()
        conduct(session(store, who), device, Script())
        rows = [row for row in store.rows(WHERE) if row["choice"]]
        assert device.playing == [json.loads(row["stimuli"])[0] for row in rows]
        assert {row["path_length_m"] for row in rows} == {0.08}
        assert {row["mean_normal_force_N"] for row in rows} == {0.49}
        for row in rows:
            (name,) = json.loads(row["traces"])
            assert (store.traces / name).read_text() == TRACE
            assert who not in name
        assert store.unreferenced_traces() == []


def test_magnitudes_are_numbers_above_nought(tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "a.sqlite", magnitudes(), 7) as store:
        run = session(store, store.enrol())
        shown = run.next_trial()
        assert shown is not None
        for wrong in (
            Response(choice="4 mm"),
            Response(estimate=0.0),
            Response(estimate=float("nan")),
        ):
            with pytest.raises(InputError):
                run.respond(shown.token, wrong)
        assert run.respond(shown.token, Response(estimate=12.5)).estimate == 12.5


def test_what_is_not_the_trials_turn_or_no_answer_of_it_is_refused(tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "a.sqlite", gratings(), 7) as store:
        who = store.enrol()
        run = session(store, who)
        tokens = [r["uuid"] for r in store.rows("SELECT uuid FROM trial ORDER BY number")]
        with pytest.raises(InputError, match="not presented yet"):
            run.respond(tokens[0], Response())
        shown = run.next_trial()
        assert shown is not None
        assert shown.token == tokens[0]
        with pytest.raises(InputError, match="not the one to be answered"):
            run.respond(tokens[1], Response())
        with pytest.raises(InputError, match="no trial of this participant"):
            run.respond("nonsense", Response())
        with pytest.raises(InputError, match="only felt"):
            run.respond(tokens[0], Response(choice="4 mm"))
        with pytest.raises(InputError, match="response_time"):
            run.respond(tokens[0], Response(response_time=-1.0))
        assert store.rows("SELECT * FROM response") == []
        with pytest.raises(InputError, match="no session"):
            StudyRun(store, "nonsense")


def test_a_trace_that_cannot_be_written_leaves_no_answer(tmp_path: Path) -> None:
    from squeezefilm.core.errors import RecordError

    with StudyStore.create(tmp_path / "a.sqlite", gratings(), 7) as store:
        run = session(store, store.enrol())
        shown = run.next_trial()
        assert shown is not None
        store.traces.write_text("a file in the way")
        with pytest.raises(RecordError, match="nothing was acknowledged"):
            run.respond(shown.token, Response(explorations=(TrialMotion(trace=TRACE),)))
        assert store.rows("SELECT * FROM response") == []
        store.traces.unlink()
        assert not run.respond(shown.token, Response()).repeated


def test_nothing_in_the_file_asks_for_an_address_or_a_program(tmp_path: Path) -> None:
    path = tmp_path / "a.sqlite"
    StudyStore.create(path, gratings(), 7).close()
    connection = sqlite3.connect(path)
    tables = [row[0] for row in connection.execute("SELECT name FROM sqlite_master")]
    columns = {
        row[1] for table in tables for row in connection.execute(f"PRAGMA table_info({table})")
    }
    connection.close()
    assert "participant" in columns
    for word in ("address", "agent", "host", "ip", "mail", "birth", "user"):
        assert not [one for one in columns if word in one.split("_")]


def test_a_break_goes_on_where_it_was_and_starts_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    design = dataclasses.replace(gratings(), blocks=2, break_between_blocks=60.0)
    with StudyStore.create(tmp_path / "a.sqlite", design, 7) as store:
        run = session(store, store.enrol())
        while (shown := run.next_trial()) is not None and not shown.trial.pause:
            assert shown.rest == 0.0
            run.respond(
                shown.token,
                Response(choice=shown.trial.alternatives[0] if shown.trial.asks else ""),
            )
        assert shown is not None
        assert shown.rest == pytest.approx(60.0)
        began = datetime.fromisoformat(
            store.rows("SELECT max(ended_utc) AS at FROM response")[0]["at"]
        )
        for later, left in ((20.0, 40.0), (59.0, 1.0), (600.0, 0.0), (-300.0, 60.0)):
            monkeypatch.setattr(
                "squeezefilm.study.conduct.run.utc_now",
                lambda later=later: (began + timedelta(seconds=later)).isoformat(
                    timespec="milliseconds"
                ),
            )
            again = StudyRun(store, run.session["uuid"]).next_trial()
            assert again is not None
            assert again.token == shown.token
            assert again.rest == pytest.approx(left, abs=2e-3)


def presentations(store: StudyStore) -> list[int]:
    found = store.rows(
        "SELECT (SELECT count(*) FROM presentation p WHERE p.trial = t.uuid) AS n FROM trial t "
        "ORDER BY t.number"
    )
    return [row["n"] for row in found]


def test_a_trial_counts_as_presented_when_it_was_shown_and_not_in_the_break_before_it(
    tmp_path: Path,
) -> None:
    """However often a session is killed in a break, and once for each time it is shown."""
    design = dataclasses.replace(gratings(1), blocks=2, break_between_blocks=60.0)
    killed = [0]

    class DiesInBreaks(Script):
        def rest(self, duration: float) -> None:
            killed[0] += 1
            if killed[0] <= 3:
                raise KeyboardInterrupt

    with StudyStore.create(tmp_path / "a.sqlite", design, 7) as store:
        who = store.enrol()
        for _ in range(3):
            with pytest.raises(KeyboardInterrupt):
                conduct(session(store, who), NoDevice(), DiesInBreaks())
        assert set(presentations(store)) == {0, 1}
        conduct(session(store, who), NoDevice(), DiesInBreaks())
        assert set(presentations(store)) == {1}
        # What comes next may be asked for as often as one likes.
        run = session(store, store.enrol())
        first = [run.next_trial(shown=False) for _ in range(3)]
        assert {one.times_presented for one in first if one is not None} == {1}
        assert sum(presentations(store)) == len(presentations(store)) // 2
        assert first[0] is not None
        with pytest.raises(InputError, match="was not presented yet"):
            run.respond(first[0].token, Response())


def test_by_hand_the_clock_starts_when_the_surface_is_in_place(tmp_path: Path) -> None:
    """The experimenter's swap takes 20 s, the answer 1 s."""
    now = [100.0]

    def placed() -> None:
        assert presentations(store)[len(answered)] == 0
        now[0] += 20.0

    class Slow(Script):
        def ask(self, presentation: Presentation) -> str | float:
            assert presentations(store)[len(answered)] == 1
            now[0] += 1.0
            answered.append(presentation.token)
            return super().ask(presentation)

    answered: list[str] = []
    design = dataclasses.replace(gratings(1), familiarisation=0)
    with StudyStore.create(tmp_path / "a.sqlite", design, 7) as store:
        run = session(store, store.enrol())
        conduct(run, NoDevice(), Slow(), clock=lambda: now[0], placed=placed)
        rows = store.rows("SELECT response_time_s AS took, started_monotonic_s AS at FROM response")
    assert [row["took"] for row in rows] == [1.0] * 3
    assert sorted(row["at"] for row in rows) == [120.0, 141.0, 162.0]


@pytest.mark.parametrize("step", [3600.0, -3600.0])
def test_a_clock_that_is_set_changes_no_answer_and_no_break(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: float
) -> None:
    from datetime import UTC, datetime, timedelta

    from squeezefilm.study.conduct.sessions import end_session

    wall, ticks = [0.0], [1000.0]

    def now() -> str:
        at = datetime(2026, 11, 1, 12, tzinfo=UTC) + timedelta(seconds=wall[0])
        return at.isoformat(timespec="milliseconds")

    def tick() -> float:
        ticks[0] += 1.0
        return ticks[0]

    for room in ("conduct.run", "conduct.terminal_run", "conduct.sessions", "record.store"):
        monkeypatch.setattr(f"squeezefilm.study.{room}.utc_now", now)
    design = dataclasses.replace(gratings(1), blocks=2, break_between_blocks=60.0)
    with StudyStore.create(tmp_path / "a.sqlite", design, 7) as store:
        begun = session(store, store.enrol()).session["uuid"]
        run, device = StudyRun(store, begun, clock=lambda: ticks[0]), NoDevice()
        expected, told = [], []
        while (shown := run.next_trial()) is not None:
            # The clock is set in the middle of every trial, and of every break.
            wall[0] += step
            if shown.rest:
                assert shown.rest == 60.0
                ticks[0] += 20.0
                again = run.next_trial()
                assert again is not None
                assert again.rest == 40.0
            choice = shown.trial.alternatives[0] if shown.trial.asks else ""
            expected.append((shown.trial.number, choice))
            begun_at, ended_at = tick(), tick()
            answer = Response(
                choice=choice, response_time=1.0, started_monotonic=begun_at,
                ended_monotonic=ended_at,
            )  # fmt: skip
            told.append(run.respond(shown.token, answer).number)
        end_session(store, begun, device)
        rows = store.rows(WHERE)
        assert [(row["number"], row["choice"]) for row in rows] == expected
        assert told == [number for number, _ in expected]
        assert {row["ended_monotonic_s"] - row["started_monotonic_s"] for row in rows} == {1.0}
        assert len(expected) == 9
    with StudyStore.open(tmp_path / "a.sqlite") as store:
        assert export_study(store, "csv").is_dir()
