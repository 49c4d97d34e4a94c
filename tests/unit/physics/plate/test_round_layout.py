"""Discs and stators: what is described and what is refused, at the limits themselves."""

from __future__ import annotations

import math
from typing import Any

import pytest

from squeezefilm.core.errors import GeometryError, InputError
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.plate.round_layout import AnnularStator, DiscPlate, GlueLayer

GLASS = ElasticMaterial("glass", 72e9, 0.22, 2480)
CERAMIC = Piezoceramic("P1-91", 67.9e9, 0.2897, 23e9, 7700, -247e-12, 1900, 60)
# Nine waves of 2 cm.
NINE = 9 * 20e-3 / math.pi


def stator(**changes: Any) -> AnnularStator:
    parts: dict[str, Any] = {
        "mean_diameter": NINE, "radial_width": 5e-3, "wavelength": 20e-3,
        "resonance_frequency": 40e3, "quality_factor": 200.0, "reference_amplitude": 1e-6,
        "reference_voltage": 10.0,
    }  # fmt: skip
    return AnnularStator(**{**parts, **changes})


def disc(**changes: Any) -> DiscPlate:
    parts: dict[str, Any] = {
        "diameter": 30e-3, "thickness": 1.5e-3, "quality_factor": 80.0, "substrate": GLASS,
        "ceramic": CERAMIC, "ceramic_outer_diameter": 20e-3, "ceramic_thickness": 1e-3,
    }  # fmt: skip
    return DiscPlate(**{**parts, **changes})


def test_glue_is_a_plausible_layer() -> None:
    glue = GlueLayer(50e-6, 2e9)
    assert (glue.poisson_ratio, glue.density, glue.quality_factor) == (0.38, 1150.0, 20.0)
    assert GlueLayer(50e-6, 2e9, 0.499).poisson_ratio == 0.499
    assert GlueLayer(50e-6, 2e9, -0.999).poisson_ratio == -0.999
    for name, value in (
        ("thickness", 0.0), ("young_modulus", 0.0), ("poisson_ratio", 0.5),
        ("poisson_ratio", -1.0), ("density", 0.0), ("quality_factor", 0.4),
    ):  # fmt: skip
        parts: dict[str, Any] = {"thickness": 50e-6, "young_modulus": 2e9, name: value}
        with pytest.raises(InputError, match=name):
            GlueLayer(**parts)


def test_a_stator_holds_a_whole_number_of_waves() -> None:
    assert stator().wavelengths_around == pytest.approx(9.0)
    assert stator().type == "annular_stator"
    for waves, fits in ((9.049, True), (8.951, True), (9.051, False), (8.949, False)):
        if fits:
            assert stator(mean_diameter=NINE * waves / 9).wavelengths_around == pytest.approx(waves)
            continue
        with pytest.raises(GeometryError, match=rf"^{waves:.2f} wavelengths of 20 mm fit on"):
            stator(mean_diameter=NINE * waves / 9)
    assert stator(mean_diameter=NINE / 9, radial_width=1e-3).wavelengths_around == pytest.approx(1)
    with pytest.raises(GeometryError, match=r"^0\.04 wavelengths"):
        stator(mean_diameter=20e-3 * 0.04 / math.pi, radial_width=1e-5)


def test_a_stator_has_a_hole_and_teeth_or_none() -> None:
    with pytest.raises(InputError, match="which is mean_diameter"):
        stator(radial_width=NINE)
    assert stator(radial_width=0.999 * NINE).tooth_pitch is None
    assert stator(tooth_pitch=2e-3, slot_width=0.5e-3).slot_width == 0.5e-3
    for half in ({"tooth_pitch": 2e-3}, {"slot_width": 0.5e-3}):
        with pytest.raises(GeometryError, match="belong together"):
            stator(**half)
    for name, parts in (
        ("slot_width", {"tooth_pitch": 2e-3, "slot_width": 2e-3}),
        ("slot_width", {"tooth_pitch": 2e-3, "slot_width": 0.0}),
        ("tooth_pitch", {"tooth_pitch": 0.0, "slot_width": 1e-3}),
    ):
        with pytest.raises(InputError, match=name):
            stator(**parts)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("mean_diameter", 0.0),
        ("radial_width", 0.0),
        ("wavelength", 0.0),
        ("reference_amplitude", 0.0),
        ("reference_amplitude", 2e-3),
        ("reference_voltage", 0.0),
        ("resonance_frequency", 0.0),
        ("quality_factor", 0.4),
    ],
)
def test_a_stator_s_numbers_are_above_zero(name: str, value: float) -> None:
    with pytest.raises(InputError, match=name):
        stator(**{name: value})


def test_a_disc_has_the_lines_of_its_mode() -> None:
    plain = disc()
    assert (plain.nodal_circles, plain.nodal_diameters, plain.nodal_lines) == (1, 0, 1)
    assert (plain.inner_diameter, plain.ceramic_inner_diameter, plain.type) == (0.0, 0.0, "disc")
    assert (plain.sectors, plain.glue) == (0, None)
    assert disc(nodal_circles=2, nodal_diameters=3, sectors=6).nodal_lines == 5


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("diameter", 0.0),
        ("thickness", 0.0),
        ("ceramic_outer_diameter", 0.0),
        ("ceramic_thickness", 0.0),
        ("quality_factor", 0.4),
        ("nodal_circles", -1),
        ("nodal_diameters", -1),
        ("inner_diameter", -1e-3),
        ("inner_diameter", 30e-3),
        ("ceramic_inner_diameter", -1e-3),
        ("ceramic_inner_diameter", 20e-3),
    ],
)
def test_a_disc_s_numbers_are_in_range(name: str, value: float) -> None:
    with pytest.raises(InputError, match=name):
        disc(**{name: value})


def test_a_ceramic_may_end_with_the_disc_and_begin_with_its_hole() -> None:
    whole = disc(ceramic_outer_diameter=30e-3, inner_diameter=5e-3, ceramic_inner_diameter=5e-3)
    assert whole.ceramic_inner_diameter == whole.inner_diameter
    # A nanometre is rounding.
    assert disc(ceramic_outer_diameter=30e-3 + 0.9e-9).nodal_lines == 1
    assert disc(inner_diameter=5e-3, ceramic_inner_diameter=5e-3 - 0.9e-9).nodal_lines == 1
    with pytest.raises(GeometryError, match="overhangs the disc of 30 mm") as outside:
        disc(ceramic_outer_diameter=30e-3 + 1.1e-9)
    assert outside.value.quantity == "ceramic_outer_diameter"
    with pytest.raises(GeometryError, match="overhangs the hole of 5 mm") as inside:
        disc(inner_diameter=5e-3, ceramic_inner_diameter=5e-3 - 1.1e-9)
    assert inside.value.quantity == "ceramic_inner_diameter"


def test_sectors_are_half_waves_of_a_mode_that_has_diameters() -> None:
    for sectors in (1, 2, 4):
        assert disc(nodal_diameters=2, sectors=sectors).sectors == sectors
    for sectors in (0, 5, -1):
        with pytest.raises(InputError, match="from 1 to 4 sectors of half a wave") as refused:
            disc(nodal_diameters=2, sectors=sectors)
        assert refused.value.quantity == "sectors"
    with pytest.raises(InputError, match="sectors = 1 drive no mode") as refused:
        disc(sectors=1)
    assert refused.value.quantity == "sectors"


def test_a_disc_that_does_not_bend_has_no_mode() -> None:
    assert disc(nodal_circles=0, nodal_diameters=2, sectors=1).nodal_lines == 2
    for diameters, sectors in ((0, 0), (1, 1)):
        with pytest.raises(InputError, match=rf"B\(0,{diameters}\)") as refused:
            disc(nodal_circles=0, nodal_diameters=diameters, sectors=sectors)
        assert refused.value.quantity == "nodal_circles"
