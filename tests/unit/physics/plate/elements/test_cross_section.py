"""The matrices of a slice: the energies of fields on it, its electrodes, sides and springs."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from squeezefilm.physics.plate.elements.box_model import (
    POTENTIAL_UNIT,
    BoxModel,
    EndCondition,
    Foundation,
    Medium,
    ModelElectrode,
)
from squeezefilm.physics.plate.elements.cross_section import (
    CrossSection,
    code_parts,
    cross_section,
    potential_base,
)
from squeezefilm.physics.plate.elements.lobatto import LineMesh

X = LineMesh((0.0, 1.0, 2.0), (2, 2))
Y = LineMesh((0.0, 0.6, 1.0), (3, 2))
Z = LineMesh((0.0, 0.1, 0.3), (2, 3))
RNG = np.random.default_rng(7)


def anyhow(size: int, scale: float) -> np.ndarray:
    A = RNG.normal(size=(size, size))
    return (A @ A.T / size + np.eye(size)) * scale


# As little symmetry as a material can have.
CASE = Medium("case", anyhow(6, 1e11), 3000.0)
CERAMIC = Medium(
    "ceramic", anyhow(6, 8e10), 7000.0, 0.0, RNG.normal(size=(3, 6)) * 10, anyhow(3, 1e-8)
)
MEDIA = (CASE, CERAMIC)
# Below the case, above it a ceramic on each y element: numbers 0 and 1. At x element 1 there is
# no cell at all under the second, and only the case under the first.
MEDIUM = np.array([[[0, 1], [0, 1]], [[0, -1], [-1, -1]]])
NUMBER = np.array([[[-1, 0], [-1, 1]], [[-1, -1], [-1, -1]]])
TOP, BOND = 5, 2
MODEL = BoxModel(
    X, Y, Z, MEDIA, MEDIUM, NUMBER, (ModelElectrode(TOP, BOND), ModelElectrode(TOP, BOND))
)


def shapes(mesh: LineMesh, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values and slopes of all functions of a line at points, the slopes by differences."""
    step = 1e-6
    slope = mesh.interpolation(points + step, hierarchic=True) - mesh.interpolation(
        points - step, hierarchic=True
    )
    return mesh.interpolation(points, hierarchic=True), slope / (2 * step)


def energy(
    model: BoxModel,
    section: CrossSection,
    element: int,
    along: np.ndarray,
    here: np.ndarray,
    volts: tuple[float, ...] = (),
) -> tuple[float, float]:
    """Twice the energy a length of the field N = `here` with N′ = `along`, and ∫ρ u² of `here`,
    by quadrature over the cells."""
    component, iy, iz = code_parts(model, section.codes)
    nodes_y, nodes_z = model.y.nodes.size, model.z.nodes.size
    ceramics = max(len(model.electrodes), 1)
    total = inertia = 0.0
    points, weights = np.polynomial.legendre.leggauss(6)
    for j, k in np.ndindex(model.y.elements, model.z.elements):
        medium = model.medium[element, j, k]
        if medium < 0:
            continue
        number = model.ceramic[element, j, k]
        owned = np.where(
            component == 3, (section.codes - potential_base(model)) % ceramics == number, True
        )
        fields = np.zeros((2, 4, nodes_y, nodes_z))
        for field, vector in zip(fields, (along, here), strict=True):
            field[component[owned], iy[owned], iz[owned]] = vector[owned]
        if number >= 0 and volts:
            plane = model.electrodes[number].driven_plane
            ends = model.y.function_orders == 1
            fields[1, 3, ends, plane] = volts[number] / POTENTIAL_UNIT
        sizes = [(m.edges[e + 1] - m.edges[e], m.edges[e]) for m, e in ((model.y, j), (model.z, k))]
        (hy, y0), (hz, z0) = sizes
        Ny, Dy = shapes(model.y, y0 + hy * (points + 1) / 2)
        Nz, Dz = shapes(model.z, z0 + hz * (points + 1) / 2)
        area = np.outer(weights, weights) * hy * hz / 4
        one = "ayz,py,qz->apq"
        g = np.stack(
            [
                np.einsum(one, fields[0], Ny, Nz),
                np.einsum(one, fields[1], Dy, Nz),
                np.einsum(one, fields[1], Ny, Dz),
            ]
        )
        u = np.einsum(one, fields[1], Ny, Nz)
        S = np.stack(
            [
                g[0, 0], g[1, 1], g[2, 2], g[1, 2] + g[2, 1], g[0, 2] + g[2, 0],
                g[0, 1] + g[1, 0],
            ]
        )  # fmt: skip
        material = model.media[medium]
        density = np.einsum("apq,ab,bpq->pq", S, material.stiffness, S)
        if material.stress_matrix is not None and material.permittivity is not None:
            E = g[:, 3] * POTENTIAL_UNIT
            density += 2 * np.einsum("dpq,da,apq->pq", E, material.stress_matrix, S)
            density -= np.einsum("dpq,de,epq->pq", E, material.permittivity, E)
        total += float(np.sum(density * area))
        inertia += material.density * float(np.sum(area * np.sum(u[:3] ** 2, axis=0)))
    return total, inertia


def by_matrices(
    section: CrossSection, along: np.ndarray, here: np.ndarray, volts: Any = ()
) -> tuple[float, float]:
    total = along @ section.P2 @ along + 2 * along @ section.P1 @ here + here @ section.P0 @ here
    if len(volts):
        v = np.asarray(volts)
        total += 2 * (here @ section.g0 + along @ section.g1) @ v + v @ section.c0 @ v
    return float(total), float(here @ section.R @ here)


@pytest.mark.parametrize("element", [0, 1])
@pytest.mark.parametrize("trunk", [np.inf, 1.0])
def test_any_field_has_the_energy_and_inertia_of_its_medium(element: int, trunk: float) -> None:
    model = dataclasses.replace(MODEL, trunk=trunk)
    section = cross_section(model, element)
    size = section.codes.size
    volts = (2.0, -0.7) if element == 0 else ()
    assert section.electrodes == ((0, 1) if element == 0 else ())
    for _ in range(2):
        along, here = RNG.normal(size=(2, size))
        exact = energy(model, section, element, along, here, volts)
        assert by_matrices(section, along, here, volts) == pytest.approx(exact, rel=1e-6)
    for matrix in (section.P2, section.P0, section.R):
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-12 * np.abs(matrix).max())


def test_the_unknowns_are_those_of_the_cells_that_are_there() -> None:
    whole = cross_section(MODEL, 0)
    component, iy, iz = code_parts(MODEL, whole.codes)
    assert potential_base(MODEL) == 4 * 6 * 6
    assert np.array_equal(whole.codes, np.unique(whole.codes))
    for a in range(3):
        assert np.sum(component == a) == 36
    # A potential lives between the planes of its ceramic: grounded below, driven above.
    electric = component == 3
    assert set(iz[electric]) == {3, 4}
    numbers = (whole.codes[electric] - potential_base(MODEL)) % 2
    assert set(iy[electric][numbers == 0]) == {0, 1, 2, 3}
    assert set(iy[electric][numbers == 1]) == {3, 4, 5}
    bare = cross_section(MODEL, 1)
    component, iy, iz = code_parts(MODEL, bare.codes)
    # One element of the case: its four functions along y and three across.
    assert (bare.codes.size, iy.max(), iz.max(), component.max()) == (3 * 4 * 3, 3, 2, 2)
    assert bare.g0.shape == bare.g1.shape == (36, 0)


def plain(ends: tuple[EndCondition, ...] = ("free",) * 4, **more: Any) -> BoxModel:
    """One ceramic alone, 2 wide and 0.5 high, grounded below."""
    line = LineMesh((0.0, 1.0, 2.0), (2, 2)), LineMesh((0.0, 0.5), (2,))
    return BoxModel(
        X, *line, (CERAMIC,), np.zeros((2, 2, 1), int), np.zeros((2, 2, 1), int),
        (ModelElectrode(2, 0),), ends, **more,
    )  # fmt: skip


def stretched(model: BoxModel, section: CrossSection, component: int, by: str) -> np.ndarray:
    """The field that is 1 in one component, or grows along y."""
    a, iy, iz = code_parts(model, section.codes)
    ends = (model.y.function_orders[iy] == 1) & (model.z.function_orders[iz] == 1)
    value = np.ones(a.size) if by == "1" else model.y.nodes[iy]
    return np.where((a == component) & ends, value, 0.0)


def test_an_electrode_has_its_capacitance_and_pulls_with_its_constants() -> None:
    model = plain()
    section = cross_section(model, 0)
    e, epsilon = CERAMIC.stress_matrix, CERAMIC.permittivity
    assert e is not None
    assert epsilon is not None
    assert section.c0 == pytest.approx(np.array([[-epsilon[2, 2] * 2 / 0.5]]))
    # A volt over 0.5: a field of 2 all through, over an area of 2 × 0.5 a length.
    along_y = stretched(model, section, 1, "y")
    assert along_y @ section.g0 == pytest.approx([2 * e[2, 1]])
    assert stretched(model, section, 0, "1") @ section.g1 == pytest.approx([2 * e[2, 0]])
    assert stretched(model, section, 0, "1") @ section.g0 == pytest.approx([0], abs=1e-9)


def test_weights_scale_elastic_and_electric_constants_apart() -> None:
    model, full = plain(), cross_section(plain(), 0)
    half = cross_section(model, 0, lambda medium: (0.5, 1.0))
    dry = cross_section(model, 0, lambda medium: (1.0, 0.0))
    mechanical = code_parts(model, full.codes)[0] < 3
    solid = np.ix_(mechanical, mechanical)
    for name in ("P0", "P1", "P2"):
        whole, part = getattr(full, name), getattr(half, name)
        assert part[solid] == pytest.approx(whole[solid] / 2, rel=1e-12, abs=1e-3)
        assert np.array_equal(getattr(dry, name)[solid], whole[solid])
        assert not getattr(dry, name)[~mechanical].any()
    assert half.g0 == pytest.approx(full.g0, rel=1e-9, abs=1e-9)
    assert not dry.g0.any()
    assert not dry.c0.any()


@pytest.mark.parametrize("side", [2, 3])
@pytest.mark.parametrize(
    ("condition", "left"),
    [("free", [0, 1, 2, 3]), ("clamped", [3]), ("symmetric", [0, 2, 3]), ("antisymmetric", [1])],
)
def test_sides_hold_what_their_condition_says(
    side: int, condition: EndCondition, left: list[int]
) -> None:
    ends: list[EndCondition] = ["free"] * 4
    ends[side] = condition
    model = plain(tuple(ends))
    section = cross_section(model, 0)
    component, iy, _ = code_parts(model, section.codes)
    at, other = (0, 4) if side == 2 else (4, 0)
    assert sorted(set(component[iy == at])) == left
    assert sorted(set(component[iy == other])) == [0, 1, 2, 3]


def test_springs_stand_under_their_own_elements() -> None:
    springs = (
        Foundation((0, 1), (1, 2), 0, (3.0, 5.0, 7.0)),
        Foundation((0, 2), (0, 2), 2, (0.0, 0.0, 11.0)),
    )
    model, bare = plain(foundations=springs), plain()

    def added(element: int, **more: Any) -> list[float]:
        on, off = cross_section(model, element, **more), cross_section(bare, element)
        gain = (on.P0 - off.P0) / 1.0
        assert np.array_equal(on.P2, off.P2)
        return [float(u @ gain @ u) for u in (stretched(bare, off, a, "1") for a in range(3))]

    # The first is 1 wide and under the first x element alone, the second 2 wide.
    assert added(0) == pytest.approx([3.0, 5.0, 7.0 + 22.0], abs=1e-2)
    assert added(1) == pytest.approx([0.0, 0.0, 22.0], abs=1e-2)
    assert added(0, springs=1e6) == pytest.approx([3e6, 5e6, 29e6], rel=1e-6)
    assert added(0, springs=(1e6, 2e6)) == pytest.approx([3e6, 5e6, 51e6], rel=1e-6)
    # On their planes and only there: by the place of what they hold.
    on, off = (cross_section(m, 0, springs=1e6) if m is model else cross_section(m, 0)
               for m in (model, bare))  # fmt: skip
    a, iy, iz = code_parts(bare, off.codes)
    change = np.diag(on.P0 - off.P0)
    moved = change > 1e4
    assert set(iz[moved & (a < 2)]) == {0}
    assert set(iz[moved & (a == 2)]) == {0, 2}
    assert set(iy[moved & (a < 2)]) == {2, 3, 4}
    assert set(iy[moved & (iz == 2)]) == {0, 1, 2, 3, 4}
