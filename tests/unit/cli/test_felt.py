"""`study felt`: whose path it takes, what it says and writes, and what it asks for."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.e2e.program import run as program

from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.study.record.store import StudyStore

from ..study.scripted import gratings

DESIGN = """
name = "two"
title = "Two"
task = "same-different"
exploring = "free"
displays = ["biet2008-plate"]
reference = "disc"

[[stimuli]]
name = "disc"

[stimuli.pattern]
type = "band"
start = "-8 mm"
end = "8 mm"
along = { type = "radius", x = "20 mm", y = "10 mm" }

[[stimuli]]
name = "grooves"
spatial_period = "4 mm"
period_means = "period"
"""  # fmt: skip
STROKE = "80 mm/s over 4 cm, 3 passes, y 10 mm"


@pytest.fixture
def design(tmp_path: Path) -> Path:
    path = tmp_path / "two.toml"
    path.write_text(DESIGN)
    return path


@pytest.mark.slow
def test_a_path_in_words_is_felt_drawn_and_told(design: Path, tmp_path: Path) -> None:
    done = program(
        "study", "felt", design, "--path", STROKE, "--stimulus", "grooves", "--force", "0.6 N",
        "--out", tmp_path / "felt.png",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "SIMULATED: 4 mm along x" in done.stdout
    assert "0.6 N" in done.stdout
    assert (tmp_path / "felt.png").read_bytes().startswith(b"\x89PNG")
    told = program("study", "felt", design, "--path", STROKE, "--stimulus", "grooves", "--json")
    (found,) = json.loads(told.stdout)
    assert found["directions"]["along x"]["rhythms"][0]["period_m"] == pytest.approx(4e-3, rel=5e-3)
    assert found["nearest"][0]["name"] == "grooves"
    assert found["normal_force_is"].startswith("assumed")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--path", STROKE), "say by --stimulus which surface"),
        (("--path", "far away", "--stimulus", "disc"), "is no stroke"),
        (("--path", STROKE, "--stimulus", "disk"), "Did you mean 'disc'"),
        (("--path", STROKE, "--stimulus", "disc", "--force", "3 kg"), "--force"),
        ((), "say whose path"),
    ],
)
def test_what_is_missing_is_asked_for(design: Path, arguments: tuple[str, ...], says: str) -> None:
    done = program("study", "felt", design, *arguments)
    assert done.returncode == 2
    assert says in done.stderr
    assert "Traceback" not in done.stderr


Shown = Callable[..., Any]


def felt_one(name: str) -> Any:
    return SimpleNamespace(summary=lambda: {"name": name})


def test_a_path_is_felt_as_asked_and_drawn_where_asked(
    design: Path, tmp_path: Path, stands_in: Shown
) -> None:
    one = felt_one("one")
    asked = stands_in("study.simulated.felt_paths:felt_on_path", one)
    shown = stands_in("study.report.felt_path:show_all")
    drawn = stands_in("subjects:plot", "the figure")
    stands_in("core.kit.style:png", b"a picture")
    arguments = ("study", "felt", design, "--path", STROKE, "--stimulus", "grooves")
    done = program(*arguments)
    found, *rest = asked.given
    assert (found.name, *rest) == ("two", "grooves", STROKE)
    assert asked.named == {
        "observer": load_observer("fingertip"), "display": None, "normal_force": None,
    }  # fmt: skip
    assert shown.given == ((one,),)
    assert done.stdout == ""
    assert drawn.calls == []
    picture = tmp_path / "felt.png"
    done = program(
        *arguments, "--force", "0.6 N", "--display", "winfield2007-tpad", "--out", picture
    )
    named = asked.calls[-1][1]
    assert (named["display"].name, named["normal_force"]) == ("winfield2007-tpad", 0.6)
    assert picture.read_bytes() == b"a picture"
    assert drawn.given == (one,)
    assert done.stdout == f"figure: {picture}\n"
    told = program(*arguments, "--json")
    assert json.loads(told.stdout) == [{"name": "one"}]
    assert len(shown.calls) == 2


def test_each_surface_of_a_recorded_trial_has_a_picture_of_its_own(
    tmp_path: Path, stands_in: Shown
) -> None:
    store = tmp_path / "a.sqlite"
    with StudyStore.create(store, gratings(), 7) as found:
        found.enrol()
    pair = (felt_one("first"), felt_one("second"))
    asked = stands_in("study.simulated.felt_trials:felt_in_trial", pair)
    shown = stands_in("study.report.felt_path:show_all")
    stands_in("subjects:plot", "the figure", tells=False)
    stands_in("core.kit.style:png", b"a picture", tells=False)
    whose = ("--participant", "abc", "--trial", "4")
    done = program("study", "felt", store, *whose, "--out", tmp_path / "felt.png")
    assert asked.given[1:] == ("abc", 4, load_observer("fingertip"))
    assert shown.given == (pair,)
    written = [tmp_path / f"felt-{number}.png" for number in (1, 2)]
    assert done.stdout.splitlines() == [f"figure: {path}" for path in written]
    assert all(path.exists() for path in written)
    for half in (whose[:2], whose[2:]):
        refused = program("study", "felt", store, *half)
        assert refused.returncode == 2
        assert "say whose path by --participant and --trial" in refused.stderr
