"""The bare ceramic disc against elements, the formula of a thin disc, and its own derivatives."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import jv

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError
from squeezefilm.core.materials import VACUUM_PERMITTIVITY
from squeezefilm.physics.plate.elements.box_model import Medium
from squeezefilm.physics.plate.ring.ceramic_disc import (
    CONSTANTS,
    CeramicDisc,
    disc_admittance,
    disc_system,
    weak_constants,
)
from squeezefilm.physics.plate.ring.modes import annular_admittance, annular_modes
from squeezefilm.physics.plate.ring.section import AnnularSection, RingLayer, full_drive

DISC = CeramicDisc(35e-3, 2e-3, 7743.0)
S = (16.4e-12, -5.74e-12, -7.22e-12, 18.8e-12, 47.5e-12)
D = (-171e-12, 374e-12, 584e-12)
EPS = (1730.0, 1700.0)


def constants(loss: float = 0.0) -> si.ComplexArray:
    """PZT-5A's, all with one loss tangent."""
    share = 1 - 1j * loss
    return weak_constants(np.array(S) * share, np.array(D) * share, np.array(EPS) * share)


def resonances(disc: CeramicDisc, along_radius: int, along_thickness: int) -> si.FloatArray:
    """The lowest frequencies of the shorted disc, by its matrices."""
    system = disc_system(disc, along_radius, along_thickness)
    matrix = np.tensordot(constants().real, system.parts, 1)[:-1, :-1]
    fields = np.diag(system.mass)[:-1] == 0
    moving, electric = np.flatnonzero(~fields), np.flatnonzero(fields)
    within = matrix[np.ix_(moving, electric)]
    stiffness = matrix[np.ix_(moving, moving)] - within @ np.linalg.solve(
        matrix[np.ix_(electric, electric)], within.T
    )
    root = np.linalg.cholesky(system.mass[np.ix_(moving, moving)])
    half = np.linalg.solve(root, np.linalg.solve(root, stiffness).T)
    return np.sqrt(np.linalg.eigvalsh((half + half.T) / 2)[:3]) / (2 * math.pi)


def section(disc: CeramicDisc) -> AnnularSection:
    """The same disc for elements."""
    w = constants().real
    c = np.zeros((6, 6))
    c[:3, :3] = [[w[0], w[1], w[2]], [w[1], w[0], w[2]], [w[2], w[2], w[3]]]
    c[3, 3] = c[4, 4] = w[4]
    c[5, 5] = (w[0] - w[1]) / 2
    e = np.zeros((3, 6))
    e[2, :3] = w[5], w[5], w[6]
    e[0, 4] = e[1, 3] = w[7]
    medium = Medium("ceramic", c, disc.density, 1e-6, e, np.diag([w[8], w[8], w[9]]))
    return AnnularSection((RingLayer(0.0, disc.diameter / 2, 0.0, disc.thickness, medium),))


def test_its_radial_modes_are_those_of_elements() -> None:
    modes = [m for m in annular_modes(section(DISC), 0, near=100e3, count=12) if m.label == "R(0)"]
    assert resonances(DISC, 7, 3)[:2] == pytest.approx([m.frequency for m in modes[:2]], rel=1e-6)


def test_its_polynomials_converge() -> None:
    limit = resonances(DISC, 12, 6)
    for count, allowed in (((4, 2), 2e-3), ((5, 2), 1e-4), ((7, 3), 1e-6)):
        assert resonances(DISC, *count)[:2] == pytest.approx(limit[:2], rel=allowed), count


def test_its_admittance_is_that_of_elements() -> None:
    # Away from resonances, where modes that the elements leave out of their sum do little.
    frequency = np.array([20e3, 40e3, 52e3])
    own = disc_admittance(DISC, constants(), frequency)[0]
    other = annular_admittance(section(DISC), full_drive(), frequency, harmonics=(0,), modes=14)
    assert own.imag == pytest.approx(other.imag, rel=2e-3)


@pytest.mark.parametrize("loss", [0.0, 0.02])
def test_a_thin_disc_has_the_formula_of_a_thin_disc(loss: float) -> None:
    """Meitzler, O'Bryan and Tiersten 1973, 10.1109/T-SU.1973.29743, in plane stress."""
    thin = CeramicDisc(35e-3, 35e-6, 7743.0)
    frequency = np.array([20e3, 50e3, 62e3, 130e3])
    share = 1 - 1j * loss
    s11, s12 = S[0] * share, S[1] * share
    sigma = -S[1] / S[0]
    omega = 2 * np.pi * frequency
    eta = omega * thin.diameter / 2 * np.sqrt(thin.density * s11 * (1 - sigma**2))
    free = EPS[1] * VACUUM_PERMITTIVITY * share
    planar = 2 * (D[0] * share) ** 2 / (free * (s11 + s12))
    first, zeroth = jv(1, eta), jv(0, eta)
    motion = (1 + sigma) * first / (eta * zeroth - (1 - sigma) * first)
    area = math.pi / 4 * thin.diameter**2
    expected = 1j * omega * free * area / thin.thickness * (1 - planar + planar * motion)
    found = disc_admittance(thin, constants(loss), frequency)[0]
    assert np.abs(found / expected - 1).max() < 1e-3


def test_derivatives_are_those_of_differences() -> None:
    frequency = np.array([40e3, 56e3, 62e3, 145e3])
    at = constants(0.02)
    slopes = disc_admittance(DISC, at, frequency)[1]
    for k, name in enumerate(CONSTANTS):
        step = np.zeros(10, dtype=complex)
        step[k] = 1e-4 * at[k]
        rise = disc_admittance(DISC, at + step, frequency)[0]
        rise = rise - disc_admittance(DISC, at - step, frequency)[0]
        largest = np.abs(at[k] * slopes[k]).max()
        assert np.abs(rise / 2e-4 - at[k] * slopes[k]).max() < 1e-4 * largest + 1e-9, name


def test_losses_only_take_power() -> None:
    frequency = np.linspace(30e3, 160e3, 200)
    assert np.all(disc_admittance(DISC, constants(0.02), frequency)[0].real > 0)


def test_constants_may_change_with_frequency() -> None:
    frequency = np.array([40e3, 56e3])
    both = np.stack([constants(0.01), constants(0.03)], axis=1)
    together = disc_admittance(DISC, both, frequency)[0]
    for k, loss in enumerate((0.01, 0.03)):
        alone = disc_admittance(DISC, constants(loss), frequency[k : k + 1])[0]
        assert together[k] == pytest.approx(alone[0], rel=1e-12)


def test_what_cannot_be_solved_is_refused() -> None:
    with pytest.raises(InputError, match=r"shape \(3,\)"):
        disc_admittance(DISC, constants()[:3], np.array([50e3]))
    with pytest.raises(ConvergenceError, match="as good as none"):
        disc_admittance(DISC, np.zeros(10, dtype=complex), np.array([50e3]))
