"""The tensor-product elements against scikit-fem's on identical meshes, to eight digits."""

import numpy as np
import pytest

from squeezefilm.physics.plate.elements.box_model import BoxModel, Medium, ModelElectrode
from squeezefilm.physics.plate.elements.lobatto import LineMesh
from squeezefilm.physics.plate.elements.slab_modes import SlabFactor, modes_near
from squeezefilm.physics.plate.elements.slabs import Slabs

from .test_solid_elements import STEEL, monomorph_on_a_uniform_mesh, pzt_5a

pytest.importorskip("skfem", reason="scikit-fem is a test extra; install squeezefilm[test]")


def two_ceramics() -> BoxModel:
    x = LineMesh((0.0, 3e-3, 8e-3, 9e-3, 14e-3, 15.5e-3), (2,) * 5)
    y = LineMesh((0.0, 2e-3, 7e-3), (2, 2))
    z = LineMesh((-0.8e-3, 0.0, 1e-3), (2, 2))
    medium, ceramic = np.zeros((5, 2, 2), dtype=int), np.full((5, 2, 2), -1)
    medium[:, :, 0] = -1
    for number, column in enumerate((1, 3)):
        medium[column, :, 0], ceramic[column, :, 0] = 1, number
    piezo = pzt_5a()
    flipped = Medium("below", piezo.stiffness, piezo.density, 0, -np.array(piezo.stress_matrix),
                     piezo.permittivity)  # fmt: skip
    return BoxModel(x, y, z, (STEEL, flipped), medium, ceramic, (ModelElectrode(0, 2),) * 2)


@pytest.mark.slow
def test_identical_meshes_give_identical_frequencies() -> None:
    from .skfem_plate import skfem_frequencies

    model, guess = two_ceramics(), 60e3
    wanted = skfem_frequencies(model, guess, 4)
    slabs = Slabs(model)
    shift = (2 * np.pi * guess) ** 2
    start = np.random.default_rng(0).standard_normal((slabs.unknowns, 4))
    start[slabs.components == 3] = 0
    pairs = modes_near(
        slabs, SlabFactor(slabs, shift).solve, shift,
        lambda v: np.sort(np.argsort(np.abs(v - shift))[:4]), start, tolerance=1e-13,
    )  # fmt: skip
    found = np.sqrt(pairs.values) / (2 * np.pi)
    assert found == pytest.approx(wanted, rel=1e-8)


@pytest.mark.nightly
def test_the_paper_s_plate_on_a_quadratic_mesh() -> None:
    from .skfem_plate import skfem_frequencies

    found = skfem_frequencies(monomorph_on_a_uniform_mesh(2, 8), 34650.0, 2)
    assert np.min(np.abs(found - 34640.12)) < 0.05
