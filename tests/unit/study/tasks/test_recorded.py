"""A study's file analysed: the answers that stand in it, and nothing else."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.study.conduct.rehearsal import rehearse
from squeezefilm.study.conduct.run import StudyRun
from squeezefilm.study.conduct.sessions import begin_session
from squeezefilm.study.conduct.study_device import NoDevice
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import SIMULATED, origin_of, trial_table
from squeezefilm.study.simulated.answers import simulate_participants
from squeezefilm.study.tasks.analyze import analyze_study

from ..scripted import CONSENT, Script, gratings, staircase


def run_through(store: StudyStore, people: int) -> None:
    for _ in range(people):
        who = store.enrol()
        session = begin_session(store, who, NoDevice(), CONSENT, None, acknowledged=False)
        conduct(StudyRun(store, session), NoDevice(), Script())


def test_counts_are_those_of_the_main_trials(tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "s.sqlite", gratings(repetitions=3), 4) as store:
        run_through(store, 3)
        (found,) = analyze_study(store, resamples=50).values()
        rows = [row for row in trial_table(store) if row["phase"] == "main"]
    names = ["2 mm", "4 mm", "8 mm"]
    counts = np.zeros((3, 3), dtype=int)
    for row in rows:
        counts[names.index(str(row["choice"])), names.index(str(row["stimulus"]))] += 1
    assert counts.sum() == 27
    assert np.array_equal(found.matrix.counts, counts)
    assert found.participants == 3
    assert found.origin == "people"


def test_a_rehearsal_answers_everything_and_says_that_nobody_did(tmp_path: Path) -> None:
    design = gratings(repetitions=2, displays=("biet2008-stator",))
    observer = dataclasses.replace(load_observer(), finger_classes=1)
    with StudyStore.create(tmp_path / "r.sqlite", design, 4) as store:
        people = rehearse(store, observer, 2)
        assert origin_of(store) == SIMULATED
        assert all(one["planned"] == one["answered"] for one in store.participants())
        assert {one["uuid"] for one in store.participants()} == set(people)
        (found,) = analyze_study(store, resamples=50).values()
        expected = simulate_participants(design, observer, 2, 4).confusion(0)
    assert found.origin == SIMULATED
    assert np.array_equal(found.matrix.counts, expected.counts)
    with StudyStore.create(tmp_path / "p.sqlite", design, 4) as store:
        run_through(store, 1)
        with pytest.raises(InputError, match="people took part"):
            rehearse(store, observer, 1)


class Killed(BaseException):
    """What stands for a kill: nothing of this program catches it."""


@pytest.mark.parametrize("task", ["matches", pytest.param("series", marks=pytest.mark.slow)])
def test_a_rehearsal_that_is_killed_goes_on_with_the_same_people(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, task: str
) -> None:
    if task == "matches":
        design = dataclasses.replace(gratings(1, ("biet2008-stator",)), resume_within=1.0)
    else:
        design = dataclasses.replace(staircase(8), displays=("biet2008-stator",))
    observer = dataclasses.replace(load_observer(), finger_classes=1)
    with StudyStore.create(tmp_path / "whole.sqlite", design, 4) as store:
        rehearse(store, observer, 2)
        expected = answers_by_number(store)
    path, kills = tmp_path / "killed.sqlite", 0
    random = np.random.default_rng(5)
    while True:
        # Opened anew each time, as another process would.
        store = StudyStore.open(path) if path.exists() else StudyStore.create(path, design, 4)
        with store, monkeypatch.context() as patched:
            dies_within(patched, int(random.integers(0, 10)))
            try:
                people = rehearse(store, observer, 2)
                break
            except Killed:
                kills += 1
    assert kills > 2
    with StudyStore.open(path) as store:
        assert [one["uuid"] for one in store.participants()] == list(people)
        assert len(people) == 2
        assert answers_by_number(store) == expected
        # Asked once more for as many there is nothing to do; for more, those are added.
        assert rehearse(store, observer, 2) == people
        assert rehearse(store, observer, 3)[:2] == people
        assert [one["number"] for one in store.participants()] == [0, 1, 2]


def test_a_rehearsal_touches_nobody_who_was_enrolled_by_a_person(tmp_path: Path) -> None:
    design = gratings(repetitions=1, displays=("biet2008-stator",))
    observer = dataclasses.replace(load_observer(), finger_classes=1)
    with StudyStore.create(tmp_path / "a.sqlite", design, 4) as store:
        person = store.enrol()
        (simulated,) = rehearse(store, observer, 1)
        assert simulated != person
        progress = {one["uuid"]: one["answered"] for one in store.participants()}
        assert progress[person] == 0 < progress[simulated]


def dies_within(patched: pytest.MonkeyPatch, steps: int) -> None:
    """Let the program be killed instead of its next step but so many: enrolments, presentations
    and answers."""
    left = [steps]
    for owner, name in ((StudyStore, "enrol"), (StudyRun, "next_trial"), (StudyRun, "respond")):
        work = getattr(owner, name)

        def step(*given: object, work: Callable[..., object] = work, **more: object) -> object:
            left[0] -= 1
            if left[0] < 0:
                raise Killed
            return work(*given, **more)

        patched.setattr(owner, name, step)


def answers_by_number(store: StudyStore) -> list[dict[str, object]]:
    """Every answer with the numbers of its participant and trial, without when and in which file
    it was given."""
    return store.rows(
        "SELECT p.number AS person, t.number, r.stimuli, r.intensity, r.choice, r.estimate, "
        "r.correct, r.response_time_s, r.path_length_m FROM response r "
        "JOIN trial t ON t.uuid = r.trial JOIN participant p ON p.uuid = t.participant "
        "ORDER BY p.number, t.number"
    )


def test_what_has_no_answer_is_refused(tmp_path: Path) -> None:
    design = gratings()
    odd = dataclasses.replace(design, stimuli=design.stimuli[:2])
    with (
        StudyStore.create(tmp_path / "j.sqlite", odd, 4) as store,
        pytest.raises(InputError, match="one right answer for each stimulus"),
    ):
        analyze_study(store)
    with (
        StudyStore.create(tmp_path / "e.sqlite", gratings(), 4) as store,
        pytest.raises(InputError, match="no answered main trial"),
    ):
        analyze_study(store)


def test_response_times_of_the_file_are_those_of_the_analysis(tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "t.sqlite", gratings(repetitions=3), 4) as store:
        run_through(store, 2)
        (found,) = analyze_study(store, resamples=50).values()
        times = [
            float(row["response_time_s"]) for row in trial_table(store) if row["phase"] == "main"
        ]
    assert len(times) == 18
    assert sum(summary.trials for summary in found.response_times) >= len(times)
