"""`squeezefilm.cli.actuator`: `analyze` of a motor or an array."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from tests.e2e.program import run


def test_options_of_displays_are_refused_of_actuators() -> None:
    done = run("analyze", "biet2008-motor", "--force", "1 N", "--wanted", "0.5")
    assert done.returncode == 2
    assert "--force, --wanted: only a display" in done.stderr
    assert "--voltage, --out and --json" in done.stderr


@pytest.mark.slow
def test_an_array_is_analysed_as_one(tmp_path: Path) -> None:
    done = run("analyze", "biet2008-skin-stretch", "--json", "--out", str(tmp_path))
    assert json.loads(done.stdout)["kind"] == "skin_stretch"
    assert (tmp_path / "report.html").exists()
