"""Solids of rings and discs in their own axes (r, θ, z): metals, ceramics, layers of teeth.

Components are in Voigt order rr, θθ, zz, θz, rz, rθ with engineering shear strains.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.plate.elements.box_model import Medium


def require_decoupled(solid: Medium) -> None:
    """Refuse a medium that is no solid, or whose Fourier harmonics would not decouple.

    Raises `InputError` for a stiffness that is not symmetric and non-negative, or that couples the
    even components (rr, θθ, zz, rz) to the odd ones (θz, rθ).
    """
    c, e = solid.stiffness, solid.stress_matrix
    si.require("stiffness", c, si.Unit("Pa"))
    si.require("density", solid.density, si.Unit("kg/m3"), above=0)
    if solid.loss is not None:
        si.require("loss", solid.loss, at_least=0, below=2)
    if c.shape != (6, 6) or not np.allclose(c, c.T, rtol=1e-9, atol=1e-9 * np.abs(c).max()):
        raise InputError(f"the stiffness of {solid.name} must be a symmetric 6 × 6 array")
    if np.linalg.eigvalsh(c)[0] < -1e-9 * np.abs(c).max():
        raise InputError(f"the stiffness of {solid.name} is not that of a stable solid")
    odd, even = [3, 5], [0, 1, 2, 4]
    if np.any(c[np.ix_(odd, even)]):
        raise InputError(
            f"the stiffness of {solid.name} couples θz or rθ shear to the other strains; only "
            "materials with a mirror plane normal to θ can be computed by Fourier harmonics"
        )
    if e is None:
        return
    si.require("piezoelectric", e, si.Unit("C/m2"))
    if solid.permittivity is None:
        raise InputError(f"{solid.name} is piezoelectric; give its clamped permittivity too")
    si.require("permittivity", np.diag(solid.permittivity), si.Unit("F/m"), above=0)
    if np.any(e[np.ix_([0, 2], odd)]) or np.any(e[np.ix_([1], even)]):
        raise InputError(
            f"{solid.name} must be poled along z (or r): its couplings to θz and rθ shear "
            "would mix Fourier harmonics"
        )


@si.checked_numbers
def stiff_teeth(
    solid: Medium, fill: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)]
) -> Medium:
    """A layer of radial teeth, smeared, at its upper bound: everything times `fill`.

    `fill` is the share of the circumference that is metal. A smooth motion of the filled layer is
    admissible for the teeth, so (Rayleigh) a frequency computed with this layer is not below the
    true one of a ring with many teeth per half wave.
    """
    return Medium(
        f"{solid.name} teeth, stiff",
        fill * solid.stiffness,
        fill * solid.density,
        solid.loss,
    )


@si.checked_numbers
def soft_teeth(
    solid: Medium, fill: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)]
) -> Medium:
    """A layer of radial teeth, smeared, at its lower bound: no hoop stiffness at all.

    Each tooth is solid in r and z with its flanks free (plane stress in θ), stands upright and
    shears over its height (Grz and Gθz times `fill`), but hands no hoop stress (Eθ = 0) and no
    in-plane shear (Grθ = 0) on to its neighbours. Valid well below the teeth's own bending
    resonance. Teeth modelled one by one (72 of 80 % fill, 1.5–2.5 mm on a ring of 2–2.9 mm) lie 7
    to 13 % of the way from this bound to `stiff_teeth`.

    Radial stiffness cannot be dropped as well: a tooth is one piece from the inner to the outer
    edge, and without it the layer has waves of any shortness at any frequency.
    """
    compliance = np.linalg.inv(solid.stiffness)
    meridian = np.ix_([0, 2], [0, 2])
    stiffness = np.zeros((6, 6))
    stiffness[meridian] = np.linalg.inv(compliance[meridian])
    stiffness[3, 3], stiffness[4, 4] = solid.stiffness[3, 3], solid.stiffness[4, 4]
    return Medium(
        f"{solid.name} teeth, soft",
        fill * stiffness,
        fill * solid.density,
        solid.loss,
    )
