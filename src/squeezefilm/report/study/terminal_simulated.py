"""What the terminal shows of simulated participants."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squeezefilm.report.kit.terminal import heading, plain_console, table
from squeezefilm.report.study.simulated_page import (
    LEGEND,
    REASONS,
    REMARK,
    confusion_rows,
    reason_rows,
)

if TYPE_CHECKING:
    from squeezefilm.study.simulated.participants import SimulatedStudy


def show_simulated(study: SimulatedStudy) -> None:
    """Print each display's table of answers and the model's reasons."""
    console = plain_console()
    for index, name in enumerate(study.tables.design.displays):
        heading(
            console,
            f"{name}, SIMULATED: {100 * study.proportion_correct(index):.1f} % right, "
            f"{study.participants} simulated participants, seed {study.seed}",
        )
        head, rows = confusion_rows(study, index)
        table(console, head, rows)
        console.print("Per cent of each column; rows are gratings answered, columns simulated.")
        table(console, REASONS, reason_rows(study, index))
    console.print(LEGEND)
    console.print(REMARK)
