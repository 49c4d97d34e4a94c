"""What the chain of a display is asked: at which working point, and, from its end to its beginning,
the voltage for a wanted friction."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, fields
from typing import Annotated, Any, NamedTuple

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.drive_limits import HIGHEST_VOLTAGE
from squeezefilm.core.errors import UnreachableError
from squeezefilm.physics.chain.area_map import at_best_place
from squeezefilm.physics.chain.friction import FrictionLaw, friction_law
from squeezefilm.physics.chain.pad_law import DEFAULT_MODEL, FrictionModel
from squeezefilm.physics.chain.pad_place import FacePlace, pad_place
from squeezefilm.physics.chain.touch import amplitude_per_volt, chosen_mode, kept_at
from squeezefilm.physics.display import NamedDisplay
from squeezefilm.physics.plate.working_mode import PlateTheory, WorkingMode
from squeezefilm.physics.plausibility.checks import require_plausible

WantedFriction = Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)]
"""A µ′/µ that is asked for."""


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class WorkingPoint:
    """What every prediction may be asked at; of what is left out says `predict` what it is."""

    display: NamedDisplay
    _: KW_ONLY
    voltage: si.Volt | None = None
    frequency: si.Hertz | None = None
    normal_force: si.Newton | None = None
    surface: str | None = None
    vibration_amplitude: si.Metre | None = None
    model: FrictionModel | None = None
    speed: si.MetrePerSecond | None = None
    place: FacePlace | None = None

    def point(self) -> dict[str, Any]:
        """The working point alone, as the arguments of `predict`."""
        names = (field.name for field in fields(WorkingPoint))
        return {name: getattr(self, name) for name in names}


class WantedVoltage(NamedTuple):
    """Voltage (V, zero-to-peak) that a friction takes, and the amplitude that it gives: zero-to-
    peak, at the antinode with the finger on (m)."""

    voltage: si.Volt
    vibration_amplitude: si.Metre


@reads_text
@si.checked_numbers
def voltage_for_friction(
    display: NamedDisplay,
    relative_friction: WantedFriction,
    *,
    frequency: si.Hertz | None = None,
    normal_force: si.Newton | None = None,
    surface: str | None = None,
    theory: PlateTheory | None = None,
    model: FrictionModel | None = None,
    speed: si.MetrePerSecond | None = None,
    place: FacePlace | None = None,
    position: si.Metre | None = None,
) -> WantedVoltage:
    """The voltage (V, zero-to-peak) that brings µ′/µ down to a wanted value, and its amplitude (m).

    The inverse of `predict`, with the pad where that has it, the finger's damping and detuning
    included; linear in the voltage up to there. The amplitude is the antinode's, with the finger
    on, wherever the pad is. Raises
    `UnreachableError` where no amplitude does, or where the voltage would be more than the 2 kV
    that a `Drive` may have.
    """
    require_plausible(display)
    mode, _ = chosen_mode(display.actuator, theory)
    drive_frequency = mode.resonance_frequency if frequency is None else frequency
    si.require("frequency", drive_frequency, si.Unit("Hz"), above=0)
    law = friction_law(
        display,
        mode.half_wavelength,
        drive_frequency,
        surface=display.surface(surface),
        normal_force=normal_force,
        model=model or DEFAULT_MODEL,
        speed=speed,
        position=position or 0.0,
        place=pad_place(display.actuator, mode, drive_frequency, place),
    )
    if place is None and position is None:
        law = at_best_place(display, mode, law)
    return needed_voltage(mode, law, relative_friction)


def needed_voltage(
    mode: WorkingMode, law: FrictionLaw, relative_friction: WantedFriction
) -> WantedVoltage:
    """Voltage and amplitude that bring µ′/µ of a law down to a wanted value, on a plate that moves
    in a mode. Raises as `voltage_for_friction`."""
    amplitude = law.amplitude_for(relative_friction)
    if amplitude == 0:
        return WantedVoltage(0.0, 0.0)
    volts = amplitude / (amplitude_per_volt(mode, law.frequency) * kept_at(mode, law, amplitude))
    if volts > HIGHEST_VOLTAGE:
        raise UnreachableError(
            f"relative_friction = {relative_friction:.4g} needs {amplitude * 1e6:.3g} µm and so "
            f"{volts:.4g} V; a drive may have {HIGHEST_VOLTAGE:.4g} V. Drive at the resonance, ask "
            "for less, or take a plate with more amplitude per volt"
        )
    return WantedVoltage(float(volts), amplitude)
