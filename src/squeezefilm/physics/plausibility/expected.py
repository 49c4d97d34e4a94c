"""Forecast of a display by closed forms, before anything is solved, and values to compare with what
is usual: ratios, speeds, fields, each at the key that is most likely the wrong one.

A plate is a Timoshenko beam that carries ceramic in places, a disc a thin free plate. A few
milliseconds.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median
from typing import Annotated, NamedTuple

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.core.materials import Gas, Piezoceramic
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.beam_response import BeamResponse, beam_response
from squeezefilm.physics.plate.laminate import plate_laminate
from squeezefilm.physics.plate.layout import (
    Actuator,
    AnnularStator,
    CeramicPatch,
    DiscPlate,
    RectangularPlate,
)
from squeezefilm.physics.plate.solid.forecast import bare_frequency
from squeezefilm.physics.plate.thermal import driven_thickness

# How far estimates may be off, as a factor. All of 95 random plates lay within 1.13 of the solved
# frequency (tests/verification/test_beam_beside_solid.py); the disc as `_of_disc` says.
_PLATE_OFF, _DISC_OFF = 1.15, 2.0
# What strips along edges drive is not told: they drive modes along the other side as well.
_COVERED = 0.8
_USUAL_BAND: tuple[si.Hertz, si.Hertz] = (20e3, 200e3)
_DENSE: si.KilogramPerCubicMetre = 2100.0
_FILM: si.Metre = 20e-6
Path = tuple[str | int, ...]


@dataclass(frozen=True)
class Expectation:
    """An estimate of a working mode: `frequency` (Hz) is right within the factor `off`.

    `amplitude_per_volt` (m/V) is at the largest interior lobe and `power_per_mass` (W/kg) that of
    one volt, both None where the estimate does not know them; `model` names what made it.
    """

    frequency: si.Hertz
    off: si.Dimensionless
    model: str
    amplitude_per_volt: si.MetrePerVolt | None = None
    power_per_mass: Annotated[float, si.Unit("W/kg/V2")] | None = None
    half_wavelength_over_thickness: si.Dimensionless | None = None

    @property
    def nearest_frequency(self) -> si.Hertz:
        """The frequency within the estimate's doubt that is nearest to what displays work at."""
        low, high = _USUAL_BAND
        wanted = min(max(self.frequency, low), high)
        return min(max(wanted, self.frequency / self.off), self.frequency * self.off)

    @property
    def sentence(self) -> str:
        """Sentence on what is expected, for people who wait: ``"about 33.4 kHz (mostly right to 15
        %), 110 nm/V (to a factor of two), by a beam"``."""
        known = self.off == 1
        said = f"about {si.format_quantity(self.frequency, si.Unit('Hz'), 3)}"
        said += "" if known else f" (mostly right to {100 * (self.off - 1):.0f} %)"
        if self.amplitude_per_volt is not None:
            said += f", {si.format_quantity(self.amplitude_per_volt, si.Unit('m/V'), 2)}"
            said += "" if known else " (to a factor of two)"
        return f"{said}, by {self.model}"


@functools.lru_cache(maxsize=64)
def expectation(actuator: Actuator) -> Expectation | None:
    """Expected working mode of an actuator; None where no closed form says it."""
    try:
        if isinstance(actuator, AnnularStator):
            return _of_stator(actuator)
        if isinstance(actuator, DiscPlate):
            return _of_disc(actuator)
        return _of_plate(actuator)
    except (InputError, OverflowError, ZeroDivisionError):
        return None


def _of_stator(ring: AnnularStator) -> Expectation:
    per_volt = ring.reference_amplitude / ring.reference_voltage
    return Expectation(ring.resonance_frequency, 1.0, "its measurement", per_volt)


def _of_plate(plate: RectangularPlate) -> Expectation:
    span = plate.length if plate.lines_across == "length" else plate.width
    flexural = span / (plate.nodal_lines - 0.5) / plate.thickness
    try:
        beam = beam_response(plate)
    except OutOfRangeError:
        bare = bare_frequency(plate, plate.working_label)
        return Expectation(bare, _DISC_OFF, "a thin plate", None, None, flexural)
    covered = plate.coverage >= _COVERED
    per_volt, power = (beam.amplitude_per_volt, _beam_power(beam)) if covered else (None, None)
    return Expectation(beam.mode.frequency, _PLATE_OFF, "a beam", per_volt, power, flexural)


def _beam_power(beam: BeamResponse) -> float:
    """The power (W) that one volt loses at resonance over the plate's mass: the mode's kinetic
    energy, ½ m (ωA)²/2 of a shape whose mean square is half that of its lobe, times ω/Q."""
    omega = 2 * math.pi * beam.mode.frequency
    speed = omega * beam.amplitude_per_volt
    return 0.25 * speed**2 * omega / beam.plate.quality_factor


def _of_disc(disc: DiscPlate) -> Expectation:
    """A thin free disc: λ² = (π/2 (n + 2s))² of n nodal diameters and s circles, for large ones;
    within a factor of two for the lowest (Leissa 1969, NASA SP-160, has 5.25 for n = 2, s = 0 and
    9.08 for n = 0, s = 1 where this gives 9.87)."""
    section = plate_laminate(disc)
    order = disc.nodal_diameters + 2 * disc.nodal_circles
    number = math.pi / 2 * order / (disc.diameter / 2)
    frequency = (
        number**2 * math.sqrt(section.bending_stiffness / section.mass_per_area) / (2 * math.pi)
    )
    # The ceramic may be smaller than the disc; then the bare disc is nearer.
    half = disc.diameter / order / disc.thickness
    return Expectation(frequency, _DISC_OFF, "a thin disc", None, None, half)


class Ratio(NamedTuple):
    """A value (SI) that the bound `of` holds for, at the key `path` of the description.

    `told` is the estimate that people are told, where a doubt is taken off what is compared.
    """

    of: str
    path: Path
    value: float
    told: float | None = None


def ratios(display: Display, voltage: si.Volt | None = None) -> Iterator[Ratio]:
    """All that is compared of a display driven with a voltage (V, zero-to-peak; None: its own).

    Closed forms only: a few milliseconds.
    """
    actuator = display.actuator
    volts = display.drive.voltage if voltage is None else voltage
    if isinstance(actuator, RectangularPlate):
        yield from _ratios_of_plate(actuator)
    if isinstance(actuator, DiscPlate):
        yield Ratio(
            "ceramic over plate thickness",
            ("actuator", "ceramic_thickness"),
            actuator.ceramic_thickness / actuator.thickness,
        )
        yield Ratio(
            "plate thickness over its shorter side",
            ("actuator", "thickness"),
            actuator.thickness / actuator.diameter,
        )
        yield from _of_glue(actuator, actuator.ceramic_thickness)
    if isinstance(actuator, AnnularStator):
        yield from _ratios_of_stator(actuator)
    else:
        yield from _of_materials(actuator)
    yield from _of_drive(display, volts)
    yield from _of_expected(display, expectation(actuator), volts)
    yield from _of_finger(display)
    yield from _of_gas(display.gas)


def _ratios_of_plate(plate: RectangularPlate) -> Iterator[Ratio]:
    at: Path = ("actuator", "thickness")
    shorter, longer = sorted(plate.extent)
    yield Ratio("plate thickness over its shorter side", at, plate.thickness / shorter)
    yield Ratio("plate thickness over its longer side", at, plate.thickness / longer)
    covered = "area of ceramics over that of the plate"
    yield Ratio(covered, ("actuator", "patches"), plate.coverage)
    sizes = {
        name: [getattr(patch, name) for patch in plate.patches]
        for name in ("length", "width", "thickness")
    }
    for number, patch in enumerate(plate.patches):
        yield from _of_patch(plate, patch, ("actuator", "patches", number))
        for name, all_of_them in sizes.items():
            if len(all_of_them) > 1:
                # Against the others: of two that differ either may be the wrong one.
                others = median(all_of_them[:number] + all_of_them[number + 1 :])
                yield Ratio(
                    "ceramic size over its neighbours'",
                    ("actuator", "patches", number, name),
                    getattr(patch, name) / others,
                )
    yield from _of_glue(plate, min(sizes["thickness"]))


def _of_patch(plate: RectangularPlate, patch: CeramicPatch, at: Path) -> Iterator[Ratio]:
    yield Ratio(
        "ceramic over plate thickness", (*at, "thickness"), patch.thickness / plate.thickness
    )
    for name in ("length", "width"):
        side: si.Metre = getattr(patch, name)
        yield Ratio("ceramic side over its thickness", (*at, name), side / patch.thickness)


def _of_glue(actuator: RectangularPlate | DiscPlate, ceramic: si.Metre) -> Iterator[Ratio]:
    if actuator.glue is None:
        return
    at: Path = ("actuator", "glue", "thickness")
    yield Ratio("glue over ceramic thickness", at, actuator.glue.thickness / ceramic)
    yield Ratio("glued film's thickness", _thickness_key(actuator), ceramic)


def _thickness_key(actuator: RectangularPlate | DiscPlate) -> Path:
    """The key of the thinnest ceramic's thickness."""
    if isinstance(actuator, DiscPlate):
        return ("actuator", "ceramic_thickness")
    sizes = [patch.thickness for patch in actuator.patches]
    return ("actuator", "patches", sizes.index(min(sizes)), "thickness")


def _of_materials(actuator: RectangularPlate | DiscPlate) -> Iterator[Ratio]:
    substrate, ceramic = actuator.substrate, actuator.ceramic
    speed = math.sqrt(substrate.young_modulus / substrate.density)
    at: Path = ("actuator", "substrate", "young_modulus")
    yield Ratio("wave speed of the substrate", at, speed)
    if substrate.density > _DENSE:
        yield Ratio("wave speed of a dense substrate", at, speed)
    yield Ratio(
        "wave speed of the ceramic",
        ("actuator", "ceramic", "in_plane_stiffness"),
        math.sqrt(ceramic.in_plane_stiffness / ceramic.density),
    )
    yield from _of_constants(ceramic)


def _of_constants(ceramic: Piezoceramic) -> Iterator[Ratio]:
    full = ceramic.constants
    if full is None:
        return
    for of, name, part, whole in (
        ("s33 over s11", "compliance_33", full.compliance_33, full.compliance_11),
        ("s44 over s11", "compliance_44", full.compliance_44, full.compliance_11),
        ("s13 over s12", "compliance_13", full.compliance_13, full.compliance_12),
        (
            "d33 over d31",
            "charge_coefficient_33",
            full.charge_coefficient_33,
            full.charge_coefficient_31,
        ),
        (
            "d15 over d31",
            "charge_coefficient_15",
            full.charge_coefficient_15,
            full.charge_coefficient_31,
        ),
    ):
        if whole != 0:
            yield Ratio(of, ("actuator", "ceramic", "constants", name), part / whole)


def _ratios_of_stator(ring: AnnularStator) -> Iterator[Ratio]:
    yield Ratio(
        "speed of the stator's wave",
        ("actuator", "wavelength"),
        ring.wavelength * ring.resonance_frequency,
    )
    yield Ratio(
        "radial width over mean diameter",
        ("actuator", "radial_width"),
        ring.radial_width / ring.mean_diameter,
    )
    if ring.tooth_pitch is not None and ring.slot_width is not None:
        yield Ratio(
            "slot over tooth pitch",
            ("actuator", "slot_width"),
            ring.slot_width / ring.tooth_pitch,
        )


def _of_drive(display: Display, volts: si.Volt) -> Iterator[Ratio]:
    thickness = driven_thickness(display.actuator)
    if thickness is None:
        return
    of = "field in the ceramic" if thickness > _FILM else "field in a film"
    yield Ratio(of, ("drive", "voltage"), volts / thickness)


def _of_expected(display: Display, seen: Expectation | None, volts: si.Volt) -> Iterator[Ratio]:
    """Ratios by a closed estimate of the vibration, where it says enough to doubt it."""
    if seen is None:
        return
    by_kind = {"rectangular_plate": "nodal_lines", "disc": "nodal_circles"}
    at: Path = ("actuator", by_kind.get(display.actuator.type, "resonance_frequency"))
    yield Ratio("expected frequency", at, seen.nearest_frequency, seen.frequency)
    if seen.half_wavelength_over_thickness is not None:
        yield Ratio("half wave over plate thickness", at, seen.half_wavelength_over_thickness)
    if seen.amplitude_per_volt is not None:
        amplitude = volts * seen.amplitude_per_volt
        yield Ratio("expected amplitude", ("drive", "voltage"), amplitude)
    if seen.power_per_mass is not None:
        yield Ratio("expected power per mass", ("drive", "voltage"), volts**2 * seen.power_per_mass)


def _of_finger(display: Display) -> Iterator[Ratio]:
    finger = display.finger
    yield Ratio(
        "plateau over ridge period",
        ("finger", "plateau_width"),
        finger.plateau_width / finger.ridge_period,
    )
    yield Ratio("pressure under the finger", ("finger", "contact_length"), finger.mean_pressure)


def _of_gas(gas: Gas) -> Iterator[Ratio]:
    pressure = gas.ambient_pressure
    yield Ratio("gas density over pressure", ("gas", "density"), gas.density / pressure)
    # Kinetic theory with Maxwell's viscosity: Bird 1994, 10.1093/oso/9780198561958.001.0001.
    kinetic = gas.viscosity * math.sqrt(math.pi / (2 * gas.density * pressure))
    yield Ratio(
        "mean free path over the kinetic one",
        ("gas", "mean_free_path"),
        gas.mean_free_path / kinetic,
    )
