"""The oracle: the same piezoelectric boxes by scikit-fem's quadratic hexahedra, assembled whole.

Runs on any `BoxModel` of order-2 elements with free or symmetric sides; electrodes are shorted,
tied in groups that float, or left out. scikit-fem is a test extra; of the package only the model's
description is used.
"""

from typing import Any, Literal

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import eigsh

from squeezefilm.physics.plate.elements.box_model import BoxModel

Outer = Literal["shorted", "bare"] | list[list[tuple[int, int]]]
"""What becomes of the outer faces: all at zero volts, without any metal, or groups of (electrode,
sign) that each share one potential and carry no charge together."""


def assembled(model: BoxModel, outer: Outer = "shorted") -> tuple[Any, Any]:
    """K and M with the potential condensed by elimination order: (u, φ) sparse, free unknowns."""
    from skfem import Basis, BilinearForm, ElementHex2, ElementVector, MeshHex
    from skfem.helpers import ddot, dot, grad, sym_grad

    mesh = MeshHex.init_tensor(*(np.array(m.edges) for m in (model.x, model.y, model.z)))
    centre = mesh.p[:, mesh.t].mean(axis=1)
    cells = [
        np.searchsorted(np.array(m.edges), c) - 1
        for m, c in zip((model.x, model.y, model.z), centre, strict=True)
    ]
    medium, ceramic = model.medium[tuple(cells)], model.ceramic[tuple(cells)]
    vector, scalar = ElementVector(ElementHex2()), ElementHex2()
    whole, potential = Basis(mesh, vector, intorder=6), Basis(mesh, scalar, intorder=6)
    nu, nphi = whole.N, potential.N
    K, M = sp.csr_matrix((nu, nu)), sp.csr_matrix((nu, nu))
    B, E = sp.csr_matrix((nphi, nu)), sp.csr_matrix((nphi, nphi))
    tensor = ((0, 5, 4), (5, 1, 3), (4, 3, 2))
    for number, matter in enumerate(model.media):
        elements = np.flatnonzero(medium == number)
        if elements.size == 0:
            continue
        some = Basis(mesh, vector, elements=elements, intorder=6)
        c = np.array(
            [[[[matter.stiffness[tensor[i][j], tensor[k][m]] for m in range(3)] for k in range(3)]
              for j in range(3)] for i in range(3)]
        )  # fmt: skip

        @BilinearForm
        def elastic(u: Any, v: Any, w: Any, c: Any = c) -> Any:
            return ddot(np.einsum("ijkl,kl...->ij...", c, sym_grad(u)), sym_grad(v))

        @BilinearForm
        def inertia(u: Any, v: Any, w: Any, rho: float = matter.density) -> Any:
            return rho * dot(u, v)

        K, M = K + elastic.assemble(some), M + inertia.assemble(some)
        if matter.stress_matrix is None:
            continue
        e = np.array(
            [[[matter.stress_matrix[d, tensor[i][j]] for j in range(3)] for i in range(3)]
             for d in range(3)]
        )  # fmt: skip
        own = Basis(mesh, scalar, elements=elements, intorder=6)

        @BilinearForm
        def piezo(u: Any, q: Any, w: Any, e: Any = e) -> Any:
            return np.einsum("dij,ij...,d...->...", e, sym_grad(u), grad(q))

        @BilinearForm
        def dielectric(p: Any, q: Any, w: Any, eps: Any = matter.permittivity) -> Any:
            return np.einsum("ij,j...,i...->...", eps, grad(p), grad(q))

        B, E = B + piezo.assemble(some, own), E + dielectric.assemble(own)
    inside = np.unique(potential.element_dofs[:, ceramic >= 0])
    height = potential.doflocs[2, inside]
    # Potentials scaled so that elimination keeps its digits.
    scale = 3e9

    def on(plane_of: str) -> Any:
        found = np.zeros(inside.size, dtype=bool)
        for number, one in enumerate(model.electrodes):
            own = np.isin(inside, np.unique(potential.element_dofs[:, ceramic == number]))
            found |= own & (np.abs(height - model.z.nodes[getattr(one, plane_of)]) < 1e-12)
        return found

    grounded, driven = on("grounded_plane"), on("driven_plane")
    free = inside[~grounded if outer == "bare" else ~(grounded | driven)]
    groups = [] if isinstance(outer, str) else outer
    T = sp.lil_matrix((nphi, free.size + len(groups)))
    T[free, np.arange(free.size)] = scale
    for column, group in enumerate(groups):
        for electrode, sign in group:
            own = np.unique(potential.element_dofs[:, ceramic == electrode])
            plane = model.z.nodes[model.electrodes[electrode].driven_plane]
            own = own[np.abs(potential.doflocs[2, own] - plane) < 1e-12]
            T[own, free.size + column] = scale * sign
    T = T.tocsr()
    count = T.shape[1]
    A = sp.bmat([[K, (T.T @ B).T], [T.T @ B, -(T.T @ E @ T)]])
    mass = sp.bmat([[M, None], [None, sp.csr_matrix((count, count))]])
    used = np.concatenate([np.unique(whole.element_dofs[:, medium >= 0]), nu + np.arange(count)])
    used = np.setdiff1d(used, _held(model, mesh, whole))
    return A.tocsr()[used][:, used].tocsc(), mass.tocsr()[used][:, used].tocsc()


def _held(model: BoxModel, mesh: Any, whole: Any) -> Any:
    """The displacements normal to sides held symmetric."""
    held = [np.zeros(0, dtype=int)]
    for side, condition in enumerate(model.ends):
        if condition == "free":
            continue
        assert condition == "symmetric", "the oracle knows free and symmetric sides"
        axis = side // 2
        edge = (model.x, model.y)[axis].edges[0 if side % 2 == 0 else -1]
        facets = mesh.facets_satisfying(
            lambda x, axis=axis, edge=edge: np.abs(x[axis] - edge) < 1e-9
        )
        held.append(whole.get_dofs(facets).all(f"u^{axis + 1}"))
    return np.concatenate(held)


def skfem_frequencies(
    model: BoxModel, guess: float, count: int, outer: Outer = "shorted"
) -> np.ndarray:
    """The `count` frequencies (Hz) nearest to a guess."""
    A, mass = assembled(model, outer)
    shift = (2 * np.pi * guess) ** 2
    values = eigsh(A, k=count, M=mass, sigma=shift, return_eigenvectors=False, tol=1e-13)
    return np.sort(np.sqrt(values)) / (2 * np.pi)
