"""Contactors that slip on the skin: forces that friction can hold, and what is left of the way.

With s how far each contactor has slid, sticking asks A F = w − s for A = C + 1/k and w = δ V; none
may pull with more than its friction h. Among forces within ±h those of least energy
½ Fᵀ A F − Fᵀ (w − s) stick where they can and slip in their own direction where they cannot
(Coulomb's law with the normal forces known, which the pull sideways is taken not to change).
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from scipy.linalg import solve_triangular
from scipy.optimize import lsq_linear

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError

# Friction below this share of the largest holds nothing.
_HELD = 1e-9


@si.checked_numbers
def held_forces(
    compliance: Annotated[si.FloatArray, si.Unit("m/N")],
    wanted: si.MetreArray,
    held: Annotated[si.NewtonArray, si.AtLeast(0.0)],
) -> si.NewtonArray:
    """The forces (N) of contactors that friction holds with at most `held` (N).

    `compliance` (contactors × contactors, m/N, symmetric and positive definite) is A, `wanted` (m)
    the way that sticking asks for. Raises `InputError` for shapes that do not fit,
    `OutOfRangeError` for a compliance that is not positive definite, and `ConvergenceError` where
    no forces are found.
    """
    si.require_alike(wanted=wanted, held=held)
    if compliance.shape != (wanted.size, wanted.size):
        raise InputError(
            f"compliance has the shape {compliance.shape}; {wanted.size} contactors have "
            f"{(wanted.size, wanted.size)}",
            quantity="compliance",
        )
    forces = np.asarray(np.linalg.solve(compliance, wanted), dtype=float)
    if np.all(np.abs(forces) <= held):
        return forces
    touching = held > _HELD * float(np.max(held, initial=0.0))
    forces = np.zeros(wanted.size)
    if not touching.any():
        return forces
    lower = np.linalg.cholesky(compliance[np.ix_(touching, touching)])
    limit = held[touching]
    # As least squares |Lᵀ F − L⁻¹ w|, in shares of each limit.
    found = lsq_linear(
        lower.T * limit,
        solve_triangular(lower, wanted[touching], lower=True),
        bounds=(-1.0, 1.0),
        method="bvls",
        tol=1e-12,
    )
    if not found.success:
        raise ConvergenceError(
            f"the forces of {touching.sum()} contactors that stick and slip were not found: "
            f"{found.message}",
            iterations=int(found.nit),
        )
    forces[touching] = found.x * limit
    return forces
