"""A study under kill -9 and on a full disk: what was acknowledged is there, once, in order."""

from __future__ import annotations

import dataclasses
import json
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tests.faults.forked import Forked
from tests.faults.study_child import run

from squeezefilm.physics.perception.stimuli import Grating, Stimulus
from squeezefilm.study.design.rules import AdaptiveCondition
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.design.trials import trials
from squeezefilm.study.record.store import StudyStore

CHILD = Path(__file__).with_name("study_child.py")
LENGTHS = {"2 mm": 2e-3, "4 mm": 4e-3, "8 mm": 8e-3, "10 mm": 10e-3}


def _design(repetitions: int) -> StudyDesign:
    return StudyDesign(
        name="faults",
        title="",
        displays=("biet2008-plate",),
        task="match-to-sample",
        stimuli=tuple(Stimulus(name, at, "period") for name, at in LENGTHS.items()),
        alternatives=tuple(Grating(name, at, "period") for name, at in LENGTHS.items()),
        familiarisation=1,
        repetitions=repetitions,
    )


def _adaptive(count: int) -> StudyDesign:
    """Two interleaved series, whose levels are what their answers have made them."""
    return StudyDesign(
        name="series",
        title="",
        displays=("biet2008-plate",),
        task="two-interval",
        stimuli=(Stimulus("4 mm", 4e-3, "period"),),
        reference="4 mm",
        blocks=3,
        break_between_blocks=0.0,
        adaptive=(
            AdaptiveCondition("stairs", "staircase", count=count),
            AdaptiveCondition("bayes", "bayesian", count=count),
        ),
    )


def _same_different(count: int) -> StudyDesign:
    """A series of same-different."""
    return dataclasses.replace(
        _adaptive(count),
        task="same-different",
        adaptive=(AdaptiveCondition("bayes", "bayesian", count=2 * count),),
    )


def _created(path: Path, design: StudyDesign) -> str:
    with StudyStore.create(path, design, 7) as store:
        return store.enrol()


def _uninterrupted(path: Path, design: StudyDesign) -> list[tuple[int, str, str, float | None]]:
    """What is presented and answered, trial by trial, where nothing is killed."""
    who = _created(path, design)
    child = Forked(run, path, who)
    assert list(iter(child.hear, None))[-1] == "finished"
    return _course(path)


def _course(path: Path) -> list[tuple[int, str, str, float | None]]:
    with StudyStore.open(path) as store:
        rows = store.rows(
            "SELECT t.number, r.stimuli, r.choice, r.intensity FROM response r "
            "JOIN trial t ON t.uuid = r.trial ORDER BY t.number"
        )
    return [(one["number"], one["stimuli"], one["choice"], one["intensity"]) for one in rows]


def _killed(path: Path, who: str, heard_first: int, delay: float) -> list[int]:
    """Kill the child `delay` seconds after so many acknowledgements. All it was acknowledged."""
    child = Forked(run, path, who)
    assert child.hear() == "ready"
    said = [child.hear() for _ in range(heard_first)]
    time.sleep(delay)
    child.kill()
    assert child.process.exitcode == -signal.SIGKILL
    said += iter(child.hear, None)
    assert "finished" not in said, "it finished first: give it more trials"
    return said


def _rows(path: Path) -> list[tuple[int, str, str, str]]:
    with StudyStore.open(path) as store:
        assert store.rows("PRAGMA integrity_check")[0]["integrity_check"] == "ok"
        rows = store.rows(
            "SELECT t.number, t.uuid, r.choice, r.stimuli, r.traces FROM response r "
            "JOIN trial t ON t.uuid = r.trial ORDER BY t.number"
        )
        for row in rows:
            for name in json.loads(row["traces"]):
                assert (store.traces / name).is_file()
    return [(row["number"], row["uuid"], row["choice"], row["stimuli"]) for row in rows]


def _survives(path: Path, kills: int, design: StudyDesign) -> None:
    who = _created(path, design)
    planned = trials(design, 0, 7)
    whole = _uninterrupted(path.with_name("whole.sqlite"), design)
    acknowledged: list[int] = []
    before: list[tuple[int, str, str, str]] = []
    unheard, seed = 0, random.Random(1)
    for kill in range(kills + 1):
        if kill < kills:
            heard = _killed(path, who, seed.randrange(12), seed.uniform(0.0, 0.004))
        else:
            child = Forked(run, path, who)
            words = list(iter(child.hear, None))
            assert (words[0], words[-1]) == ("ready", "finished")
            heard = words[1:-1]
        acknowledged += heard
        rows = _rows(path)
        # What was recorded before stands, and nothing acknowledged is missing.
        assert rows[: len(before)] == before
        assert {one[0] for one in rows} >= set(acknowledged)
        new = len(rows) - len(before) - len(heard)
        assert new in (0, 1)
        unheard += new
        before = rows
    assert [one[0] for one in before] == [one.number for one in planned]
    assert len(set(acknowledged)) == len(acknowledged)
    assert len(acknowledged) + unheard == len(planned)
    for row, one in zip(before, planned, strict=True):
        names = sorted(one.alternatives)
        assert row[2] == (names[one.seed % len(names)] if one.asks else "")
        assert one.adaptive or json.loads(row[3]) == list(one.stimuli)
    # Every level of an adaptive series is the one that it would have had.
    assert _course(path) == whole
    with StudyStore.open(path) as store:
        shown = store.rows("SELECT count(*) AS n FROM presentation")[0]["n"]
        stray = len(store.unreferenced_traces())
    print(
        f"\n{kills} kills: {len(planned)} trials, {len(acknowledged)} acknowledged, 0 lost, 0 "
        f"twice; {unheard} recorded whose acknowledgement was not heard, {shown - len(planned)} "
        f"presented again, {stray} traces without an answer"
    )


@pytest.mark.slow
def test_kill_9_loses_no_acknowledged_trial(tmp_path: Path) -> None:
    _survives(tmp_path / "study.sqlite", kills=12, design=_design(60))


@pytest.mark.slow
@pytest.mark.parametrize("design", [_adaptive(60), _same_different(60)], ids=lambda one: one.task)
def test_kill_9_leaves_adaptive_series_where_they_stood(
    tmp_path: Path, design: StudyDesign
) -> None:
    _survives(tmp_path / "study.sqlite", kills=12, design=design)


MANY = [
    pytest.param(40, marks=pytest.mark.nightly),
    pytest.param(200, marks=pytest.mark.campaign),
]


@pytest.mark.parametrize("kills", MANY)
def test_kill_9_at_many_moments_leaves_adaptive_series_where_they_stood(
    tmp_path: Path, kills: int
) -> None:
    _survives(tmp_path / "study.sqlite", kills=kills, design=_adaptive(4 * kills))


@pytest.mark.parametrize("kills", MANY)
def test_kill_9_at_many_moments_loses_no_acknowledged_trial(tmp_path: Path, kills: int) -> None:
    _survives(tmp_path / "study.sqlite", kills=kills, design=_design(3 * kills))


def _full(command: list[str], path: Path, who: str, how: str) -> None:
    done = subprocess.run(
        [*command, sys.executable, str(CHILD), str(path), who, how],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    every = list(range(1, len(trials(_design(60), 0, 7)) + 1))
    count = len(found["acknowledged"])
    assert 0 < count < len(every)
    for message in (found["message"], found["again"]):
        assert "nothing was acknowledged" in message or "nothing was left behind" in message
    # No acknowledgement without data, nor the other way round; and again while it is full.
    assert found["recorded"] == found["acknowledged"] == every[:count]
    assert found["between"] == every[: len(found["between"])]
    assert found["finally"] == found["order"] == every
    assert found["integrity"] == "ok"
    print(f"\n{how}: full after {count} trials ({found['message'][-90:]}), then on to {len(every)}")


@pytest.mark.slow
def test_a_write_beyond_the_limit_acknowledges_nothing_and_the_run_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "study.sqlite"
    _full([], path, _created(path, _design(60)), "limit")


@pytest.mark.slow
def test_a_full_disk_acknowledges_nothing_and_the_run_goes_on(tmp_path: Path) -> None:
    unshare = shutil.which("unshare")
    disk = tmp_path / "disk"
    disk.mkdir()
    made = tmp_path / "made"
    made.mkdir()
    who = _created(made / "study.sqlite", _design(60))
    script = (
        f"mount -t tmpfs -o size=16m none '{disk}' && cp '{made}'/study.sqlite '{disk}'/ && "
        'exec "$@"'
    )
    mount = [str(unshare), "-Urm", "sh", "-c", script, "sh"]
    if unshare is None or subprocess.run([*mount, "true"], capture_output=True).returncode:
        pytest.skip("no small disk can be mounted here (user namespaces are off)")
    _full(mount, disk / "study.sqlite", who, "disk")


def test_a_database_that_may_not_grow_acknowledges_nothing(tmp_path: Path) -> None:
    from squeezefilm.core.errors import RecordError
    from squeezefilm.study.conduct.run import Response, StudyRun
    from squeezefilm.study.conduct.sessions import SessionConditions, begin_session
    from squeezefilm.study.conduct.study_device import NoDevice

    path = tmp_path / "study.sqlite"
    who = _created(path, _design(60))
    with StudyStore.open(path) as store:
        begun = begin_session(
            store, who, NoDevice(), SessionConditions(consent=True), None, acknowledged=False
        )
        run = StudyRun(store, begun)
        pages = store.rows("PRAGMA page_count")[0]["page_count"]
        store.rows(f"PRAGMA max_page_count = {pages + 4}")
        told, message = 0, ""
        while not message:
            try:
                shown = run.next_trial()
                assert shown is not None
                choice = shown.trial.alternatives[0] if shown.trial.asks else ""
                run.respond(shown.token, Response(choice=choice))
            except RecordError as error:
                message = str(error)
            else:
                told += 1
        assert "full" in message
        assert "nothing was acknowledged" in message
        assert told > 0
        assert len(store.rows("SELECT * FROM response")) == told
        store.rows("PRAGMA max_page_count = 1000000")
        shown = run.next_trial()
        assert shown is not None
        choice = shown.trial.alternatives[0] if shown.trial.asks else ""
        assert run.respond(shown.token, Response(choice=choice)).number == told + 1
