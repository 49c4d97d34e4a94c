"""Pages of actuators: everything is in its folder, nothing from elsewhere, a texture that moves."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from PIL import Image

from squeezefilm.actuators.described import is_actuator
from squeezefilm.config.provenance import Provenance
from squeezefilm.errors import ConfigError
from squeezefilm.report.actuators import motor, skin_stretch, skin_stretch_figures
from squeezefilm.report.actuators.dispatch import AnalyzedActuator, analyze_actuator
from squeezefilm.report.actuators.page import assumed_words

NAMES = ("biet2008-motor", "biet2008-skin-stretch")
KINDS = {
    "biet2008-motor": motor.write_motor,
    "biet2008-skin-stretch": skin_stretch.write_skin_stretch,
}


@pytest.fixture(scope="module", params=NAMES)
def analyzed(request: pytest.FixtureRequest) -> AnalyzedActuator:
    return analyze_actuator(request.param)


@pytest.mark.slow
def test_all_that_a_page_shows_lies_beside_it(analyzed: AnalyzedActuator, tmp_path: Path) -> None:
    assert analyzed.write is KINDS[analyzed.found.described.name]
    page = analyzed.write(analyzed.found, tmp_path / "out")
    said = page.read_text(encoding="utf-8")
    pictures = re.findall(r'<img src="([^"]+)" alt="([^"]+)"', said)
    assert len(pictures) >= 4
    for name, _ in pictures:
        assert (page.parent / name).stat().st_size > 5000
    assert "http" not in said.replace("http-equiv", "")
    assert "What each assumed value does" in said
    told = json.loads((page.parent / "result.json").read_text(encoding="utf-8"))
    assert told["stamp"]["squeezefilm_version"]
    assert told["actuator"] == analyzed.found.described.name


@pytest.mark.slow
def test_the_texture_moves(tmp_path: Path) -> None:
    found = analyze_actuator("biet2008-skin-stretch").found
    (tmp_path / "wave.png").write_bytes(skin_stretch_figures.wave_animation(found))  # type: ignore[arg-type]
    with Image.open(tmp_path / "wave.png") as picture:
        assert getattr(picture, "n_frames", 1) == found.wave.times.size  # type: ignore[attr-defined]


@pytest.mark.slow
def test_the_terminal_says_what_is_assumed(
    analyzed: AnalyzedActuator, capsys: pytest.CaptureFixture[str]
) -> None:
    analyzed.show(analyzed.found)
    said = " ".join(capsys.readouterr().out.split())
    assert "values with a source are assumed" in said
    assert analyzed.found.described.name in said


def test_how_many_are_assumed() -> None:
    known = {"a": Provenance("x", "assumed"), "b": Provenance("y", "measured")}
    assert assumed_words(known).startswith("1 of 2 values")


def test_an_actuator_is_told_by_its_table(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text('name = "a"\n[motor]\nslider_mass = "1 g"\n', encoding="utf-8")
    assert is_actuator(file)
    file.write_text('name = "a"\n[actuator]\n# [motor]\n', encoding="utf-8")
    assert not is_actuator(file)
    assert all(is_actuator(name) for name in NAMES)
    assert not is_actuator("biet2008-plate")
    assert not is_actuator(tmp_path / "absent.toml")


def test_a_file_that_is_wrong_is_refused_with_its_line(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text('name = "a"\ntitle = "b"\n[motor]\nslider_mass = "1 V"\n', encoding="utf-8")
    with pytest.raises(ConfigError, match="line 4"):
        analyze_actuator(file)
