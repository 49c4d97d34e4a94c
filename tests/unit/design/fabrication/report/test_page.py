"""The folder of a fabrication: every file is there, says the same, and reads back."""

from __future__ import annotations

import csv
import dataclasses
import io
import json
import math
from collections.abc import Callable
from pathlib import Path

import meshio
import numpy as np
import pytest
from ezdxf.filemanagement import readfile

import squeezefilm as sf
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import config_hash, stamp
from squeezefilm.design.fabrication.fabricate import Fabrication
from squeezefilm.design.fabrication.report.page import (
    PREDICTION,
    display_toml,
    show_fabrication,
    write_fabrication,
)
from squeezefilm.design.fabrication.report.rows import expected_rows, plan_csv, said
from squeezefilm.measure.calibration.blind import BlindPrediction, Predicted
from squeezefilm.physics.plate.layout import RectangularPlate

Preset = Callable[[str], Fabrication]


@pytest.fixture(scope="module")
def folder(preset: Preset, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_fabrication(preset("touchpad-glass"), tmp_path_factory.mktemp("made")).parent


def table_of(file: Path) -> list[dict[str, str]]:
    """The rows of a CSV by their columns."""
    return list(csv.DictReader(io.StringIO(file.read_text(encoding="utf-8"))))


def test_everything_is_there(folder: Path) -> None:
    names = {one.name for one in folder.iterdir()}
    assert names == {
        "index.html", "drawing.dxf", "drawing.svg", "drawing.pdf", "assembly.stl", "assembly.step",
        "substrate.stl",
        "ceramics.stl", "glue.stl", "bill-of-materials.csv", "electrodes.csv", "test-plan.csv",
        "display.toml", "display.json", "fabrication.json",
    }  # fmt: skip
    assert not readfile(folder / "drawing.dxf").audit().errors
    page = (folder / "index.html").read_text(encoding="utf-8")
    for heading in ("What to expect", "Drawing", "Bill of materials", "Drive electronics",
                    "2. Impedance sweep", "Friction bench", "What is assumed"):  # fmt: skip
        assert heading in page
    assert all(f'href="{name}"' in page for name in names - {"index.html"})
    svg = (folder / "drawing.svg").read_text(encoding="utf-8")
    assert "var(--" not in svg
    assert svg.count("<svg ") == 1


@pytest.mark.parametrize("name", sf.display_names())
def test_the_display_reads_back_as_the_same_description(
    preset: Preset, name: str, tmp_path: Path
) -> None:
    made = preset(name)
    file = tmp_path / "display.toml"
    file.write_text(display_toml(made), encoding="utf-8")
    again = sf.load_display(file)
    assert again == made.display
    assert config_hash(again) == config_hash(made.display)


def test_the_bodies_fill_the_volumes_of_the_description(folder: Path, preset: Preset) -> None:
    plate = preset("touchpad-glass").display.actuator
    assert isinstance(plate, RectangularPlate)
    volumes = {
        "substrate": plate.area * plate.thickness,
        "ceramics": 2 * 100e-3 * 5e-3 * 0.5e-3,
        "glue": 2 * 100e-3 * 5e-3 * 20e-6,
    }
    for name, wanted in {**volumes, "assembly": math.fsum(volumes.values())}.items():
        found = meshio.read(folder / f"{name}.stl")
        a, b, c = (found.points[found.cells_dict["triangle"][:, k]] for k in range(3))
        volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
        assert 1e-9 * volume == pytest.approx(wanted, rel=1e-4), name


def test_tables_say_what_the_page_says(folder: Path, preset: Preset) -> None:
    made = preset("touchpad-glass")
    bill = table_of(folder / "bill-of-materials.csv")
    counted = math.fsum(float(row["mass_kg"]) for row in bill if row["in_mass"] == "yes")
    assert counted == pytest.approx(made.mass)
    electrodes = [list(row.values()) for row in table_of(folder / "electrodes.csv")]
    assert electrodes == [
        ["1", "0", "0", "100", "5", "0.5", "A", "away"],
        ["2", "0", "55", "100", "5", "0.5", "B", "away"],
    ]
    data = json.loads((folder / "fabrication.json").read_text(encoding="utf-8"))
    assert data["mass_kg"] == pytest.approx(made.mass)
    assert data["provenance"]["config_sha256"] == stamp(made.display)["config_sha256"]


def test_the_plan_has_a_place_for_what_is_measured(folder: Path) -> None:
    rows = table_of(folder / "test-plan.csv")
    assert {row["measured (SI)"] for row in rows} == {""}
    # Every recording has a kind that is known, and is named as its fit expects.
    kinds = {row["file"]: row["kind of recording"] for row in rows if row["file"]}
    assert kinds["frequency-response.csv"] == "frequency response"
    resonance = next(row for row in rows if row["answer"] == "resonance_frequency")
    assert float(resonance["as described (SI)"]) > 2e4
    assert resonance["unit"] == "Hz"


@pytest.mark.usefixtures("undrawn")
def test_intervals_are_shown_and_sealed_once(preset: Preset, tmp_path: Path) -> None:
    made = preset("biet2008-plate")
    low_high = Predicted("mass", {}, 0.0962, (0.093, 0.099), 0.001)
    blind = BlindPrediction("biet2008-plate", "by hand", (low_high,), stamp(made.display, 1), "")
    with_one = dataclasses.replace(made, blind=blind, no_intervals="")
    assert expected_rows(with_one)[0][:3] == ("Mass", "96.16 g", "93 g to 99 g (90 %)")
    row = next(csv.DictReader(io.StringIO(plan_csv(with_one))))
    assert (row["low (SI)"], row["high (SI)"], row["level"]) == ("0.093", "0.099", "0.9")
    write_fabrication(with_one, tmp_path)
    first = (tmp_path / PREDICTION).read_bytes()
    with pytest.raises(InputError, match="never overwritten"):
        write_fabrication(with_one, tmp_path)
    # Once sealed it stays as it is while the rest is written again.
    kept = dataclasses.replace(with_one, blind=dataclasses.replace(blind, sha256="0" * 64))
    write_fabrication(kept, tmp_path)
    assert (tmp_path / PREDICTION).read_bytes() == first
    assert f'href="{PREDICTION}"' in (tmp_path / "index.html").read_text(encoding="utf-8")


@pytest.mark.usefixtures("undrawn")
def test_a_stator_says_what_nobody_should_cut(preset: Preset, tmp_path: Path) -> None:
    page = write_fabrication(preset("biet2008-stator"), tmp_path).read_text(encoding="utf-8")
    assert "NOT TO BE MADE BY THESE THICKNESSES" in page
    assert "flat facets" in page


def test_what_is_printed(preset: Preset, capsys: pytest.CaptureFixture[str]) -> None:
    show_fabrication(preset("biet2008-plate"))
    out = capsys.readouterr().out
    for words in ("Free amplitude at 15 V", "96.16 g", "impedance.csv", "none were asked for"):
        assert words in out
    assert said(None, "m") == "–"


@pytest.mark.usefixtures("undrawn")
def test_through_the_front_door(preset: Preset, tmp_path: Path) -> None:
    page = sf.write_report(preset("biet2008-plate"), tmp_path / "a")
    assert page.name == "index.html"
    figure = sf.plot(preset("biet2008-plate"))
    assert 25.4 * figure.get_size_inches()[0] == pytest.approx(420.0)
