"""A solved plate, disc or stator: its modes, the working one, a summary, and what the working mode
becomes where one thing is different."""

from __future__ import annotations

import dataclasses
import functools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal, TypeVar

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.results import Result, stamp, to_json, values_of
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.circuit import DrivenResponse, EquivalentCircuit
from squeezefilm.physics.plate.electronics import ElectricalLoad, electrical_load
from squeezefilm.physics.plate.layout import DiscPlate, GlueLayer, RectangularPlate
from squeezefilm.physics.plate.solid.modes import Label, PlateModes
from squeezefilm.physics.plate.solid.response import harmonic_response
from squeezefilm.physics.plate.solid.solve import solve_modes
from squeezefilm.physics.plate.solid.symmetry import drive_signs
from squeezefilm.physics.plate.sound import SoundField
from squeezefilm.physics.plate.working_mode import WorkingMode
from squeezefilm.physics.uncertainty.parameters import with_values

if TYPE_CHECKING:
    from squeezefilm.physics.plate.warming import Warming

ALONE = "the budget left no time for the other modes of the band"
"""Sentence where only the working mode was solved."""


@dataclass(frozen=True)
class ModeRow:
    """A mode of the table: label by nodal lines across length and width, extrapolated frequency
    with its estimated error, Q, amplitude per volt of this mode alone at its antinode, effective
    coupling √(1 − f²/f_p²) with the parallel resonance f_p (terminals open, no losses), modal force
    (N/V for unit modal mass). Errors are None where nobody estimates them."""

    label: str
    frequency: si.Hertz
    frequency_error: si.Hertz
    quality_factor: si.Dimensionless
    alone_per_volt: si.MetrePerVolt
    coupling_coefficient: si.Dimensionless
    modal_force: float
    half_wavelength: si.Metre | None
    parallel_resonance_frequency: si.Hertz | None = None
    parallel_resonance_frequency_error: si.Hertz | None = None
    coupling_coefficient_error: si.Dimensionless | None = None


@dataclass(frozen=True)
class Remarks:
    """Remarks beside the numbers of a working mode: of its frequency, where it moves most, what its
    quality factor is of, where it is loudest."""

    frequency: str
    largest: str
    quality: str
    loudest: str


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class SolvedBody(Result):
    """Solved plate, disc or stator: its modes, the working one, response and sound.

    `mode` is the working mode as every verb has it, whose free amplitude per volt at the antinode
    `amplitude_per_volt` is; `largest_per_volt` (m/V) is the largest of the touched face at the same
    frequency, number `resonance` of the response. `circuit_said` is what is to be said of the
    circuit, or why there is none; `model` made the numbers, `status` says how good the table of
    modes is. `objections` say what of its description is doubtful, and what a budget left out.
    """

    display: Display
    rows: tuple[ModeRow, ...]
    mode: WorkingMode
    working: ModeRow
    response: DrivenResponse
    resonance: int
    largest_per_volt: si.MetrePerVolt
    circuit: EquivalentCircuit | None
    circuit_said: str
    sound: SoundField
    model: str
    status: str
    remarks: Remarks
    objections: tuple[str, ...] = ()
    _shown: ClassVar[str] = (
        "display.name working.label working.frequency working.quality_factor amplitude_per_volt "
        "model"
    )

    @property
    def amplitude_per_volt(self) -> si.MetrePerVolt:
        """Free amplitude per volt at the antinode, at resonance (m/V): the working mode's."""
        return self.mode.amplitude_per_volt

    @functools.cached_property
    def load(self) -> ElectricalLoad:
        """Load that the body is for its amplifier at its resonance, at the display's voltage."""
        volts, at = self.display.drive.voltage, self.mode.resonance_frequency
        return electrical_load(self.response, volts, at, circuit=self.circuit)

    @functools.cached_property
    def heat(self) -> Warming:
        """Warming by the power that the working mode loses, at the display's voltage.

        Of a stator, whose modal mass nobody measured, the power that its fitted body takes.
        """
        # Compiled code comes with it, which a list of modes has no use for.
        from squeezefilm.physics.plate.warming import heat_source, warming, warming_of_mode

        volts, mode, thermal = self.display.drive.voltage, self.mode, self.display.thermal
        known = warming_of_mode(self.display.actuator, thermal, mode, volts)
        if known is not None:
            return known
        source = heat_source(
            self.display.actuator,
            volts,
            mode.resonance_frequency,
            mode.quality_factor,
            volts * self.amplitude_per_volt,
            self.load.real_power,
        )
        return warming(source, self.display.actuator, thermal)

    def summary(self) -> dict[str, Any]:
        """Mapping of plain JSON values; keys carry units."""
        levels = zip(self.sound.distances, self.sound.sound_pressure_level_dB, strict=True)
        return {
            "display": self.display.name,
            "mode": self.working.label,
            "modes": to_json(self.rows),
            "heat": to_json(self.heat),
            "input_power_W": self.load.real_power,
            "equivalent_circuit": to_json(self.circuit),
            "equivalent_circuit_said": self.circuit_said,
            **values_of(
                self,
                "working.frequency working.frequency_error amplitude_per_volt largest_per_volt "
                "working.alone_per_volt mode.neighbour working.half_wavelength "
                "working.quality_factor working.coupling_coefficient "
                "working.coupling_coefficient_error working.parallel_resonance_frequency "
                "working.parallel_resonance_frequency_error display.drive.voltage load.current "
                "load.apparent_power model status objections",
            ),
            **self._particulars(),
            "sound_pressure_level_dB": {f"{far:g} m": level for far, level in levels},
            "sound_guidance": to_json(self.sound.guidance),
            "provenance": stamp(self.display),
        }

    def _particulars(self) -> dict[str, Any]:
        raise NotImplementedError

    def _table(self) -> Any:
        return to_json(self.rows)


def sweep_around(
    frequency: si.Hertz, quality_factor: si.Dimensionless, points: int
) -> si.HertzArray:
    """Frequencies (Hz) over ±4/Q about a resonance, 1 % at the least, shape (points,).

    They are dense near the peak, where the curve turns within f/Q.
    """
    span = max(4 / quality_factor, 0.01)
    near = np.sinh(np.linspace(-3, 3, points)) / np.sinh(3)
    return np.asarray(frequency * (1 + span * near))


def half_power(frequency: si.FloatArray, amplitude: si.FloatArray) -> tuple[float, float] | None:
    """The two frequencies beside the peak where the amplitude falls to 1/√2 of it, in the unit of
    `frequency`; None where the curve does not fall so far."""
    top = int(np.argmax(amplitude))
    level = float(amplitude[top]) / math.sqrt(2)
    below = np.flatnonzero(amplitude < level)
    left, right = below[below < top], below[below > top]
    if not left.size or not right.size:
        return None
    edges = []
    for low, high in ((left[-1], left[-1] + 1), (right[0], right[0] - 1)):
        share = (level - amplitude[low]) / (amplitude[high] - amplitude[low])
        edges.append(float(frequency[low] + share * (frequency[high] - frequency[low])))
    return edges[0], edges[1]


# Plates with one thing different. Each is solved in three dimensions; solved plates are kept, so
# that asking again costs nothing.
LOSSLESS: si.Dimensionless = 1e5
"""The quality factor that stands for a substrate without losses of its own."""
_POINTS = 61

_Plate = TypeVar("_Plate", RectangularPlate, DiscPlate)


@dataclass(frozen=True)
class PlatePoint:
    """Working mode of a plate: its frequency with its estimated error,
    the largest amplitude per volt on the upper face at resonance (None where nothing drives it),
    quality factor, and the frequency with the drive's terminals open."""

    label: Label
    frequency: si.Hertz
    frequency_error: si.Hertz
    largest_per_volt: si.MetrePerVolt | None
    quality_factor: si.Dimensionless
    open_frequency: si.Hertz


_MODES: Kept[PlateModes] = Kept("compared-modes", PlateModes)
_AMPLITUDES: Kept[float] = Kept("compared-amplitudes", float)


@functools.lru_cache(maxsize=256)
def _solved(plate: RectangularPlate, label: Label) -> PlateModes:
    def modes() -> PlateModes:
        # Without what fields are evaluated on: megabytes each, and not asked for here.
        return dataclasses.replace(solve_modes(plate, mode=label), _fields=(), _again=None)

    return _MODES.found(repr((plate, label)), modes)


@functools.lru_cache(maxsize=256)
def _amplitude(
    plate: RectangularPlate, frequency: si.Hertz, quality: si.Dimensionless
) -> si.MetrePerVolt:
    def largest() -> float:
        # The harmonic mesh is another one, so the peak need not lie at the middle exactly.
        response = harmonic_response(plate, sweep_around(frequency, quality, _POINTS))
        return float(np.max(response.maximum))

    return _AMPLITUDES.found(repr((plate, frequency, quality)), largest)


def working_point(
    plate: RectangularPlate, label: Label | None = None, *, amplitude: bool = True
) -> PlatePoint:
    """A plate's working mode (or the one with this label) as explanations are compared by it.

    Raises what `solve_modes` raises. The amplitude is left out where no electrode is driven or
    `amplitude` is False.
    """
    wanted = label or (plate.nodal_lines, 0)
    modes = _solved(plate, wanted)
    index = modes.index(wanted)
    frequency, quality = float(modes.frequencies[index]), float(modes.quality_factors[index])
    driven = amplitude and bool(np.any(drive_signs(plate)))
    return PlatePoint(
        wanted,
        frequency,
        float(modes.errors[index]),
        _amplitude(plate, frequency, quality) if driven else None,
        quality,
        float(modes.open_frequencies[index]),
    )


def with_ceramic_stiffness(plate: _Plate, share: si.Dimensionless) -> _Plate:
    """The plate or disc with all stiffnesses of its ceramic multiplied, d31 (or e31) kept."""
    return dataclasses.replace(plate, ceramic=plate.ceramic.scaled(stiffness=share))


def with_other_data_set(plate: RectangularPlate) -> RectangularPlate:
    """The plate with the other of the two data sets of its ceramic believed."""
    ceramic = plate.ceramic
    other: Literal["from_d31", "printed_e31"] = (
        "printed_e31" if ceramic.data_set == "from_d31" else "from_d31"
    )
    return dataclasses.replace(plate, ceramic=dataclasses.replace(ceramic, data_set=other))


def with_glue(
    plate: RectangularPlate, thickness: si.Metre, young_modulus: si.Pascal
) -> RectangularPlate:
    """The plate with a glue line of this thickness and Young's modulus (losses as `GlueLayer`)."""
    return dataclasses.replace(plate, glue=GlueLayer(thickness, young_modulus))


def with_loss_in_ceramic_alone(plate: RectangularPlate) -> RectangularPlate:
    """The plate with no losses but its ceramic's (and its glue's, where it has one)."""
    return with_values(plate, {"substrate.quality_factor": LOSSLESS})
