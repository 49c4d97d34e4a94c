"""Figures of rendering: one texture under a moving finger, and which textures survive."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.render.fidelity.survival import PAPER_PERIODS
from squeezefilm.render.fidelity.trace import period_of
from squeezefilm.report.kit import style
from squeezefilm.report.kit.numbers import M, S, shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.analysis.analyze import Analysis
    from squeezefilm.analysis.textures import TextureSurvival
    from squeezefilm.render.fidelity.survival import FidelityTable

_NOTHING = (
    "The amplitude at the working point changes no friction, so there is no texture to draw: raise "
    "the voltage, drive at the resonance, or give an amplitude."
)
_PERIODS_SHOWN = 3.5
_MOST_POINTS = 1500


@style.drawn
def texture(analysis: Analysis) -> Figure:
    """A grating under the finger: what is wanted and what the resonator makes of it."""
    trace = analysis.texture
    if trace is None:
        return style.message_figure("No texture can be rendered here", _NOTHING)
    period = period_of(trace.texture) or trace.stroke.length / 20
    figure = style.new_figure(
        f"A grating of {shown(period, M, 3)} at {1e3 * trace.stroke.speed:g} mm/s comes "
        f"{shown(trace.lag, M, 2)} late: the resonator needs {shown(trace.time_constant, S, 3)} "
        "to follow",
        f"{trace.model}; friction by {analysis.prediction.model}, following the amplitude at once",
        5.8,
    )
    grid, strip = style.pairs_of_axes(figure)
    # A rise in the middle of the stroke, where nothing remembers the start.
    middle = trace.position.searchsorted(trace.stroke.start + trace.stroke.length / 2)
    rises = middle + np.flatnonzero(np.diff(trace.command[middle:]) > 0)
    edge = float(trace.position[rises[0]] if rises.size else trace.position[middle])
    wide = (edge - 0.25 * period, edge + (_PERIODS_SHOWN - 0.25) * period)
    near = 0.5 * min(period, max(10 * trace.lag, 0.2 * period))
    close = (edge - 0.35 * near, edge + 1.65 * near)
    pairs = (
        (1e6 * trace.command, 1e6 * trace.amplitude),
        (trace.relative_friction_wanted, trace.relative_friction_rendered),
    )
    for column, (low, high) in enumerate((wide, close)):
        inside = np.flatnonzero((trace.position >= low) & (trace.position <= high))
        inside = inside[:: max(1, inside.size // _MOST_POINTS)]
        x = 1e3 * trace.position[inside]
        for row, (wanted, rendered) in enumerate(pairs):
            grid[row][column].plot(x, wanted[inside], **style.WANTED, label="wanted")
            grid[row][column].plot(x, rendered[inside], **style.RENDERED, label="rendered")
        grid[1][column].set(xlim=(1e3 * low, 1e3 * high), xlabel="finger position (mm)")
    late = f"lag τ·v = {shown(trace.lag, M, 2)}"
    for axes in (grid[0][1], grid[1][1]):
        axes.axvspan(1e3 * edge, 1e3 * (edge + trace.lag), color=style.SKIN, lw=0, label=late)
    grid[0][0].set(ylabel="amplitude (µm)", ylim=(0, None))
    grid[1][0].set(ylabel="relative friction µ′/µ")
    if np.ptp(trace.relative_friction_wanted) < 0.01:
        # What nobody feels must not look like a swing because the axis stretches it.
        grid[1][0].set(ylim=(0, 1.05))
    grid[0][0].set_title(f"{_PERIODS_SHOWN:g} periods from the middle of the stroke")
    grid[0][1].set_title("one edge, enlarged")
    style.legend_in(strip, grid[0][1])
    return figure


@style.drawn
def fidelity(analysis: Analysis) -> Figure:
    """Which spatial period keeps its swing at which finger speed."""
    from matplotlib.patches import Patch

    table = analysis.fidelity
    if table is None:
        return style.message_figure("No texture survives here", _NOTHING)
    fastest = 1e3 * float(table.speeds[-1])
    title = (
        f"At {fastest:g} mm/s the finest {table.shape} grating that keeps {100 * table.kept:.0f} % "
        f"of its swing, {_percent(table.fundamental_at_limit)} of its fundamental, has a period of "
        f"{shown(float(table.finest_period[-1]), M, 3)}"
    )
    rows, columns = table.amplitude_kept.shape
    figure = style.new_figure(
        title, f"{table.model}; friction by {analysis.prediction.model}", 2.5 + 0.78 * rows
    )
    axes, strip = figure.subplots(2, 1, height_ratios=[rows, 0.35])
    strip.set_axis_off()
    for row in range(rows):
        for column in range(columns):
            _draw_cell(axes, table, row, column)
    axes.set(xlim=(-0.52, columns - 0.48), ylim=(rows - 0.5, -0.5))
    axes.set_yticks(range(rows), [f"{1e3 * period:g}" for period in table.spatial_periods])
    columns_named = [
        f"{1e3 * speed:g}\nfinest {shown(float(finest), M, 2)}\nlag {shown(float(lag), M, 2)}"
        for speed, finest, lag in zip(table.speeds, table.finest_period, table.lag, strict=True)
    ]
    axes.set_xticks(range(columns), columns_named)
    axes.set(xlabel="finger speed (mm/s)", ylabel="spatial period (mm)")
    style.bare(axes)
    kept = f"✓ keeps {100 * table.kept:.0f} % of the amplitude's swing, peak to peak"
    handles = [
        Patch(facecolor="none", edgecolor=style.INK, lw=1.2, label=kept),
        Patch(facecolor="none", edgecolor=style.INK, lw=0.8, ls="--", label="✗ loses more"),
    ]
    strip.legend(handles=handles, loc="center", ncols=2, frameon=False)
    return figure


@style.drawn
def survival(analysis: Analysis) -> Figure:
    """`texture_survival` of an analysis."""
    found = analysis.survival
    return _nothing() if found is None else texture_survival(found)


def _nothing() -> Figure:
    return style.message_figure("Nothing to compensate", "No voltage makes an amplitude here.")


@style.drawn
def texture_survival(table: TextureSurvival) -> Figure:
    """Which spatial period survives at which speed, one line per drive."""
    figure = style.new_figure(
        f"Compensation with phase inversion keeps a grating up to {table.gain[-1]:.2g} times the "
        f"finger speed, without inversion up to {table.gain[1]:.2g} times",
        f"{table.model}; swing from 0 to {100 * table.level:g} % of what the full voltage holds, "
        f"{100 * table.kept:g} % of it kept, peak to peak; Q as the display states it",
        5.0,
    )
    grid = figure.add_gridspec(2, 1, height_ratios=[1, 0.1])
    strip, axes = figure.add_subplot(grid[1]), figure.add_subplot(grid[0])
    strip.set_axis_off()
    for law, row, wave, (color, dashes) in zip(
        table.laws, table.finest_period, table.fundamental, style.LINES, strict=False
    ):
        name = f"{law.name}: {100 * wave:.0f} % of the fundamental"
        axes.loglog(1e3 * table.speeds, 1e3 * row, color=color, ls=dashes, label=name)
    for period in PAPER_PERIODS:
        named = "the paper's gratings" if period == PAPER_PERIODS[0] else None
        axes.axhline(1e3 * period, **style.GUIDE, label=named)
    axes.set_title(f"{style.plain(table.name)}, τ = {shown(table.time_constant, S, 3)}")
    axes.set(xlabel="finger speed (mm/s)", xlim=(10, 400), ylim=(0.02, 12))
    axes.set_ylabel("finest period that survives (mm)")
    axes.set_xticks([10, 20, 50, 100, 200, 400])
    axes.set_yticks([0.02, 0.05, 0.1, 0.2, 0.4, 1, 2, 4, 10])
    style.plain_log(axes.xaxis, axes.yaxis)
    style.legend_in(strip, axes, columns=2)
    return figure


def _draw_cell(axes: Axes, table: FidelityTable, row: int, column: int) -> None:
    """One period at one speed: what is kept of the amplitude, and of the friction."""
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.patches import Rectangle

    # The same colours on a light and a dark page: the text on each cell is chosen for the cell.
    colors = LinearSegmentedColormap.from_list("kept", ["#f6efe2", "#8fc1c7", "#0d4f6b"])
    share = float(table.amplitude_kept[row, column])
    survives = bool(table.amplitude_survives[row, column])
    fill = colors(share**3)
    edge: dict[str, Any] = {"lw": 1.2, "ls": "-"} if survives else {"lw": 0.8, "ls": (0, (3, 2))}
    corner = column - 0.48, row - 0.46
    axes.add_patch(Rectangle(corner, 0.96, 0.92, facecolor=fill, edgecolor=style.INK, **edge))
    ink = "#ffffff" if _luminance(fill[:3]) < 0.2 else "#101820"
    words = f"{_percent(share, table.kept)}  {'✓' if survives else '✗'}"
    axes.text(column, row - 0.15, words, ha="center", va="center", color=ink, fontsize=12)
    waves = table.amplitude_fundamental[row, column], table.friction_fundamental[row, column]
    felt = _percent(float(table.friction_kept[row, column]), table.kept)
    for down, small in (
        (0.14, f"fundamental {_percent(float(waves[0]))}"),
        (0.33, f"friction {felt}, {_percent(float(waves[1]))}"),
    ):
        axes.text(column, row + down, small, ha="center", va="center", color=ink, fontsize=8)


def _percent(share: float, kept: float = math.inf) -> str:
    """A share in whole percent, never rounded up to a share that had to be kept."""
    rounded = round(100 * share)
    if math.isfinite(kept) and share < kept and rounded >= 100 * kept:
        rounded -= 1
    return f"{rounded} %"


def _luminance(color: tuple[float, ...]) -> float:
    """Relative luminance of an sRGB colour, as WCAG defines contrast by it."""
    r, g, b = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in color)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b
