"""The verbs about a display's description, and `analyze` with its defaults and units."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import typer
from tests.e2e.program import run

from squeezefilm.cli.app import app
from squeezefilm.cli.describe import analyze, materials, new, presets, show
from squeezefilm.core.presets import display_names, names
from squeezefilm.physics.display import load_display

DISPLAY = "biet2008-plate"
StandsIn = Callable[..., Any]
ANSWER = SimpleNamespace(
    summary=lambda: {"found": 1},
    compute=lambda names, tell: None,
    whole=False,
    has_sensitivities=False,
)


def test_the_verbs_are_those_of_the_program() -> None:
    said = run("--help").stdout
    for verb in (presets, show, new, materials, analyze):
        assert verb.__name__ in said


def test_every_verb_is_described_in_the_docs() -> None:
    text = (Path(__file__).parents[3] / "docs" / "reference" / "cli.md").read_text(encoding="utf-8")
    commands: dict[str, Any] = vars(typer.main.get_command(app))["commands"]
    verbs = [
        f"{name} {below}".strip()
        for name, command in commands.items()
        for below in getattr(command, "commands", [""])
    ]
    assert len(verbs) > 15
    headed = [
        word.split()[0]
        for line in text.splitlines()
        if line.startswith("## ")
        for word in line[3:].split(", ")
    ]
    assert [
        verb for verb in verbs if f"squeezefilm {verb}" not in text and verb not in headed
    ] == []


@pytest.mark.slow
def test_the_package_can_be_run_by_its_name() -> None:
    command = [sys.executable, "-m", "squeezefilm", "presets", "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert [one["name"] for one in json.loads(done.stdout)] == [
        *display_names(),
        *names("actuator"),
    ]


def test_presets_are_listed() -> None:
    listing = json.loads(run("presets", "--json").stdout)
    assert [one["name"] for one in listing] == [*display_names(), *names("actuator")]
    said = run("presets").stdout
    assert not said.startswith("[")
    assert all(name in said for name in (*display_names(), *names("actuator")))
    assert "what it is" in said


def test_materials_are_listed_and_shown() -> None:
    listing = json.loads(run("materials", "--json").stdout)
    assert "aluminium 5083" in [one["name"] for one in listing]
    (one,) = json.loads(run("materials", "AA5083", "--json").stdout)
    assert one["values"][0]["path"] == "young_modulus"
    assert "5083" in run("materials").stdout
    refused = run("materials", "PZT-6")
    assert refused.returncode == 2
    assert "there is no material 'PZT-6'" in refused.stderr


def test_values_are_shown_with_their_sources() -> None:
    values = json.loads(run("show", DISPLAY, "--json").stdout)
    assert {one["path"]: one["text"] for one in values}["actuator.thickness"] == "2 mm"
    said = run("show", DISPLAY).stdout
    sourced = [one for one in values if one["evidence"] is not None]
    assert f"of {len(sourced)} values" in said
    refused = run("show", "biet2008-plat")
    assert refused.returncode == 2
    assert f"Did you mean '{DISPLAY}'" in refused.stderr


def test_a_new_file_is_a_display_and_is_kept_unless_forced(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    done = run("new", file, "--from", DISPLAY)
    assert done.stdout == f"wrote {file}; edit it, then: squeezefilm analyze {file}\n"
    assert load_display(file).actuator == load_display(DISPLAY).actuator
    file.write_text("mine", encoding="utf-8")
    refused = run("new", file, "--from", DISPLAY)
    assert refused.returncode == 2
    assert file.read_text(encoding="utf-8") == "mine"
    assert run("new", file, "--from", DISPLAY, "--force").returncode == 0
    assert load_display(file).actuator == load_display(DISPLAY).actuator


@pytest.fixture
def analysis(stands_in: StandsIn, tmp_path: Path) -> SimpleNamespace:
    """What `analyze` calls."""
    return SimpleNamespace(
        asked=stands_in("design.analysis.analyze:analyze", ANSWER),
        shown=stands_in("design.analysis.report.page:show_analysis"),
        written=stands_in("design.analysis.report.page:write_analysis", tmp_path / "report.html"),
    )


def test_an_analysis_is_the_displays_own_unless_asked(analysis: SimpleNamespace) -> None:
    done = run("analyze", DISPLAY)
    assert done.returncode == 0, done.stderr
    assert analysis.asked.given == (load_display(DISPLAY),)
    assert analysis.asked.named == {
        "voltage": None, "frequency": None, "vibration_amplitude": None, "normal_force": None,
        "surface": None, "samples": 16, "wanted_friction": None, "sensitivities": None,
        "theory": None, "model": None, "strict": False,
        "speed": None, "budget": None, "place": None, "whole": False,
    }  # fmt: skip
    assert analysis.shown.given == (ANSWER,)
    assert done.stdout == "add --out DIR to write result.json and a report with figures\n"
    expected, *steps = done.stderr.splitlines()
    assert expected.startswith("expected about ")
    assert steps == ["  a step …"]
    assert analysis.written.calls == []


def test_every_option_of_an_analysis_arrives(analysis: SimpleNamespace, tmp_path: Path) -> None:
    options = (
        "--voltage", "15 V", "--frequency", "34 kHz", "--amplitude", "2 um", "--force", "0.3 N",
        "--surface", "copper", "--samples", "8", "--wanted", "0.5", "--sensitivities", "solved",
        "--theory", "timoshenko", "--model", "levitation-2016", "--all",
        "--speed", "50 mm/s", "--strict", "--out", tmp_path, "--budget", "2 min",
    )  # fmt: skip
    done = run("analyze", DISPLAY, *options)
    assert analysis.asked.named == {
        "voltage": 15.0, "frequency": 34e3, "vibration_amplitude": pytest.approx(2e-6),
        "normal_force": 0.3, "surface": "copper", "samples": 8, "wanted_friction": 0.5,
        "sensitivities": "solved", "theory": "timoshenko",
        "model": "levitation-2016", "speed": pytest.approx(0.05), "strict": True, "budget": 120.0,
        "place": None, "whole": True,
    }  # fmt: skip
    assert analysis.written.given == (ANSWER, tmp_path)
    assert analysis.shown.given == (ANSWER,)
    assert done.stdout == f"report: {tmp_path / 'report.html'}\n"
    done = run("analyze", DISPLAY, "--json")
    assert json.loads(done.stdout) == {"found": 1}
    assert done.stderr == ""
    assert len(analysis.shown.calls) == 1


@pytest.mark.parametrize("option", ["voltage", "frequency", "amplitude", "force"])
def test_a_wrong_unit_is_refused_with_its_option(option: str, analysis: SimpleNamespace) -> None:
    done = run("analyze", DISPLAY, f"--{option}", "3 kg")
    assert done.returncode == 2
    assert f"error: --{option}: " in done.stderr
    assert analysis.asked.calls == []


def test_a_place_nobody_can_write_to_is_refused_first(
    analysis: SimpleNamespace, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    done = run("analyze", DISPLAY, "--out", tmp_path / "file" / "out")
    assert done.returncode == 2
    assert "nothing can be written there" in done.stderr
    assert analysis.asked.calls == []


def test_a_new_file_says_from_what_it_can_start(tmp_path: Path) -> None:
    done = run("new", str(tmp_path / "mine.toml"))
    assert done.returncode == 2
    assert "--from biet2008-plate" in done.stderr
    assert not (tmp_path / "mine.toml").exists()
