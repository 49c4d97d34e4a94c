"""Solids of rings and discs in their own axes (r, θ, z): metals, ceramics, layers of teeth.

Components are in Voigt order rr, θθ, zz, θz, rz, rθ with engineering shear strains.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm.errors import InputError
from squeezefilm.materials import VACUUM_PERMITTIVITY, ElasticMaterial, Piezoceramic
from squeezefilm.quantities import (
    Dimensionless,
    FloatArray,
    KilogramPerCubicMetre,
    Unit,
    require,
)

# PZT-5H, from which the ratios of a soft ceramic's compliances and couplings are taken.
# Source: Berlincourt, Krueger and Near, Morgan/Vernitron TP-226; clamped permittivities as in the
# project's reference problem.
_PZT5H_COMPLIANCE = {"11": 16.5, "12": -4.78, "13": -8.45, "33": 20.7, "44": 43.5, "66": 42.6}
_PZT5H_CHARGE = {"31": -274.0, "33": 593.0, "15": 741.0}
_PZT5H_CLAMPED_PERMITTIVITY = (1666.84, 1381.80)


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
    stiffness: FloatArray
    density: KilogramPerCubicMetre
    piezoelectric: FloatArray | None = None
    permittivity: FloatArray | None = None
    loss_factor: Dimensionless | None = None

    def __post_init__(self) -> None:
        c = self.stiffness
        require("stiffness", c, Unit("Pa"))
        require("density", self.density, Unit("kg/m3"), above=0)
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
        if self.loss_factor is not None:
            require("loss_factor", self.loss_factor, at_least=0, below=2)
        if self.piezoelectric is None:
            return
        e = self.piezoelectric
        require("piezoelectric", e, Unit("C/m2"))
        if self.permittivity is None:
            raise InputError(f"{self.name} is piezoelectric; give its clamped permittivity too")
        require("permittivity", self.permittivity, Unit("F/m"), above=0)
        if np.any(e[np.ix_([0, 2], odd)]) or np.any(e[np.ix_([1], even)]):
            raise InputError(
                f"{self.name} must be poled along z (or r): its couplings to θz and rθ shear "
                "would mix Fourier harmonics"
            )


def isotropic_solid(
    material: ElasticMaterial, loss_factor: Dimensionless | None = None
) -> RingSolid:
    """A metal or a glass as a `RingSolid`. Source: Hooke's law, λ = Eν/((1 + ν)(1 − 2ν))."""
    lame = (
        material.young_modulus
        * material.poisson_ratio
        / ((1 + material.poisson_ratio) * (1 - 2 * material.poisson_ratio))
    )
    stiffness = np.zeros((6, 6))
    stiffness[:3, :3] = lame
    stiffness += material.shear_modulus * np.diag([2.0, 2, 2, 1, 1, 1])
    return RingSolid(material.name, stiffness, material.density, loss_factor=loss_factor)


def piezoceramic_solid(
    ceramic: Piezoceramic, loss_factor: Dimensionless | None = None
) -> RingSolid:
    """A soft ceramic poled along z, in three dimensions, from its in-plane data.

    The compliances are those of PZT-5H in the ratio that gives `ceramic.in_plane_stiffness`; the
    charge coefficients those of PZT-5H in the ratio that gives the effective in-plane e31 of the
    data set believed; e = d c. The clamped permittivities are 1667 and 1382 ε0 whatever the
    ceramic says. An assumption, good for soft PZT only.
    Without `loss_factor` the ceramic's own 1/Q is taken.
    """
    s = np.zeros((6, 6))
    t = _PZT5H_COMPLIANCE
    s[:2, :2] = [[t["11"], t["12"]], [t["12"], t["11"]]]
    s[:2, 2] = s[2, :2] = t["13"]
    s[2, 2] = t["33"]
    s[3, 3] = s[4, 4] = t["44"]
    s[5, 5] = 2 * (t["11"] - t["12"])
    s /= ceramic.in_plane_stiffness * (t["11"] - t["12"] ** 2 / t["11"])
    stiffness = np.linalg.inv(s)
    d31 = ceramic.effective_stress_coefficient * (s[0, 0] + s[0, 1])
    ratio = d31 / _PZT5H_CHARGE["31"]
    d = np.zeros((3, 6))
    d[2, :3] = np.array([_PZT5H_CHARGE["31"], _PZT5H_CHARGE["31"], _PZT5H_CHARGE["33"]]) * ratio
    d[0, 4] = d[1, 3] = _PZT5H_CHARGE["15"] * ratio
    radial, axial = (VACUUM_PERMITTIVITY * value for value in _PZT5H_CLAMPED_PERMITTIVITY)
    return RingSolid(
        ceramic.name,
        (stiffness + stiffness.T) / 2,
        ceramic.density,
        piezoelectric=d @ stiffness,
        permittivity=np.array([radial, radial, axial]),
        loss_factor=1 / ceramic.quality_factor if loss_factor is None else loss_factor,
    )


def stiff_teeth(solid: RingSolid, fill: Dimensionless) -> RingSolid:
    """A layer of radial teeth, smeared, at its upper bound: everything times `fill`.

    `fill` is the share of the circumference that is metal. A smooth motion of the filled layer is
    admissible for the teeth, so (Rayleigh) a frequency computed with this layer is not below the
    true one of a ring with many teeth per half wave.
    """
    require("fill", fill, above=0, at_most=1)
    return RingSolid(
        f"{solid.name} teeth, stiff",
        fill * solid.stiffness,
        fill * solid.density,
        loss_factor=solid.loss_factor,
    )


def soft_teeth(solid: RingSolid, fill: Dimensionless) -> RingSolid:
    """A layer of radial teeth, smeared, at its lower bound: no hoop stiffness at all.

    Each tooth is solid in r and z with its flanks free (plane stress in θ), stands upright and
    shears over its height (Grz and Gθz times `fill`), but hands no hoop stress (Eθ = 0) and no
    in-plane shear (Grθ = 0) on to its neighbours. Valid well below the teeth's own bending
    resonance. Teeth modelled one by one (72 of 80 % fill, 1.5–2.5 mm on a ring of 2–2.9 mm) lie 7
    to 13 % of the way from this bound to `stiff_teeth`.

    Radial stiffness cannot be dropped as well: a tooth is one piece from the inner to the outer
    edge, and without it the layer has waves of any shortness at any frequency.
    """
    require("fill", fill, above=0, at_most=1)
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
