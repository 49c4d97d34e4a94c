"""Solids of rings: what is refused, and layers of teeth between their two bounds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import ElasticMaterial
from squeezefilm.physics.plate.elements.box_model import Medium, isotropic_solid
from squeezefilm.physics.plate.ring.section import RingLayer, soft_teeth, stiff_teeth

STEEL = isotropic_solid(ElasticMaterial("steel", 200e9, 0.3, 7800.0))
PLAIN = STEEL.stiffness
# Rows r, θ, z; strains rr, θθ, zz, θz, rz, rθ.
POLED = np.array([[0, 0, 0, 0, 9.0, 0], [0, 0, 0, 9.0, 0, 0], [-5.0, -5.0, 12.0, 0, 0, 0]])
CLAMPED = np.diag([8e-9, 8e-9, 7e-9])


def changed(row: int, column: int, value: float, *, both: bool = True) -> np.ndarray:
    one = PLAIN.copy()
    one[row, column] = value
    if both:
        one[column, row] = value
    return one


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"stiffness": PLAIN[:5, :5]}, "symmetric 6 × 6"),
        ({"stiffness": changed(0, 1, 1e9, both=False)}, "symmetric 6 × 6"),
        ({"stiffness": changed(3, 3, -1e9)}, "not that of a stable solid"),
        ({"stiffness": changed(0, 3, 1e9)}, "couples θz or rθ"),
        ({"stiffness": changed(4, 5, 1e9)}, "couples θz or rθ"),
        ({"stress_matrix": POLED}, "give its clamped permittivity"),
        ({"stress_matrix": POLED, "permittivity": -CLAMPED}, "permittivity = "),
        ({"loss": -0.1}, "loss = "),
        ({"loss": 2.0}, "loss = "),
        ({"stress_matrix": np.roll(POLED, 1, axis=0), "permittivity": CLAMPED}, "must be poled"),
        ({"stress_matrix": np.eye(3, 6)[[1, 0, 2]], "permittivity": CLAMPED}, "must be poled"),
    ],
)
def test_a_solid_that_cannot_be_is_refused(given: dict[str, Any], says: str) -> None:
    good: dict[str, Any] = {"name": "one", "stiffness": PLAIN, "density": 7800.0}
    RingLayer(0, 1e-2, 0, 1e-3, Medium(**good, stress_matrix=POLED, permittivity=CLAMPED))
    with pytest.raises(InputError, match=says):
        RingLayer(0, 1e-2, 0, 1e-3, Medium(**{**good, **given}))


def test_losses_are_the_materials_own_unless_one_is_given() -> None:
    lossy = ElasticMaterial("steel", 200e9, 0.3, 7800.0, 500.0)
    assert STEEL.loss is None
    assert isotropic_solid(lossy).loss == pytest.approx(1 / 500)
    assert isotropic_solid(lossy, 0.01).loss == 0.01
    assert isotropic_solid(lossy, 0.0).loss == 0.0


def test_stiff_teeth_are_a_share_of_the_metal() -> None:
    layer = stiff_teeth(STEEL, 0.7)
    assert layer.stiffness == pytest.approx(0.7 * PLAIN)
    assert layer.density == pytest.approx(0.7 * 7800)
    assert layer.name == "steel teeth, stiff"


def test_soft_teeth_hand_no_hoop_stress_on() -> None:
    layer = soft_teeth(STEEL, 0.7)
    c = layer.stiffness / 0.7
    # Plane stress in r and z: E/(1 − ν²), ν of it across; shear of the metal but for rθ.
    plane = 200e9 / (1 - 0.09)
    expected = np.zeros((6, 6))
    expected[0, 0] = expected[2, 2] = plane
    expected[0, 2] = expected[2, 0] = 0.3 * plane
    expected[3, 3] = expected[4, 4] = 200e9 / 2.6
    assert c == pytest.approx(expected, rel=1e-9, abs=1.0)
    assert layer.density == pytest.approx(0.7 * 7800)
    assert layer.name == "steel teeth, soft"


@pytest.mark.parametrize("fill", [0.0, 1.01])
def test_a_share_of_teeth_is_above_none_and_at_most_all(fill: float) -> None:
    for layer in (stiff_teeth, soft_teeth):
        layer(STEEL, 1.0)
        with pytest.raises(InputError, match="fill"):
            layer(STEEL, fill)
