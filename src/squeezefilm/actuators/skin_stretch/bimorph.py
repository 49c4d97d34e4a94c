"""The bending actuator of a skin-stretch array: what it moves, pushes, and asks of its driver."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Annotated, Literal

from squeezefilm import hard_limits as hard
from squeezefilm import quantities as si
from squeezefilm.actuators.skin_stretch import triple_layer
from squeezefilm.errors import GeometryError, OutOfRangeError
from squeezefilm.materials import ElasticMaterial, Piezoceramic
from squeezefilm.plate.laminate import Laminate, Layer, laminate

Wiring = Literal["parallel", "series"]

LEAST_SLENDERNESS = 4.0
"""Length over width, and over thickness, from which a narrow beam is a fair description: the clamp
is felt over about a width. At this ratio the three-dimensional solid deflects some 3 % less (see
`tests/verification/test_skin_stretch_bimorph.py`); above 8 the two agree within 1 %."""

_M, _V, _E = si.Unit("m"), si.Unit("V"), si.Unit("V/m")


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

    @functools.cached_property
    def section(self) -> Laminate:
        """The layers as the plate room bends them, each free across its width, at constant field.

        Electrodes without a material are left out.
        """
        full = self.ceramic.full_constants
        ceramic = Layer(
            self.ceramic_thickness,
            1 / full.compliance_11,
            self.ceramic.shear_modulus,
            self.ceramic.density,
        )

        def metal(material: ElasticMaterial | None, thickness: float) -> list[Layer]:
            if material is None or thickness == 0:
                return []
            return [
                Layer(thickness, material.young_modulus, material.shear_modulus, material.density)
            ]

        skin = metal(self.electrode, self.electrode_thickness)
        core = metal(self.shim, self.shim_thickness)
        return laminate([*skin, ceramic, *core, ceramic, *skin])

    @property
    def bending_stiffness(self) -> si.NewtonMetre:
        """G per width with the voltage held: the laminate's, and what the field adds that follows
        the strain (`triple_layer.field_stiffening`)."""
        added = triple_layer.field_stiffening(
            self.ceramic_thickness, self.ceramic.full_constants.compliance_11, self.coupling
        )
        return self.section.bending_stiffness + float(added)

    @property
    def ceramic_share(self) -> si.Dimensionless:
        """The voltage of one ceramic over that of the actuator: 1 in parallel, 1/2 in series."""
        return 1.0 if self.wiring == "parallel" else 0.5

    @property
    def moment_per_volt(self) -> si.NewtonPerVolt:
        """The bending moment per width that one volt on the actuator makes, taken positive.

        From the arms of the laminate: each ceramic pulls with d31/s11 per volt of its own.
        """
        full = self.ceramic.full_constants
        upper = len(self.section.layers) // 2 + (1 if len(self.section.layers) % 2 else 0)
        force = abs(full.charge_coefficient_31) / full.compliance_11
        return 2 * force * self.ceramic_share * abs(self.section.moment_arm(upper))

    @property
    def deflection_per_volt(self) -> si.MetrePerVolt:
        """The free deflection of the tip, quasi-static."""
        return self.moment_per_volt * self.length**2 / (2 * self.bending_stiffness)

    @property
    def force_per_volt(self) -> si.NewtonPerVolt:
        """The blocked force at the tip."""
        return 3 * self.moment_per_volt * self.width / (2 * self.length)

    @property
    def stiffness(self) -> si.NewtonPerMetre:
        """Of the tip, with the voltage held."""
        return float(
            triple_layer.tip_stiffness(self.bending_stiffness, self.width, self.length)
        )

    @property
    def resonance_frequency(self) -> si.Hertz:
        """The first bending resonance of the free actuator, with the voltage held."""
        return float(
            triple_layer.resonance_frequency(
                self.bending_stiffness, self.section.mass_per_area, self.length
            )
        )

    @property
    def effective_mass(self) -> si.Kilogram:
        """k/(2π f1)²: the mass at the tip that resonates with it at f1 (0.243 of the beam's)."""
        return self.stiffness / (2 * math.pi * self.resonance_frequency) ** 2

    @property
    def mass(self) -> si.Kilogram:
        """Of the free length."""
        return self.section.mass_per_area * self.length * self.width

    @property
    def capacitance(self) -> si.Farad:
        """Of the free actuator at low frequency.

        In parallel 2 (C0 + q²/k_e), with C0 that of a ceramic that may not bend and the rest the
        charge that bending brings; in series a quarter of that.
        """
        held = triple_layer.clamped_capacitance(
            self.free_permittivity, self.coupling, self.ceramic_thickness, self.length, self.width
        )
        # The charge of bending by a volt is the moment of a volt times the tip's rotation.
        bent = self.moment_per_volt**2 * self.width * self.length / self.bending_stiffness
        return 2 * float(held) * self.ceramic_share**2 + bent

    @property
    def bandwidth(self) -> si.Hertz:
        """The frequency up to which the free tip stays within 3 dB of its quasi-static deflection:
        f1 √(1 − 1/√2), from one mode without damping. The skin's load moves it
        (`load_line.Loaded.bandwidth`)."""
        return self.resonance_frequency * math.sqrt(1 - 1 / math.sqrt(2))

    @property
    def largest_voltage(self) -> si.Volt:
        """The voltage at which the ceramic driven against its poling sees `depolarising_field`."""
        return self.depolarising_field * self.ceramic_thickness / self.ceramic_share

    @si.checked_numbers
    def require_voltage(self, voltage: si.Volt) -> None:
        """Refuse a voltage (V, either sign) that would undo the poling. Raises `OutOfRangeError`."""
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

    @si.checked_numbers
    def power(
        self, voltage: si.Volt, frequency: Annotated[si.Hertz, si.AtLeast(0)]
    ) -> si.Watt:
        """The heat in the ceramic (W) of a sinusoidal voltage (V, zero to peak) at a frequency,
        π f C tan δ V². Holds well below the resonance. Raises `OutOfRangeError` beyond the voltage
        that undoes the poling."""
        self.require_voltage(voltage)
        return math.pi * frequency * self.capacitance * self.loss_tangent * voltage**2
