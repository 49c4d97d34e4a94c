"""What plates, ceramics and gas are made of. Pure data with range checks; no physics of its own
beyond conversions between the ways in which the same constant is given."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Literal

from squeezefilm.errors import ContradictionError, ContradictionWarning
from squeezefilm.quantities import (
    CoulombPerSquareMetre,
    Dimensionless,
    FaradPerMetre,
    KilogramPerCubicMetre,
    Metre,
    MetrePerVolt,
    Pascal,
    PascalSecond,
    SquareMetrePerNewton,
    Unit,
    require,
)

PiezoDataSet = Literal["from_d31", "printed_e31"]

VACUUM_PERMITTIVITY: FaradPerMetre = 8.8541878128e-12


@dataclass(frozen=True)
class ElasticMaterial:
    """An isotropic, linear elastic substrate."""

    name: str
    young_modulus: Pascal
    poisson_ratio: Dimensionless
    density: KilogramPerCubicMetre

    def __post_init__(self) -> None:
        require("young_modulus", self.young_modulus, Unit("Pa"), above=0)
        require("poisson_ratio", self.poisson_ratio, above=-1, below=0.5)
        require("density", self.density, Unit("kg/m3"), above=0)

    @property
    def shear_modulus(self) -> Pascal:
        """E / 2(1 + ν)."""
        return self.young_modulus / (2 * (1 + self.poisson_ratio))

    @property
    def plane_strain_modulus(self) -> Pascal:
        """E / (1 − ν²): the stiffness of a strip that cannot contract across its width."""
        return self.young_modulus / (1 - self.poisson_ratio**2)


@dataclass(frozen=True)
class Piezoceramic:
    """A thin ceramic plate poled through its thickness, working in its plane (the 31 effect).

    The in-plane stiffness c11_p = s11/(s11² − s12²) is the one of a plate under plane stress. The
    coupling can be given twice, by the charge coefficient d31 and by the effective stress
    coefficient e31_p; `data_set` says which is believed. If both are given and differ by more than
    10 %, `check_consistency` names both.
    """

    name: str
    in_plane_stiffness: Pascal
    in_plane_poisson_ratio: Dimensionless
    shear_modulus: Pascal
    density: KilogramPerCubicMetre
    charge_coefficient: MetrePerVolt
    relative_permittivity: Dimensionless
    quality_factor: Dimensionless
    stress_coefficient: CoulombPerSquareMetre | None = None
    data_set: PiezoDataSet = "from_d31"

    def __post_init__(self) -> None:
        require("in_plane_stiffness", self.in_plane_stiffness, Unit("Pa"), above=0)
        require("in_plane_poisson_ratio", self.in_plane_poisson_ratio, above=-1, below=0.5)
        require("shear_modulus", self.shear_modulus, Unit("Pa"), above=0)
        require("density", self.density, Unit("kg/m3"), above=0)
        require("charge_coefficient", self.charge_coefficient, Unit("m/V"))
        require("relative_permittivity", self.relative_permittivity, at_least=1)
        require("quality_factor", self.quality_factor, above=0.5)
        if self.stress_coefficient is not None:
            require("stress_coefficient", self.stress_coefficient, Unit("C/m2"))
        elif self.data_set == "printed_e31":
            raise ContradictionError(
                "data_set = 'printed_e31' needs a stress_coefficient; give one in C/m2, "
                "or choose data_set = 'from_d31'"
            )

    @property
    def compliance_11(self) -> SquareMetrePerNewton:
        """s11 = 1 / (c11_p (1 − ν_p²)) with ν_p = −s12/s11."""
        return 1 / (self.in_plane_stiffness * (1 - self.in_plane_poisson_ratio**2))

    @property
    def stress_coefficient_from_d31(self) -> CoulombPerSquareMetre:
        """The effective in-plane e31 = d31 / (s11 + s12) of a plate free across its thickness."""
        return self.charge_coefficient / (self.compliance_11 * (1 - self.in_plane_poisson_ratio))

    @property
    def effective_stress_coefficient(self) -> CoulombPerSquareMetre:
        """The effective in-plane e31 of the data set that is believed."""
        if self.data_set == "printed_e31" and self.stress_coefficient is not None:
            return self.stress_coefficient
        return self.stress_coefficient_from_d31

    @property
    def contradiction(self) -> str | None:
        """A sentence naming both couplings if they differ by more than 10 %, else None."""
        if self.stress_coefficient is None:
            return None
        derived = self.stress_coefficient_from_d31
        if abs(derived - self.stress_coefficient) <= 0.1 * abs(derived):
            return None
        other = "printed_e31" if self.data_set == "from_d31" else "from_d31"
        return (
            f"the data of {self.name} contradict each other: d31 = "
            f"{self.charge_coefficient * 1e12:.4g} pm/V gives an effective e31 of "
            f"{derived:.3g} C/m2 (data set 'from_d31'), but {self.stress_coefficient:.3g} C/m2 is "
            f"stated (data set 'printed_e31'); '{self.data_set}' is used, choose '{other}' with "
            "the key data_set"
        )

    def check_consistency(self, *, strict: bool = False) -> None:
        """Warn (`ContradictionWarning`), or raise `ContradictionError` if strict, when the two
        couplings given contradict each other."""
        if (message := self.contradiction) is None:
            return
        if strict:
            raise ContradictionError(message)
        warnings.warn(message, ContradictionWarning, stacklevel=2)


@dataclass(frozen=True)
class Gas:
    """The gas between finger and surface, at ambient pressure."""

    viscosity: PascalSecond
    ambient_pressure: Pascal
    density: KilogramPerCubicMetre
    mean_free_path: Metre

    def __post_init__(self) -> None:
        require("viscosity", self.viscosity, Unit("Pa*s"), above=0)
        require("ambient_pressure", self.ambient_pressure, Unit("Pa"), above=0)
        require("density", self.density, Unit("kg/m3"), above=0)
        require("mean_free_path", self.mean_free_path, Unit("m"), above=0)
