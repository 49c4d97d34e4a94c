"""`squeezefilm.cli.described`: `analyze` of a motor or an array."""

from __future__ import annotations

import functools
import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest import mock

import pytest
from tests.e2e.program import run
from tests.shared import shared

from squeezefilm.actuators.report import motor, skin_stretch
from squeezefilm.actuators.report.page import analyze_actuator


def test_options_of_displays_are_refused_of_actuators() -> None:
    done = run("analyze", "biet2008-motor", "--force", "1 N", "--wanted", "0.5", "--all")
    assert done.returncode == 2
    assert "--force, --wanted, --all: only a display" in done.stderr
    assert "--voltage, --out and --json" in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["motor", "skin_stretch"])
def test_an_actuator_is_analysed_as_one(kind: str, tmp_path: Path) -> None:
    name = f"biet2008-{kind.replace('_', '-')}"
    # What is computed of each is asked in its own tests.
    analysis = shared(name, lambda: analyze_actuator(name)).analysis
    with mock.patch(f"squeezefilm.actuators.report.page.analyze_{kind}") as analyze:
        analyze.return_value = analysis
        done = run("analyze", name, "--voltage", "3 V", "--json", "--out", str(tmp_path))
    assert analyze.call_args.args[0].name == name
    assert analyze.call_args.kwargs["voltage"] == 3.0
    assert json.loads(done.stdout)["kind"] == kind
    assert (tmp_path / "report.html").exists()


def test_an_actuator_is_analysed_shown_and_written_where_asked(
    tmp_path: Path, stands_in: Any
) -> None:
    shown: list[object] = []
    wrote: list[object] = []

    def write(folder: Path) -> Path:
        wrote.append(folder)
        return folder / "report.html"

    analysis = SimpleNamespace(summary=lambda: {"kind": "motor"})
    show = functools.partial(shown.append, analysis)
    analyzed = SimpleNamespace(analysis=analysis, show=show, write=write)
    asked = stands_in("actuators.report.page:analyze_actuator", analyzed, tells=False)
    done = run("analyze", "biet2008-motor")
    assert asked.given[:2] == ("biet2008-motor", None)
    assert (done.stdout, shown, wrote) == ("", [analysis], [])
    done = run("analyze", "biet2008-motor", "--voltage", "30 V", "--out", str(tmp_path))
    assert asked.calls[-1][0][1] == 30.0
    assert wrote == [tmp_path]
    assert done.stdout == f"report: {tmp_path / 'report.html'}\n"
    told = run("analyze", "biet2008-motor", "--json")
    assert json.loads(told.stdout) == {"kind": "motor"}
    assert len(shown) == 2


@pytest.mark.parametrize(
    ("name", "kind", "report"),
    [
        ("biet2008-motor", "motor", (motor.motor_rows, motor.MOTOR_FIGURES)),
        (
            "biet2008-skin-stretch",
            "skin_stretch",
            (skin_stretch.skin_stretch_rows, skin_stretch.SKIN_STRETCH_FIGURES),
        ),
    ],
)
def test_each_kind_has_its_own_analysis_and_report(name: str, kind: str, report: object) -> None:
    place = f"squeezefilm.actuators.report.page.analyze_{kind}"
    with mock.patch(place, return_value="analysed") as analyze:
        found = analyze_actuator(name, 12.0, print)
    assert analyze.call_args.args[0].name == name
    assert analyze.call_args.kwargs == {"voltage": 12.0, "progress": print}
    assert found.analysis == "analysed"
    assert (found.rows, found.figures) == report
