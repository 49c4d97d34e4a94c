"""The verbs about textures: defaults, units, and files that need a folder."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.e2e.program import run

from squeezefilm.cli.textures import render, textures
from squeezefilm.core.presets import texture_names
from squeezefilm.physics.display import load_display
from squeezefilm.physics.texture_files.texture_file import load_texture

DISPLAY, TEXTURE = "biet2008-plate", "sine-3mm"
StandsIn = Callable[..., Any]
ANSWER = SimpleNamespace(summary=lambda: {"found": 1})


@pytest.fixture
def rendered(stands_in: StandsIn, tmp_path: Path) -> SimpleNamespace:
    """What `render` calls."""
    return SimpleNamespace(
        asked=stands_in("physics.chain.rendered_texture:render_texture", ANSWER),
        shown=stands_in("design.report.texture_page:show_render"),
        lost=stands_in("design.report.texture_page:show_lost"),
        written=stands_in("design.report.texture_page:write_render", tmp_path / "index.html"),
        hjif=stands_in("design.report.texture_page:hjif_export", "the export"),
    )


def test_a_texture_is_rendered_under_a_known_finger(rendered: SimpleNamespace) -> None:
    done = run("render", TEXTURE, "--display", DISPLAY)
    assert done.returncode == 0, done.stderr
    display, texture, motion = rendered.asked.given
    assert display == load_display(DISPLAY)
    assert texture.title == load_texture(TEXTURE).title
    # 60 mm/s over 4 cm, to and fro.
    assert motion.duration >= 2 * 0.04 / 0.06
    assert rendered.asked.named == {
        "voltage": None, "normal_force": None, "surface": None, "model": None, "sensor": None,
        "compensation": "none", "braking": False, "wave": "ignored", "seed": 0,
        "place": None,
    }  # fmt: skip
    assert rendered.shown.given == (ANSWER,)
    assert (done.stdout, done.stderr) == ("", "  a step …\n")
    assert rendered.written.calls == rendered.lost.calls == []


def test_every_option_of_a_rendering_arrives(rendered: SimpleNamespace, tmp_path: Path) -> None:
    done = run(
        "render", TEXTURE, "--display", DISPLAY, "--stroke", "60 mm/s over 4 cm", "--sensor",
        "touch-panel-120-hz", "--compensate", "inverse", "--braking", "--wave", "felt",
        "--voltage", "15 V", "--force", "0.3 N", "--surface", "copper", "--model",
        "levitation-2016", "--seed", "5", "--finger", "mean", "--out", tmp_path,
        "--table", "parquet",
        "--drive", "--hjif",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert rendered.asked.named == {
        "voltage": 15.0, "normal_force": 0.3, "surface": "copper", "model": "levitation-2016",
        "sensor": "touch-panel-120-hz", "compensation": "inverse", "braking": True, "wave": "felt",
        "seed": 5, "place": None,
    }  # fmt: skip
    assert "mean of people" in rendered.asked.given[0].whose_finger
    assert rendered.written.given == (ANSWER, tmp_path)
    assert rendered.written.named == {"table": "parquet", "drive": True, "hjif": True}
    assert rendered.hjif.given == (ANSWER,)
    assert rendered.lost.given == ("the export",)
    assert done.stdout == f"page: {tmp_path / 'index.html'}\n"


def test_plain_files_are_a_csv_without_sound_and_hjif(
    rendered: SimpleNamespace, tmp_path: Path
) -> None:
    done = run("render", TEXTURE, "--display", DISPLAY, "--out", tmp_path, "--json")
    assert rendered.written.named == {"table": "csv", "drive": False, "hjif": False}
    assert json.loads(done.stdout) == {"found": 1}
    assert done.stderr == ""
    assert rendered.shown.calls == rendered.lost.calls == []


@pytest.mark.parametrize("option", [("--drive",), ("--hjif",), ("--table", "parquet")])
def test_files_without_a_folder_are_refused(
    option: tuple[str, ...], rendered: SimpleNamespace
) -> None:
    done = run("render", TEXTURE, "--display", DISPLAY, *option)
    assert done.returncode == 2
    assert "say where with --out DIR" in done.stderr
    assert rendered.asked.calls == []


@pytest.mark.parametrize("option", ["voltage", "force"])
def test_a_wrong_unit_is_refused_with_its_option(option: str, rendered: SimpleNamespace) -> None:
    done = run("render", TEXTURE, "--display", DISPLAY, f"--{option}", "3 kg")
    assert done.returncode == 2
    assert f"error: --{option}: " in done.stderr
    assert rendered.asked.calls == []


def test_presets_are_listed_with_title_and_quantity() -> None:
    listing = json.loads(run("textures", "--json").stdout)
    assert [one["name"] for one in listing] == list(texture_names())
    one = load_texture(TEXTURE)
    expected = {"name": TEXTURE, "title": one.title, "quantity": one.texture.quantity}
    assert expected in listing
    said = run("textures").stdout
    assert not said.startswith("[")
    assert all(name in said for name in texture_names())


def test_the_verbs_are_those_of_the_program() -> None:
    said = run("--help").stdout
    assert render.__name__ in said
    assert textures.__name__ in said
