"""What the terminal shows of modes that were followed over a parameter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.report.kit.numbers import shown
from squeezefilm.report.kit.terminal import heading, table

if TYPE_CHECKING:
    from rich.console import Console

    from squeezefilm.analysis.plate.tracking import ModeTracks


def show_tracks(console: Console, found: ModeTracks) -> None:
    """Print each mode's frequency at the first, the plate's own and the last value."""
    unit = si.Unit(found.unit)
    own = int(np.argmin(np.abs(found.values - found.begun)))
    columns = (0, own, found.values.size - 1)

    def at(value: float) -> str:
        return f"{value:.4g}" if found.unit == "1" else shown(value, unit)

    heading(console, f"Modes against {found.parameter}")
    table(
        console,
        ("mode", *(at(float(found.values[k])) for k in columns), ""),
        [
            (
                track.label,
                *(
                    "not followed"
                    if np.isnan(track.frequency[k])
                    else shown(float(track.frequency[k]), si.Unit("Hz"), 5)
                    for k in columns
                ),
                "driven" if track.driven else "",
            )
            for track in found.tracks
        ],
    )
