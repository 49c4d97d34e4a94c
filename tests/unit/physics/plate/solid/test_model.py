"""A plate in one class of symmetry: fields on the other half are mirror images."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.linalg import eigh

from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.plate.elements.lobatto import line_matrices
from squeezefilm.physics.plate.layout import CeramicPatch, RectangularPlate
from squeezefilm.physics.plate.solid.layers import COARSE
from squeezefilm.physics.plate.solid.mesh import plate_model
from squeezefilm.physics.plate.solid.refined_modes import with_coarse_modes
from squeezefilm.physics.plate.solid.resonances import screened_modes
from squeezefilm.physics.plate.solid.response import harmonic_response
from squeezefilm.physics.plate.solid.solve import ModesRequest, solve_modes, solved_classes
from squeezefilm.physics.plate.solid.symmetry import Parity, PlateModel

GLASS = ElasticMaterial("glass", 72e9, 0.22, 2480)
CERAMIC = Piezoceramic("P1-91", 67.9e9, 0.2897, 23e9, 7700, -247e-12, 1900, 60)
PLATE = RectangularPlate(
    24e-3, 14e-3, 1.2e-3, 3, 60, GLASS, CERAMIC, (CeramicPatch(2e-3, 0, 20e-3, 14e-3, 0.5e-3),),
)  # fmt: skip
PARTLY_COVERED = dataclasses.replace(PLATE, patches=(CeramicPatch(2e-3, 0, 5e-3, 14e-3, 0.5e-3),))


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


@pytest.mark.parametrize(
    "ask",
    [
        lambda: solve_modes(PLATE, near=7e6),
        lambda: solve_modes(PLATE, band=(6.9e6, 7e6)),
        lambda: harmonic_response(PLATE, np.array([6.9e6, 7e6])),
        lambda: screened_modes(PLATE, (15e3, 7e6)),
        lambda: solve_modes(PLATE, mode=(400, 0)),
        # With ceramics on a part of its face only, the beam of pieces guesses.
        lambda: solve_modes(PARTLY_COVERED, mode=(0, 400)),
    ],
)
def test_a_frequency_of_waves_across_the_thickness_is_refused(
    ask: Callable[[], object], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "squeezefilm.physics.plate.solid.mesh._in_plane", None
    )  # Nothing is meshed.
    # Half a wave of shear across 1.2 mm of this glass: 1.44 MHz.
    most = math.sqrt(GLASS.shear_modulus / GLASS.density) / (2 * 1.2e-3)
    assert most == pytest.approx(1.44e6, rel=2e-3)
    with pytest.raises(OutOfRangeError, match=r"across the plate.* 1\.4\d+ MHz at most"):
        ask()


def test_one_element_across_resolves_half_a_wave_and_not_two() -> None:
    mass, _, stiffness = line_matrices(1.0, COARSE.order_z)
    waves = np.sqrt(np.maximum(eigh(stiffness, mass, eigvals_only=True), 0.0)) / np.pi
    assert waves[1] == pytest.approx(1, rel=1e-3)
    assert waves[2] > 2.4


@pytest.mark.slow
def test_a_response_that_knows_the_modes_about_it_is_that_of_a_long_space() -> None:
    modes, (piece,) = solved_classes(
        ModesRequest(PLATE, mode=(2, 0), tolerance=3e-3), keep_factors=True
    )
    known = with_coarse_modes(piece)
    assert known.shape[1] == piece.found.values.size
    gram = known.T @ piece.solved.slabs.mass_times(known)
    assert gram == pytest.approx(np.eye(known.shape[1]), abs=1e-9)
    f = float(modes.frequencies[0]) * np.linspace(0.9, 1.1, 41)
    short = harmonic_response(PLATE, f, solved=[piece])
    long = harmonic_response(PLATE, f, steps=60)
    error = np.max(np.abs(short.admittance - long.admittance)) / np.max(np.abs(long.admittance))
    assert error < 1e-4
    around = 0.5 * f[0], 4 * f[-1]
    found = {mode.frequency: mode.name for mode in short.settled_modes(around)}
    settled = {mode.frequency: mode.name for mode in long.settled_modes(around)}
    assert "(2,0)" in found.values()
    assert len(found) >= 2
    for frequency, name in found.items():
        nearest = min(settled, key=lambda other: abs(other - frequency))
        assert nearest == pytest.approx(frequency, rel=1e-3)
        assert settled[nearest] == name
