"""A plate in one class of symmetry: fields on the other half are mirror images."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.materials import ElasticMaterial, Piezoceramic
from squeezefilm.plate.layout import CeramicPatch, RectangularPlate
from squeezefilm.plate.solid.layers import COARSE
from squeezefilm.plate.solid.mesh import plate_model
from squeezefilm.plate.solid.model import PlateModel
from squeezefilm.plate.solid.symmetry import Parity

GLASS = ElasticMaterial("glass", 72e9, 0.22, 2480)
CERAMIC = Piezoceramic("P1-91", 67.9e9, 0.2897, 23e9, 7700, -247e-12, 1900, 60)
PLATE = RectangularPlate(
    24e-3, 14e-3, 1.2e-3, 3, 60, GLASS, CERAMIC, (CeramicPatch(2e-3, 0, 20e-3, 14e-3, 0.5e-3),),
)  # fmt: skip


@pytest.mark.parametrize(("along", "sign"), [("S", 1.0), ("A", -1.0)])
def test_the_other_half_is_the_mirror_image(along: Parity, sign: float) -> None:
    one: PlateModel = plate_model(PLATE, 15e3, COARSE, (along, "S"))
    vector = np.random.default_rng(4).standard_normal((one.slabs.unknowns, 1))
    vector[one.slabs.held] = 0
    x, y = np.array([3e-3, 21e-3]), np.array([2e-3])
    near, far = one.field(vector, x, y, 1e-3)[0, :, 0]
    # w and v of an even shape are even along x, u is odd.
    assert far == pytest.approx(sign * near * [-1, 1, 1], rel=1e-9)
    *_, signs = one.evaluation(x, y, np.array([1e-3]))
    assert signs[:, 0] == pytest.approx(np.array([[1, 1, 1], sign * np.array([-1, 1, 1])]))
