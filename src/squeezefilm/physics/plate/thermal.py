"""Warmth of a plate and its effects, as a description says it; the body that is warm.

Nothing here was measured on a display: every default is assumed, and says from what.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, NamedTuple

from squeezefilm.core import quantities as si
from squeezefilm.core.materials import SOLID_HEAT
from squeezefilm.physics.plate.layout import Actuator, AnnularStator, DiscPlate, RectangularPlate

LOSS_TANGENT = 0.02
"""Dielectric loss of the ceramic (assumed; data sheets of soft PZT give 0.015 to 0.03)."""
STATOR_THICKNESS: si.Metre = 4e-3
"""Thickness of a motor's stator, which no description of it states (assumed)."""


@si.checked_numbers
@dataclass(frozen=True)
class Thermal:
    """Thermal description of a plate: how it warms and what warmth, speed and field do to it.

    Args:
        thermal_resistance: warmth per power lost in the plate (K/W), where it was measured; None
            computes it from the plate's faces. At 0 the plate keeps the room's temperature.
        thermal_time: time constant of warming (s), where it was measured; None computes it from
            mass and specific heat.
        emissivity: of both faces, for their radiation (1): an adhesive film has 0.9, bare metal
            0.1. Used where the resistance is computed; None is not known, and 0.5 is assumed.
        ambient_temperature: of the room (K).
        temperature_coefficient: of the resonance frequency, relative (1/K).
        charge_temperature_coefficient: of the ceramic's charge coefficient, relative (1/K); 0 is
            "not known".
        quality_temperature_coefficient: of the quality factor, relative (1/K); 0 is "not known".
        rayleigh_softening: relative fall of the resonance frequency per peak speed of the surface
            (s/m), by the Rayleigh law; its loss follows. 0, not measured, is off.
        rayleigh_charge: relative rise of the charge coefficient per peak field (m/V), by the
            Rayleigh law. 0, not measured, is off.
        coercive_field: of the ceramic (V/m); a third of it is warned of.
        highest_speed: of the surface, r.m.s. (m/s), that is warned of; None takes 0.3 m/s of a hard
            ceramic (Q of 200 and more) and 0.1 m/s of a soft one.

    Raises:
        InputError: a value outside its range.
    """

    thermal_resistance: Annotated[si.KelvinPerWatt, si.AtLeast(0.0), si.AtMost(1e6)] | None = None
    thermal_time: Annotated[si.Second, si.Above(0.0), si.AtMost(1e7)] | None = None
    emissivity: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)] | None = None
    ambient_temperature: Annotated[si.AbsoluteKelvin, si.AtLeast(230.0), si.AtMost(350.0)] = 293.15
    temperature_coefficient: Annotated[si.PerKelvin, si.Above(-1e-2), si.Below(1e-2)] = -1e-4
    charge_temperature_coefficient: Annotated[si.PerKelvin, si.Above(-1e-1), si.Below(1e-1)] = 0.0
    quality_temperature_coefficient: Annotated[si.PerKelvin, si.Above(-1e-1), si.Below(1e-1)] = 0.0
    rayleigh_softening: Annotated[si.SecondPerMetre, si.AtLeast(0.0), si.AtMost(1.0)] = 0.0
    rayleigh_charge: Annotated[si.MetrePerVolt, si.AtLeast(0.0), si.AtMost(1e-3)] = 0.0
    coercive_field: Annotated[si.VoltPerMetre, si.Above(0.0), si.AtMost(1e9)] = 1e6
    highest_speed: Annotated[si.MetrePerSecond, si.Above(0.0), si.AtMost(1e3)] | None = None


class Cooling(NamedTuple):
    """Cooling of a body: a fixed conductance (W/K; 0 where it is computed), the area of one face
    (m²), area over perimeter (m), emissivity, the room's temperature (K)."""

    fixed: float
    area: float
    length: float
    emissivity: float
    ambient: float


@dataclass(frozen=True)
class ThermalBody:
    """Body that is warm: one temperature, two faces that give heat away.

    `face_area` is of one face, `perimeter` around it, `heat_capacity` of all that vibrates, without
    glue and supports. `assumed` says what its description leaves open.
    """

    face_area: si.SquareMetre
    perimeter: si.Metre
    heat_capacity: si.JoulePerKelvin
    assumed: tuple[str, ...] = ()


def thermal_body(actuator: Actuator) -> ThermalBody:
    """Faces, mass and heat of a plate, a disc or a stator.

    Both faces of the substrate count, its edges do not (a tenth of the area of a plate of 2 mm):
    they make it warmer than it gets. A stator is taken as a plain ring of `STATOR_THICKNESS`.
    """
    if isinstance(actuator, AnnularStator):
        around = math.pi * actuator.mean_diameter
        area = around * actuator.radial_width
        capacity = area * STATOR_THICKNESS * SOLID_HEAT
        stator = f"a stator {1e3 * STATOR_THICKNESS:g} mm thick that takes 3 J/(cm3 K)"
        return ThermalBody(area, 2 * around, capacity, (stator,))
    if isinstance(actuator, DiscPlate):
        outer, inner = actuator.diameter, actuator.inner_diameter
        area = math.pi / 4 * (outer**2 - inner**2)
        perimeter = math.pi * (outer + inner)
        hole, rim = actuator.ceramic_inner_diameter, actuator.ceramic_outer_diameter
        ceramic = math.pi / 4 * (rim**2 - hole**2) * actuator.ceramic_thickness
    else:
        area, perimeter = actuator.area, 2 * (actuator.length + actuator.width)
        ceramic = sum(patch.length * patch.width * patch.thickness for patch in actuator.patches)
    metal, piezo = actuator.substrate, actuator.ceramic
    capacity = area * actuator.thickness * metal.heat_per_volume + ceramic * piezo.heat_per_volume
    said = tuple(
        f"specific heat of {part.name}" for part in (metal, piezo) if part.specific_heat is None
    )
    return ThermalBody(area, perimeter, capacity, said)


def driven_thickness(actuator: Actuator) -> si.Metre | None:
    """Distance of the electrodes of the thinnest ceramic (m); None where none is described."""
    if isinstance(actuator, RectangularPlate):
        driven = [patch.thickness for patch in actuator.patches if patch.electrode == "driven"]
        return min(driven, default=None)
    return actuator.ceramic_thickness if isinstance(actuator, DiscPlate) else None
