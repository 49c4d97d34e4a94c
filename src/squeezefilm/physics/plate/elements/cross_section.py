"""A y–z slice of a box model, discretised: the matrices that every x element above it shares.

The stiffness of an x element of length h and order p over a slice is
    K = ∫N′N′ᵀ ⊗ P2 + ∫N′Nᵀ ⊗ P1 + ∫N N′ᵀ ⊗ P1ᵀ + ∫N Nᵀ ⊗ P0,     M = ∫N Nᵀ ⊗ R,
so slices are assembled once for each distinct pattern of materials, whatever the number of
elements along x.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.elements.box_model import (
    POTENTIAL_UNIT,
    BoxModel,
    Medium,
    held_components,
)
from squeezefilm.physics.plate.elements.lobatto import LineMesh, line_matrices

# (mechanical, electrical) factors of a medium's constants; None leaves the medium out.
Weight = Callable[[Medium], tuple[float, float]]
# A factor on all foundations' stiffness, or one for each of them.
Springs = float | Sequence[float]
_Block = tuple[si.IntArray, si.FloatArray, si.FloatArray, si.FloatArray, si.FloatArray]
"""Codes of an element's unknowns, and its P2, P1, P0 and R."""


def full_weight(medium: Medium) -> tuple[float, float]:
    """All constants as they are."""
    return 1.0, 1.0


@dataclass(frozen=True, eq=False)
class CrossSection:
    """The matrices of a slice over its unknowns.

    `codes` numbers the unknowns: 4 · (y node · z nodes + z node) + component for displacements
    (component 0–2); potentials (component 3) are offset by `potential_base` and numbered by node
    and ceramic. `g0` and `g1` have one column per electrode in `electrodes`: the slice's coupling
    to that electrode's potential; `c0` (electrodes²) their capacitance term.
    """

    codes: si.IntArray
    P2: si.FloatArray
    P1: si.FloatArray
    P0: si.FloatArray
    R: si.FloatArray
    electrodes: tuple[int, ...]
    g0: si.FloatArray
    g1: si.FloatArray
    c0: si.FloatArray

    # The bases are nearly orthogonal: a few hundredths of these entries are not 0.

    @functools.cached_property
    def stiffnesses(self) -> tuple[sparse.csr_array, sparse.csr_array, sparse.csr_array]:
        """P2, P1 and P0 as sparse matrices, to be applied by."""
        return sparse.csr_array(self.P2), sparse.csr_array(self.P1), sparse.csr_array(self.P0)

    @functools.cached_property
    def inertia(self) -> sparse.csr_array:
        """R as a sparse matrix, to be applied by."""
        return sparse.csr_array(self.R)


def potential_base(model: BoxModel) -> int:
    """First code of potentials."""
    return 4 * model.y.nodes.size * model.z.nodes.size


def code_parts(model: BoxModel, codes: si.IntArray) -> tuple[si.IntArray, si.IntArray, si.IntArray]:
    """The component (0–3), y node and z node of each code."""
    base, planes = potential_base(model), model.z.nodes.size
    ceramics = max(len(model.electrodes), 1)
    electric = codes >= base
    node = np.where(electric, (codes - base) // ceramics, codes // 4)
    return np.where(electric, 3, codes % 4), node // planes, node % planes


def _z_arrays(
    mesh: LineMesh, column: tuple[int, ...], media: tuple[Medium, ...], weight: Weight
) -> tuple[si.FloatArray, si.FloatArray]:
    """Z[c, d, a, i, b, j] = ∫ H[a, c, b, d] (∂)N_i (∂)N_j dz and the mass ∫ρ N_i N_j dz of a
    column of cells; the derivative is taken where the direction is z."""
    size = mesh.nodes.size
    Z = np.zeros((3, 3, 4, size, 4, size))
    mass = np.zeros((size, size))
    for k, index in enumerate(column):
        if index < 0:
            continue
        at = slice(mesh.first_node[k], mesh.first_node[k + 1] + 1)
        length = mesh.edges[k + 1] - mesh.edges[k]
        M, D, S = line_matrices(length, mesh.orders[k], hierarchic=True)
        H = media[index].gradient_matrix(*weight(media[index]))
        for c in range(3):
            for d in range(3):
                line = (S if d == 2 else D) if c == 2 else (D.T if d == 2 else M)
                part = H[:, c, :, d][:, None, :, None] * line[None, :, None, :]
                Z[c, d, :, at, :, at] += part
        mass[at, at] += media[index].density * M
    return Z, mass


def _kron(Y: si.FloatArray, Z: si.FloatArray) -> si.FloatArray:
    """Y[i, j] Z[a, k, b, l] as a matrix over (i, k, a) and (j, l, b)."""
    n, planes = Y.shape[0], Z.shape[1]
    out = Y[:, None, None, :, None, None] * Z.transpose(1, 0, 3, 2)[None, :, :, None, :, :]
    return out.reshape(n * planes * 4, n * planes * 4)


def cross_section(
    model: BoxModel, element: int, weight: Weight = full_weight, *, springs: Springs = 1.0
) -> CrossSection:
    """The slice matrices of x element number `element`, with the side conditions of y− and y+.

    `weight` scales the constants of each medium and `springs` the foundations, so that energy
    shares and losses come from the same assembly.
    """
    y, z = model.y, model.z
    ny, nz, base = y.nodes.size, z.nodes.size, potential_base(model)
    ceramics = max(len(model.electrodes), 1)
    size = base + ny * nz * ceramics
    blocks: list[_Block] = []
    cache: dict[tuple[int, ...], tuple[si.FloatArray, si.FloatArray]] = {}
    kron_cache: dict[tuple[object, ...], tuple[si.FloatArray, ...]] = {}
    present = np.zeros(size, dtype=bool)
    electrode_of = np.full(size, -1)
    for j in range(y.elements):
        column = tuple(int(m) for m in model.medium[element, j])
        if all(m < 0 for m in column):
            continue
        if column not in cache:
            cache[column] = _z_arrays(z, column, model.media, weight)
        Z, mass = cache[column]
        length, order = y.edges[j + 1] - y.edges[j], y.orders[j]
        key = (column, round(length, 12), order)
        if key not in kron_cache:
            M, D, S = line_matrices(length, order, hierarchic=True)
            three = np.diag([1.0, 1.0, 1.0, 0.0])
            R = _kron(M, mass[None, :, None, :] * three[:, None, :, None])
            if Z.any():
                P2 = _kron(M, Z[0, 0])
                P1 = _kron(D.T, Z[0, 1]) + _kron(M, Z[0, 2])
                P0 = _kron(S, Z[1, 1]) + _kron(D, Z[1, 2]) + _kron(D.T, Z[2, 1])
                P0 += _kron(M, Z[2, 2])
            else:
                # A weight may leave all of a column out.
                P2 = P1 = P0 = np.zeros_like(R)
            kron_cache[key] = (P2, P1, P0, R)
        P2, P1, P0, R = kron_cache[key]
        for number, spring in enumerate(model.foundations):
            if (
                spring.x_elements[0] <= element < spring.x_elements[1]
                and spring.y_elements[0] <= j < spring.y_elements[1]
            ):
                Zs = np.zeros((4, nz, 4, nz))
                scale = springs if isinstance(springs, float) else springs[number]
                for a in range(3):
                    Zs[a, spring.z_plane, a, spring.z_plane] = spring.stiffness[a] * scale
                P0 = P0 + _kron(line_matrices(length, order, hierarchic=True)[0], Zs)
        codes, keep = _element_codes(model, element, j, present, electrode_of)
        at = np.ix_(keep, keep)
        blocks.append((codes[keep], P2[at], P1[at], P0[at], R[at]))
    return _assemble(model, blocks, present, electrode_of)


def slice_codes(model: BoxModel, element: int) -> si.IntArray:
    """The codes of the unknowns of x element number `element`'s slice, as `CrossSection` has them,
    without its matrices."""
    size = potential_base(model) + model.y.nodes.size * model.z.nodes.size * max(
        len(model.electrodes), 1
    )
    present, electrode_of = np.zeros(size, dtype=bool), np.full(size, -1)
    for j in np.flatnonzero(np.any(model.medium[element] >= 0, axis=1)).tolist():
        _element_codes(model, element, j, present, electrode_of)
    return np.flatnonzero(present & (electrode_of < 0))


def _element_codes(
    model: BoxModel, element: int, j: int, present: si.FloatArray, electrode_of: si.IntArray
) -> tuple[si.IntArray, si.IntArray]:
    """Codes of the unknowns of one y element in (y node, z node, component) order and which of
    them exist; marks them in `present` and the driven electrodes in `electrode_of`."""
    y, z = model.y, model.z
    nz, base, ceramics = z.nodes.size, potential_base(model), max(len(model.electrodes), 1)
    solid = np.zeros(nz, dtype=bool)
    owner = np.full(nz, -1)
    for k in range(z.elements):
        if model.medium[element, j, k] < 0:
            continue
        nodes = slice(z.first_node[k], z.first_node[k + 1] + 1)
        solid[nodes] = True
        if (number := int(model.ceramic[element, j, k])) >= 0:
            owner[nodes] = number
            grounded = model.electrodes[number].grounded_plane
            if z.first_node[k] <= grounded <= z.first_node[k + 1]:
                owner[grounded] = -1
    iy = np.arange(y.first_node[j], y.first_node[j + 1] + 1)
    node = iy[:, None] * nz + np.arange(nz)[None, :]
    codes = np.empty((iy.size, nz, 4), dtype=np.int64)
    exists = np.zeros((iy.size, nz, 4), dtype=bool)
    codes[:, :, :3] = 4 * node[:, :, None] + np.arange(3)
    exists[:, :, :3] = solid[None, :, None]
    codes[:, :, 3] = base + node * ceramics + np.maximum(owner, 0)[None, :]
    exists[:, :, 3] = owner[None, :] >= 0
    for side, at in ((2, 0), (3, y.nodes.size - 1)):
        row = np.flatnonzero(iy == at)
        if row.size:
            exists[row[0]][:, held_components(model.ends[side], 1)] = False
    flat = codes.reshape(-1)
    exists &= model.kept[iy][:, :, None]
    keep = np.flatnonzero(exists.reshape(-1))
    present[flat[keep]] = True
    for number in {int(n) for n in owner if n >= 0}:
        plane = model.electrodes[number].driven_plane
        if owner[plane] == number:
            electrode_of[codes[exists[:, plane, 3], plane, 3]] = number
    return flat, keep


def _assemble(
    model: BoxModel,
    blocks: list[_Block],
    present: si.FloatArray,
    electrode_of: si.IntArray,
) -> CrossSection:
    all_codes = np.flatnonzero(present)
    position = np.full(present.size, -1)
    position[all_codes] = np.arange(all_codes.size)
    n = all_codes.size
    P2, P1, P0, R = (np.zeros((n, n)) for _ in range(4))
    for codes, *parts in blocks:
        at = np.ix_(position[codes], position[codes])
        for total, part in zip((P2, P1, P0, R), parts, strict=True):
            total[at] += part
    number = electrode_of[all_codes]
    free, electrodes = number < 0, tuple(int(k) for k in np.unique(number[number >= 0]))
    # A potential that is one along y is the sum of the end functions of the elements alone.
    _, iy, _ = code_parts(model, all_codes)
    ends = model.y.function_orders[iy] == 1
    psi = np.zeros((n, len(electrodes)))
    for column, k in enumerate(electrodes):
        psi[(number == k) & ends, column] = 1 / POTENTIAL_UNIT
    at = np.ix_(free, free)
    return CrossSection(
        codes=all_codes[free],
        P2=P2[at],
        P1=P1[at],
        P0=P0[at],
        R=R[at],
        electrodes=electrodes,
        g0=(P0 @ psi)[free],
        g1=(P1 @ psi)[free],
        c0=psi.T @ P0 @ psi,
    )
