"""The elements of a shear plate: constant strains, rigid motions, drive, and mirror classes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

from squeezefilm.physics.plate.shear.elements import ShearSystem, make_axis, shear_system
from squeezefilm.physics.plate.shear.section import ShearLayout, ShearSection

RNG = np.random.default_rng(11)


def spd(size: int) -> np.ndarray:
    A = RNG.normal(size=(size, size))
    return np.asarray(A @ A.T + size * np.eye(size))


def section(stress: float = 0.0) -> ShearSection:
    """Any laminate: stiffness in all that couples, and a mass off its mid-plane."""
    law = spd(6)
    coupling = (law[:3, 3:] + law[3:, :3]) / 2
    return ShearSection(
        law[:3, :3], coupling, law[3:, 3:], 3.0, np.array([2.0, 0.3, 0.5]), stress, -0.25
    )


def isotropic(scale: float, stress: float = 0.0) -> ShearSection:
    """A laminate with mirror symmetry in its constants, coupled by an eccentric layer."""
    law = scale * np.array([[1, 0.3, 0], [0.3, 1, 0], [0, 0, 0.35]])
    inertia = scale * np.array([1.0, 0.05, 0.02])
    return ShearSection(law, 0.1 * law, 0.05 * law, 0.3 * scale, inertia, stress, -0.2)


TWO = (section(), section(1.7))
# Four cells; the second laminate in two of them, driven against each other.
WHOLE = ShearLayout(
    np.array([0.0, 0.7, 1.2]), np.array([0.0, 0.4, 1.0]), TWO, np.array([[0, 1], [1, 0]]),
    np.array([[0.0, 1.0], [-1.0, 0.0]]),
)  # fmt: skip
AREAS = np.outer([0.7, 0.5], [0.4, 0.6])

Field = Callable[[np.ndarray, np.ndarray], Any]


def vector(system: ShearSystem, *fields: Field) -> np.ndarray:
    """The unknowns of five fields u, v, w, a, b given as functions of x and y."""
    x, y = np.meshgrid(system.x.nodes, system.y.nodes, indexing="ij")
    out = np.zeros(system.force.size)
    for k, field in enumerate(fields):
        rows = system.unknown[:, :, k]
        out[rows[rows >= 0]] = (field(x, y) + 0 * x)[rows >= 0]
    return out


def test_cells_are_cut_and_short_elements_have_lower_degrees() -> None:
    axis = make_axis(np.array([0.0, 1.0, 1.2, 1.25]), 5, 0.5, halved=False)
    assert axis.edges == pytest.approx([0.0, 0.5, 1.0, 1.2, 1.25])
    assert axis.cell == (0, 0, 1, 2)
    # Half as long as the longest still has the full degree.
    assert axis.degrees == (5, 5, 4, 2)
    assert axis.first == (0, 5, 10, 14)
    assert axis.nodes.size == 17
    assert axis.nodes[list(axis.first)] == pytest.approx(axis.edges[:-1])
    assert axis.nodes[-3:] == pytest.approx([1.2, 1.225, 1.25])
    assert np.all(np.diff(axis.nodes) > 0)
    assert make_axis(np.array([0.0, 1.0 + 1e-12]), 3, 0.5, halved=False).cell == (0, 0)
    assert make_axis(np.array([0.0, 1.01]), 3, 0.5, halved=False).cell == (0, 0, 0)


def test_a_halved_axis_ends_in_the_middle() -> None:
    axis = make_axis(np.array([1.0, 2.0, 4.0, 5.0]), 2, 0.6, halved=True)
    assert axis.edges == pytest.approx([1.0, 1.5, 2.0, 2.5, 3.0])
    assert axis.cell == (0, 0, 1, 1)
    at_edge = make_axis(np.array([0.0, 1.0, 2.0]), 2, 2.0, halved=True)
    assert at_edge.edges == pytest.approx([0.0, 1.0])


STRAINS = RNG.normal(size=8)


def strained(strains: np.ndarray) -> list[Field]:
    """The fields of constant strains exx, eyy, exy, kxx, kyy, kxy and shears."""
    e, k, g = strains[:3], strains[3:6], strains[6:]
    return [
        lambda x, y: e[0] * x + 0.3 * e[2] * y,
        lambda x, y: e[1] * y + 0.7 * e[2] * x,
        lambda x, y: -(k[0] * x**2 + k[1] * y**2 + k[2] * x * y) / 2,
        lambda x, y: k[0] * x + k[2] * y / 2 + g[0],
        lambda x, y: k[1] * y + k[2] * x / 2 + g[1],
    ]


def test_constant_strains_have_the_energy_of_their_sections() -> None:
    system = shear_system(WHOLE, 3, 0.45, (0, 0))
    q = vector(system, *strained(STRAINS))
    energies = [STRAINS @ one.stiffness @ STRAINS for one in TWO]
    exact = np.sum(AREAS * np.array(energies)[WHOLE.section])
    assert q @ system.stiffness @ q == pytest.approx(exact, rel=1e-10)
    # One volt works on the sum of the strains at the ceramic's height.
    work = 1.7 * (STRAINS[0] + STRAINS[1] - 0.25 * (STRAINS[3] + STRAINS[4]))
    assert system.force @ q == pytest.approx(work * np.sum(AREAS * WHOLE.polarity), rel=1e-10)
    assert (system.stiffness - system.stiffness.T).max() == pytest.approx(0, abs=1e-9)


def test_rigid_motions_cost_nothing_and_have_the_mass_of_the_plate() -> None:
    system = shear_system(WHOLE, 3, 0.45, (0, 0))
    nothing: Field = lambda x, y: 0.0  # noqa: E731
    one: Field = lambda x, y: 1.0  # noqa: E731
    rigid = [
        (one, nothing, nothing, nothing, nothing),
        (nothing, one, nothing, nothing, nothing),
        (nothing, nothing, one, nothing, nothing),
        (nothing, nothing, lambda x, y: x, lambda x, y: -1.0, nothing),
        (nothing, nothing, lambda x, y: y, nothing, lambda x, y: -1.0),
        (lambda x, y: -y, lambda x, y: x, nothing, nothing, nothing),
    ]
    q = np.stack([vector(system, *fields) for fields in rigid], axis=1)
    assert np.abs(system.stiffness @ q).max() < 1e-10
    area, x1, x2 = 1.2, 1.2**2 / 2, 1.2**3 / 3
    mass = q.T @ system.mass @ q
    assert np.diag(mass)[:3] == pytest.approx([2 * area] * 3)
    # Tilting moves w by x, and by the rotation what lies off the mid-plane.
    assert mass[3, 3] == pytest.approx(2 * x2 + 0.5 * area)
    assert mass[4, 4] == pytest.approx(2 * area / 3 + 0.5 * area)
    assert mass[0, 3] == pytest.approx(-0.3 * area)
    assert mass[1, 4] == pytest.approx(-0.3 * area)
    assert mass[2, 3] == pytest.approx(2 * x1)
    assert mass[0, 4] == pytest.approx(0, abs=1e-12)
    assert mass[5, 5] == pytest.approx(2 * (x2 + area / 3))
    w = system.deflection(q[:, 3])
    assert w == pytest.approx(np.repeat(system.x.nodes[:, None], system.y.nodes.size, axis=1))


def mirrored_layout(polarity: list[list[float]]) -> ShearLayout:
    """Three cells along x, driven or bare."""
    driven = np.array([[int(cell != 0) for cell in row] for row in polarity])
    return ShearLayout(
        np.array([0.0, 0.4, 0.8, 1.2]), np.array([0.0, 1.0]),
        (isotropic(1.0), isotropic(2.5, 1.3)), driven, np.array(polarity),
    )  # fmt: skip


CENTRED = mirrored_layout([[0.0], [1.0], [0.0]])


def squares(system: ShearSystem) -> np.ndarray:
    return np.asarray(eigh(system.stiffness.toarray(), system.mass.toarray(), eigvals_only=True))


def test_the_four_classes_together_have_the_modes_of_the_whole() -> None:
    whole = squares(shear_system(CENTRED, 4, 0.4, (0, 0)))[6:18]
    # An element that a mirror line cuts is half as long, its degree the same: finer, not other.
    classes = [(p, q) for p in (1, -1) for q in (1, -1)]
    parts = [squares(shear_system(CENTRED, 4, 0.4, parity)) for parity in classes]
    found = np.sort(np.concatenate(parts))[6:18]
    assert found == pytest.approx(whole, rel=2e-3)
    halves = [squares(shear_system(CENTRED, 4, 0.4, (0, p))) for p in (1, -1)]
    assert np.sort(np.concatenate(halves))[6:18] == pytest.approx(whole, rel=2e-3)


@pytest.mark.parametrize(
    ("parity", "held_x", "held_y"),
    [
        ((1, 1), {0, 3}, {1, 4}),
        ((-1, -1), {1, 2, 4}, {0, 2, 3}),
        ((1, 0), {0, 3}, set()),
        ((0, -1), set(), {0, 2, 3}),
    ],
)
def test_a_mirror_line_holds_what_is_odd_there(
    parity: tuple[int, int], held_x: set[int], held_y: set[int]
) -> None:
    system = shear_system(CENTRED, 2, 0.4, parity)
    # Beside a corner, where both lines meet.
    assert {k for k in range(5) if system.unknown[-1, 1, k] < 0} == held_x
    assert {k for k in range(5) if system.unknown[1, -1, k] < 0} == held_y
    assert np.all(system.unknown[:-1, :-1] >= 0)
    free = np.sort(system.unknown[system.unknown >= 0])
    assert np.array_equal(free, np.arange(system.force.size))
    w = system.deflection(np.ones(system.force.size))
    assert np.all(w == (system.unknown[:, :, 2] >= 0))
    assert system.parity == parity


def test_a_class_has_the_energy_and_the_drive_of_all_its_images() -> None:
    # u odd and the rest even about both middles, w = const: strains exx, kxx and kyy of one sign.
    fields = strained(np.array([0.5, -0.2, 0.0, 0.7, 0.4, 0.0, 0.0, 0.0]))

    def centred(k: int) -> Field:
        return lambda x, y: fields[k](x - 0.6, y - 0.5)

    even = [centred(k) for k in range(5)]
    found = []
    for parity in ((0, 0), (1, 0), (0, 1), (1, 1)):
        system = shear_system(CENTRED, 3, 0.5, parity)
        q = vector(system, *even)
        found.append([q @ system.stiffness @ q, q @ system.mass @ q, system.force @ q])
    assert np.array(found[1:]) == pytest.approx(np.array(3 * [found[0]]), rel=1e-10)
    # Of a drive at one end the even half drives the even class, the odd half the odd one.
    one_end, both, against = ([[1.0], [0.0], [0.0]], [[0.5], [0.0], [0.5]], [[0.5], [0.0], [-0.5]])
    ends = [
        shear_system(mirrored_layout(polarity), 3, 0.5, (parity, 0)).force
        for polarity, parity in ((one_end, 1), (both, 1), (one_end, -1), (against, -1))
    ]
    assert np.abs(ends[0]).max() > 0.1
    assert ends[0] == pytest.approx(ends[1])
    assert ends[2] == pytest.approx(ends[3])
    odd_in_even = shear_system(mirrored_layout([[1.0], [0.0], [-1.0]]), 3, 0.5, (1, 0))
    assert not odd_in_even.force.any()
