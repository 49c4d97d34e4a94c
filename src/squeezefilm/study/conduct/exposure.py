"""The airborne ultrasound a session exposes people to, which they must have acknowledged."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from squeezefilm import quantities as si
from squeezefilm.display import Display
from squeezefilm.plate.sound import SoundField

HEAD_DISTANCE: si.Metre = 0.5
"""From the plate to the ear of somebody seated at it (assumed)."""


@dataclass(frozen=True)
class Exposure:
    """The strongest level a session can bring to a head, and what it is compared with.

    `level_dB` is the sound pressure level (re 20 µPa) in the strongest direction at `distance`,
    for the whole `duration` at the display's voltage: an upper estimate, since stimuli pause.
    `guidance_dB` is the public guidance for the frequency, None where there is none.
    """

    display: str
    frequency: si.Hertz
    distance: si.Metre
    level_dB: float
    duration: si.Second
    guidance_dB: float | None
    guidance: str
    model: str

    @property
    def above_guidance_dB(self) -> si.Dimensionless | None:
        """By how much the level exceeds the guidance (dB); None where there is none."""
        return None if self.guidance_dB is None else self.level_dB - self.guidance_dB

    @property
    def statement(self) -> str:
        """What the experimenter acknowledges, in two sentences."""
        said = (
            f"Airborne ultrasound of {self.display}: up to {self.level_dB:.0f} dB at "
            f"{si.format_quantity(self.distance, si.Unit('m'))}, "
            f"{si.format_quantity(self.frequency, si.Unit('Hz'), 3)}, for about "
            f"{self.duration / 60:.0f} min ({self.model})."
        )
        above = self.above_guidance_dB
        if above is None:
            return f"{said} There is no published guidance for this frequency."
        word = f"{above:.0f} dB above" if above > 0 else f"{-above:.0f} dB below"
        return f"{said} That is {word} the guidance for the public, {self.guidance}."


def exposure(
    display: Display,
    duration: si.Second,
    *,
    distance: si.Metre = HEAD_DISTANCE,
    progress: Callable[[str], None] | None = None,
) -> Exposure:
    """The exposure of a session of `duration` (s) on a display at its own voltage.

    The plate or ring is solved and its field searched over all directions (`plate.sound`), which
    takes seconds. Raises what `solve_plate` raises.
    """
    from squeezefilm.analysis.plate.command import solve_plate

    field = solve_plate(display, points=41, progress=progress).sound
    return exposure_of(display.name, field, duration, distance)


def exposure_of(
    display: str, field: SoundField, duration: si.Second, distance: si.Metre
) -> Exposure:
    """The exposure that a computed sound field means at a distance (m).

    Between the field's distances the level falls with 1/distance from the nearest one.
    """
    import math

    nearest = min(range(len(field.distances)), key=lambda i: abs(field.distances[i] - distance))
    level = field.sound_pressure_level_dB[nearest]
    level += 20 * math.log10(field.distances[nearest] / distance)
    guidance = field.guidance
    return Exposure(
        display=display,
        frequency=field.frequency,
        distance=distance,
        level_dB=float(level),
        duration=duration,
        guidance_dB=None if guidance is None else guidance.level_dB,
        guidance="" if guidance is None else f"{guidance.source} ({guidance.evidence})",
        model=f"estimated, {field.model}",
    )
