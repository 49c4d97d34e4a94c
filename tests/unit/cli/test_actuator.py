"""`squeezefilm.cli.actuator`: `analyze` of a motor or an array."""

from __future__ import annotations

import json
from pathlib import Path
from unittest import mock

import pytest
from tests.e2e.program import run
from tests.shared import shared

from squeezefilm.actuators.report.dispatch import analyze_actuator


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
    drawn = "squeezefilm.actuators.report.skin_stretch.wave_animation"
    with (
        mock.patch(f"squeezefilm.actuators.analysis.{kind}.analyze_{kind}") as analyze,
        mock.patch(drawn, return_value=b""),
    ):
        analyze.return_value = analysis
        done = run("analyze", name, "--voltage", "3 V", "--json", "--out", str(tmp_path))
    assert analyze.call_args.args[0].name == name
    assert analyze.call_args.kwargs["voltage"] == 3.0
    assert json.loads(done.stdout)["kind"] == kind
    assert (tmp_path / "report.html").exists()
