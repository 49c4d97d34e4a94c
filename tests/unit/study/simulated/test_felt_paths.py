"""A study's recorded and drawn paths, and what they would have felt like; on every surface."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.unit.study.design.test_matching import shapes

from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.core.formats.traces import Table, csv_text
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.render.motion.finger_path import FingerPath
from squeezefilm.study.conduct.rehearsal import rehearse
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.report.felt_path import felt_path, show_all
from squeezefilm.study.simulated import felt_trials
from squeezefilm.study.simulated.felt_paths import felt_on_path
from squeezefilm.study.simulated.felt_trials import felt_in_trial
from squeezefilm.subjects import plot

pytestmark = pytest.mark.usefixtures("figures_as_described")

SLANTED = "80 mm/s over 4 cm, 3 passes, at 30 deg"


def test_the_period_of_a_slanted_path_is_nearest_to_the_grating_of_its_length() -> None:
    found = felt_on_path("biet2008-gratings", "4 mm", SLANTED, display="biet2008-plate")
    one = found.directions["along x"]
    assert one.clearest_period == pytest.approx(4e-3 / math.cos(math.radians(30)), rel=5e-3)
    assert found.nearest[0].name == "4 mm"
    assert found.compared_by == "the period of the clearest rhythm"
    assert found.explored.passes == 3
    assert "assumed" in found.force_is
    assert any("assumed" in said for said in found.assumed)


def test_a_path_along_the_ridges_is_like_no_grating() -> None:
    found = felt_on_path(
        "biet2008-gratings", "4 mm", "80 mm/s over 3 cm, 3 passes, at 90 deg",
        display="biet2008-plate",
    )  # fmt: skip
    assert "along x" not in found.directions
    assert found.directions["along y"].clearest_d_prime == 0.0
    assert all(math.isinf(one.apart) for one in found.nearest)


def test_a_surface_is_nearest_to_itself_and_a_known_force_is_used(tmp_path: Path) -> None:
    t = np.linspace(0, 2, 201)
    x = 0.02 - 0.02 * np.cos(2 * math.pi * t)
    table = Table({"time_s": t, "x_m": x, "y_m": 0.01 + 0 * t, "force_N": 0.8 + 0 * t})
    (tmp_path / "mine.csv").write_text(csv_text(table))
    found = felt_on_path(shapes(), "bars", str(tmp_path / "mine.csv"))
    assert found.nearest[0].name == "bars"
    drawn = felt_path(dataclasses.replace(found, source="mine.csv"))
    assert "bars along this path: " in drawn.get_suptitle()
    assert found.nearest[0].apart == 0.0
    assert all(a.apart <= b.apart for a, b in zip(found.nearest, found.nearest[1:], strict=False))
    assert found.finger.normal_force == pytest.approx(0.8)
    assert found.force_is.startswith("known")
    again = json.loads(json.dumps(found.summary()))
    assert again["origin"] == "simulated"
    assert again["explored"]["passes"] == 4
    assert again["directions"]["along x"]["runs"] == 4


@pytest.mark.parametrize(
    ("stimulus", "path", "says"),
    [
        ("nothing", SLANTED, "has no stimulus 'nothing'"),
        ("disc", "fast", "is no stroke"),
        ("disc", "missing.csv", "missing.csv"),
        ("disc", "80 mm/s over 40 cm", "the surface has"),
        ("disc", "80 mm/s over 3 mm", "no straight run of 4 mm"),
    ],
)
def test_what_cannot_be_felt_says_why(stimulus: str, path: str, says: str) -> None:
    with pytest.raises(SqueezefilmError, match=says):
        felt_on_path(shapes(), stimulus, path)


@pytest.mark.slow
def test_a_rehearsed_answer_is_felt_along_its_own_path(tmp_path: Path) -> None:
    from dataclasses import replace

    observer = replace(load_observer(), finger_classes=1)
    with StudyStore.create(tmp_path / "study.sqlite", shapes(), 3) as store:
        (who,) = rehearse(store, observer, 1)
        first = 1 + len(shapes().stimuli)
        (found,) = felt_in_trial(store, who, first, observer)
        assert found.source == f"trial {first} of {who} (simulated participants)"
        assert found.answer == found.stimulus.name == found.nearest[0].name
        assert found.explored.passes == 16
        assert found.force_is == "known"
        # The path as the study keeps it, every 10 ms, and the model's own give the same percept.
        from squeezefilm.physics.display import load_display
        from squeezefilm.study.conduct.rehearsal import path_of

        exact = path_of("free", load_display("biet2008-plate"), observer, observer.median_finger())
        again = felt_on_path(
            store.design, found.stimulus.name, exact, observer=observer,
            normal_force=found.finger.normal_force,
        )  # fmt: skip
        for name, one in again.directions.items():
            here = found.directions[name]
            assert here.clearest_d_prime == pytest.approx(one.clearest_d_prime, rel=0.02, abs=0.02)
        show_all((found,))
        assert plot(found).axes
        assert felt_path(found).axes
        for trial, says in ((1, "has no answer"), (99, "has no answer")):
            with pytest.raises(InputError, match=says):
                felt_in_trial(store, who, trial, observer)
        with pytest.raises(InputError, match="enrolled are"):
            felt_in_trial(store, "somebody", first, observer)
        for path in store.traces.iterdir():
            path.unlink()
        with pytest.raises(InputError, match="has 0 paths"):
            felt_in_trial(store, who, first, observer)


def test_a_trial_of_a_series_has_no_stimulus_to_feel(monkeypatch: pytest.MonkeyPatch) -> None:
    row = {"participant_id": "p", "trial": 4, "phase": "main", "adaptive_series": "stairs"}
    monkeypatch.setattr(felt_trials, "trial_table", lambda _: [row])
    with pytest.raises(InputError, match="the series 'stairs' chose, which is no stimulus"):
        felt_in_trial(SimpleNamespace(), "p", 4)  # type: ignore[arg-type]


def test_two_touches_are_two_paths() -> None:
    t = np.linspace(0, 0.5, 51)
    there = FingerPath(t, 0.08 * t, 0 * t + 0.02)
    back = FingerPath(t, 0.04 - 0.08 * t, 0 * t + 0.02)
    found = felt_on_path(shapes(), "checks", (there, back))
    assert found.explored.passes == 2
    assert found.explored.touched == pytest.approx(1.0)
    assert found.directions["along x"].runs == 2


@pytest.mark.parametrize(
    ("participant", "trial", "says"),
    [
        ("q", 4, "'q' has no answer in s.sqlite; enrolled are: p, r"),
        ("p", 3, "trial 3 of p has no answer; answered are 2 to 5"),
        # What one got to know before has no number of its own.
        ("p", 1, "answered are 2 to 5"),
        ("r", 1, "answered are 0 to 0"),
    ],
)
def test_an_answer_that_is_not_there_says_which_are(
    participant: str, trial: int, says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = [
        {"participant_id": who, "trial": number, "phase": phase, "adaptive_series": ""}
        for who, number, phase in (
            ("p", 1, "familiarisation"),
            ("p", 5, "main"),
            ("p", 2, "main"),
            ("r", 1, "familiarisation"),
        )
    ]
    monkeypatch.setattr(felt_trials, "trial_table", lambda _: rows)
    people = [{"uuid": "p"}, {"uuid": "r"}]
    store = SimpleNamespace(participants=lambda: people, path=Path("s.sqlite"))
    with pytest.raises(InputError, match=says):
        felt_in_trial(store, participant, trial)  # type: ignore[arg-type]


def store_of(monkeypatch: pytest.MonkeyPatch, row: dict[str, object], paths: int) -> Any:
    """A study's file with one answer and so many paths of it, each felt as what it is asked by."""
    t = np.linspace(0, 0.5, 51)
    tables = [Table({"time_s": t, "x_m": 0.01 * k + 0.08 * t, "y_m": 0 * t}) for k in range(paths)]
    asked: list[str] = []
    read = SimpleNamespace(paths=lambda names: asked.extend(names) or tables)
    monkeypatch.setattr(felt_trials, "trial_table", lambda _: [row])
    monkeypatch.setattr(felt_trials, "ExploredTrials", lambda _: read)
    monkeypatch.setattr(felt_trials, "felt_on_path", lambda *given, **named: (given, named))
    monkeypatch.setattr(felt_trials, "origin_of", lambda _: "people")
    return SimpleNamespace(
        design="the design", asked=asked, path=Path("s.sqlite"), traces=Path("s.traces")
    )


ROW = {
    "participant_id": "p", "trial": 4, "phase": "main", "adaptive_series": "",
    "stimulus": "bars", "second_stimulus": "checks", "third_stimulus": "", "traces": "a.csv b.csv",
    "mean_normal_force_N": 0.7, "display": "biet2008-plate", "choice": None, "answer": "first",
}  # fmt: skip


def test_each_surface_of_a_trial_is_felt_along_its_own_path(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    store, told = store_of(monkeypatch, ROW, 2), print
    found: Any = felt_in_trial(store, "p", 4, progress=told)
    assert store.asked == ["a.csv", "b.csv"]
    for place, (name, (given, named)) in enumerate(zip(("bars", "checks"), found, strict=True)):
        design, stimulus, (path,) = given
        assert (design, stimulus) == ("the design", name)
        assert path.x[0] == pytest.approx(0.01 * place, abs=1e-12)
        assert named.pop("display").name == "biet2008-plate"
        assert named == {
            "observer": None, "normal_force": 0.7, "source": "trial 4 of p (people)",
            "choice": "", "answer": "first", "progress": told,
        }  # fmt: skip


@pytest.mark.parametrize("known", [None, math.nan])
def test_a_force_that_was_not_measured_is_not_known(
    known: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = store_of(monkeypatch, ROW | {"mean_normal_force_N": known, "choice": "second"}, 2)
    found: Any = felt_in_trial(store, "p", 4)
    assert [named["normal_force"] for _, named in found] == [None, None]
    assert found[0][1]["choice"] == "second"


@pytest.mark.parametrize("paths", [0, 1, 3])
def test_a_trial_without_a_path_of_each_surface_is_refused(
    paths: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = store_of(monkeypatch, ROW, paths)
    says = f"presented 2 surfaces and has {paths} paths beside s.sqlite; .* in s.traces"
    with pytest.raises(InputError, match=says):
        felt_in_trial(store, "p", 4)
