"""What the terminal shows alike of plates, discs and stators: sound levels, the table of modes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from squeezefilm.quantities import MetrePerVolt, Unit
from squeezefilm.report.kit.numbers import shown
from squeezefilm.report.kit.terminal import heading, table

if TYPE_CHECKING:
    from rich.console import Console

    from squeezefilm.analysis.plate.command import ModeRow
    from squeezefilm.plate.sound import SoundField

# Of the working mode's amplitude per volt: below it a mode is called not driven.
_DRIVEN = 1e-4


def sound_rows(sound: SoundField, direction: str) -> list[tuple[str, str, str]]:
    """Sound pressure levels by distance; `direction` says where they are loudest."""
    guidance = sound.guidance
    limit = "no guidance" if guidance is None else f"guidance {guidance.level_dB:.0f} dB"
    return [
        (
            f"Sound at {distance:g} m",
            f"{level:.0f} dB",
            f"{direction}; {limit}" if number == 0 else "",
        )
        for number, (distance, level) in enumerate(
            zip(sound.distances, sound.sound_pressure_level_dB, strict=True)
        )
    ]


def show_guidance(console: Console, sound: SoundField) -> None:
    """Print where the guidance on airborne ultrasound is from."""
    if sound.guidance is not None:
        console.print(f"Guidance ({sound.guidance.evidence}): {sound.guidance.source}")


def show_modes(console: Console, rows: Sequence[ModeRow], amplitude_per_volt: MetrePerVolt) -> None:
    """Print the table of modes; `amplitude_per_volt` is the working mode's (m/V)."""
    hertz, per_volt = Unit("Hz"), Unit("m/V")
    heading(console, "Modes in the band")
    table(
        console,
        ("mode", "frequency", "±", "Q", "per volt", "coupling"),
        [
            (
                row.label,
                shown(row.frequency, hertz, 5),
                shown(row.frequency_error, hertz, 2),
                f"{row.quality_factor:.3g}",
                "not driven"
                if row.amplitude_per_volt < _DRIVEN * amplitude_per_volt
                else shown(row.amplitude_per_volt, per_volt, 3),
                f"{row.coupling:.2g}",
            )
            for row in rows
        ],
    )
