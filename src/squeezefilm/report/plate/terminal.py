"""What the terminal shows of a solved film, and of a solved plate, disc or stator."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squeezefilm.analysis.plate.command import PlateAnalysis
from squeezefilm.analysis.plate.ring import RingAnalysis
from squeezefilm.report.kit.numbers import HZ, shown
from squeezefilm.report.kit.terminal import heading, plain_console, table
from squeezefilm.report.plate.terminal_modes import (
    Row,
    drive_rows,
    fit_sentences,
    show_guidance,
    show_modes,
    sound_rows,
    working_rows,
)

if TYPE_CHECKING:
    from rich.console import Console

    from squeezefilm.analysis.film.command import FilmAnswer
    from squeezefilm.analysis.plate.solved import SolvedBody


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


def show_plate(result: SolvedBody) -> None:
    """Print a solved plate, disc or stator: the working mode, then every mode of the band."""
    console = plain_console()
    heading(console, f"{result.display.title} [{result.display.name}]")
    rows = working_rows(result)
    if isinstance(result, PlateAnalysis):
        rows += _theory_rows(result)
    rows += drive_rows(result) + sound_rows(result.sound, result.remarks.loudest)
    table(console, ("", "", ""), rows, fixed=(0,))
    show_guidance(console, result.sound)
    if isinstance(result, RingAnalysis) and result.body.fit is not None:
        for sentence in fit_sentences(result.body.fit):
            console.print(sentence)
    show_modes(console, result.rows, result.amplitude_per_volt)
    if isinstance(result, RingAnalysis):
        console.print(
            "B(circles, diameters) bends; R and T move in the plane, radially and around."
        )
    console.print(f"{result.model}; {result.status}")
    if isinstance(result, PlateAnalysis):
        _show_changes(console, result)


def _theory_rows(result: PlateAnalysis) -> list[Row]:
    """The working mode's frequency by simpler theories."""
    theories = ("Timoshenko beam", result.beam_frequency), ("shear plate", result.shear_frequency)
    return [
        (f"As a {name}", shown(found, HZ, 5), f"{found / result.working.frequency - 1:+.1%}")
        for name, found in theories
        if found is not None
    ]


def _show_changes(console: Console, result: PlateAnalysis) -> None:
    """What other materials and dimensions would change, where that was asked for."""
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
