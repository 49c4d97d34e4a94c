"""Free–free beams against analysis: tabulated roots, limits, orthogonality, an independent solver,
and the harmonic response against a direct solution of the driven equations."""

import dataclasses
import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh, expm
from tests.verification.random_plates import random_plate

from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.beam_modes import (
    euler_bernoulli_frequency,
    euler_bernoulli_half_wavelength,
    free_beam_mode,
    timoshenko_frequency,
)
from squeezefilm.physics.plate.beam_pieces import (
    BeamPiece,
    beam_pieces,
    pieced_beam_mode,
    stressed_span,
)
from squeezefilm.physics.plate.beam_response import BeamResponse, beam_response
from squeezefilm.physics.plate.laminate import Laminate, LaminateLayer, laminate, plate_laminate
from squeezefilm.physics.plate.layout import CeramicPatch, RectangularPlate
from squeezefilm.physics.plate.working_mode import working_mode


@pytest.fixture(scope="module")
def plate() -> RectangularPlate:
    actuator = load_display("biet2008-plate").actuator
    assert isinstance(actuator, RectangularPlate)
    return actuator


@pytest.fixture(scope="module")
def section(plate: RectangularPlate) -> Laminate:
    return plate_laminate(plate, "paper")


@pytest.mark.parametrize(
    ("nodal_lines", "beta_length"),
    [
        (2, 4.730040744862704),
        (3, 7.853204624095838),
        (4, 10.995607838001671),
        (5, 14.13716549125746),
        (8, 23.561944902040455),
    ],
)
def test_euler_bernoulli_roots(section: Laminate, nodal_lines: int, beta_length: float) -> None:
    length = 0.083
    mode = free_beam_mode(section, length, nodal_lines, "euler_bernoulli")
    assert math.pi * length / mode.half_wavelength == pytest.approx(beta_length, rel=1e-9)
    assert len(mode.nodal_positions) == nodal_lines
    assert mode.frequency == pytest.approx(
        euler_bernoulli_frequency(
            length * math.pi / beta_length, section.bending_stiffness, section.mass_per_area
        ),
        rel=1e-9,
    )


def test_thin_timoshenko_tends_to_euler_bernoulli_with_second_order() -> None:
    errors = []
    thicknesses = [2e-3, 1e-3, 0.5e-3]
    for thickness in thicknesses:
        thin = laminate([LaminateLayer(thickness, 123e9, 47e9, 8250.0)])
        euler = free_beam_mode(thin, 0.1, 4, "euler_bernoulli").frequency
        errors.append(1 - free_beam_mode(thin, 0.1, 4).frequency / euler)
    assert all(error > 0 for error in errors)  # shear and rotation only soften
    orders = np.diff(np.log(errors)) / np.diff(np.log(thicknesses))
    assert orders == pytest.approx([2, 2], abs=0.05)


def _ritz(section: Laminate, length: float, points: int) -> tuple[Any, Any]:
    """Stiffness and mass of a free Timoshenko beam in Legendre polynomials for w and ψ: an
    independent solver (free ends are natural)."""
    nodes, weights = np.polynomial.legendre.leggauss(2 * points)
    V = np.polynomial.legendre.legvander(nodes, points - 1)
    slopes = [np.polynomial.legendre.legder(row) for row in np.eye(points)]
    D = np.stack([np.polynomial.legendre.legval(nodes, slope) for slope in slopes], axis=1)
    D, w = D * 2 / length, weights * length / 2
    G, S = section.bending_stiffness, section.shear_stiffness
    M, J = section.mass_per_area, section.rotary_inertia
    VV, VD, DD = ((a.T * w) @ b for a, b in ((V, V), (V, D), (D, D)))
    stiffness = np.block([[S * DD, -S * VD.T], [-S * VD, S * VV + G * DD]])
    zero = np.zeros((points, points))
    return stiffness, np.block([[M * VV, zero], [zero, J * VV]])


@pytest.mark.parametrize("nodal_lines", [2, 3, 7, 8, 9, 13])
def test_timoshenko_agrees_with_an_independent_ritz_solver(
    section: Laminate, nodal_lines: int
) -> None:
    # Two rigid motions come first (w = const, rotation).
    values = eigh(*_ritz(section, 0.083, 40), eigvals_only=True)
    reference = math.sqrt(values[nodal_lines]) / (2 * math.pi)
    assert free_beam_mode(section, 0.083, nodal_lines).frequency == pytest.approx(
        reference, rel=1e-9
    )


def test_modes_are_orthogonal_in_the_kinetic_energy(section: Laminate) -> None:
    modes = [free_beam_mode(section, 0.083, n, points=8001) for n in (4, 6, 8, 9)]
    x = modes[0].position
    for i, a in enumerate(modes):
        for b in modes[:i]:
            cross = np.trapezoid(
                section.mass_per_area * a.deflection * b.deflection
                + section.rotary_inertia * a.rotation * b.rotation,
                x,
            )
            scale = math.sqrt(a.modal_mass_per_width * b.modal_mass_per_width)
            assert abs(cross) / scale < 1e-5


def test_mode_shape_is_scaled_to_its_largest_inner_lobe(section: Laminate) -> None:
    mode = free_beam_mode(section, 0.083, 8)
    inside = (mode.position > mode.nodal_positions[0]) & (mode.position < mode.nodal_positions[-1])
    assert np.max(np.abs(mode.deflection[inside])) == pytest.approx(1, abs=1e-12)
    assert mode.deflection == pytest.approx(mode.deflection[::-1])  # eight lines: symmetric
    odd = free_beam_mode(section, 0.083, 7)
    assert odd.deflection == pytest.approx(-odd.deflection[::-1])


def test_waves_and_their_inverse(section: Laminate) -> None:
    G, M = section.bending_stiffness, section.mass_per_area
    for half in (5e-3, 11e-3, 40e-3):
        f = euler_bernoulli_frequency(half, G, M)
        assert euler_bernoulli_half_wavelength(f, G, M) == pytest.approx(half, rel=1e-12)
        assert timoshenko_frequency(half, section) < f
    # The end effects of a long beam are small: its half wavelength gives its frequency.
    mode = free_beam_mode(section, 0.5, 60)
    assert timoshenko_frequency(mode.half_wavelength, section) == pytest.approx(
        mode.frequency, rel=1e-9
    )


def test_neutral_axis_balances_the_section(section: Laminate) -> None:
    # ∫ E z dz = 0 about the neutral axis; one material twice is the same as once.
    total = sum(
        layer.modulus * layer.thickness * section.moment_arm(i)
        for i, layer in enumerate(section.layers)
    )
    assert abs(total) < 1e-6 * section.layers[0].modulus * section.layers[0].thickness ** 2
    layer = LaminateLayer(1e-3, 123e9, 47e9, 8250.0)
    twice, once = laminate([layer, layer]), laminate([LaminateLayer(2e-3, 123e9, 47e9, 8250.0)])
    assert twice.bending_stiffness == pytest.approx(once.bending_stiffness, rel=1e-12)
    assert once.bending_stiffness == pytest.approx(123e9 * (2e-3) ** 3 / 12, rel=1e-12)
    with pytest.raises(InputError, match="no layers"):
        laminate([])


def test_covered_everywhere_the_pieces_are_the_uniform_beam(section: Laminate) -> None:
    constants = (
        section.bending_stiffness,
        section.shear_stiffness,
        section.mass_per_area,
        section.rotary_inertia,
    )
    for lines in (2, 3, 7, 8, 13):
        for stops in ([0.0, 0.083], [0.0, 0.01, 0.0101, 0.083]):
            pieces = [BeamPiece(a, b, *constants) for a, b in itertools.pairwise(stops)]
            found, exact = (
                pieced_beam_mode(pieces, lines),
                free_beam_mode(section, 0.083, lines),
            )
            assert found.frequency == pytest.approx(exact.frequency, rel=2e-5)
            assert found.half_wavelength == pytest.approx(exact.half_wavelength, rel=2e-5)
            assert found.modal_mass_per_width == pytest.approx(exact.modal_mass_per_width, rel=2e-3)
            sign = np.sign(found.deflection @ exact.deflection)
            assert np.max(np.abs(sign * found.deflection - exact.deflection)) < 1e-3
            turning = np.max(np.abs(exact.rotation))
            assert np.max(np.abs(sign * found.rotation - exact.rotation)) < 2e-3 * turning


def _carried(one: BeamPiece, omega2: complex, loss: complex = 1.0) -> np.ndarray:
    """What carries deflection, rotation, shear force and moment from one end of a piece to the
    other: the exact solution of its equations by a matrix exponential."""
    G, S = one.bending_stiffness * loss, one.shear_stiffness * loss
    M, J = one.mass_per_area, one.rotary_inertia
    equations = np.zeros((4, 4), dtype=complex)
    equations[0, 1], equations[0, 2] = 1, 1 / S
    equations[1, 3] = 1 / G
    equations[2, 0] = -M * omega2
    equations[3, 1], equations[3, 2] = -J * omega2, -1
    return np.asarray(expm(equations * (one.end - one.begin)))


def _free_determinant(pieces: Sequence[BeamPiece], frequency: float) -> float:
    """Zero where free motions of the first end leave the last end free."""
    chain = np.eye(4, dtype=complex)
    for one in pieces:
        chain = _carried(one, (2 * math.pi * frequency) ** 2) @ chain
    # The moment in units of the force, so that the determinant has no scale of its own.
    return float(np.linalg.det(chain[2:, :2]).real)


@pytest.mark.parametrize("seed", range(6))
def test_a_beam_of_pieces_agrees_with_the_exact_solution_of_each(seed: int) -> None:
    """Of random plates with gaps, on one face or both: the determinant of the free ends changes
    sign within a few parts in 100 000 of the frequency found."""
    plate = random_plate(seed)
    pieces = beam_pieces(plate, "plane_strain")
    found = beam_response(plate).mode
    assert found.nodal_positions.size == plate.nodal_lines
    below, above = (_free_determinant(pieces, found.frequency * (1 + x)) for x in (-4e-5, 4e-5))
    assert below * above < 0


def test_the_pieces_of_a_plate_have_its_mass_and_its_ceramics_ends() -> None:
    plate = random_plate(3)
    pieces = beam_pieces(plate, "plane_strain")
    assert (pieces[0].begin, pieces[-1].end) == (0.0, plate.length)
    assert all(a.end == b.begin for a, b in itertools.pairwise(pieces))
    mass = sum((one.end - one.begin) * one.mass_per_area for one in pieces) * plate.width
    ceramic = sum(one.length * one.width * one.thickness for one in plate.patches)
    metal = plate.length * plate.width * plate.thickness
    assert mass == pytest.approx(
        metal * plate.substrate.density + ceramic * plate.ceramic.density, rel=1e-6
    )
    stiff = {round(one.bending_stiffness, 9) for one in pieces}
    assert len(stiff) == 2
    for patch in plate.patches:
        low, _ = stressed_span(plate, patch)
        assert any(one.begin == pytest.approx(low, abs=1e-6) for one in pieces)


def test_ceramics_that_touch_are_one_and_short_ones_keep_half_of_them() -> None:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    whole = CeramicPatch(0.01, 0.0, 0.06, plate.width, 1e-3)
    halves = tuple(dataclasses.replace(whole, x=x, length=0.03) for x in (0.01, 0.04))
    one, two = (dataclasses.replace(plate, patches=some) for some in ((whole,), halves))
    assert beam_response(two).mode.frequency == pytest.approx(
        beam_response(one).mode.frequency, rel=1e-6
    )
    assert beam_response(two).force_per_width == pytest.approx(
        beam_response(one).force_per_width, rel=1e-5
    )
    short = CeramicPatch(0.02, 0.0, 1e-3, plate.width, 1e-3)
    assert stressed_span(dataclasses.replace(plate, patches=(short,)), short) == pytest.approx(
        (0.02025, 0.02075)
    )


def test_a_ceramic_pulls_about_the_axis_of_what_lies_there() -> None:
    """One below beside one above: each as if the other face had none anywhere."""
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    below = CeramicPatch(0.005, 0.0, 0.03, plate.width, 1e-3)
    above = CeramicPatch(0.048, 0.0, 0.03, plate.width, 1e-3, polarity=-1, face="top")
    turned_over = dataclasses.replace(above, face="bottom", polarity=1)
    mixed, alike = (
        dataclasses.replace(plate, patches=(below, other)) for other in (above, turned_over)
    )
    assert beam_response(mixed).mode.frequency == pytest.approx(
        beam_response(alike).mode.frequency, rel=1e-9
    )
    assert abs(beam_response(mixed).force_per_width) == pytest.approx(
        abs(beam_response(alike).force_per_width), rel=1e-6
    )


def test_what_no_beam_has_is_refused_by_the_pieces() -> None:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    pieces = beam_pieces(plate, "plane_strain")
    with pytest.raises(InputError, match="at least 2"):
        pieced_beam_mode(pieces, 1)
    with pytest.raises(OutOfRangeError, match="cut-off frequency"):
        pieced_beam_mode(pieces, 90)


def test_a_long_beam_of_pieces_has_its_mode_of_sixty_lines_and_not_another() -> None:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    for length, lines in ((5.0, 60), (5.0, 150), (0.6, 2)):
        long = dataclasses.replace(plate, length=length, nodal_lines=lines)
        assert beam_response(long).mode.nodal_positions.size == lines


def _driven_beam(response: BeamResponse, frequency: float) -> tuple[np.ndarray, np.ndarray]:
    """Places and w per volt of the driven equations, piece by piece: the moment steps where a
    ceramic begins and ends to pull, and the motion of the first end leaves the last end free."""
    plate, section = response.plate, response.section
    moment = plate.ceramic.effective_stress_coefficient * section.moment_arm(1)
    steps = dict[float, float]()
    for patch in plate.patches:
        for edge, sign in zip(stressed_span(plate, patch), (-1, 1), strict=True):
            steps[edge] = steps.get(edge, 0.0) + moment * patch.polarity * sign
    omega2, loss = (2 * np.pi * frequency) ** 2, 1 + 1j / plate.quality_factor
    chain, pushed = np.eye(4, dtype=complex), np.zeros(4, dtype=complex)
    along, places = list[tuple[np.ndarray, np.ndarray]](), list[float]()
    for one in beam_pieces(plate, "plane_strain"):
        for edge, step in steps.items():
            if abs(edge - one.begin) < 1e-9:
                pushed = pushed - np.array([0, 0, 0, step])
        parts = max(1, round((one.end - one.begin) / 1e-4))
        stride = dataclasses.replace(one, end=one.begin + (one.end - one.begin) / parts)
        for k in range(parts):
            along.append((chain, pushed))
            places.append(one.begin + k * (stride.end - stride.begin))
            carry = _carried(stride, omega2, loss)
            chain, pushed = carry @ chain, carry @ pushed
    start = np.linalg.solve(chain[2:, :2], -pushed[2:])
    w = [(c[0, :2] @ start + p[0]) for c, p in along]
    return np.array(places), np.array(w)


def test_amplitude_per_volt_agrees_with_the_driven_equations(plate: RectangularPlate) -> None:
    response = beam_response(plate)
    frequency = response.mode.frequency
    x, driven = _driven_beam(response, frequency)
    superposed = response.transfer(np.array([frequency]), x)[0]
    peak = np.max(np.abs(driven))
    # The superposition lacks the modes above twice the frequency: 1 % of the peak.
    assert np.max(np.abs(superposed - driven)) < 0.01 * peak
    inside = (x > response.mode.nodal_positions[0]) & (x < response.mode.nodal_positions[-1])
    assert response.amplitude_per_volt == pytest.approx(np.max(np.abs(driven[inside])), rel=0.015)


def test_one_mode_law_follows_the_superposition_near_resonance(plate: RectangularPlate) -> None:
    mode = working_mode(plate, "timoshenko")
    assert mode.beam is not None
    frequency = mode.resonance_frequency * np.linspace(0.99, 1.01, 41)
    full = mode.beam.amplitude_at(frequency, plate.length / 2)
    assert mode.amplitude_per_volt_at(frequency) == pytest.approx(full, rel=0.03)
    assert mode.amplitude_per_volt_at(mode.resonance_frequency) == mode.amplitude_per_volt


def test_reversed_polarity_reverses_and_equal_polarity_hardly_drives(
    plate: RectangularPlate,
) -> None:
    response = beam_response(plate)
    flipped = dataclasses.replace(
        plate,
        patches=tuple(dataclasses.replace(p, polarity=-p.polarity) for p in plate.patches),  # type: ignore[arg-type]
    )
    assert beam_response(flipped).force_per_width == pytest.approx(-response.force_per_width)
    same = dataclasses.replace(
        plate, patches=tuple(dataclasses.replace(p, polarity=1) for p in plate.patches)
    )
    assert beam_response(same).amplitude_per_volt < 0.25 * response.amplitude_per_volt


def test_a_bimorphs_ceramics_pull_together() -> None:
    """Equal ceramics on both faces, driven against each other: twice the moment of one of them, on
    a section whose neutral axis is its middle; driven alike they only stretch it."""
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    half = tuple(dataclasses.replace(one, thickness=0.5e-3) for one in plate.patches)
    above = tuple(
        dataclasses.replace(one, face="top", polarity=-one.polarity)  # type: ignore[arg-type]
        for one in half
    )
    both = dataclasses.replace(plate, patches=(*half, *above))
    section = plate_laminate(both)
    assert section.neutral_axis == pytest.approx(sum(one.thickness for one in section.layers) / 2)
    one_face = dataclasses.replace(both, patches=(*half, *_idle(above)))
    found, single = beam_response(both), beam_response(one_face)
    assert found.amplitude_per_volt == pytest.approx(2 * single.amplitude_per_volt)
    alike = dataclasses.replace(
        both, patches=(*half, *(dataclasses.replace(one, face="top") for one in half))
    )
    assert beam_response(alike).amplitude_per_volt < 1e-9 * found.amplitude_per_volt


def _idle(patches: tuple[CeramicPatch, ...]) -> tuple[CeramicPatch, ...]:
    return tuple(dataclasses.replace(one, electrode="shorted") for one in patches)


@pytest.mark.slow
def test_a_bimorph_as_a_beam_stands_beside_the_solid() -> None:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    half = tuple(dataclasses.replace(one, thickness=0.5e-3) for one in plate.patches)
    above = tuple(
        dataclasses.replace(one, face="top", polarity=-one.polarity)  # type: ignore[arg-type]
        for one in half
    )
    both = dataclasses.replace(plate, patches=(*half, *above))
    beam, solid = working_mode(both, "timoshenko"), working_mode(both)
    assert beam.resonance_frequency == pytest.approx(solid.resonance_frequency, rel=0.04)
    assert beam.amplitude_per_volt == pytest.approx(solid.amplitude_per_volt, rel=0.2)


def test_all_modes_up_to_twice_the_working_one_are_superposed() -> None:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    response = beam_response(plate)
    lines = [mode.nodal_lines for mode in response.modes]
    frequencies = [mode.frequency for mode in response.modes]
    assert lines == list(range(2, 2 + len(lines)))
    assert response.mode in response.modes
    beyond = pieced_beam_mode(beam_pieces(plate, "plane_strain"), lines[-1] + 1)
    assert frequencies[-1] <= 2 * response.mode.frequency < beyond.frequency


def test_a_mode_whose_shape_was_not_guessed_is_found_beside_rigid_motions() -> None:
    pieces = beam_pieces(random_plate(1), "plane_strain")
    assert pieced_beam_mode(pieces, 10).nodal_lines == 10
