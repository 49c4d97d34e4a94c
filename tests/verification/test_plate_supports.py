"""Foam along the rim against perturbation theory and against the driven response; plates whose
lines cross the width against the same plates turned; modes that change places between meshes."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from tests.verification.rims import rim_supports

from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.plate.layout import (
    CeramicPatch,
    FoamSupport,
    RectangularPlate,
    turned,
)
from squeezefilm.physics.plate.solid.forecast import bare_frequency, pieced_frequency
from squeezefilm.physics.plate.solid.modes import PlateModes
from squeezefilm.physics.plate.solid.response import harmonic_response
from squeezefilm.physics.plate.solid.solve import energy_shares_of, solve_modes

GLASS = ElasticMaterial("glass", 72e9, 0.22, 2480, quality_factor=1000)
CERAMIC = Piezoceramic("PZT", 67.9e9, 0.2897, 23e9, 7700, -180e-12, 1900, 75)
LENGTH, WIDTH, STRIP = 36e-3, 11e-3, 4e-3


def glass_plate(**changes: object) -> RectangularPlate:
    """Strips along the two short edges, mode (4,0): a small plate like today's glass ones."""
    plate = RectangularPlate(
        LENGTH, WIDTH, 0.9e-3, 4, 100, GLASS, CERAMIC,
        (
            CeramicPatch(0, 0, STRIP, WIDTH, 0.5e-3),
            CeramicPatch(LENGTH - STRIP, 0, STRIP, WIDTH, 0.5e-3),
        ),
    )  # fmt: skip
    return dataclasses.replace(plate, **changes)  # type: ignore[arg-type]


def rim(young_modulus: float) -> tuple[FoamSupport, ...]:
    return rim_supports(LENGTH, WIDTH, 1e-3, 0.5e-3, young_modulus, 3.0, "top")


def _first_order(modes: PlateModes, supports: tuple[FoamSupport, ...]) -> float:
    """∫ k u² over the foam with a mode of unit mass: the rise of ω² to first order (1/s²)."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    rise = 0.0
    for foam in supports:
        x = foam.x + foam.length * (nodes + 1) / 2
        y = foam.y + foam.width * (nodes + 1) / 2
        field = modes.field(0, x, y, modes.plate.thickness)
        area = np.outer(weights, weights) * foam.length * foam.width / 4
        rise += float(np.einsum("xyc,c,xy->", field**2, np.array(foam.stiffness_per_area), area))
    return rise


@pytest.mark.slow
def test_foam_at_the_rim_shifts_and_damps_as_perturbation_theory_says() -> None:
    # Foam of nothing: the same mesh, a bare plate.
    bare = solve_modes(glass_plate(supports=rim(1.0)))
    omega2 = (2 * np.pi * bare.mesh_frequencies[0]) ** 2
    gaps = []
    for modulus in (4e6, 2e6):
        foam = rim(modulus)
        rise = _first_order(bare, foam)
        held = solve_modes(glass_plate(supports=foam))
        found = (2 * np.pi * held.mesh_frequencies[0]) ** 2 - omega2
        gaps.append(found / rise - 1)
        share = held.energy_shares[0][held.materials.index("supports")]
        assert share == pytest.approx(rise / (omega2 + rise), rel=0.06)
        # Its loss comes on top of that of the materials, each by its share.
        expected = (1 - share) / bare.quality_factors[0] + share / 3
        assert 1 / held.quality_factors[0] == pytest.approx(expected, rel=0.02)
        assert held.quality_factors[0] < bare.quality_factors[0] / 5
    # First order bounds the rise from above (Rayleigh), and what it leaves is of second order in
    # the foam's stiffness: half the foam, half the relative gap.
    assert -0.01 < gaps[0] < gaps[1] < 0
    assert gaps[0] / gaps[1] == pytest.approx(2, rel=0.05)


@pytest.mark.slow
def test_q_from_energies_is_the_width_of_the_driven_resonance() -> None:
    plate = glass_plate(supports=rim(2e6))
    modes = solve_modes(plate)
    f, q = modes.mesh_frequencies[0], modes.quality_factors[0]
    response = harmonic_response(plate, f * (1 + np.linspace(-1, 1, 161) / q))
    amplitude, peak = response.maximum, response.resonance
    level = amplitude[peak] / np.sqrt(2)
    low = np.interp(level, amplitude[: peak + 1], response.frequencies[: peak + 1])
    high = np.interp(-level, -amplitude[peak:], response.frequencies[peak:])
    assert response.frequencies[peak] / (high - low) == pytest.approx(q, rel=0.02)
    assert response.frequencies[peak] == pytest.approx(f, rel=1e-3)


@pytest.mark.slow
def test_a_turned_plate_is_the_same_plate() -> None:
    plate = glass_plate(supports=rim(2e6)[:1])
    other = turned(plate)
    assert turned(other) == plate
    assert (plate.working_label, other.working_label) == ((4, 0), (0, 4))
    one, two = solve_modes(plate), solve_modes(other)
    assert two.labels == ((0, 4),)
    assert two.frequencies[0] == pytest.approx(one.frequencies[0], rel=1e-7)
    assert two.drive_forces[0] == pytest.approx(one.drive_forces[0], rel=1e-5)
    # λ/2 is measured across the lines, whichever side they cross.
    assert two.half_wavelength(0) == pytest.approx(one.half_wavelength(0), rel=2e-2)


def test_the_beam_of_pieces_tells_where_to_look() -> None:
    plate = glass_plate()
    guess = pieced_frequency(plate, (4, 0))
    assert guess == pytest.approx(solve_modes(plate).frequencies[0], rel=0.03)
    # A bare plate's beam formula: k L = 3.5 π and Kirchhoff's stiffness.
    wave = 3.5 * np.pi / LENGTH
    stiffness = GLASS.plane_strain_modulus * (0.9e-3) ** 2 / 12
    expected = wave**2 * np.sqrt(stiffness / GLASS.density) / (2 * np.pi)
    assert bare_frequency(plate, (4, 0)) == pytest.approx(expected, rel=1e-12)
    # Lines both ways: between the bare plate and the covered one.
    assert bare_frequency(plate, (4, 2)) < 1.1 * pieced_frequency(plate, (4, 2))


@pytest.mark.slow
def test_modes_that_change_places_between_meshes_keep_their_energies() -> None:
    """A plate of the size of basdogan2020-glass has modes a percent apart: what is taken from the
    coarse mesh (energy shares, Q) must be the same mode's as the frequency from the fine one."""
    plate = glass_plate(
        length=93e-3, width=65e-3, nodal_lines=12,
        patches=(
            CeramicPatch(0, 0, 6e-3, 65e-3, 0.5e-3),
            CeramicPatch(87e-3, 0, 6e-3, 65e-3, 0.5e-3),
        ),
    )  # fmt: skip
    modes = solve_modes(plate, band=(31.5e3, 34.5e3), driven_only=True)
    assert modes.count == 5
    for number, (solved, vector) in enumerate(modes._fields):
        fine, _ = energy_shares_of(solved.slabs, vector[:, None])
        assert modes.energy_shares[number] == pytest.approx(fine[0], rel=0.15, abs=5e-3)
