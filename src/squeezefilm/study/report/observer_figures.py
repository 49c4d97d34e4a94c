"""Figure of simulated participants: what the chain gives them of each surface."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core.kit import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.core.quantities import FloatArray
    from squeezefilm.physics.perception.stimuli import Stimulus
    from squeezefilm.study.simulated.chain_tables import ChainTables

_DISPLAYS = (style.BLUE, style.ORANGE)


@style.drawn
def percepts(tables: ChainTables) -> Figure:
    """Evidence for a rhythm of each period, before noise: virtual gratings by display, and real."""
    from squeezefilm.physics.perception.senses import line_periods

    design, observer = tables.design, tables.observer
    clearest = tables.directions.d_prime[..., 0].max(axis=-1)
    faint = np.unravel_index(int(np.argmin(np.median(clearest, axis=1))), clearest[:, 0].shape)
    figure = style.new_figure(
        f"Least evident: {style.plain(design.stimuli[faint[1]].name, 14)} on "
        f"{style.plain(design.displays[faint[0]], 24)}, d′ = "
        f"{max(float(np.median(clearest, axis=1)[faint]), 0.0):.2f} at its clearest rhythm",
        "the chain before noise: thin lines finger classes, thick their median; dashed the "
        "criterion below which nothing is felt; upright lines the true period",
        1.4 + 1.15 * len(design.stimuli),
    )
    period = 1e3 * line_periods()
    columns = _columns(tables)
    real = len(columns)
    heads = [head for head, *_ in columns]
    heads += ["real gratings"] if design.alternatives else []
    axes = figure.subplots(
        max(len(design.stimuli), len(design.alternatives)), len(heads), sharex=True, squeeze=False
    )
    highest = 1.15 * max(float(clearest.max()), observer.detection_criterion)
    for column, head in enumerate(heads):
        surfaces = design.stimuli if column < real else design.alternatives
        for row, cell in enumerate(axes[:, column]):
            if row >= len(surfaces):
                cell.set_axis_off()
                continue
            if column < real:
                _, rhythm, color, angle = columns[column]
                found, true = rhythm[:, row], _period_along(design.stimuli[row], angle)
            else:
                found, color, true = tables.real_rhythm[:, row], style.INK, surfaces[row].period
            cell.plot(period, found.T, color=color, lw=0.6, alpha=0.35)
            cell.plot(period, np.median(found, axis=0), color=color, lw=1.7)
            cell.axhline(observer.detection_criterion, color=style.MUTED, lw=0.9, ls=(0, (4, 2)))
            cell.axvline(1e3 * true, color=style.METAL, lw=2.2, zorder=0)
            cell.set(xscale="log", xlim=(0.25, 20), ylim=(0, highest if column < real else None))
            cell.set_title(f"{head}: {style.plain(surfaces[row].name, 14)}", fontsize=9.0)
            cell.set_xticks([0.4, 1, 2, 4, 10], ["0.4", "1", "2", "4", "10"])
            cell.minorticks_off()
    figure.supylabel("evidence for a rhythm, d′", fontsize=10.5)
    for cell in axes[-1]:
        cell.set_xlabel("spatial period (mm)")
    return figure


def _columns(tables: ChainTables) -> list[tuple[str, FloatArray, str, float]]:
    """Head, evidence by finger and stimulus, colour and direction (rad) of each display; of free
    exploration twice, for runs along x and along y."""
    columns = []
    for number, name in enumerate(tables.design.displays):
        head, colour = style.plain(name, 24), _DISPLAYS[number % 2]
        if tables.across_rhythm is None:
            columns.append((head, tables.virtual_rhythm[number], colour, math.nan))
        else:
            columns.append((f"{head}, along x", tables.virtual_rhythm[number], colour, 0.0))
            columns.append((f"{head}, along y", tables.across_rhythm[number], colour, math.pi / 2))
    return columns


def _period_along(surface: Stimulus, angle: float) -> float:
    """The true period (m) that runs in a direction (rad) meet; NaN where there is none, or where
    it is not known in which of two it lies."""
    if math.isnan(angle):
        return surface.period
    off = abs(math.cos(surface.orientation - angle))
    if off > 0.999:
        return surface.period
    return surface.second_period if off < 0.001 else math.nan
