"""The bodies of a display weigh what its description says, by other ways of adding up."""

from __future__ import annotations

import dataclasses
import math

import pytest

import squeezefilm as sf
from squeezefilm.core.errors import InputError
from squeezefilm.physics.plate.layout import AnnularStator, DiscPlate, RectangularPlate
from squeezefilm.physics.plate.parts import (
    Part,
    Rectangle,
    Sector,
    assembly_mass,
    parts_of,
    teeth_of,
)
from squeezefilm.physics.plate.ring.body import ring_body

PLATES = ("biet2008-plate", "touchpad-glass", "basdogan2020-glass")


@pytest.mark.parametrize("name", PLATES)
def test_a_plate_weighs_substrate_ceramics_and_glue(name: str) -> None:
    plate = sf.load_display(name).actuator
    assert isinstance(plate, RectangularPlate)
    covered = plate.coverage * plate.area
    glue = 0.0 if plate.glue is None else plate.glue.density * plate.glue.thickness * covered
    ceramic = plate.ceramic.density * plate.ceramic_thickness * covered
    body = plate.substrate.density * plate.area * plate.thickness
    assert assembly_mass(plate) == pytest.approx(body + ceramic + glue, rel=1e-12)


@pytest.mark.parametrize("glued", [True, False])
def test_a_disc_weighs_what_its_solved_section_does(glued: bool) -> None:
    disc = sf.load_display("winfield2007-tpad").actuator
    assert isinstance(disc, DiscPlate)
    ring = dataclasses.replace(
        disc,
        inner_diameter=4e-3,
        ceramic_inner_diameter=6e-3,
        ceramic_outer_diameter=20e-3,
        glue=disc.glue if glued else None,
    )
    for one in (disc, ring):
        assert assembly_mass(one) == pytest.approx(ring_body(one).section.mass, rel=1e-12)


@pytest.mark.slow
def test_a_stator_weighs_what_its_fitted_section_does() -> None:
    stator = sf.load_display("biet2008-stator").actuator
    assert isinstance(stator, AnnularStator)
    teeth = teeth_of(stator)
    assert len(teeth) == 72
    # The section is about nine whole waves: 1.4 µm more of a mean diameter than is described.
    assert assembly_mass(stator) == pytest.approx(ring_body(stator).section.mass, rel=3e-4)
    assert all(one.assumed for one in parts_of(stator))
    assert teeth_of(dataclasses.replace(stator, tooth_pitch=None, slot_width=None)) == ()


def test_ceramics_of_both_faces_lie_on_their_glue() -> None:
    plate = sf.load_display("touchpad-glass").actuator
    assert isinstance(plate, RectangularPlate)
    first, second = plate.patches
    both = dataclasses.replace(
        plate, supports=(), patches=(first, dataclasses.replace(second, face="top"))
    )
    at = {(one.kind, one.number): (one.bottom, one.top) for one in parts_of(both)}
    glue, thick = 20e-6, plate.thickness
    assert at["glue", 1] == pytest.approx((-glue, 0.0))
    assert at["ceramic", 1] == pytest.approx((-glue - 0.5e-3, -glue))
    assert at["glue", 2] == pytest.approx((thick, thick + glue))
    assert at["ceramic", 2] == pytest.approx((thick + glue, thick + glue + 0.5e-3))


def test_footprints_know_their_area_and_refuse_what_is_none() -> None:
    assert Rectangle(0.0, 0.0, 2e-3, 3e-3).area == pytest.approx(6e-6)
    quarter = Sector(1e-3, 2e-3, 0.0, math.pi / 2)
    assert quarter.area == pytest.approx(math.pi / 4 * 3e-6)
    assert not quarter.is_whole
    with pytest.raises(InputError):
        Sector(2e-3, 1e-3)
    with pytest.raises(InputError):
        Sector(0.0, 1e-3, 0.0, 7.0)
    with pytest.raises(InputError):
        Part("glue", 1, "glue", 1150.0, quarter, 1e-3, 0.0)
