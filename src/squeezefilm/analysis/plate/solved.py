"""What is alike in a solved plate, disc and stator: its modes, the working one, a summary."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.display import Display
from squeezefilm.plate.circuit import DrivenResponse, EquivalentCircuit
from squeezefilm.plate.sound import SoundField
from squeezefilm.results import Result, stamp, to_json

if TYPE_CHECKING:
    from squeezefilm.plate.heat.warming import Warming


@dataclass(frozen=True)
class ModeRow:
    """One mode of the table: label by nodal lines across length and width, extrapolated frequency
    with its estimated error, Q, amplitude per volt at the largest point of the face if it stood
    alone, effective coupling √(1 − f²/f_p²) with the parallel resonance f_p (terminals open, no
    losses), modal force (N/V for unit modal mass). Errors are None where nobody estimates them."""

    label: str
    frequency: si.Hertz
    frequency_error: si.Hertz
    quality_factor: si.Dimensionless
    amplitude_per_volt: si.MetrePerVolt
    coupling_coefficient: si.Dimensionless
    modal_force: float
    half_wavelength: si.Metre | None
    parallel_resonance_frequency: si.Hertz | None = None
    parallel_resonance_frequency_error: si.Hertz | None = None
    coupling_coefficient_error: si.Dimensionless | None = None


@dataclass(frozen=True)
class Remarks:
    """What is said beside the numbers of a working mode: of its frequency, where it moves most and
    along which line, what its quality factor is of, where it is loudest."""

    frequency: str
    largest: str
    centreline: str
    quality: str
    loudest: str


class SolvedBody(Result):
    """What a solved plate, disc or stator has: its modes, the working one, response and sound.

    `objections` say what of its description is doubtful, and what a budget left out.
    """

    display: Display
    rows: tuple[ModeRow, ...]
    working: ModeRow
    circuit: EquivalentCircuit | None
    sound: SoundField
    response: DrivenResponse
    # A field of one and computed by another, which no narrower type allows.
    amplitude_per_volt: Any
    centreline_per_volt: Any
    model: Any
    status: Any
    remarks: Any
    objections: Any = ()
    _shown: ClassVar[str] = (
        "display.name working.label working.frequency working.quality_factor amplitude_per_volt "
        "model"
    )

    @functools.cached_property
    def heat(self) -> Warming:
        """What the power that the body takes at resonance does to it, at the display's voltage.

        All of it is lost in its materials, foam included: the solved body radiates nothing.
        """
        # Compiled code comes with it, which a list of modes has no use for.
        from squeezefilm.plate.heat.warming import heat_source, warming

        volts, at, mode = self.display.drive.voltage, self.response.resonance, self.working
        source = heat_source(
            self.display.actuator,
            volts,
            mode.frequency,
            mode.quality_factor,
            volts * self.amplitude_per_volt,
            float(self.response.input_power(volts)[at]),
        )
        return warming(source, self.display.actuator, self.display.thermal)

    def summary(self) -> dict[str, Any]:
        """What ``--json`` prints; keys carry units."""
        volts, at = self.display.drive.voltage, self.response.resonance
        levels = zip(self.sound.distances, self.sound.sound_pressure_level_dB, strict=True)
        return {
            "display": self.display.name,
            "mode": self.working.label,
            "frequency_Hz": self.working.frequency,
            "frequency_error_Hz": self.working.frequency_error,
            "amplitude_m_per_V": self.amplitude_per_volt,
            "centreline_amplitude_m_per_V": self.centreline_per_volt,
            "half_wavelength_m": self.working.half_wavelength,
            "quality_factor": self.working.quality_factor,
            "coupling_coefficient": self.working.coupling_coefficient,
            "coupling_coefficient_error": self.working.coupling_coefficient_error,
            "parallel_resonance_frequency_Hz": self.working.parallel_resonance_frequency,
            "parallel_resonance_frequency_error_Hz": (
                self.working.parallel_resonance_frequency_error
            ),
            "modes": to_json(self.rows),
            "voltage_V": volts,
            "current_A": float(self.response.current(volts)[at]),
            "apparent_power_VA": float(self.response.apparent_power(volts)[at]),
            "input_power_W": float(self.response.input_power(volts)[at]),
            "heat": to_json(self.heat),
            "equivalent_circuit": to_json(self.circuit),
            **self._particulars(),
            "sound_pressure_level_dB": {f"{far:g} m": level for far, level in levels},
            "sound_guidance": to_json(self.sound.guidance),
            "model": self.model,
            "status": self.status,
            "objections": list(self.objections),
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
