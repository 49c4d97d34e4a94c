"""The stiffness and mass of one Fourier harmonic of a ring: high-order elements in (r, z), gathered
into sparse matrices, and the modes of these.

u_r = U cos mθ, u_θ = V sin mθ, u_z = W cos mθ, φ = Φ cos mθ; for m = 0 V is torsion on its own.
Strains in cylindrical coordinates after any text on elasticity (e.g. Timoshenko and Goodier,
eq 178); the weak form of linear piezoelectricity after Allik and Hughes 1970,
10.1002/nme.1620020202.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError
from squeezefilm.core.hard_limits import RING_ELEMENTS, require_within
from squeezefilm.physics.plate.elements.box_model import require_aspect
from squeezefilm.physics.plate.elements.lobatto import apart, gauss_points, lagrange, lobatto_nodes
from squeezefilm.physics.plate.ring.section import AnnularSection, RingLayer

Entries = tuple[si.IntArray, si.IntArray, si.FloatArray]
"""Rows, columns and values of entries of a matrix."""


def entries(rows: si.IntArray, block: si.FloatArray) -> Entries:
    """An element's matrix as entries; unknowns numbered −1 are held and left out."""
    keep = rows >= 0
    rows, block = rows[keep], block[np.ix_(keep, keep)]
    return np.repeat(rows, rows.size), np.tile(rows, rows.size), block.ravel()


def gathered(parts: list[Entries], size: int) -> sparse.csc_matrix:
    """The sum of all elements' entries, shape (size, size)."""
    row, column, values = (np.concatenate([part[k] for part in parts]) for k in range(3))
    return sparse.coo_matrix((values, (row, column)), shape=(size, size)).tocsc()


_SAME = 5e-10
# Radius over thickness: a plain disc of 500 still has its lowest frequency to 1e-3.
_THINNEST_BODY, _THINNEST_LAYER = 500.0, 20000.0
_RADIAL, _HOOP, _AXIAL, _POTENTIAL = range(4)


CORNER_GRADING = 0.15
"""The ratio in which elements shrink towards a singular corner; near the optimum of hp methods
(Babuška and Guo 1986: (√2 − 1)²)."""


@dataclass(frozen=True, eq=False)
class HarmonicSystem:
    """The matrices of one harmonic: K u + G φ = ω² M u + f V and Gᵀ u − D φ = 0, shorted.

    `matrix` is the whole of [[K, G], [Gᵀ, −D]], shape (n + p, n + p), `mass` is (n, n); the first
    n unknowns are displacements. `force` (n,) is what one volt makes where the polarity is +1 all
    round (angular integral left out). `r`, `z` are the nodes; `unknown` (nodes, 4) is the row of
    each field at each node, −1 where it is held, and `sign` what to multiply it by.
    """

    harmonic: int
    degree: int
    matrix: sparse.csc_matrix
    mass: sparse.csc_matrix
    force: si.FloatArray
    r: si.FloatArray
    z: si.FloatArray
    unknown: np.ndarray
    sign: si.FloatArray
    layer_stiffness: tuple[sparse.csc_matrix, ...]

    @property
    def displacements(self) -> int:
        """n, the number of mechanical unknowns."""
        return self.force.size

    def field(self, vector: si.FloatArray) -> si.FloatArray:
        """U, V, W at the nodes, shape (nodes, 3), of a vector of mechanical unknowns."""
        padded = np.append(vector[: self.displacements], 0.0)
        rows = self.unknown[:, :3]
        return padded[np.where(rows < 0, -1, rows)] * self.sign[:, :3]


@dataclass(frozen=True, eq=False)
class RingMesh:
    """Element edges of a section and the layer that fills each cell (−1 for none)."""

    r_edges: si.FloatArray
    z_edges: si.FloatArray
    layer: np.ndarray


def ring_mesh(section: AnnularSection) -> RingMesh:
    """Edges on every layer's edges, graded towards the corners where layers meet the surface.

    Elements are no longer than 3 thicknesses or 1/6 of the radial extent, whichever is more.
    Raises `OutOfRangeError` for layers so thin that elements lose their digits.
    """
    layers = section.layers
    radius = max(layer.outer_radius for layer in layers)
    thinnest = min(layer.thickness for layer in layers)
    require_aspect("body", section.thickness, "radius", radius, _THINNEST_BODY)
    require_aspect("layer", thinnest, "radius", radius, _THINNEST_LAYER)
    r_breaks = apart((x for a in layers for x in (a.inner_radius, a.outer_radius)), _SAME)
    z_breaks = apart((x for a in layers for x in (a.bottom, a.top)), _SAME)
    longest = max(3 * section.thickness, (r_breaks[-1] - r_breaks[0]) / 6)
    # Only where two layers meet is there a singular corner worth grading for; the free corners of
    # one homogeneous layer have smooth enough fields.
    single = len(layers) == 1
    singular_r = [] if single else [x for x in r_breaks if x > 0]
    singular_z = [] if single else z_breaks[1:-1]
    shortest = 0.02 * section.thickness
    r_edges = graded_edges(r_breaks, longest, singular_r, shortest=shortest)
    z_edges = graded_edges(z_breaks, np.inf, singular_z, shortest=shortest)
    require_within(RING_ELEMENTS, (r_edges.size - 1) * (z_edges.size - 1))
    rm, zm = (r_edges[1:] + r_edges[:-1]) / 2, (z_edges[1:] + z_edges[:-1]) / 2
    fill = np.full((rm.size, zm.size), -1)
    for index, a in enumerate(layers):
        inside_r = (rm > a.inner_radius) & (rm < a.outer_radius)
        fill[np.ix_(inside_r, (zm > a.bottom) & (zm < a.top))] = index
    return RingMesh(r_edges, z_edges, fill)


def node_coordinates(edges: si.FloatArray, degree: int) -> si.FloatArray:
    """The nodes of a row of elements, shape ((len(edges) − 1) × degree + 1,), shared at edges."""
    reference = (lobatto_nodes(degree) + 1) / 2
    inner = edges[:-1, None] + np.diff(edges)[:, None] * reference[None, :-1]
    return np.append(inner.ravel(), edges[-1])


def graded_edges(
    breaks: Sequence[float],
    longest: float,
    singular: Sequence[float] = (),
    shortest: float = 0.0,
) -> si.FloatArray:
    """Element edges that contain all `breaks`, no element longer than `longest`.

    Next to each value in `singular` an element is cut off that is shorter by `CORNER_GRADING`, if
    that is above `shortest`.
    """
    edges = [breaks[0]]
    for left, right in itertools.pairwise(breaks):
        span = right - left
        cuts = np.linspace(0.0, span, max(1, int(np.ceil(span / longest - 1e-9))) + 1)
        small = cuts[1] * CORNER_GRADING
        if small > shortest and _in(left, singular):
            cuts = np.append(cuts, small)
        # The last element as the rounded cut leaves it: at a tie with `shortest`, `small` itself
        # could decide otherwise, and the mesh would no longer be the one results were made on.
        if span - (span - small) > shortest and _in(right, singular):
            cuts = np.append(cuts, span - small)
        edges += [left + cut for cut in np.unique(cuts)[1:-1]]
        edges.append(right)
    return np.array(edges)


def _in(value: float, values: Sequence[float]) -> bool:
    return any(abs(value - other) <= 1e-9 for other in values)


def harmonic_system(
    section: AnnularSection, harmonic: int, degree: int, mesh: RingMesh | None = None
) -> HarmonicSystem:
    """Assemble one harmonic at one polynomial degree.

    The electrodes are held at 0 V; what one volt does stands in `force`. Sectors of alternate
    poling are equivalent to uniform poling with the potential's sign turned along, but for the
    fringes at their ends (a ceramic thickness each), which are neglected.
    """
    mesh = mesh or ring_mesh(section)
    r = node_coordinates(mesh.r_edges, degree)
    z = node_coordinates(mesh.z_edges, degree)
    unknown, sign, count, potentials, used = _unknowns(section, mesh, harmonic, degree, r, z)
    total = count + potentials
    local = np.arange(degree + 1)
    nodes = local.size**2
    triples: list[Entries] = []
    masses: list[Entries] = []
    per_layer: list[list[Entries]] = [[] for _ in section.layers]
    force = np.zeros(total + 1)
    angular = 2 * np.pi if harmonic == 0 else np.pi
    for i, j in zip(*np.nonzero(mesh.layer >= 0), strict=True):
        layer = section.layers[mesh.layer[i, j]]
        N, B, area = _element(harmonic, degree, mesh.r_edges[i : i + 2], mesh.z_edges[j : j + 2])
        law = _constitutive(layer)
        stress = (law @ B) * (angular * area)[:, None, None]
        stiff = B.reshape(-1, B.shape[2]).T @ stress.reshape(-1, B.shape[2])
        inertia = angular * layer.solid.density * (N.T * area) @ N
        grid = (i * degree + local)[:, None] * z.size + (j * degree + local)[None, :]
        rows = unknown[grid.ravel()].T.ravel()
        signs = sign[grid.ravel()].T.ravel()
        stiff *= signs[:, None] * signs[None, :]
        triples.append(entries(rows, stiff))
        mechanical = np.where(rows < count, rows, -1)
        per_layer[mesh.layer[i, j]].append(entries(mechanical, stiff))
        whole = np.kron(np.eye(3), inertia) * np.outer(signs[: 3 * nodes], signs[: 3 * nodes])
        masses.append(entries(rows[: 3 * nodes], whole))
        if layer.solid.piezoelectric:
            # One volt between the faces: E_z = 1/h, uniform, so that no charge is left inside.
            field = 1.0 / layer.thickness
            # law[:6, 6:] is −eᵀ: T = c S − eᵀ E.
            pull = (law[:6, 8] * field) @ np.tensordot(area, B[:, :6], axes=1) * signs
            np.add.at(force, np.where(rows < count, rows, total), -pull)
    matrix = gathered(triples, total)
    mass = gathered(masses, count)
    return HarmonicSystem(
        harmonic=harmonic,
        degree=degree,
        matrix=matrix,
        mass=mass,
        force=force[:count],
        r=np.repeat(r, z.size)[used],
        z=np.tile(z, r.size)[used],
        unknown=unknown[used],
        sign=sign[used],
        layer_stiffness=tuple(gathered(part, count) for part in per_layer),
    )


def _element(
    m: int, degree: int, r: si.FloatArray, z: si.FloatArray
) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray]:
    """Matrices of the cell between two radii and two heights (m), at its Gauss points: N (points,
    nodes), B as `_strains` has it, and the area with the radius in it, r dr dz (points,)."""
    points, weights = gauss_points(degree + 3)
    value, slope = lagrange(degree, tuple(points))
    half_r, half_z = (r[1] - r[0]) / 2, (z[1] - z[0]) / 2
    radius = (r[0] + r[1]) / 2 + half_r * points
    shape = np.einsum("ga,hb->ghab", value, value)
    along_r = np.einsum("ga,hb->ghab", slope, value) / half_r
    along_z = np.einsum("ga,hb->ghab", value, slope) / half_z
    over_r = shape / radius[:, None, None, None]
    flat = (-1, (degree + 1) ** 2)
    B = _strains(m, *(x.reshape(flat) for x in (along_r, along_z, over_r)))
    area = (np.outer(weights * radius * half_r, weights) * half_z).ravel()
    return shape.reshape(flat), B, area


def _strains(
    m: int, along_r: si.FloatArray, along_z: si.FloatArray, over_r: si.FloatArray
) -> si.FloatArray:
    """B (points, 9, 4 × nodes): six strains, then the field E = −grad φ."""
    points, nodes = along_r.shape
    B = np.zeros((points, 9, 4, nodes))
    B[:, 0, _RADIAL] = along_r
    B[:, 1, _RADIAL] = over_r
    B[:, 1, _HOOP] = m * over_r
    B[:, 2, _AXIAL] = along_z
    B[:, 3, _HOOP] = along_z
    B[:, 3, _AXIAL] = -m * over_r
    B[:, 4, _RADIAL] = along_z
    B[:, 4, _AXIAL] = along_r
    B[:, 5, _RADIAL] = -m * over_r
    B[:, 5, _HOOP] = along_r - over_r
    B[:, 6, _POTENTIAL] = -along_r
    B[:, 7, _POTENTIAL] = m * over_r
    B[:, 8, _POTENTIAL] = -along_z
    return B.reshape(points, 9, 4 * nodes)


def _constitutive(layer: RingLayer) -> si.FloatArray:
    """[[c, −eᵀ], [−e, −ε]] (9, 9): the electric enthalpy is half of its quadratic form."""
    law = np.zeros((9, 9))
    solid = layer.solid
    law[:6, :6] = solid.stiffness
    if solid.stress_matrix is not None and solid.permittivity is not None:
        law[:6, :6] = (solid.stiffness + solid.stiffness.T) / 2
        law[6:, :6] = -solid.stress_matrix
        law[:6, 6:] = -solid.stress_matrix.T
        law[6:, 6:] = -solid.permittivity
    return law


def _unknowns(
    section: AnnularSection,
    mesh: RingMesh,
    m: int,
    degree: int,
    r: si.FloatArray,
    z: si.FloatArray,
) -> tuple[np.ndarray, si.FloatArray, int, int, np.ndarray]:
    """Number the fields at each node; hold those that the axis or an electrode holds."""
    used = np.zeros((r.size, z.size), dtype=bool)
    electric = np.zeros_like(used)
    held = np.zeros_like(used)
    for i, j in zip(*np.nonzero(mesh.layer >= 0), strict=True):
        cell = np.s_[i * degree : (i + 1) * degree + 1, j * degree : (j + 1) * degree + 1]
        used[cell] = True
        layer = section.layers[mesh.layer[i, j]]
        if layer.solid.piezoelectric:
            electric[cell] = True
            faces = (np.abs(z - layer.bottom) <= _SAME) | (np.abs(z - layer.top) <= _SAME)
            held[cell] |= faces[None, j * degree : (j + 1) * degree + 1]
    free = np.repeat(used.ravel()[:, None], 4, axis=1)
    free[:, _POTENTIAL] = (electric & ~held).ravel()
    axis = np.repeat(r <= _SAME, z.size)
    tied = np.zeros_like(free)
    if m != 1:
        free[axis, _RADIAL] = free[axis, _HOOP] = False
    else:
        tied[axis, _HOOP] = free[axis, _HOOP]
        free[axis, _HOOP] = False
    if m != 0:
        free[axis, _AXIAL] = free[axis, _POTENTIAL] = False
    unknown = np.full(free.shape, -1)
    mechanical = free.copy()
    mechanical[:, _POTENTIAL] = False
    count = int(mechanical.sum())
    unknown[mechanical] = np.arange(count)
    potentials = int(free[:, _POTENTIAL].sum())
    unknown[free[:, _POTENTIAL], _POTENTIAL] = count + np.arange(potentials)
    sign = np.ones(free.shape)
    # A rigid shift has u_r = cos θ and u_θ = −sin θ: on the axis V is −U.
    at = tied[:, _HOOP]
    unknown[at, _HOOP] = unknown[at, _RADIAL]
    sign[at, _HOOP] = -1.0
    return unknown, sign, count, potentials, used.ravel()


def shift_near(system: HarmonicSystem, near: si.Hertz) -> float:
    """The shift of ω² for modes near a frequency (Hz), kept off rigid-body modes at zero."""
    scale = abs(system.matrix.diagonal()[: system.displacements] / system.mass.diagonal()).min()
    return (2 * np.pi * near) ** 2 * (1 + 1e-7) - 1e-7 * float(scale)


def shifted_inverse(system: HarmonicSystem, shift: float) -> LinearOperator:
    """(K − `shift` M)⁻¹; unknowns of the matrix beyond those of the mass are potentials, which
    have none and carry no load."""
    n, size = system.displacements, system.matrix.shape[0]
    inertia = system.mass.tocoo()
    padded_mass = sparse.coo_matrix((inertia.data, (inertia.row, inertia.col)), shape=(size, size))
    factors = splu(
        (system.matrix - shift * padded_mass).tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    padded = np.zeros(size)

    def solve(b: si.FloatArray) -> si.FloatArray:
        padded[:n] = np.ravel(b)
        answer: si.FloatArray = factors.solve(padded)[:n]
        return answer

    return LinearOperator((n, n), matvec=solve, dtype=float)


def nearest_modes(
    system: HarmonicSystem, near: si.Hertz, count: int
) -> tuple[si.FloatArray, si.FloatArray]:
    """The `count` ω² nearest to a frequency (Hz), rising, and their vectors of unit modal mass.

    Raises `InputError` for as many modes as there are unknowns, `ConvergenceError`.
    """
    n, shift = system.displacements, shift_near(system, near)
    if count >= n:
        raise InputError(f"{count} modes were asked for of {n} unknowns; ask for fewer")
    try:
        squares, vectors = eigsh(
            system.mass,  # not used: OPinv holds the potential too
            k=count,
            M=system.mass,
            sigma=shift,
            OPinv=shifted_inverse(system, shift),
            v0=np.random.default_rng(1).standard_normal(n),
            tol=1e-11,
        )
    except (RuntimeError, ValueError) as error:  # ARPACK's and SuperLU's
        raise ConvergenceError(
            f"the modes of harmonic {system.harmonic} near {near:.6g} Hz did not converge "
            f"({error}); ask for fewer modes or another degree"
        ) from error
    order = np.argsort(squares)
    return squares[order], vectors[:, order]
