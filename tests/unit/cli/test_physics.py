"""The verbs of the single rooms: their defaults, the units they read, what they refuse."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.e2e.program import run

from squeezefilm.cli.describe import film, friction, modes, plate
from squeezefilm.design.film import FilmRequest
from squeezefilm.physics.display import load_display

PLATE, STATOR = "biet2008-plate", "biet2008-stator"
StandsIn = Callable[..., Any]
ANSWER = SimpleNamespace(summary=lambda: {"found": 1})


def test_the_verbs_are_those_of_the_program() -> None:
    said = run("--help").stdout
    for verb in (friction, film, modes, plate):
        assert verb.__name__ in said


def test_a_friction_has_the_fields_own_defaults(stands_in: StandsIn, tmp_path: Path) -> None:
    asked = stands_in("design.friction:analyze_friction", ANSWER)
    shown = stands_in("design.report.friction:show_friction")
    written = stands_in("design.report.friction:write_friction", "a/folder")
    done = run("friction", PLATE)
    assert done.returncode == 0, done.stderr
    assert asked.given == (load_display(PLATE),)
    assert asked.named == {
        "voltage": None, "frequency": None, "vibration_amplitude": None, "normal_force": None,
        "surface": None, "model": None, "position": None, "place": None, "speed": None,
        "ambient_pressure": None, "wanted_friction": None, "samples": 16, "seed": 1,
    }  # fmt: skip
    assert shown.given == (ANSWER,)
    assert (done.stdout, done.stderr.splitlines()[1:]) == ("", ["  a step …"])
    assert written.calls == []

    done = run(
        "friction", PLATE, "--voltage", "15 V", "--frequency", "34 kHz", "--force", "0.3 N",
        "--surface", "copper", "--model", "levitation-2016", "--position", "2 mm",
        "--speed", "50 mm/s", "--finger", "mean",
        "--ambient-pressure", "2 kPa", "--wanted", "0.7", "--samples", "8", "--seed", "5",
        "--out", tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert asked.calls[-1][1] == {
        "voltage": 15.0, "frequency": 34e3, "vibration_amplitude": None, "normal_force": 0.3,
        "surface": "copper", "model": "levitation-2016", "position": pytest.approx(2e-3),
        "speed": pytest.approx(0.05), "ambient_pressure": 2000.0, "wanted_friction": 0.7,
        "samples": 8, "seed": 5, "place": None,
    }  # fmt: skip
    (display,) = asked.calls[-1][0]
    assert "mean of people" in display.provenance["finger.contact_decay_length"].source
    assert written.given == (ANSWER, tmp_path)
    assert done.stdout == "figures: a/folder\n"
    done = run("friction", PLATE, "--amplitude", "2 um", "--speed", "0 mm/s", "--json")
    assert asked.calls[-1][1]["vibration_amplitude"] == pytest.approx(2e-6)
    assert asked.calls[-1][1]["speed"] == 0.0
    assert json.loads(done.stdout) == {"found": 1}
    assert done.stderr == ""
    assert len(shown.calls) == 2


@pytest.mark.parametrize(
    "option", ["voltage", "frequency", "amplitude", "force", "position", "speed"]
)
def test_a_quantity_of_another_kind_is_refused_with_its_option(
    option: str, stands_in: StandsIn
) -> None:
    asked = stands_in("design.friction:analyze_friction", ANSWER)
    done = run("friction", PLATE, f"--{option}", "3 kg")
    assert done.returncode == 2
    assert f"error: --{option}: " in done.stderr
    assert asked.calls == []


def test_a_film_is_an_isothermal_strip_unless_asked(stands_in: StandsIn) -> None:
    asked = stands_in("design.film:solve_film", ANSWER)
    shown = stands_in("design.report.film:show_film")
    done = run("film", "--squeeze-number", "10", "--excursion", "0.5")
    assert asked.given == (10.0, 0.5)
    assert asked.named == {
        "shape": "strip", "aspect_ratio": 1.0, "polytropic_exponent": 1.0, "knudsen_number": 0.0,
        "slip": "first", "tolerance": 1e-3,
    }  # fmt: skip
    assert shown.given == (ANSWER,)
    assert (done.stdout, done.stderr) == ("", "  solving the film …\n")

    done = run(
        "film", "--squeeze-number", "3", "--excursion", "0.1", "--shape", "ellipse", "--aspect",
        "2", "--polytropic", "1.4", "--knudsen", "0.1", "--slip", "second", "--tolerance", "0.01",
        "--json",
    )  # fmt: skip
    assert asked.calls[-1][1] == {
        "shape": "ellipse", "aspect_ratio": 2.0, "polytropic_exponent": 1.4, "knudsen_number": 0.1,
        "slip": "second", "tolerance": 0.01,
    }  # fmt: skip
    assert json.loads(done.stdout) == {"found": 1}
    assert done.stderr == ""
    assert len(shown.calls) == 1


@pytest.mark.parametrize(
    "given", [(), ("--squeeze-number", "10"), ("--excursion", "0.5"), ("--sweep",)]
)
def test_a_film_of_which_too_little_is_said_is_refused(given: tuple[str, ...]) -> None:
    done = run("film", *given)
    assert done.returncode == 2
    assert "--out DIR" in done.stderr
    assert ("say which" if given == ("--sweep",) else "--squeeze-number and") in done.stderr
    assert done.stdout == ""


def test_a_sweep_is_drawn_into_a_folder(stands_in: StandsIn, tmp_path: Path) -> None:
    asked = stands_in("design.film:sweep_film", ANSWER)
    written = stands_in("design.report.film:write_film_map", "map.png")
    solved = stands_in("design.film:solve_film", ANSWER)
    done = run("film", "--sweep", "--shape", "disc", "--out", tmp_path)
    assert asked.given == (FilmRequest("disc", 1.0, 1.0, 0.0, "first", 1e-3),)
    assert written.given == (ANSWER, tmp_path)
    assert (done.stdout, done.stderr) == ("map: map.png\n", "  a step …\n")
    done = run("film", "--sweep", "--out", tmp_path, "--json")
    assert json.loads(done.stdout) == {"found": 1}
    assert solved.calls == []


class Plate(SimpleNamespace):
    """Stands for the analysis of a rectangular plate."""


@pytest.fixture
def plates(stands_in: StandsIn, monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """What `plate` calls, with the analysis of a rectangle as the answer."""
    from squeezefilm.design.plate import command

    monkeypatch.setattr(command, "PlateAnalysis", Plate)
    return SimpleNamespace(
        solve=stands_in("design.plate.command:solve_plate", Plate(summary=lambda: {"plate": 1})),
        show_plate=stands_in("design.plate.report.terminal:show_plate"),
        page=stands_in("design.plate.report.page:write_plate", "plate.html"),
        volume=stands_in("design.plate.report.page:write_mode", "plate.vtu"),
    )


def test_a_plate_is_solved_and_shown(plates: SimpleNamespace) -> None:
    done = run("plate", PLATE)
    assert done.returncode == 0, done.stderr
    assert plates.solve.given == (load_display(PLATE),)
    assert plates.solve.named == {"mode": None, "band": None, "budget": None}
    assert plates.show_plate.given == (plates.solve.answer,)
    assert (done.stdout, done.stderr.splitlines()[1:]) == ("", ["  a step …"])
    assert plates.page.calls == plates.volume.calls == []
    options = ("--band", "25 kHz:45 kHz", "--mode", "8,0", "--budget", "60 s", "--json")
    done = run("plate", PLATE, *options)
    assert plates.solve.calls[-1][1] == {"mode": (8, 0), "band": (25e3, 45e3), "budget": 60.0}
    assert json.loads(done.stdout) == {"plate": 1}
    assert done.stderr == ""
    assert len(plates.show_plate.calls) == 1


def test_a_plate_is_written_where_asked(plates: SimpleNamespace, tmp_path: Path) -> None:
    done = run("plate", PLATE, "--out", tmp_path)
    assert plates.page.given == (plates.solve.answer, tmp_path)
    assert plates.volume.calls == []
    assert done.stdout == "wrote plate.html\n"
    assert "  figures …" in done.stderr
    done = run("plate", PLATE, "--vtu", tmp_path / "a.vtu")
    assert plates.volume.given == (plates.solve.answer, tmp_path / "a.vtu")
    assert len(plates.page.calls) == 1
    assert done.stdout == "wrote plate.vtu\n"
    done = run("plate", PLATE, "--vtu", tmp_path / "a.vtu", "--out", tmp_path)
    assert done.stdout == "wrote plate.html\nwrote plate.vtu\n"


def test_a_stator_has_a_page_and_no_volume(plates: SimpleNamespace, tmp_path: Path) -> None:
    plates.solve.answer = ANSWER
    done = run("plate", STATOR)
    assert plates.show_plate.given == (ANSWER,)
    assert done.stdout == ""
    done = run("plate", STATOR, "--out", tmp_path)
    assert plates.page.given == (ANSWER, tmp_path)
    assert done.stdout == "wrote plate.html\n"
    refused = run("plate", STATOR, "--vtu", tmp_path / "a.vtu")
    assert refused.returncode == 2
    assert f"actuator of '{STATOR}' is of the type annular stator" in refused.stderr
    assert "annular stator" in refused.stderr
    assert len(plates.solve.calls) == 2
    assert plates.volume.calls == []


def test_modes_are_listed_in_a_band_and_shown(stands_in: StandsIn, tmp_path: Path) -> None:
    asked = stands_in("design.plate.modes:list_modes", ANSWER)
    shown = stands_in("design.plate.report.modes:show_mode_list")
    written = stands_in("design.plate.report.modes:write_modes", "a/folder")
    done = run("modes", PLATE)
    assert done.returncode == 0, done.stderr
    assert asked.given == (load_display(PLATE), (15e3, 60e3))
    assert asked.named == {}
    assert shown.given == (ANSWER,)
    assert written.calls == []

    done = run("modes", STATOR, "--band", "20 kHz..50 kHz", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert asked.calls[-1][0][1] == (20e3, 50e3)
    assert written.given == (ANSWER, tmp_path)
    assert done.stdout == "figures: a/folder\n"

    assert json.loads(run("modes", PLATE, "--json").stdout) == {"found": 1}
    wrong = run("modes", PLATE, "--band", "20 kHz")
    assert wrong.returncode != 0
    assert "25 kHz..45 kHz" in wrong.stderr
