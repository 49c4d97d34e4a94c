"""The tensor-product elements against analysis: patch test, rigid bodies, beams, plates, a k31 bar,
a bimorph, published quadratic-mesh values, and measured p-convergence."""

import math
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.materials import PiezoConstants, isotropic_stiffness
from squeezefilm.physics.plate.elements.box_model import (
    BoxModel,
    EndCondition,
    Medium,
    ModelElectrode,
)
from squeezefilm.physics.plate.elements.lobatto import LineMesh
from squeezefilm.physics.plate.elements.slab_modes import (
    SlabFactor,
    modes_near,
    with_open_electrodes,
)
from squeezefilm.physics.plate.elements.slabs import Slabs

FREE: tuple[EndCondition, ...] = ("free", "free", "free", "free")
VACUUM = 8.8541878128e-12


def line(length: float, elements: int, order: int, start: float = 0.0) -> LineMesh:
    edges = tuple(start + length * k / elements for k in range(elements + 1))
    return LineMesh(edges, (order,) * elements)


def solid(x: LineMesh, y: LineMesh, z: LineMesh, medium: Medium, **more: Any) -> BoxModel:
    shape = (x.elements, y.elements, z.elements)
    number = 0 if medium.piezoelectric else -1
    return BoxModel(x, y, z, (medium,), np.zeros(shape, dtype=int), np.full(shape, number), **more)


def frequencies(
    model: BoxModel, guess: float, count: int, open_columns: np.ndarray | None = None
) -> np.ndarray:
    slabs = Slabs(model)
    shift = (2 * np.pi * guess) ** 2
    solve: Any = SlabFactor(slabs, shift).solve
    if open_columns is not None:
        solve = with_open_electrodes(slabs, solve, open_columns)

    def wanted(values: np.ndarray) -> np.ndarray:
        # What moves as a rigid body is at rounding: of thin plates up to 0.04 of the guess, by the
        # processor. No elastic mode that is asked for is below a third.
        elastic = np.flatnonzero(values > (0.1 * 2 * np.pi * guess) ** 2)
        return np.sort(elastic[np.argsort(np.abs(values[elastic] - shift))][:count])

    start = np.random.default_rng(0).standard_normal((slabs.unknowns, 4))
    start[(slabs.components == 3) | slabs.held] = 0
    pairs = modes_near(slabs, solve, shift, wanted, start, tolerance=1e-11)
    return np.sqrt(pairs.values) / (2 * np.pi)


STEEL = Medium("steel", isotropic_stiffness(200e9, 0.3), 8000.0)


def linear_field(slabs: Slabs, gradient: np.ndarray) -> np.ndarray:
    """A displacement linear in the coordinates: end functions carry it, the others are zero."""
    model = slabs.model
    out = []
    for n, (component, iy, iz) in enumerate(slabs.parts):
        ends = (model.y.function_orders[iy] == 1) & (model.z.function_orders[iz] == 1)
        position = np.stack(
            [np.full(iy.size, model.x.nodes[n]), _ends(model.y)[iy], _ends(model.z)[iz]]
        )
        value = np.einsum("ik,ki->i", gradient[np.minimum(component, 2)], position)
        out.append(np.where(ends & (component < 3), value, 0.0))
    return np.concatenate(out)[:, None]


def _ends(mesh: LineMesh) -> np.ndarray:
    out = np.zeros(mesh.nodes.size)
    out[list(mesh.first_node)] = mesh.edges
    return out


@pytest.mark.parametrize("trunk", [np.inf, 1.0])
def test_patch_test_of_constant_strain(trunk: float) -> None:
    x = LineMesh((0.0, 0.3, 0.35, 1.0), (3, 2, 4))
    y = LineMesh((0.0, 0.6, 1.0), (4, 2))
    z = LineMesh((0.0, 0.1, 0.3), (3, 2))
    slabs = Slabs(solid(x, y, z, STEEL, trunk=trunk))
    gradient = np.random.default_rng(1).standard_normal((3, 3))
    u = linear_field(slabs, gradient)
    force = slabs.stiffness_times(u)[:, 0]
    energy = 0.5 * float(u[:, 0] @ force)
    strain = (gradient + gradient.T) / 2
    voigt = np.array([*np.diag(strain), 2 * strain[1, 2], 2 * strain[0, 2], 2 * strain[0, 1]])
    assert energy == pytest.approx(0.5 * voigt @ STEEL.stiffness @ voigt * 0.3, rel=1e-12)
    inside = []
    for n, (_, iy, iz) in enumerate(slabs.parts):
        skin_y = np.isin(iy, [0, y.nodes.size - 1])
        skin_z = np.isin(iz, [0, z.nodes.size - 1])
        inside.append(~(skin_y | skin_z) & (0 < n < x.nodes.size - 1))
    assert np.max(np.abs(force[np.concatenate(inside)])) < 1e-9 * np.max(np.abs(force))


@pytest.mark.slow
def test_operators_are_the_same_for_many_vectors_at_once_as_for_each() -> None:
    x = LineMesh((0.0, 0.3, 0.35, 0.65, 1.0), (3, 2, 3, 3))
    slabs = Slabs(solid(x, line(0.6, 2, 3), line(0.3, 1, 2), STEEL))
    many = np.random.default_rng(2).standard_normal((slabs.unknowns, 70))
    for times in (slabs.mass_times, slabs.stiffness_times):
        together = times(many)
        each = np.concatenate([times(many[:, k : k + 1]) for k in range(70)], axis=1)
        assert together == pytest.approx(each, rel=1e-12, abs=1e-12 * np.max(np.abs(each)))
        # Symmetric, as an operator assembled by parts must be.
        assert many.T @ together == pytest.approx(
            together.T @ many, rel=1e-9, abs=1e-12 * np.max(np.abs(together))
        )


def test_rigid_motion_costs_nothing_and_there_are_six_of_them() -> None:
    slabs = Slabs(solid(line(0.1, 3, 3), line(0.04, 1, 5), line(0.005, 1, 3), STEEL))
    scale = np.max(np.abs(slabs.stiffness_times(linear_field(slabs, np.eye(3)))))
    for a, b in ((0, 1), (0, 2), (1, 2)):
        spin = np.zeros((3, 3))
        spin[a, b], spin[b, a] = 1, -1
        assert np.max(np.abs(slabs.stiffness_times(linear_field(slabs, spin)))) < 1e-10 * scale
    assert SlabFactor(slabs, (2 * np.pi * 10.0) ** 2).modes_below == 6


def test_free_beam_has_euler_s_roots() -> None:
    # So slender (1:500) that shear and rotation take less than 1e-4 of the lowest modes.
    L, h, E, rho = 1.0, 0.002, 200e9, 8000.0
    medium = Medium("nu0", isotropic_stiffness(E, 0.0), rho)
    model = solid(
        line(L, 8, 5), line(h, 1, 2), line(h, 1, 2), medium,
        ends=("free", "free", "symmetric", "free"),
    )  # fmt: skip
    # One face held symmetric: bending across it is left out, bending along z remains.
    scale = math.sqrt(E * h**2 / 12 / rho) / (2 * np.pi * L**2)
    wanted = np.array([4.730041, 7.853205, 10.995608, 14.137165]) ** 2 * scale
    found = frequencies(model, 0.9 * wanted[1], 4)
    assert found == pytest.approx(wanted, rel=3e-4)


def plate_frequencies(a: float, b: float, h: float, order: int, guess: float, count: int) -> Any:
    found = []
    for p in ("symmetric", "antisymmetric"):
        for q in ("symmetric", "antisymmetric"):
            model = solid(
                line(a / 2, 2, order), line(b / 2, 1, order + 2), line(h, 1, 3), STEEL,
                ends=("free", p, "free", q),
            )  # fmt: skip
            found.append(frequencies(model, guess, count))
    return np.sort(np.concatenate(found))


def test_free_square_plate_of_nafems_fv12() -> None:
    # Converged Kirchhoff values; t/a = 1/200 takes a few 1e-4 off them, more for higher modes.
    found = plate_frequencies(10.0, 10.0, 0.05, 6, 2.5, 3)
    wanted = [1.6217, 2.3595, 2.9223, 4.1902, 4.1902, 7.3560]
    for value in wanted:
        assert np.min(np.abs(found / value - 1)) < 2e-3
    assert found[:6] == pytest.approx(
        [1.6217, 2.3595, 2.9223, 4.1902, 4.1902, found[5]], rel=1.5e-3
    )


@pytest.mark.parametrize(
    ("ratio", "wanted"), [(1.5, (20.096, 21.413, 46.347)), (2.5, (21.454, 32.989, 59.629))]
)
def test_free_rectangular_plates(ratio: float, wanted: tuple[float, ...]) -> None:
    a, h = 1.0, 0.002
    D = 200e9 * h**3 / 12 / (1 - 0.09)
    scale = math.sqrt(D / (8000 * h)) / (2 * np.pi * a**2)
    found = plate_frequencies(a, a / ratio, h, 6, 30 * scale, 3) / scale
    assert found[:3] == pytest.approx(wanted, rel=1.5e-3)


def pzt_5a() -> Medium:
    constants = PiezoConstants(
        16.4e-12, -5.74e-12, -7.22e-12, 18.8e-12, 47.5e-12, 44.3e-12,
        -171e-12, 374e-12, 584e-12, 916.0, 830.0,
    )  # fmt: skip
    # The clamped permittivity that belongs to a free one of 1700.
    free = constants.free_permittivity_matrix[2, 2] / VACUUM
    permittivity = constants.permittivity_matrix.copy()
    permittivity[2, 2] += (1700.0 - free) * VACUUM
    return Medium("PZT-5A", constants.stiffness_matrix, 7750.0, 0, constants.stress_matrix,
                  permittivity)  # fmt: skip


def test_k31_bar_has_the_resonance_and_antiresonance_of_one_dimensional_theory() -> None:
    # 20 mm long, 0.3 × 0.3 mm: lateral inertia takes less than 1e-5.
    width = 0.3e-3
    model = solid(
        line(10e-3, 3, 5), line(width, 1, 3), line(width, 1, 3), pzt_5a(),
        electrodes=(ModelElectrode(3, 0),), ends=("free", "symmetric", "free", "free"),
    )  # fmt: skip
    short = frequencies(model, 70e3, 1)[0]
    opened = frequencies(model, 72e3, 1, np.ones((1, 1)))[0]
    assert short == pytest.approx(70124.1, rel=1e-4)
    assert opened == pytest.approx(73747.4, rel=1e-4)
    ratio = opened / short
    K = np.pi / 2 * ratio * np.tan(np.pi / 2 * (ratio - 1))
    assert np.sqrt(K / (1 + K)) == pytest.approx(0.3442, rel=2e-3)


def test_pvdf_bimorph_cantilever_bends_as_published() -> None:
    # w = 3 e31 V x² / (2 E t²), two layers of opposite poling, no Poisson contraction.
    E, t, e31 = 2e9, 1e-3, 0.046
    e = np.zeros((3, 6))
    e[2, 0] = e31
    layers = [
        Medium(name, isotropic_stiffness(E, 0.0), 1800.0, 0, sign * e, 12 * VACUUM * np.eye(3))
        for name, sign in (("lower", 1.0), ("upper", 1.0))
    ]
    x, y = line(0.1, 6, 4), line(0.005, 1, 2)
    z = LineMesh((-t / 2, 0.0, t / 2), (3, 3))
    shape = (6, 1, 2)
    medium = np.broadcast_to(np.array([0, 1]), shape).copy()
    model = BoxModel(
        x, y, z, tuple(layers), medium, medium.copy(),
        (ModelElectrode(0, 3), ModelElectrode(6, 3)), ends=("clamped", "free", "free", "free"),
    )  # fmt: skip
    slabs = Slabs(model)
    G, _ = slabs.electrode_columns
    # Half a volt on either outer face against the middle: a field V/t in opposite directions.
    u = SlabFactor(slabs, 0.0).solve(-(G @ np.array([0.5, 0.5]))[:, None])[:, 0]
    w = slabs.grid(u)[:, 0, 3, 2]
    for position, micrometre in ((0.02, 0.0138), (0.04, 0.0552), (0.06, 0.1242), (0.08, 0.2208),
                                 (0.1, 0.345)):  # fmt: skip
        found = abs(float(x.interpolation(np.array([position]))[0] @ w)) * 1e6
        # The bimorph's own field stiffens it by e31²/(ε E) and the clamp by its width: 1 %.
        assert found == pytest.approx(micrometre, rel=1.5e-2)


PRINTED_E31 = (-1.3881, 4.8710, 3.5703)
FROM_D31 = (-6.1274, 21.5017, 15.7602)


def monomorph_on_a_uniform_mesh(
    strip: int, across: int, stress: tuple[float, float, float] = PRINTED_E31
) -> BoxModel:
    """The reference quadratic mesh of 7 strips: elements per strip, along y; one in z each.

    `stress` is e31, e33 and e15 (C/m²)."""
    edges = [0.0]
    inside = []
    for k in range(7):
        edges += [0.012 * k + 0.011 * (i + 1) / strip for i in range(strip)]
        inside += [k] * strip
        if k < 6:
            edges.append(0.012 * (k + 1))
            inside.append(-1)
    half = int(np.searchsorted(edges, 0.0415 - 1e-9))
    x = LineMesh(tuple(edges[: half + 1]), (2,) * half)
    y = line(0.0245, across // 2, 2)
    z = LineMesh((-1e-3, 0.0, 2e-3), (2, 2))
    shape = (half, across // 2, 2)
    medium, ceramic = np.zeros(shape, dtype=int), np.full(shape, -1)
    covered = np.array(inside[:half]) >= 0
    medium[:, :, 0] = np.where(covered, 1, -1)[:, None]
    ceramic[:, :, 0] = np.array(inside[:half])[:, None]
    c = {"s11": 16.0768, "s12": -4.6574, "s13": -8.2333, "s33": 20.1690, "s44": 42.3842}
    s = np.zeros((6, 6))
    s[:2, :2] = [[c["s11"], c["s12"]], [c["s12"], c["s11"]]]
    s[:2, 2] = s[2, :2] = c["s13"]
    s[2, 2], s[3, 3], s[4, 4], s[5, 5] = c["s33"], c["s44"], c["s44"], 41.5073
    e = np.zeros((3, 6))
    e31, e33, e15 = stress
    e[2, :3], e[1, 3], e[0, 4] = [e31, e31, e33], e15, e15
    media = (
        Medium("CuBe", isotropic_stiffness(123e9, 0.3), 8250.0),
        Medium("PZT", np.linalg.inv(s * 1e-12), 7700.0, 0, -e,
               VACUUM * np.diag([1666.84, 1666.84, 1381.80])),
    )  # fmt: skip
    return BoxModel(
        x, y, z, media, medium, ceramic, tuple(ModelElectrode(0, 2) for _ in range(4)),
        ("free", "symmetric", "free", "symmetric"),
    )  # fmt: skip


@pytest.mark.parametrize(("strip", "across", "wanted"), [(2, 8, 34640.12), (4, 12, 33805.86)])
def test_quadratic_meshes_give_what_three_other_codes_give(
    strip: int, across: int, wanted: float
) -> None:
    # scikit-fem, NGSolve and SfePy agree on these (PLATES.md), rounded to 0.01 Hz.
    found = frequencies(monomorph_on_a_uniform_mesh(strip, across), wanted * 1.0003, 1)
    assert found[0] == pytest.approx(wanted, abs=0.05)


@pytest.mark.slow
def test_p_convergence_is_exponential_on_a_smooth_problem() -> None:
    def lowest(order: int) -> float:
        model = solid(
            line(0.02, 1, order), line(0.01, 1, order), line(0.004, 1, order), STEEL,
            ends=("free", "symmetric", "free", "symmetric"),
        )  # fmt: skip
        return float(frequencies(model, 40e3, 1)[0])

    exact = lowest(10)
    errors = [lowest(order) / exact - 1 for order in (3, 5, 7)]
    # From above, and each two orders gain at least a factor of eight.
    assert all(error > 0 for error in errors)
    assert errors[0] / errors[1] > 8
    assert errors[1] / errors[2] > 8
