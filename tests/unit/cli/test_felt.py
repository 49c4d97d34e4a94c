"""`study felt`: whose path it takes, what it says and writes, and what it asks for."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from tests.e2e.program import run as program

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
