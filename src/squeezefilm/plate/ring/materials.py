"""Solids of rings and discs in their own axes (r, θ, z): metals, ceramics, layers of teeth.

Components are in Voigt order rr, θθ, zz, θz, rz, rθ with engineering shear strains.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.materials import ElasticMaterial, Piezoceramic, isotropic_stiffness


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class RingSolid:
    """A linear solid that looks the same from every angle θ.

    `stiffness` (6, 6) in Pa, at constant field; `piezoelectric` (3, 6) in C/m² or None, rows r, θ,
    z; `permittivity` (3,) in F/m at constant strain; `loss_factor` is 1/Q of the material, or None
    where only the assembly's Q is known.

    Raises `InputError` for a stiffness that is not symmetric and non-negative, or that couples the
    even components (rr, θθ, zz, rz) to the odd ones (θz, rθ): Fourier harmonics would not decouple.
    """

    name: str
    stiffness: si.FloatArray
    density: Annotated[si.KilogramPerCubicMetre, si.Above(0)]
    piezoelectric: si.FloatArray | None = None
    permittivity: Annotated[si.FloatArray, si.Above(0)] | None = None
    loss_factor: Annotated[si.Dimensionless, si.AtLeast(0), si.Below(2)] | None = None

    def __post_init__(self) -> None:
        c = self.stiffness
        si.require("stiffness", c, si.Unit("Pa"))
        if c.shape != (6, 6) or not np.allclose(c, c.T, rtol=1e-9, atol=1e-9 * np.abs(c).max()):
            raise InputError(f"the stiffness of {self.name} must be a symmetric 6 × 6 array")
        if np.linalg.eigvalsh(c)[0] < -1e-9 * np.abs(c).max():
            raise InputError(f"the stiffness of {self.name} is not that of a stable solid")
        odd, even = [3, 5], [0, 1, 2, 4]
        if np.any(c[np.ix_(odd, even)]):
            raise InputError(
                f"the stiffness of {self.name} couples θz or rθ shear to the other strains; only "
                "materials with a mirror plane normal to θ can be computed by Fourier harmonics"
            )
        if self.piezoelectric is None:
            return
        e = self.piezoelectric
        si.require("piezoelectric", e, si.Unit("C/m2"))
        if self.permittivity is None:
            raise InputError(f"{self.name} is piezoelectric; give its clamped permittivity too")
        if np.any(e[np.ix_([0, 2], odd)]) or np.any(e[np.ix_([1], even)]):
            raise InputError(
                f"{self.name} must be poled along z (or r): its couplings to θz and rθ shear "
                "would mix Fourier harmonics"
            )


@si.checked_numbers
def isotropic_solid(
    material: ElasticMaterial, loss_factor: si.Dimensionless | None = None
) -> RingSolid:
    """A metal or a glass as a `RingSolid`.

    Without `loss_factor` the material's own 1/Q is taken, or None where it has none.
    """
    own = None if material.quality_factor is None else 1 / material.quality_factor
    return RingSolid(
        material.name,
        isotropic_stiffness(material.young_modulus, material.poisson_ratio),
        material.density,
        loss_factor=own if loss_factor is None else loss_factor,
    )


@si.checked_numbers
def piezoceramic_solid(
    ceramic: Piezoceramic, loss_factor: si.Dimensionless | None = None
) -> RingSolid:
    """A ceramic poled along z in three dimensions: its `full_constants`, as boxes use them.

    x becomes r and y becomes θ, so the ceramic has to be isotropic across its poling (6mm), which
    `PiezoConstants` checks. Without `loss_factor` the ceramic's own 1/Q is taken.
    """
    constants = ceramic.full_constants
    stiffness = constants.stiffness_matrix
    return RingSolid(
        ceramic.name,
        (stiffness + stiffness.T) / 2,
        ceramic.density,
        piezoelectric=constants.stress_matrix,
        permittivity=np.diag(constants.permittivity_matrix).copy(),
        loss_factor=1 / ceramic.quality_factor if loss_factor is None else loss_factor,
    )


@si.checked_numbers
def stiff_teeth(
    solid: RingSolid, fill: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)]
) -> RingSolid:
    """A layer of radial teeth, smeared, at its upper bound: everything times `fill`.

    `fill` is the share of the circumference that is metal. A smooth motion of the filled layer is
    admissible for the teeth, so (Rayleigh) a frequency computed with this layer is not below the
    true one of a ring with many teeth per half wave.
    """
    return RingSolid(
        f"{solid.name} teeth, stiff",
        fill * solid.stiffness,
        fill * solid.density,
        loss_factor=solid.loss_factor,
    )


@si.checked_numbers
def soft_teeth(
    solid: RingSolid, fill: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)]
) -> RingSolid:
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
    return RingSolid(
        f"{solid.name} teeth, soft",
        fill * stiffness,
        fill * solid.density,
        loss_factor=solid.loss_factor,
    )
