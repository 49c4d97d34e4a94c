"""What the terminal shows of a solved film and of a solved plate."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squeezefilm import quantities as si
from squeezefilm.report.kit.numbers import HZ, V, shown
from squeezefilm.report.kit.terminal import heading, plain_console, table
from squeezefilm.report.plate.terminal_modes import (
    show_guidance,
    show_modes,
    sound_rows,
    working_rows,
)

if TYPE_CHECKING:
    from squeezefilm.analysis.film.command import FilmAnswer
    from squeezefilm.analysis.plate.command import PlateAnalysis


def show_film(answer: FilmAnswer) -> None:
    """Print one solved film."""
    console = plain_console()
    request = answer.request
    heading(
        console,
        f"{request.shape}, σ = {answer.squeeze_number:.4g}, ε = {answer.excursion_ratio:.4g}",
    )
    table(
        console,
        ("", "", ""),
        [
            ("Mean load W", f"{answer.mean_load:.8g}", "over ambient pressure × area"),
            (
                "Over-pressure W − 1",
                f"{answer.over_pressure:.6g}",
                f"± {answer.over_pressure_error:.1g} (estimated)",
            ),
            ("Stiffness", f"{answer.stiffness_relative:.6g}", "of p0·A·ε, first harmonic"),
            ("Damping", f"{answer.damping_relative:.6g}", "of p0·A·ε, first harmonic"),
        ],
        fixed=(0,),
    )
    console.print(answer.status)


def show_plate(result: PlateAnalysis) -> None:
    """Print a solved plate: the working mode, then every mode of the band."""
    console, mode = plain_console(), result.working
    heading(console, f"{result.display.title} [{result.display.name}]")
    rows = working_rows(result)
    rows += [
        (f"As a {theory}", shown(frequency, HZ, 5), f"{frequency / mode.frequency - 1:+.1%}")
        for theory, frequency in (
            ("Timoshenko beam", result.beam_frequency),
            ("shear plate", result.shear_frequency),
        )
        if frequency is not None
    ]
    volts = result.display.drive.voltage
    at = result.response.resonance
    rows.append(
        (
            f"At {shown(volts, V)}",
            shown(float(result.response.current(volts)[at]), si.Unit("A"), 3),
            f"{result.response.apparent_power(volts)[at]:.3g} VA, "
            f"{result.response.input_power(volts)[at]:.3g} W",
        )
    )
    rows += sound_rows(result.sound, "loudest direction")
    table(console, ("", "", ""), rows, fixed=(0,))
    show_guidance(console, result.sound)
    show_modes(console, result.rows, result.amplitude_per_volt)
    console.print(f"{result.modes.model}; {result.modes.status}")
    if result.sensitivities is not None:
        heading(console, "Sensitivities of the working mode")
        table(
            console,
            ("what is different", "", "frequency", "per volt"),
            [
                (
                    row.name,
                    row.change,
                    f"{row.frequency_shift:+.2%}",
                    "–" if row.amplitude_shift is None else f"{row.amplitude_shift:+.1%}",
                )
                for row in result.sensitivities.rows
            ],
        )
    if result.tracks is not None:
        from squeezefilm.report.plate.terminal_tracks import show_tracks

        show_tracks(console, result.tracks)
