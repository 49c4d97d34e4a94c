"""Figure of what changes a plate: a tornado of sensitivities."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core.kit import style
from squeezefilm.physics.plate.solid.resonances import label_name

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.design.plate.sensitivity import SensitivityTable

# A bar beyond this many times the third largest would hide all others: it is cut, and says so.
_CUT = 2.6


@style.drawn
def tornado(table: SensitivityTable) -> Figure:
    """Shift of frequency and of amplitude per volt under each change, largest shift first."""
    rows = sorted(table.rows, key=lambda row: -abs(row.frequency_shift))
    moving = [row for row in rows if abs(row.frequency_shift) >= 5e-5 or row.amplitude_shift]
    largest = moving[0]
    label = label_name(table.reference.label)
    figure = style.new_figure(
        f"Mode {label} at {table.reference.frequency / 1e3:.2f} kHz: {largest.name}, "
        f"{largest.change}, shifts it most: {_signed(100 * largest.frequency_shift)} %",
        "piezoelectric_solid_3d, every changed plate solved anew; the amplitude is the largest of "
        "the upper face at its own resonance",
        1.7 + 0.27 * len(moving),
    )
    left, right = figure.subplots(1, 2, sharey=True)
    at = np.arange(len(moving))[::-1]
    frequency = np.array([100 * row.frequency_shift for row in moving])
    amplitude = np.array(
        [np.nan if row.amplitude_shift is None else 100 * row.amplitude_shift for row in moving]
    )
    for axes, values, name in ((left, frequency, "frequency"), (right, amplitude, "amplitude")):
        known = np.sort(np.abs(values[np.isfinite(values)]))
        limit = _CUT * known[-3] if known.size >= 3 else known[-1]
        limit = float(min(limit, known[-1])) or 1.0
        shown = np.clip(np.nan_to_num(values), -limit, limit)
        colors = [style.BLUE if v < 0 else style.ORANGE for v in shown]
        axes.barh(at, shown, color=colors, height=0.66)
        axes.axvline(0, color=style.INK, lw=0.8)
        axes.set_xlim(-1.6 * limit, 1.6 * limit)
        for y, value, width in zip(at, values, shown, strict=True):
            cut = "" if abs(value) <= limit * 1.0001 else " (cut)"
            text = "no drive" if np.isnan(value) else f"{_signed(value)} %{cut}"
            side, aside = ("left", (3, 0)) if width >= 0 else ("right", (-3, 0))
            axes.annotate(
                text,
                (width, y),
                aside,
                textcoords="offset points",
                ha=side,
                va="center",
                fontsize=8.5,
            )
        axes.set_xlabel(f"shift of {name} (%)" if name == "frequency" else f"{name} per volt (%)")
        axes.grid(visible=False, axis="y")
    right.tick_params(left=False)
    left.set_yticks(at, [f"{row.name}: {row.change}" for row in moving])
    left.set_ylim(-0.7, len(moving) - 0.3)
    return figure


def _signed(percent: float) -> str:
    """A percentage with its sign and two digits; what shows none of them is 0."""
    if abs(percent) < 0.005:
        return "0"
    form = "+.0f" if abs(percent) >= 10 else "+.1f" if abs(percent) >= 1 else "+.2g"
    return f"{percent:{form}}".replace("-", "−")
