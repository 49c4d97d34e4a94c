"""Skin under tangential patches: Cerruti's closed form against its own integral, the layer on bone
against Navier's equations integrated in depth, limits, and Hertz's contact."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from squeezefilm.actuators.skin_stretch.cradle import (
    FingerCradle,
    Fingertip,
    force_for_all,
    radii_that_touch_all,
    seat,
)
from squeezefilm.actuators.skin_stretch.tissue import (
    Tissue,
    half_space_motion,
    influence_matrix,
    layer_compliances,
    layer_correction,
    strain_matrices,
)

SIZE = (1.0e-3, 1.6e-3)


@pytest.mark.parametrize("place", [(2.1e-3, 0.4e-3), (0.9e-3, -1.7e-3), (-1.4e-3, 1.1e-3)])
@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_a_patch_is_the_integral_of_point_forces(place: tuple[float, float], nu: float) -> None:
    points, weights = np.polynomial.legendre.leggauss(24)
    a, b = np.meshgrid(points * SIZE[0] / 2, points * SIZE[1] / 2, indexing="ij")
    area = np.outer(weights, weights) * SIZE[0] * SIZE[1] / 4
    x, y = place[0] - a, place[1] - b
    r = np.hypot(x, y)
    wanted = [
        np.sum(area * ((1 - nu) / r + nu * x**2 / r**3)) / (2 * math.pi),
        np.sum(area * nu * x * y / r**3) / (2 * math.pi),
        np.sum(area * (1 - nu) / r) / (2 * math.pi),
    ]
    at = np.array([place[0]]), np.array([place[1]])
    found = half_space_motion(*at, *SIZE, nu)
    assert [float(one[0]) for one in found] == pytest.approx(wanted, rel=1e-9, abs=1e-15)


def test_on_the_axes_and_behind_the_edges_no_digits_are_lost() -> None:
    x = np.array([0.0, 0.5e-3, -3e-3, 3e-3, 0.1, -0.1])
    y = np.array([0.0, 0.8e-3, 0.8e-3, -0.8e-3, 0.0, 0.0])
    u, v, _ = half_space_motion(x, y, *SIZE, 0.4)
    mirrored = half_space_motion(-x, -y, *SIZE, 0.4)
    assert u == pytest.approx(mirrored[0], rel=1e-11)
    assert v == pytest.approx(mirrored[1], rel=1e-9, abs=1e-18)
    # Far away it is a point force.
    assert u[-1] == pytest.approx(SIZE[0] * SIZE[1] / (2 * math.pi * 0.1), rel=1e-4)


def navier(depth: float, nu: float) -> tuple[float, float, float]:
    """The same three compliances (G u/(q h)) by integrating Navier's equations over the depth.

    State (u, w, tau, sigma) of a plane wave cos/sin kx, h = G = 1, from the bone at z = 0 up.
    """
    k = depth
    lam = 2 * nu / (1 - 2 * nu)
    # u ~ cos kx, w ~ sin kx: u' = tau − k w, w' = (sigma + lam k u)/(lam + 2),
    # tau' = k² (lam + 2) u − k lam w' , sigma' = k tau.
    c = lam + 2
    A = np.array(
        [
            [0.0, -k, 1.0, 0.0],
            [lam * k / c, 0.0, 0.0, 1 / c],
            [k**2 * (c - lam**2 / c), 0.0, 0.0, -k * lam / c],
            [0.0, 0.0, k, 0.0],
        ]
    )
    top = expm(A)[:, 2:]  # from a bone where u = w = 0
    sheared = np.linalg.solve(top[2:], [1.0, 0.0])
    pressed = np.linalg.solve(top[2:], [0.0, 1.0])
    return float(top[0] @ sheared), math.tanh(k) / k, float(top[1] @ pressed)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.45, 0.49])
@pytest.mark.parametrize("depth", [0.05, 0.5, 1.0, 3.0, 6.0])
def test_a_bonded_layer_is_navier_s_equations_integrated(depth: float, nu: float) -> None:
    found = [float(one[0]) for one in layer_compliances(np.array([depth]), nu)]
    assert found == pytest.approx(navier(depth, nu), rel=1e-7)


def test_a_thin_layer_shears_as_one_and_a_deep_one_is_a_half_space() -> None:
    along, across, _ = layer_compliances(np.array([1e-3]), 0.48)
    assert along == pytest.approx(1.0, rel=1e-4)
    assert across == pytest.approx(1.0, rel=1e-5)
    along, across, normal = layer_compliances(np.array([1e3]), 0.48)
    assert 1e3 * along == pytest.approx(0.52, rel=1e-9)
    assert 1e3 * across == pytest.approx(1.0, rel=1e-9)
    assert 1e3 * normal == pytest.approx(0.52, rel=1e-9)


def test_layer_goes_to_half_space_with_depth_and_to_rest_with_distance() -> None:
    at = np.array([0.0, 1.3e-3]), np.array([0.0, 0.7e-3])
    half = half_space_motion(*at, *SIZE, 0.45)[0]
    off = [
        float(np.max(np.abs(layer_correction(*at, *SIZE, 0.45, h)[0] / half)))
        for h in (20e-3, 40e-3, 80e-3)
    ]
    # What the bone takes away falls as 1/depth.
    assert off[0] / off[1] == pytest.approx(2, rel=0.03)
    assert off[1] / off[2] == pytest.approx(2, rel=0.01)
    far = np.array([22e-3, 25e-3]), np.array([0.0, 5e-3])
    whole = np.array(half_space_motion(*far, *SIZE, 0.45))
    rest = whole + layer_correction(*far, *SIZE, 0.45, 2e-3)
    assert np.max(np.abs(rest[:2])) < 1e-3 * np.max(whole[0])
    assert np.max(np.abs(rest[2])) < 1e-3 * np.max(whole[2])


def test_an_even_pull_over_a_wide_patch_shears_the_layer() -> None:
    # 200 patches edge to edge in a 40 mm square, of a layer of 2 mm: in the middle u = q h/G.
    x = (np.arange(40) - 19.5) * 1e-3
    px, py = (one.ravel() for one in np.meshgrid(x, x))
    tissue = Tissue(shear_modulus=1e5, poisson_ratio=0.3, thickness=2e-3)
    u, v, _ = tissue.shifts(px, py, 1e-3, 1e-3)
    assert np.sum(u) * 1e-6 == pytest.approx(2e-3 / 1e5, rel=1e-3)
    assert abs(np.sum(v)) < 1e-9 * np.sum(u)


def test_influence_is_symmetric_positive_and_its_quadrature_settled() -> None:
    x = np.repeat((np.arange(4) - 1.5) * 1.2e-3, 3)
    y = np.tile((np.arange(3) - 1) * 1.8e-3, 4)
    for normal in (False, True):
        C = influence_matrix(Tissue(), x, y, SIZE, normal)
        assert np.max(np.abs(C - C.T)) <= 1e-12 * np.max(C)
        assert np.linalg.eigvalsh(C)[0] > 0
    # The mean over a patch of its own displacement: a square's is known (Love 1929; 0.4732 √A
    # (1 − ν)/G of p for normal pressure).
    square = influence_matrix(Tissue(1e5, 0.3, None), np.zeros(1), np.zeros(1), (1e-3, 1e-3), True)[
        0, 0
    ]
    exact = 4 * (math.log(1 + math.sqrt(2)) - (math.sqrt(2) - 1) / 3) * 0.7 / (2 * math.pi)
    assert square * 1e5 * 1e-3 == pytest.approx(exact, rel=1e-3)


def test_strains_are_those_of_displacements_and_of_opposite_sign_before_and_behind() -> None:
    ex, ey, S = strain_matrices(Tissue(), np.zeros(1), np.zeros(1), SIZE, 0.25e-3)
    assert S.shape == (3, ex.size - 1, ey.size - 1, 1)
    assert S[0, ::-1, :, 0] == pytest.approx(-S[0, :, :, 0], abs=1e-9)
    # Ahead of a contactor the skin is pressed together, behind it stretched.
    assert S[0, -2, S.shape[2] // 2, 0] < 0 < S[0, 1, S.shape[2] // 2, 0]
    # Summed along x, strain is the difference of displacements at the ends.
    middle = np.array([ey[S.shape[2] // 2], ey[S.shape[2] // 2 + 1]])
    u = Tissue().shifts(ex[[0, -1]][:, None], middle[None, :], *SIZE)[0].mean(axis=1)
    total = S[0, :, S.shape[2] // 2, 0].sum() * 0.25e-3
    assert total == pytest.approx(u[1] - u[0], rel=1e-6, abs=1e-12)


@pytest.mark.slow
def test_seating_on_a_flat_half_space_is_hertz_s_contact() -> None:
    # Contactors edge to edge, a sphere on them: F = (4/3) E* √R d^(3/2), E* = 2G/(1 − ν) for rigid
    # contactors; the pitch is a tenth of the contact's radius.
    R, force, tissue = 10e-3, 1.0, Tissue(shear_modulus=20e3, poisson_ratio=0.45, thickness=None)
    grid = FingerCradle(24, 24, 0.4e-3, 0.4e-3, 0.4e-3, 0.4e-3, 9.7e-3, 9.7e-3)
    modulus = 2 * tissue.shear_modulus / (1 - tissue.poisson_ratio)
    a = (3 * force * R / (4 * modulus)) ** (1 / 3)
    assert a < 4.8e-3
    seated = seat(grid, Fingertip(R, R), tissue, force)
    assert seated.forces.sum() == pytest.approx(force, rel=1e-6)
    assert seated.depth == pytest.approx(a**2 / R, rel=0.03)
    assert math.sqrt(seated.touching * 0.16e-6 / math.pi) == pytest.approx(a, rel=0.06)
    highest = 3 * force / (2 * math.pi * a**2)
    assert seated.forces.max() / 0.16e-6 == pytest.approx(highest, rel=0.03)


@pytest.mark.slow
def test_the_least_force_for_all_is_where_the_last_contactor_is_reached() -> None:
    pulp, finger = Tissue(shear_modulus=20e3), Fingertip()
    cradle = FingerCradle(10, 6, 1.2e-3, 1.8e-3, *SIZE, 13e-3, 12e-3, 9e-3, 22e-3)
    least = force_for_all(cradle, finger, pulp)
    assert seat(cradle, finger, pulp, 1.01 * least).touching == 60
    assert seat(cradle, finger, pulp, 0.97 * least).touching < 60
    low, high = radii_that_touch_all(cradle, finger, pulp, 1.0)
    assert low < finger.radius_across < high
