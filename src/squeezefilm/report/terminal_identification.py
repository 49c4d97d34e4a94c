"""What the terminal shows of an analysed identification study."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from squeezefilm.report.study_report import key_rows
from squeezefilm.report.terminal import heading, plain_console, table

if TYPE_CHECKING:
    from squeezefilm.study.analysis import IdentificationAnalysis


def show_analyses(analyses: Mapping[str, IdentificationAnalysis]) -> None:
    """Print confusion table and main numbers of each display."""
    console = plain_console()
    for display, one in analyses.items():
        matrix = one.matrix
        heading(console, f"{display}: answers of {one.origin}")
        percent = matrix.percent
        table(
            console,
            ("grating chosen", *matrix.stimuli),
            [
                (answer, *(f"{percent[i, j]:.0f} %" for j in range(len(matrix.stimuli))))
                for i, answer in enumerate(matrix.answers)
            ],
            fixed=(0,),
        )
        table(console, ("", "", ""), key_rows(one), fixed=(0,))
        for note in one.notes:
            console.print(f"  {note}", style="dim", highlight=False)
