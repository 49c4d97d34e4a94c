"""Requirements of a page: read with the lab's files only, refused with the line, said in words."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from squeezefilm.core import config
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.design.search.candidate import display_of
from squeezefilm.design.search.criteria import criterion_of
from squeezefilm.design.search.report.page import plate_file
from squeezefilm.lab.designing.form import preset_text
from squeezefilm.lab.designing.numbers import opened
from squeezefilm.lab.search_process import (
    asked_of,
    display_text,
    folder_of,
    requirements_of,
)
from squeezefilm.physics.display import Display, load_display

from .small import TEXT, evaluated, requirements

MINE = TEXT.replace('start_from = "biet2008-plate"', 'start_from = "mine"')


def test_what_is_asked_for_is_said_before_anything_is_computed(tmp_path: Path) -> None:
    found = asked_of(TEXT, tmp_path)
    raw = tomllib.loads(TEXT)
    assert (found["name"], found["title"]) == (raw["name"], raw["title"])
    assert found["objectives"] == [
        {"key": "relative_friction", "said": "µ′/µ at the best place", "unit": ""},
        {"key": "finest_period", "said": "finest grating felt", "unit": "m"},
    ]
    assert "temperature rise at most 75 K" in found["limits"]
    assert "squeeze number at least 10" in found["limits"]
    assert found["shapes"][0]["name"] == "strips on one face"
    assert "nodal lines" in found["shapes"][0]["chosen"]
    # What has one value only is not chosen.
    assert "voltage" not in found["shapes"][0]["chosen"]
    assert (found["start_from"], found["compare_with"]) == ("biet2008-plate", "biet2008-plate")
    assert len(found["assumed"]) >= 3
    assert criterion_of("thickness").key == "total_thickness"


@pytest.mark.parametrize(
    ("old", "new", "line", "says"),
    [
        ('length = "73 mm"', 'length = "73"', 11, "has no unit"),
        ('voltage = "15 V"', 'voltage = "-15 V"', 21, "voltage"),
        ("[limits]", "[limits", 23, "limits"),
        ("least_lines = 5", "least_line = 5", 34, "least_line"),
        ('material = "aluminium 7075"', 'material = "adamant"', None, "adamant"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(
    tmp_path: Path, old: str, new: str, line: int | None, says: str
) -> None:
    with pytest.raises(ConfigError, match=says) as refused:
        asked_of(TEXT.replace(old, new), tmp_path)
    if line is not None:
        assert f"line {line}" in str(refused.value)


def test_a_display_of_the_lab_is_found_and_its_lines_stay(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"there is no file mine\.toml in the lab's folder"):
        asked_of(MINE, tmp_path)
    thicker = preset_text("biet2008-plate").replace('"biet2008-plate"', '"mine"', 1)
    (tmp_path / "mine.toml").write_text(thicker, encoding="utf-8")
    for text in (MINE, MINE.replace('"mine"', '"mine.toml"')):
        found = requirements_of(text, tmp_path)
        assert found.base.name == load_display(tmp_path / "mine.toml").name == "mine"
        assert asked_of(text, tmp_path)["start_from"] == "mine"
    with pytest.raises(ConfigError, match="line 11"):
        requirements_of(MINE.replace('length = "73 mm"', 'length = "73"'), tmp_path)


@pytest.mark.parametrize("name", ["/etc/passwd", "../mine", "a/b", ".hidden", "x" * 300, "a\\b"])
@pytest.mark.parametrize("key", ["start_from", "compare_with"])
def test_no_file_outside_the_folder_is_read(tmp_path: Path, key: str, name: str) -> None:
    (tmp_path / "lab").mkdir()
    (tmp_path / "mine.toml").write_text(preset_text("biet2008-plate"), encoding="utf-8")
    text = TEXT.replace(f'{key} = "biet2008-plate"', f"{key} = '{name}'")
    assert text != TEXT
    with pytest.raises(InputError, match="no name for a file"):
        asked_of(text, tmp_path / "lab")


def test_a_link_out_of_the_folder_is_not_followed(tmp_path: Path) -> None:
    outside = tmp_path / "outside.toml"
    outside.write_text(preset_text("biet2008-plate"), encoding="utf-8")
    (tmp_path / "lab").mkdir()
    (tmp_path / "lab" / "mine.toml").symlink_to(outside)
    with pytest.raises(InputError, match="a link"):
        asked_of(MINE, tmp_path / "lab")


@pytest.mark.parametrize(
    "text", ["", "a = [" * 3000, "x = 1\n" * 60_000, "\x00", "a = 1" + "0" * 5000]
)
def test_what_is_no_toml_is_refused_in_words(tmp_path: Path, text: str) -> None:
    with pytest.raises(ConfigError):
        asked_of(text, tmp_path)


def test_a_plate_that_was_found_is_a_display_that_design_opens(tmp_path: Path) -> None:
    asked = requirements()
    design = evaluated(asked, 0.4).design
    text = display_text(TEXT, tmp_path, design.shape, design.settings)
    assert text == plate_file(asked, design)
    assert config.load_text(Display, text) == display_of(asked, design)
    assert opened(text)["name"] == f"biet2008-plate-{design.address}"
    with pytest.raises(ConfigError, match="no shape 2"):
        display_text(TEXT, tmp_path, 1, design.settings)


def test_the_same_text_has_the_same_folder_and_any_other_another() -> None:
    assert folder_of("biet2008-plate", TEXT) == folder_of("biet2008-plate", TEXT)
    assert folder_of("biet2008-plate", TEXT + " ") != folder_of("biet2008-plate", TEXT)
    assert folder_of("../../Ä b", "").startswith("b-")
    assert folder_of("…", "").startswith("search-")
    assert len(folder_of("x" * 500, "")) <= 64
