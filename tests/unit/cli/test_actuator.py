"""`squeezefilm.cli.actuator`: `analyze` of a motor or an array."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from tests.e2e.program import run


def test_options_of_displays_are_refused_of_actuators() -> None:
    done = run("analyze", "biet2008-motor", "--force", "1 N", "--wanted", "0.5", "--all")
    assert done.returncode == 2
    assert "--force, --wanted, --all: only a display" in done.stderr
    assert "--voltage, --out and --json" in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["motor", "skin_stretch"])
def test_an_actuator_is_analysed_as_one(kind: str, tmp_path: Path) -> None:
    name = f"biet2008-{kind.replace('_', '-')}"
    done = run("analyze", name, "--json", "--out", str(tmp_path))
    assert json.loads(done.stdout)["kind"] == kind
    assert (tmp_path / "report.html").exists()
