"""Solids of rings: their losses, and layers of teeth between their two bounds."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import ElasticMaterial
from squeezefilm.physics.plate.elements.box_model import isotropic_solid
from squeezefilm.physics.plate.ring.section import soft_teeth, stiff_teeth

STEEL = isotropic_solid(ElasticMaterial("steel", 200e9, 0.3, 7800.0))
PLAIN = STEEL.stiffness


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
