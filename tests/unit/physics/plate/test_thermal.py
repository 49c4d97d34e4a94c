"""What is warm of a plate, a disc and a stator: faces, heat, and what is assumed of it."""

import dataclasses
import math

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import SOLID_HEAT
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import AnnularStator, DiscPlate, RectangularPlate
from squeezefilm.physics.plate.thermal import (
    STATOR_THICKNESS,
    Thermal,
    driven_thickness,
    thermal_body,
)


def test_a_plate_has_its_faces_and_the_heat_of_metal_and_ceramics() -> None:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    body = thermal_body(plate)
    assert body.face_area == pytest.approx(83e-3 * 49e-3)
    assert body.perimeter == pytest.approx(2 * (83e-3 + 49e-3))
    metal = 83e-3 * 49e-3 * 2e-3 * 8250 * 420
    ceramic = 7 * 11e-3 * 49e-3 * 1e-3 * 7700 * 400
    assert body.heat_capacity == pytest.approx(metal + ceramic)
    assert body.assumed == ()
    assert driven_thickness(plate) == pytest.approx(1e-3)
    bare = dataclasses.replace(plate.substrate, specific_heat=None)
    unsaid = thermal_body(dataclasses.replace(plate, substrate=bare))
    assert unsaid.assumed == ("specific heat of copper-beryllium",)
    volume = 83e-3 * 49e-3 * 2e-3
    assert unsaid.heat_capacity == pytest.approx(volume * SOLID_HEAT + ceramic)


def test_a_disc_and_a_stator_have_theirs() -> None:
    disc = load_display("winfield2007-tpad").actuator
    assert isinstance(disc, DiscPlate)
    body = thermal_body(disc)
    assert body.face_area == pytest.approx(math.pi * 12.5e-3**2)
    assert body.perimeter == pytest.approx(math.pi * 25e-3)
    glass, ceramic = 1.6e-3 * 2230 * 830, 1e-3 * 7750 * 400
    assert body.heat_capacity == pytest.approx(body.face_area * (glass + ceramic))
    assert driven_thickness(disc) == pytest.approx(1e-3)
    ring = load_display("biet2008-stator").actuator
    assert isinstance(ring, AnnularStator)
    body = thermal_body(ring)
    assert body.face_area / body.perimeter == pytest.approx(ring.radial_width / 2)
    assert body.heat_capacity == pytest.approx(body.face_area * STATOR_THICKNESS * SOLID_HEAT)
    assert "4 mm thick" in body.assumed[0]
    assert driven_thickness(ring) is None


@pytest.mark.parametrize(
    "wrong",
    [
        {"thermal_resistance": -1.0},
        {"thermal_time": 0.0},
        {"emissivity": 1.1},
        {"temperature_coefficient": -0.1},
        {"rayleigh_softening": -1e-3},
        {"coercive_field": 0.0},
    ],
)
def test_what_no_plate_has_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(InputError, match=next(iter(wrong))):
        Thermal(**wrong)  # type: ignore[arg-type]


def test_a_disc_with_a_hole_is_a_ring_under_a_ring() -> None:
    disc = load_display("winfield2007-tpad").actuator
    assert isinstance(disc, DiscPlate)
    bored = dataclasses.replace(
        disc, inner_diameter=5e-3, ceramic_inner_diameter=8e-3, ceramic_outer_diameter=20e-3
    )
    body, thick = thermal_body(bored), bored.thickness
    face = math.pi * (12.5e-3**2 - 2.5e-3**2)
    assert body.face_area == pytest.approx(face)
    assert body.perimeter == pytest.approx(2 * math.pi * (12.5e-3 + 2.5e-3))
    ceramic = math.pi * (10e-3**2 - 4e-3**2) * bored.ceramic_thickness * 7750 * 400
    assert body.heat_capacity == pytest.approx(face * thick * 2230 * 830 + ceramic)
