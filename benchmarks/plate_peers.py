"""The paper's plate by NGSolve: graded hexahedra of order 3, whole or a quarter by symmetry.

Optional: NGSolve (LGPL) is no dependency; `plate.py` uses this where it is installed.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh

from squeezefilm.core.quantities import FloatArray
from squeezefilm.physics.plate.elements.box_model import BoxModel
from squeezefilm.physics.plate.elements.lobatto import LineMesh


def graded_strips(layers: tuple[float, ...], across: int, bond: tuple[float, ...], half: bool):  # type: ignore[no-untyped-def]
    """Edges along x, y and z (m) of the plate of seven strips, layers (m) at every strip edge and
    (relative) at the bond; and which x elements lie under which strip (−1: none)."""
    x, strip_of = [0.0], []
    for k in range(7):
        start, stop = 0.012 * k, 0.012 * k + 0.011
        inner = [
            *(start + d for d in layers),
            (start + stop) / 2,
            *(stop - d for d in layers[::-1]),
        ]
        x += [*inner, stop]
        strip_of += [k] * (len(inner) + 1)
        if k < 6:
            gap = min(layers[0], 0.3e-3)
            x += [stop + gap, stop + 1e-3 - gap, stop + 1e-3]
            strip_of += [-1] * 3
    y = list(np.linspace(0, 0.0245, across // 2 + 1))
    z = [-1e-3, *(-1e-3 * b for b in bond[::-1]), 0.0, *(2e-3 * b for b in bond), 2e-3]
    if half:
        count = int(np.searchsorted(x, 0.0415 - 1e-9))
        return x[: count + 1], y, z, strip_of[:count]
    y = [*y, *(0.049 - v for v in y[-2::-1])]
    return x, y, z, strip_of


def graded_box(reference: BoxModel, order: int, *grid: Any) -> BoxModel:
    """The quarter plate of `reference` on another grid."""
    x, y, z, strip_of = grid
    meshes = [LineMesh(tuple(v), (order,) * (len(v) - 1)) for v in (x, y, z)]
    below = sum(v < -1e-12 for v in z)
    shape = tuple(m.elements for m in meshes)
    medium, ceramic = np.zeros(shape, dtype=int), np.full(shape, -1)
    strips = np.array(strip_of)
    medium[:, :, :below] = np.where(strips >= 0, 1, -1)[:, None, None]
    ceramic[:, :, :below] = strips[:, None, None]
    electrodes = tuple(type(one)(0, meshes[2].first_node[below]) for one in reference.electrodes)
    return BoxModel(*meshes, reference.media, medium, ceramic, electrodes, reference.ends)


def ngsolve_frequency(model: BoxModel, grid: Any, order: int, guess: float, half: bool) -> float:
    """The frequency (Hz) nearest to a guess."""
    import netgen.meshing as nm
    import ngsolve as ng

    x, y, z, strip_of = grid
    mesh = nm.Mesh()
    number = np.empty((len(x), len(y), len(z)), dtype=object)
    for i, j, k in itertools.product(*(range(len(v)) for v in (x, y, z))):
        number[i, j, k] = mesh.Add(nm.MeshPoint(nm.Pnt(x[i] * 1e3, y[j] * 1e3, z[k] * 1e3)))
    names = ["x", "y", "driven", "bond", "free"]
    faces = {}
    for index, name in enumerate(names, 1):
        faces[name] = mesh.Add(nm.FaceDescriptor(surfnr=index, domin=1, domout=0, bc=index))
        mesh.SetBCName(index - 1, name)
    mesh.SetMaterial(1, "plate")
    mesh.SetMaterial(2, "ceramic")

    def corners(i: int, j: int, k: int) -> list[Any]:
        return [
            number[i + a, j + b, k + c] for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))
        ]

    below = sum(v < -1e-12 for v in z)
    for i, j, k in itertools.product(*(range(len(v) - 1) for v in (x, y, z))):
        if k < below and strip_of[i] < 0:
            continue
        p = corners(i, j, k)
        mesh.Add(nm.Element3D(2 if k < below else 1, p))
        if half and i == len(x) - 2:
            mesh.Add(nm.Element2D(faces["x"], [p[1], p[2], p[6], p[5]]))
        if half and j == len(y) - 2:
            mesh.Add(nm.Element2D(faces["y"], [p[2], p[3], p[7], p[6]]))
        if k == 0 and strip_of[i] >= 0:
            mesh.Add(nm.Element2D(faces["driven"], p[:4]))
        if k == below and strip_of[i] >= 0:
            mesh.Add(nm.Element2D(faces["bond"], p[:4]))
    grown = ng.Mesh(mesh)
    steel, ceramic = model.media[0], model.media[1]
    # Lengths in mm: stiffness, density and force in units that keep ω.
    V = [
        ng.H1(grown, order=order, dirichlet="x" if half else ""),
        ng.H1(grown, order=order, dirichlet="y" if half else ""),
        ng.H1(grown, order=order),
        ng.H1(grown, order=order, definedon=grown.Materials("ceramic"), dirichlet="driven|bond"),
    ]
    space = ng.FESpace(V)
    (*u, phi), (*v, psi) = space.TnT()

    def strain(w: Any) -> Any:
        g = [ng.grad(c) for c in w]
        return ng.CF((g[0][0], g[1][1], g[2][2], g[1][2] + g[2][1], g[0][2] + g[2][0],
                      g[0][1] + g[1][0]))  # fmt: skip

    def matrix(values: Any) -> Any:
        values = np.asarray(values)
        return ng.CF(tuple(values.ravel().tolist()), dims=values.shape)

    scale = 3e9
    a, m = ng.BilinearForm(space, symmetric=True), ng.BilinearForm(space, symmetric=True)
    # grad in 1/mm is 1e3/m; ∫ in mm³ is 1e-9 m³: a common factor of 1e-3, left out of both.
    for name, medium in (("plate", steel), ("ceramic", ceramic)):
        dx = ng.dx(name)
        a += ng.InnerProduct(matrix(medium.stiffness) * strain(u), strain(v)) * dx
        m += 1e-6 * medium.density * sum(p * q for p, q in zip(u, v, strict=True)) * dx
    dx = ng.dx("ceramic")
    e = matrix(scale * np.asarray(ceramic.stress_matrix))
    a += (
        ng.InnerProduct(e * strain(u), ng.grad(psi)) + ng.InnerProduct(e * strain(v), ng.grad(phi))
    ) * dx
    eps = matrix(scale**2 * np.asarray(ceramic.permittivity))
    a += -ng.InnerProduct(eps * ng.grad(phi), ng.grad(psi)) * dx
    a.Assemble()
    m.Assemble()
    # Potentials outside the ceramics have empty rows.
    free = ng.BitArray(space.FreeDofs())
    rows, columns, entries = (np.array(part) for part in a.mat.COO())
    used = np.zeros(space.ndof, dtype=bool)
    used[rows[entries != 0]] = used[columns[entries != 0]] = True
    for unknown in np.flatnonzero(~used):
        free.Clear(int(unknown))
    # NGSolve's Arnoldi wants complex vectors: ARPACK with NGSolve's factorisation is faster.
    sigma = (2 * np.pi * guess) ** 2
    shifted = a.mat.CreateMatrix()
    shifted.AsVector().data = a.mat.AsVector() - sigma * m.mat.AsVector()
    inverse = shifted.Inverse(free, inverse="sparsecholesky")
    left, right = a.mat.CreateColVector(), a.mat.CreateColVector()

    def applied(operator: Any) -> LinearOperator:
        def times(vector: FloatArray) -> FloatArray:
            left.FV().NumPy()[:] = np.asarray(vector).ravel()
            right.data = operator * left
            return np.array(right.FV().NumPy())

        return LinearOperator((space.ndof, space.ndof), matvec=times, dtype=float)

    values = eigsh(applied(a.mat), k=2, M=applied(m.mat), sigma=sigma, OPinv=applied(inverse),
                   return_eigenvectors=False, tol=1e-7)  # fmt: skip
    found = np.sqrt(np.maximum(values, 0.0)) / (2 * np.pi)
    return float(found[np.argmin(np.abs(found - guess))])
