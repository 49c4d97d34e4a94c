"""The bill's masses add up to the display's."""

from __future__ import annotations

import dataclasses
import math

import pytest

import squeezefilm as sf
from squeezefilm.design.fabrication.wiring import BillRow, bill_of, electrodes_of
from squeezefilm.physics.plate.layout import Actuator, RectangularPlate
from squeezefilm.physics.plate.parts import assembly_mass, parts_of


def bill(actuator: Actuator) -> tuple[BillRow, ...]:
    parts = parts_of(actuator)
    return bill_of(actuator, parts, electrodes_of(actuator, parts))


@pytest.mark.parametrize("name", sf.display_names())
def test_masses_add_up(name: str) -> None:
    actuator = sf.load_display(name).actuator
    rows = bill(actuator)
    counted = math.fsum(one.mass or 0.0 for one in rows if one.in_mass)
    assert counted == pytest.approx(assembly_mass(actuator), rel=1e-12)
    assert all(one.mass is not None for one in rows if one.in_mass)
    assert all(one.mass is None for one in rows if not one.in_mass)


def test_ceramics_of_one_size_are_one_row() -> None:
    plate = sf.load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    ceramics = [one for one in bill(plate) if one.what == "Ceramic"]
    assert [(one.count, one.size) for one in ceramics] == [(7, "11 × 49 × 1 mm")]
    thin = dataclasses.replace(plate.patches[0], thickness=0.5e-3)
    mixed = dataclasses.replace(plate, patches=(thin, *plate.patches[1:]))
    ceramics = [one for one in bill(mixed) if one.what == "Ceramic"]
    assert [(one.count, one.size) for one in ceramics] == [
        (1, "11 × 49 × 0.5 mm"),
        (6, "11 × 49 × 1 mm"),
    ]


def test_foam_glue_and_resistors_are_on_it() -> None:
    plate = sf.load_display("touchpad-glass").actuator
    assert isinstance(plate, RectangularPlate)
    rows = {(one.what, one.size): one for one in bill(plate)}
    assert rows["Support", "100 × 1 × 0.5 mm"].count == 2
    assert rows["Support", "1 × 58 × 0.5 mm"].count == 2
    (glue,) = (one for one in rows.values() if one.what == "Glue")
    assert glue.size == "1000 mm² × 0.02 mm"
    shunted = dataclasses.replace(plate.patches[1], electrode="shunted", shunt_resistance=470.0)
    with_one = dataclasses.replace(plate, patches=(plate.patches[0], shunted))
    assert [one.size for one in bill(with_one) if one.what == "Shunt resistor"] == ["470 ohm"]


def test_what_holds_an_edge_is_on_it() -> None:
    plate = sf.load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    held = dataclasses.replace(plate, clamped_edges=("left", "right"))
    clamps = [one for one in bill(held) if one.what == "Clamp"]
    assert [one.remark.split()[2] for one in clamps] == ["left", "right"]
    assert not any(one.what == "Clamp" for one in bill(plate))
