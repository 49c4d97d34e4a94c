"""Presets, materials and values as the command line prints them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from squeezefilm.cli import described
from squeezefilm.core import presets
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.presets import display_names, materials, names
from squeezefilm.design.analysis.analysis import Analysis
from squeezefilm.design.analysis.report.rows import display_values


def test_presets_are_listed_with_what_is_assumed(printed: Callable[[], str]) -> None:
    listing = described.preset_list()
    by_name = {item["name"]: item for item in listing}
    assert {"biet2008-plate", "biet2008-stator", "touchpad-glass"} <= set(by_name)
    assert by_name["biet2008-plate"]["values_assumed"] == 15
    assert {one["name"] for one in listing} == {*display_names(), *names("actuator")}
    assert by_name["biet2008-motor"]["taken_by"] != by_name["biet2008-plate"]["taken_by"]
    described.show_presets(listing)
    text = printed()
    for name in by_name:
        assert name in text
    assert "15 of 70" in text


@pytest.mark.parametrize("resolve", [presets.resolve, presets.path])
def test_an_unknown_name_is_answered_with_all_that_there_is(
    resolve: Callable[[str], object],
) -> None:
    with pytest.raises(ConfigError) as caught:
        resolve("biet2008-moter")
    said = str(caught.value)
    assert "Did you mean 'biet2008-motor'?" in said
    for name in (*display_names(), *names("actuator")):
        assert name in said


@pytest.mark.parametrize("name", names("actuator"))
def test_the_values_of_an_actuator_are_shown_as_written(name: str) -> None:
    values = described.display_values(name)
    assert values[0] == {"path": "name", "text": name, "source": None, "evidence": None}
    sourced = [one["evidence"] for one in values if one["evidence"] is not None]
    (entry,) = (one for one in described.preset_list() if one["name"] == name)
    assert (sourced.count("assumed"), len(sourced)) == (
        entry["values_assumed"], entry["values_with_source"]
    )  # fmt: skip


def test_values_are_shown_as_written(
    printed: Callable[[], str], monkeypatch: pytest.MonkeyPatch
) -> None:
    values = described.display_values("biet2008-plate")
    by_path = {item["path"]: item for item in values}
    assert by_path["actuator.thickness"] == {
        "path": "actuator.thickness",
        "text": "2 mm",
        "source": "paper, section 3.1",
        "evidence": "published",
    }
    assert by_path["actuator.substrate.poisson_ratio"]["text"] == "0.30"
    assert by_path["actuator.substrate.poisson_ratio"]["evidence"] == "assumed"
    assert by_path["actuator.patches.7.polarity"]["text"] == "1"
    assert by_path["name"]["evidence"] is None
    described.show_values(values)
    text = printed()
    assert "* poisson_ratio" in text
    assert "* assumed: 15 of 67 values" in text
    assert "? " not in text
    # Where there are colours, what is assumed stands out.
    styles: list[Any] = []
    monkeypatch.setattr(described, "table", lambda *_, **how: styles.append(how["styles"]))
    described.show_values(values)
    assert [one(("* a", "b", "")) for one in styles[:2]] == ["yellow"] * 2
    assert [one(("  a", "* b", "")) for one in styles[:2]] == [""] * 2


def test_values_of_what_cannot_be_loaded_are_refused() -> None:
    with pytest.raises(ConfigError, match="Did you mean"):
        described.display_values("biet2008-plat")


def test_paths_of_the_report_are_those_of_the_listing(plate_analysis: Analysis) -> None:
    written = {item["path"] for item in described.display_values("biet2008-plate")}
    assert written <= {value.path for value in display_values(plate_analysis.display)}


def test_what_was_changed_in_a_copy_is_shown_without_its_source(
    printed: Callable[[], str], tmp_path: Any
) -> None:
    from squeezefilm.physics.display import new_display_file

    file = tmp_path / "mine.toml"
    new_display_file(file, "biet2008-plate")
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace('"49 mm"', '"48 mm"', 1).replace('width = "49', 'width = "48'))
    described.show_values(described.display_values(str(file)))
    words = " ".join(printed().split())
    assert "? width 48 mm unstated: changed from 49 mm (paper, section 3.1.2)" in words
    assert "? without a source: 8 of 67 values" in words


def test_materials_are_listed_and_one_is_shown_with_its_sources(
    printed: Callable[[], str],
) -> None:
    listing = described.material_list()
    assert [one["name"] for one in listing] == [one.name for one in materials.materials()]
    described.show_materials(listing)
    text = printed()
    assert all(one["name"] in text for one in listing)
    described.show_materials(described.material_list("pzt 5h"))
    words = " ".join(printed().split())
    assert "PZT-5H: very soft" in words
    assert "constants.compliance_11 16.5e-12 m²/N" in words
    with pytest.raises(InputError, match="Did you mean 'PZT-5"):
        described.material_list("PZT-5B")
