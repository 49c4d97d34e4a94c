"""Materials of plates and ceramics, and gas. Pure data with range checks; no physics of its own
beyond conversions between the ways in which the same constant is given."""

from __future__ import annotations

import dataclasses
import warnings
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ContradictionError, ContradictionWarning
from squeezefilm.core.hard_limits import (
    CHARGE_COEFFICIENT,
    COMPLIANCE,
    CROSS_COMPLIANCE,
    DENSITY,
    FREE_PATH,
    GAS_DENSITY,
    MODULUS,
    PERMITTIVITY,
    PRESSURE,
    QUALITY,
    SPECIFIC_HEAT,
    STRESS_COEFFICIENT,
    VISCOSITY,
    require_within,
)

# How far data that are given twice may be apart: a share of what the others give.
_AGREEMENT = 0.03
PiezoDataSet = Literal["from_d31", "printed_e31"]

SOLID_HEAT: si.JoulePerCubicMetreKelvin = 3e6
"""Heat that a volume of a solid takes per kelvin, where its specific heat is not stated (assumed):
glass takes 2.1e6, aluminium 2.4e6, ceramics about 3e6, copper 3.4e6, steel 3.7e6 (handbooks)."""

VACUUM_PERMITTIVITY: si.FaradPerMetre = 8.8541878128e-12


@si.checked_numbers
@dataclass(frozen=True)
class ElasticMaterial:
    """An isotropic, linear elastic substrate.

    `quality_factor` is the material's own; where it is None the assembly's is taken for it. Without
    a `specific_heat` it takes `SOLID_HEAT` (assumed).
    """

    name: str
    young_modulus: Annotated[si.Pascal, MODULUS]
    poisson_ratio: Annotated[si.Dimensionless, si.Above(-1), si.Below(0.5)]
    density: Annotated[si.KilogramPerCubicMetre, DENSITY]
    quality_factor: Annotated[si.Dimensionless, QUALITY] | None = None
    specific_heat: Annotated[si.JoulePerKilogramKelvin, SPECIFIC_HEAT] | None = None

    @property
    def heat_per_volume(self) -> si.JoulePerCubicMetreKelvin:
        """The heat that a volume of it takes per kelvin."""
        return _heat_per_volume(self.density, self.specific_heat)

    @property
    def shear_modulus(self) -> si.Pascal:
        """E / 2(1 + ν)."""
        return self.young_modulus / (2 * (1 + self.poisson_ratio))

    @property
    def plane_strain_modulus(self) -> si.Pascal:
        """E / (1 − ν²): the stiffness of a strip that cannot contract across its width."""
        return self.young_modulus / (1 - self.poisson_ratio**2)


def _heat_per_volume(
    density: si.KilogramPerCubicMetre, specific_heat: si.JoulePerKilogramKelvin | None
) -> si.JoulePerCubicMetreKelvin:
    return SOLID_HEAT if specific_heat is None else density * specific_heat


@si.checked_numbers
def isotropic_stiffness(young_modulus: si.Pascal, poisson_ratio: si.Dimensionless) -> si.FloatArray:
    """The 6 × 6 stiffness (Pa) of an isotropic solid; Voigt order xx, yy, zz, yz, xz, xy."""
    s = np.zeros((6, 6))
    s[:3, :3] = -poisson_ratio / young_modulus
    s[[0, 1, 2], [0, 1, 2]] = 1 / young_modulus
    s[[3, 4, 5], [3, 4, 5]] = 2 * (1 + poisson_ratio) / young_modulus
    return np.asarray(np.linalg.inv(s))


def _require_agreement(
    name: str, given: float | None, derived: float, from_what: str, unit: str = ""
) -> None:
    """Refuse a constant that contradicts what follows from others (`from_what`, with its verb)."""
    if given is not None and abs(given - derived) > _AGREEMENT * abs(derived):
        raise ContradictionError(
            f"{name} = {given:.4g}{unit} contradicts {from_what} {derived:.4g}{unit} (more than "
            f"{100 * _AGREEMENT:.0f} % apart); leave one out, or give both of one ceramic",
            quantity=name,
        )


@si.checked_numbers
@dataclass(frozen=True)
class PiezoConstants:
    """The full set of constants of a ceramic poled along z (class 6mm).

    Compliances s at constant field (s66 = 2(s11 − s12) within 3 %: it is isotropic across z),
    charge coefficients d, and relative permittivities at constant strain (clamped) and, where
    given, at constant stress (free) and the stress coefficients e: data given twice must agree
    within 3 %, or a `ContradictionError` names both.
    """

    compliance_11: Annotated[si.SquareMetrePerNewton, COMPLIANCE]
    compliance_12: Annotated[si.SquareMetrePerNewton, CROSS_COMPLIANCE]
    compliance_13: Annotated[si.SquareMetrePerNewton, CROSS_COMPLIANCE]
    compliance_33: Annotated[si.SquareMetrePerNewton, COMPLIANCE]
    compliance_44: Annotated[si.SquareMetrePerNewton, COMPLIANCE]
    compliance_66: Annotated[si.SquareMetrePerNewton, COMPLIANCE]
    charge_coefficient_31: Annotated[si.MetrePerVolt, CHARGE_COEFFICIENT]
    charge_coefficient_33: Annotated[si.MetrePerVolt, CHARGE_COEFFICIENT]
    charge_coefficient_15: Annotated[si.MetrePerVolt, CHARGE_COEFFICIENT]
    clamped_permittivity_11: Annotated[si.Dimensionless, PERMITTIVITY]
    clamped_permittivity_33: Annotated[si.Dimensionless, PERMITTIVITY]
    free_permittivity_11: si.Dimensionless | None = None
    free_permittivity_33: si.Dimensionless | None = None
    stress_coefficient_31: si.CoulombPerSquareMetre | None = None
    stress_coefficient_33: si.CoulombPerSquareMetre | None = None
    stress_coefficient_15: si.CoulombPerSquareMetre | None = None

    def __post_init__(self) -> None:
        if np.linalg.eigvalsh(self.compliance_matrix)[0] <= 0:
            raise ContradictionError(
                "the compliances of the ceramic contradict each other: the elastic energy of some "
                "strain would be negative; check s12 and s13 against s11 and s33",
                quantity="compliance_12",
            )
        _require_agreement(
            "compliance_66",
            self.compliance_66,
            2 * (self.compliance_11 - self.compliance_12),
            "2 (s11 - s12) of a ceramic poled along z, which is",
            " m2/N",
        )
        free = self.free_permittivity_matrix / VACUUM_PERMITTIVITY
        e = self.stress_matrix
        for name, given, derived, unit in (
            ("free_permittivity_11", self.free_permittivity_11, free[0, 0], ""),
            ("free_permittivity_33", self.free_permittivity_33, free[2, 2], ""),
            ("stress_coefficient_31", self.stress_coefficient_31, e[2, 0], " C/m2"),
            ("stress_coefficient_33", self.stress_coefficient_33, e[2, 2], " C/m2"),
            ("stress_coefficient_15", self.stress_coefficient_15, e[0, 4], " C/m2"),
        ):
            others = "the ceramic's other constants, which give"
            _require_agreement(name, given, float(derived), others, unit)

    @property
    def compliance_matrix(self) -> si.FloatArray:
        """s at constant field, 6 × 6 (m²/N)."""
        s = np.zeros((6, 6))
        s[0, 0] = s[1, 1] = self.compliance_11
        s[0, 1] = s[1, 0] = self.compliance_12
        s[0, 2] = s[2, 0] = s[1, 2] = s[2, 1] = self.compliance_13
        s[2, 2] = self.compliance_33
        s[3, 3] = s[4, 4] = self.compliance_44
        s[5, 5] = self.compliance_66
        return s

    @property
    def stiffness_matrix(self) -> si.FloatArray:
        """c at constant field, 6 × 6 (Pa)."""
        return np.asarray(np.linalg.inv(self.compliance_matrix))

    @property
    def charge_matrix(self) -> si.FloatArray:
        """d, 3 × 6 (m/V)."""
        d = np.zeros((3, 6))
        d[2, 0] = d[2, 1] = self.charge_coefficient_31
        d[2, 2] = self.charge_coefficient_33
        d[0, 4] = d[1, 3] = self.charge_coefficient_15
        return d

    @property
    def stress_matrix(self) -> si.FloatArray:
        """e = d c, 3 × 6 (C/m²)."""
        return self.charge_matrix @ self.stiffness_matrix

    @property
    def permittivity_matrix(self) -> si.FloatArray:
        """ε at constant strain, 3 × 3 (F/m)."""
        one, three = self.clamped_permittivity_11, self.clamped_permittivity_33
        return VACUUM_PERMITTIVITY * np.diag([one, one, three])

    @property
    def free_permittivity_matrix(self) -> si.FloatArray:
        """ε at constant stress = ε at constant strain + e dᵀ, 3 × 3 (F/m)."""
        return self.permittivity_matrix + self.stress_matrix @ self.charge_matrix.T


# PZT-5H, the soft ceramic whose ratios fill in what a data sheet leaves out. Compliances in m²/N,
# charge coefficients in m/V, free relative permittivities. Source: Morgan Electro Ceramics.
_PZT_5H = {
    "s11": 16.5e-12, "s12": -4.78e-12, "s13": -8.45e-12, "s33": 20.7e-12, "s44": 43.5e-12,
    "s66": 42.6e-12, "d31": -274e-12, "d33": 593e-12, "d15": 741e-12, "eps11": 3130.0,
    "eps33": 3400.0,
}  # fmt: skip


@si.checked_numbers
@dataclass(frozen=True)
class Piezoceramic:
    """A thin ceramic plate poled through its thickness, working in its plane (the 31 effect).

    The in-plane stiffness c11_p = s11/(s11² − s12²) is the one of a plate under plane stress. The
    coupling can be given twice, by the charge coefficient d31 and by the effective stress
    coefficient e31_p; `data_set` says which is believed. If both are given and differ by more than
    10 %, `check_consistency` names both. `constants` are the full three-dimensional ones; where
    they are None, `full_constants` makes them. Without a `specific_heat` it takes `SOLID_HEAT`
    (assumed).
    """

    name: str
    in_plane_stiffness: Annotated[si.Pascal, MODULUS]
    in_plane_poisson_ratio: Annotated[si.Dimensionless, si.Above(-1), si.Below(0.5)]
    shear_modulus: Annotated[si.Pascal, MODULUS]
    density: Annotated[si.KilogramPerCubicMetre, DENSITY]
    charge_coefficient: Annotated[si.MetrePerVolt, CHARGE_COEFFICIENT]
    relative_permittivity: Annotated[si.Dimensionless, PERMITTIVITY]
    quality_factor: Annotated[si.Dimensionless, QUALITY]
    stress_coefficient: Annotated[si.CoulombPerSquareMetre, STRESS_COEFFICIENT] | None = None
    data_set: PiezoDataSet = "from_d31"
    constants: PiezoConstants | None = None
    specific_heat: Annotated[si.JoulePerKilogramKelvin, SPECIFIC_HEAT] | None = None

    def __post_init__(self) -> None:
        if self.stress_coefficient is None and self.data_set == "printed_e31":
            raise ContradictionError(
                "data_set = 'printed_e31' needs a stress_coefficient; give one in C/m2, "
                "or choose data_set = 'from_d31'"
            )
        if (full := self.constants) is not None:
            plane = full.compliance_11 / (full.compliance_11**2 - full.compliance_12**2)
            for name, own, derived, unit in (
                ("in_plane_stiffness", self.in_plane_stiffness, plane, " Pa"),
                ("charge_coefficient", self.charge_coefficient, full.charge_coefficient_31, " m/V"),
            ):
                _require_agreement(name, own, derived, "the full constants, which give", unit)

    @si.checked_numbers
    def scaled(
        self,
        stiffness: Annotated[si.Dimensionless, si.Above(0.0)] = 1.0,
        charge: Annotated[si.Dimensionless, si.Above(0.0)] = 1.0,
        permittivity: Annotated[si.Dimensionless, si.Above(0.0)] = 1.0,
    ) -> Piezoceramic:
        """The ceramic of another batch: all its stiffnesses, all its d and all its clamped
        permittivities, by a factor each.

        What was stated of e and of free permittivities in the full constants belongs to the other
        ceramic, and follows anew; an effective e31 goes with d. Raises `InputError` for a factor
        that is not above 0, and what the dataclasses raise.
        """
        if stiffness == charge == permittivity == 1:
            return self
        full, e31 = self.constants, self.stress_coefficient
        if full is not None:
            pairs = {f"compliance_{pair}": 1 / stiffness for pair in (11, 12, 13, 33, 44, 66)}
            pairs |= {f"charge_coefficient_{pair}": charge for pair in (31, 33, 15)}
            pairs |= {f"clamped_permittivity_{axis}": permittivity for axis in (11, 33)}
            changed: dict[str, Any] = {name: by * getattr(full, name) for name, by in pairs.items()}
            changed |= {f"free_permittivity_{axis}": None for axis in (11, 33)}
            changed |= {f"stress_coefficient_{pair}": None for pair in (31, 33, 15)}
            full = dataclasses.replace(full, **changed)
        return dataclasses.replace(
            self,
            in_plane_stiffness=stiffness * self.in_plane_stiffness,
            charge_coefficient=charge * self.charge_coefficient,
            stress_coefficient=None if e31 is None else charge * e31,
            relative_permittivity=permittivity * self.relative_permittivity,
            constants=full,
        )

    @property
    def compliance_11(self) -> si.SquareMetrePerNewton:
        """s11 = 1 / (c11_p (1 − ν_p²)) with ν_p = −s12/s11."""
        return 1 / (self.in_plane_stiffness * (1 - self.in_plane_poisson_ratio**2))

    @property
    def heat_per_volume(self) -> si.JoulePerCubicMetreKelvin:
        """The heat that a volume of it takes per kelvin."""
        return _heat_per_volume(self.density, self.specific_heat)

    @property
    def stress_coefficient_from_d31(self) -> si.CoulombPerSquareMetre:
        """The effective in-plane e31 = d31 / (s11 + s12) of a plate free across its thickness."""
        return self.charge_coefficient / (self.compliance_11 * (1 - self.in_plane_poisson_ratio))

    @property
    def effective_stress_coefficient(self) -> si.CoulombPerSquareMetre:
        """The effective in-plane e31 of the data set that is believed."""
        if self.data_set == "printed_e31" and self.stress_coefficient is not None:
            return self.stress_coefficient
        return self.stress_coefficient_from_d31

    @property
    def full_constants(self) -> PiezoConstants:
        """All constants: those given, or PZT-5H's scaled to what is known of this ceramic.

        Compliances keep PZT-5H's ratios and are scaled to c11_p (s12 follows the in-plane Poisson
        ratio); charge coefficients keep their ratios and are scaled to d31 (from_d31), or to the
        d31 = e31_p (s11 + s12) of the printed stress coefficient (printed_e31). Clamped
        permittivities are the ones that PZT-5H's free permittivities and own charge coefficients
        leave with these compliances; `shear_modulus` and `relative_permittivity` serve the beam
        only. An assumption for any ceramic but a soft lead zirconate titanate.
        """
        if self.constants is not None:
            return self.constants
        p = _PZT_5H
        scale = self.compliance_11 / p["s11"]
        s12 = -self.in_plane_poisson_ratio * self.compliance_11
        d31 = self.charge_coefficient
        if self.data_set == "printed_e31" and self.stress_coefficient is not None:
            d31 = self.stress_coefficient * (self.compliance_11 + s12)
        bare = PiezoConstants(
            compliance_11=self.compliance_11,
            compliance_12=s12,
            compliance_13=scale * p["s13"],
            compliance_33=scale * p["s33"],
            compliance_44=scale * p["s44"],
            # PZT-5H's ratio to isotropy across the poling, which 6mm asks for, is kept.
            compliance_66=(self.compliance_11 - s12) * p["s66"] / (p["s11"] - p["s12"]),
            charge_coefficient_31=p["d31"],
            charge_coefficient_33=p["d33"],
            charge_coefficient_15=p["d15"],
            clamped_permittivity_11=1.0,
            clamped_permittivity_33=1.0,
        )
        gain = (bare.stress_matrix @ bare.charge_matrix.T) / VACUUM_PERMITTIVITY
        ratio = d31 / p["d31"]
        return dataclasses.replace(
            bare,
            charge_coefficient_31=d31,
            charge_coefficient_33=ratio * p["d33"],
            charge_coefficient_15=ratio * p["d15"],
            clamped_permittivity_11=p["eps11"] - gain[0, 0],
            clamped_permittivity_33=p["eps33"] - gain[2, 2],
        )

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


@si.checked_numbers
@dataclass(frozen=True)
class Gas:
    """The gas between finger and surface, at ambient pressure."""

    viscosity: Annotated[si.PascalSecond, VISCOSITY]
    ambient_pressure: Annotated[si.Pascal, PRESSURE]
    density: Annotated[si.KilogramPerCubicMetre, GAS_DENSITY]
    mean_free_path: Annotated[si.Metre, FREE_PATH]

    @si.checked_numbers
    def at_pressure(self, ambient_pressure: si.Pascal) -> Gas:
        """The same gas at the same temperature under another ambient pressure (Pa).

        Density goes with the pressure, the mean free path with its inverse; the viscosity stays
        (kinetic theory, down to where the gas is no continuum between the walls of its vessel).
        """
        require_within(PRESSURE, ambient_pressure, "ambient_pressure")
        ratio = ambient_pressure / self.ambient_pressure
        return Gas(
            self.viscosity, ambient_pressure, self.density * ratio, self.mean_free_path / ratio
        )
