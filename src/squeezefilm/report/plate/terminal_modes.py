"""What terminal and page show alike: the working mode, the table of modes, sound levels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from squeezefilm import quantities as si
from squeezefilm.report.kit.numbers import HZ, shown
from squeezefilm.report.kit.terminal import heading, table

if TYPE_CHECKING:
    from rich.console import Console

    from squeezefilm.analysis.plate.command import ModeRow, PlateAnalysis
    from squeezefilm.plate.sound import SoundField

PER_VOLT = si.Unit("m/V")

# Of the working mode's amplitude per volt: below it a mode is called not driven.
_DRIVEN = 1e-4


def working_rows(result: PlateAnalysis) -> list[tuple[str, str, str]]:
    """The working mode of a solved plate: quantity, value, remark."""
    mode = result.working
    return [
        (
            f"Mode {mode.label}",
            shown(mode.frequency, HZ, 5),
            f"± {shown(mode.frequency_error, HZ, 2)} (estimated)",
        ),
        ("Amplitude per volt", shown(result.amplitude_per_volt, PER_VOLT), "largest, upper face"),
        ("", shown(result.centreline_per_volt, PER_VOLT), "centreline, between outer nodes"),
        ("Quality factor", f"{mode.quality_factor:.4g}", "from the losses of its materials"),
        ("Effective coupling", f"{mode.coupling:.3g}", ""),
    ]


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


def mode_rows(
    rows: Sequence[ModeRow], amplitude_per_volt: si.MetrePerVolt
) -> list[tuple[str, str, str, str, str, str]]:
    """Label, frequency, its error, quality factor, amplitude per volt and coupling of every mode.

    `amplitude_per_volt` is the working mode's (m/V).
    """
    return [
        (
            row.label,
            shown(row.frequency, HZ, 5),
            shown(row.frequency_error, HZ, 2),
            f"{row.quality_factor:.3g}",
            "not driven"
            if row.amplitude_per_volt < _DRIVEN * amplitude_per_volt
            else shown(row.amplitude_per_volt, PER_VOLT, 3),
            f"{row.coupling:.2g}",
        )
        for row in rows
    ]


def show_modes(
    console: Console, rows: Sequence[ModeRow], amplitude_per_volt: si.MetrePerVolt
) -> None:
    """Print the table of modes; `amplitude_per_volt` is the working mode's (m/V)."""
    heading(console, "Modes in the band")
    head = ("mode", "frequency", "±", "Q", "per volt", "coupling")
    table(console, head, mode_rows(rows, amplitude_per_volt))
