"""The bending actuator of a skin-stretch array: what it is, and what it does as a strip of plate.

Layers thin against the width, sides free: the bending moment across the width vanishes in the mean,
but not in each layer, where one ceramic widens and the other narrows. A narrow beam (plane stress
in every layer, `triple_layer`) has none of that and is what is published; the three-dimensional
solid (`solid_bender`) says which to take. Measured on PZT-5H: at a width of twice the thickness the
narrow beam deflects 7 to 11 % too much, the strip within 1 % (`Bimorph.as_strip` says where); only
at a fifth of the thickness is the narrow beam the better (3 % too much).
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Annotated, Literal

from squeezefilm.actuators.skin_stretch import triple_layer
from squeezefilm.actuators.skin_stretch.clamp_hold import ClampHold
from squeezefilm.core import hard_limits as hard
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import GeometryError, OutOfRangeError
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.plate.laminate import Laminate, Layer, laminate

Wiring = Literal["parallel", "series"]

LEAST_SLENDERNESS = 4.0
"""Length over width, and over thickness, from which beams are answered for: the rigid clamp is felt
over about a width, and at 10 widths adds some 2 % to the deflection by voltage (`ClampHold`)."""

_M, _V = si.Unit("m"), si.Unit("V")


@si.checked_numbers
@dataclass(frozen=True)
class Bender:
    """What a bending actuator does at its tip: `deflection_per_volt` (free, quasi-static) and
    `stiffness` and `resonance_frequency` with the voltage held; `capacitance` of the free actuator;
    `theory` that made it: "strip" (a plate with free sides) or "solid" (three dimensions)."""

    deflection_per_volt: Annotated[si.MetrePerVolt, si.Above(0)]
    stiffness: Annotated[si.NewtonPerMetre, si.Above(0)]
    resonance_frequency: Annotated[si.Hertz, si.Above(0)]
    capacitance: Annotated[si.Farad, si.Above(0)]
    theory: Literal["strip", "solid"]

    @property
    def force_per_volt(self) -> si.NewtonPerVolt:
        """The blocked force at the tip."""
        return self.deflection_per_volt * self.stiffness

    @property
    def effective_mass(self) -> si.Kilogram:
        """k/(2π f1)²: the mass at the tip that resonates with its stiffness at f1."""
        return self.stiffness / (2 * math.pi * self.resonance_frequency) ** 2

    @property
    def bandwidth(self) -> si.Hertz:
        """Where the free tip has risen 3 dB above its quasi-static deflection on the way to the
        resonance, f1 √(1 − 1/√2), from one mode without damping. The skin's load moves it
        (`load_line.loaded_tip`)."""
        return self.resonance_frequency * math.sqrt(1 - 1 / math.sqrt(2))


@si.checked_numbers
@dataclass(frozen=True)
class Bimorph:
    """Two equal ceramics on a shim, clamped at one end; the free end pulls the skin.

    `length` is the free length. `wiring`: "parallel" puts the whole voltage on each ceramic (the
    shim is an electrode), "series" half of it. `electrode_thickness` is that of the metal on each
    outer face, of `electrode` (None: its stiffness and mass are neglected). A `shim_thickness` of 0
    is a bimorph without one. `depolarising_field` (V/m) is the field against its poling that a
    ceramic may see: soft ceramics lose their poling at some 0.5 kV/mm (assumed: a typical figure,
    take the maker's); one of the two ceramics is always driven against it. `loss_tangent` (1) is
    dielectric, at the voltage used (assumed 2 %, small signals; strong fields double or treble it).

    Raises `GeometryError` for a beam too short for its width or thickness.
    """

    length: Annotated[si.Metre, hard.SIDE]
    width: Annotated[si.Metre, hard.SIDE]
    ceramic: Piezoceramic
    ceramic_thickness: Annotated[si.Metre, hard.LAYER]
    shim: ElasticMaterial
    shim_thickness: Annotated[si.Metre, si.AtLeast(0), si.AtMost(hard.LAYER.most)] = 0.0
    wiring: Wiring = "parallel"
    electrode: ElasticMaterial | None = None
    electrode_thickness: Annotated[si.Metre, si.AtLeast(0), si.AtMost(hard.LAYER.most)] = 0.0
    depolarising_field: Annotated[si.VoltPerMetre, si.Above(0)] = 5e5
    loss_tangent: Annotated[si.Dimensionless, si.AtLeast(0), si.Below(1)] = 0.02

    def __post_init__(self) -> None:
        if not self.coupling < 1:
            raise OutOfRangeError(
                f"k31² = {self.coupling:.3g} of {self.ceramic.name} is not below 1: its d31, s11 "
                "and permittivity cannot be of one ceramic; correct the slip",
                quantity="ceramic",
            )
        for name, across in (("width", self.width), ("thickness", self.thickness)):
            if self.length < LEAST_SLENDERNESS * across:
                raise GeometryError(
                    f"a bending actuator of length {si.format_quantity(self.length, _M)} has a "
                    f"{name} of {si.format_quantity(across, _M)}; as a beam it must be at least "
                    f"{LEAST_SLENDERNESS:.0f} times as long: make it longer, or that smaller"
                )

    @property
    def thickness(self) -> si.Metre:
        """Of all layers together."""
        return 2 * (self.ceramic_thickness + self.electrode_thickness) + self.shim_thickness

    @property
    def free_permittivity(self) -> si.FaradPerMetre:
        """εᵀ33 of the ceramic, from its full constants."""
        return float(self.ceramic.full_constants.free_permittivity_matrix[2, 2])

    @property
    def coupling(self) -> si.Dimensionless:
        """k31² of the ceramic, from its full constants."""
        full = self.ceramic.full_constants
        return float(
            triple_layer.coupling_squared(
                full.charge_coefficient_31, full.compliance_11, self.free_permittivity
            )
        )

    def _layers(self, of: Literal["bending", "across", "twist"]) -> Laminate:
        """The layers as the plate room bends them: with the moduli of bending along (c11), of what
        bending along asks for across (c12), or of twisting (c66), each in plane stress, at constant
        field."""
        full, shim = self.ceramic.full_constants, self.electrode
        s11, s12 = full.compliance_11, full.compliance_12
        area = s11**2 - s12**2
        moduli = {"bending": s11 / area, "across": -s12 / area, "twist": 0.5 / (s11 - s12)}
        own = Layer(
            self.ceramic_thickness,
            moduli[of],
            self.ceramic.shear_modulus,
            self.ceramic.density,
        )

        def metal(material: ElasticMaterial | None, thickness: float) -> list[Layer]:
            if material is None or thickness == 0:
                return []
            modulus = material.plane_strain_modulus
            if of == "across":
                modulus *= max(material.poisson_ratio, 1e-9)
            if of == "twist":
                modulus = material.shear_modulus
            return [Layer(thickness, modulus, material.shear_modulus, material.density)]

        skin, core = metal(shim, self.electrode_thickness), metal(self.shim, self.shim_thickness)
        return laminate([*skin, own, *core, own, *skin])

    @functools.cached_property
    def section(self) -> Laminate:
        """The layers in bending along the beam with none across it, at constant field. Electrodes
        without a material are left out."""
        return self._layers("bending")

    @functools.cached_property
    def _bending(self) -> tuple[float, float]:
        """D11 and D12 per width (N·m), with what the field adds that follows the strain: e31²/ε
        about the middle of each ceramic, to both."""
        added = self._stress_coefficient**2 / self._held_permittivity
        added *= self.ceramic_thickness**3 / 6
        return (
            self.section.bending_stiffness + added,
            self._layers("across").bending_stiffness + added,
        )

    @property
    def _clamp(self) -> ClampHold:
        along, across = self._bending
        return ClampHold.of(along, across, self._layers("twist").bending_stiffness, self.width)

    @property
    def _stress_coefficient(self) -> float:
        """|e31| in plane stress across the thickness (C/m²), d31/(s11 + s12)."""
        full = self.ceramic.full_constants
        return abs(full.charge_coefficient_31) / (full.compliance_11 + full.compliance_12)

    @property
    def _held_permittivity(self) -> float:
        """ε33 (F/m) with both strains in the plane held: εᵀ33 − 2 d31²/(s11 + s12)."""
        full = self.ceramic.full_constants
        return self.free_permittivity - 2 * (
            full.charge_coefficient_31 * self._stress_coefficient
        ) * math.copysign(1, full.charge_coefficient_31)

    @property
    def ceramic_share(self) -> si.Dimensionless:
        """The voltage of one ceramic over that of the actuator: 1 in parallel, 1/2 in series."""
        return 1.0 if self.wiring == "parallel" else 0.5

    @property
    def mass(self) -> si.Kilogram:
        """Of the free length."""
        return self.section.mass_per_area * self.length * self.width

    @functools.cached_property
    def as_strip(self) -> Bender:
        """The actuator as a strip of plate with free sides, thin against its width and length.

        The voltage makes the same moment per width M along and across, M = 2 e31 z per volt of a
        ceramic with z the arm of the laminate; with no moment across in the mean the curvature is
        M/(D11 + D12), and against a force at the tip G = (D11² − D12²)/D11. Near the clamp the
        width cannot bend: see `ClampHold`. Charge by reciprocity. Deflection and stiffness are
        within 1.1 % of the solid's from 4 widths of length on where the width is 8 thicknesses; at
        2 thicknesses of width from 8 widths on, a shim half as thick as the whole 2 %; a square
        section deflects 3 % more than this (`tests/verification/test_skin_stretch_bimorph.py`
        measures all that). Source:
        classical lamination theory with D3 the same at every height of a ceramic (compare
        `triple_layer`).
        """
        along, across = self._bending
        upper = (len(self.section.layers) + 1) // 2
        moment = 2 * self._stress_coefficient * abs(self.section.moment_arm(upper))
        moment *= self.ceramic_share
        free = moment / (along + across)
        stiffness = (along**2 - across**2) / along
        held = self._held_permittivity * self.length * self.width / self.ceramic_thickness
        frequency = triple_layer.resonance_frequency(
            stiffness, self.section.mass_per_area, self.length
        )
        further, stiffer = self._clamp.shares(self.length)
        return Bender(
            free * self.length**2 / 2 * further,
            float(triple_layer.tip_stiffness(stiffness, self.width, self.length)) * stiffer,
            float(frequency) * math.sqrt(stiffer),
            2 * held * self.ceramic_share**2 + 2 * moment * free * self.width * self.length,
            "strip",
        )

    @property
    def largest_voltage(self) -> si.Volt:
        """The voltage at which the ceramic driven against its poling sees `depolarising_field`."""
        return self.depolarising_field * self.ceramic_thickness / self.ceramic_share

    @si.checked_numbers
    def require_voltage(self, voltage: si.Volt) -> None:
        """Refuse a voltage (V, either sign) that undoes the poling. Raises `OutOfRangeError`."""
        if abs(voltage) > self.largest_voltage:
            field = abs(voltage) * self.ceramic_share / self.ceramic_thickness
            raise OutOfRangeError(
                f"a voltage of {si.format_quantity(voltage, _V)} puts {field / 1e6:.3g} kV/mm on a "
                f"ceramic of {si.format_quantity(self.ceramic_thickness, _M)} against its poling; "
                f"at most {self.depolarising_field / 1e6:.3g} kV/mm is allowed, which is "
                f"{si.format_quantity(self.largest_voltage, _V)}: lower it, or take thicker "
                "ceramics",
                quantity="voltage",
            )
