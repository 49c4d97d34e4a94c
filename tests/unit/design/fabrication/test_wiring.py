"""Electrodes are joined as the description drives them."""

from __future__ import annotations

import dataclasses

import pytest

import squeezefilm as sf
from squeezefilm.design.fabrication.wiring import electrodes_of, leads_of, wiring_said
from squeezefilm.physics.plate.layout import DiscPlate, RectangularPlate
from squeezefilm.physics.plate.parts import Sector


def plate() -> RectangularPlate:
    found = sf.load_display("biet2008-plate").actuator
    assert isinstance(found, RectangularPlate)
    return found


def test_polarity_is_the_group() -> None:
    found = electrodes_of(plate())
    assert "".join(one.connection for one in found) == "ABABABA"
    leads = {one.name: one.electrodes for one in leads_of(found)}
    assert leads["A"] == ("E1", "E3", "E5", "E7")
    assert leads["B"] == ("E2", "E4", "E6")
    assert len(leads["bonded sides"]) == 7
    assert any("its sign reversed" in one for one in wiring_said(found))


def test_electrodes_that_are_not_driven_have_their_own_way() -> None:
    whole = plate()
    changes = ({"electrode": "shorted"}, {"electrode": "open"},
               {"electrode": "shunted", "shunt_resistance": 1e3}, {"poling": -1})  # fmt: skip
    patches = [
        dataclasses.replace(one, **change)
        for one, change in zip(whole.patches[:4], changes, strict=True)
    ]
    found = electrodes_of(dataclasses.replace(whole, patches=(*patches, *whole.patches[4:])))
    assert [one.connection for one in found[:4]] == ["ground", "open", "shunt 1", "B"]
    assert found[3].poling == -1
    ends = {one.name: one.to for one in leads_of(found)}
    assert "open" not in ends
    assert ends["shunt 1"] == "ground through 1000 ohm"
    assert "Open electrodes are joined to nothing." in wiring_said(found)


def test_sectors_of_a_ring_go_round_and_are_poled_in_turn() -> None:
    disc = sf.load_display("winfield2007-tpad").actuator
    assert isinstance(disc, DiscPlate)
    whole = electrodes_of(disc)
    assert len(whole) == 1
    ring = dataclasses.replace(disc, nodal_circles=0, nodal_diameters=3, sectors=6)
    found = electrodes_of(ring)
    assert [one.poling for one in found] == [1, -1, 1, -1, 1, -1]
    shapes = [one.footprint for one in found]
    assert all(isinstance(one, Sector) for one in shapes)
    assert sum(one.area for one in shapes) == pytest.approx(whole[0].footprint.area)
    assert any("poled in turn" in one for one in wiring_said(found))
