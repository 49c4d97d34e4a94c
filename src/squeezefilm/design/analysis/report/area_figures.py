"""Amplitude and friction over the active area: as maps, or as curves where it is a line."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from squeezefilm.core.kit import style
from squeezefilm.core.kit.numbers import printable
from squeezefilm.physics.chain.active_area import CRITERIA, ActiveArea
from squeezefilm.physics.chain.pad_place import place_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.core.quantities import FloatArray
    from squeezefilm.design.analysis.analyze import Analysis

_PLACE: dict[str, Any] = {
    "ms": 8,
    "color": style.PAPER,
    "mec": style.INK,
    "mew": 1.2,
    "ls": "",
    "clip_on": False,
}


@style.drawn
def active_area(analysis: Analysis) -> Figure:
    """The friction under the pad by the place of its centre, or where the model has none the
    amplitude of the face."""
    judged = analysis.active_area
    if judged is None:
        return style.message_figure(
            "No map: the mode has no shape over a face",
            f"The model '{analysis.prediction.mode.model}' gives one amplitude only.",
        )
    area = judged.area
    made = f"{area.shape_model} ({area.shape_words}); friction by {analysis.prediction.model}"
    if 1 in area.amplitude.shape:
        figure = style.new_figure(_title(area), made, 4.0)
        _line(figure.subplots(), area)
        return figure
    figure = style.new_figure(_title(area), made, 4.4)
    axes = figure.subplots()
    if area.relative_friction is None:
        _map(axes, area, 1e6 * area.amplitude, "amplitude of the face (µm)")
        return figure
    _map(axes, area, area.relative_friction, "relative friction µ′/µ under the pad")
    _places(axes, area)
    return figure


def _title(area: ActiveArea) -> str:
    """The message; the numbers of the friction stand beside the figure."""
    if area.best is None or area.worst is None:
        low, high = (1e6 * one for one in area.amplitude_range)
        return f"Under the pad {low:.3g} to {high:.3g} µm (root mean square) over the active area"
    return "Friction under a finger, by the place of its centre on the active area"


def _map(axes: Axes, area: ActiveArea, values: FloatArray, label: str) -> None:
    """Values by place (mm), the criteria as lines where they lie within."""
    from matplotlib.image import NonUniformImage
    from matplotlib.ticker import MaxNLocator

    x, y = 1e3 * area.x, 1e3 * area.y
    shown = np.ma.masked_invalid(values.T)
    low, high = float(shown.min()), float(shown.max())
    if high - low < 1e-6 * max(abs(high), 1e-9):
        low, high = low - 0.5e-3, high + 0.5e-3
    # An image: as areas between levels the map of a large plate takes two megabytes.
    ends = (x[0], x[-1], y[0], y[-1])
    filled = NonUniformImage(axes, interpolation="bilinear", extent=ends, cmap="cividis")
    filled.set_data(x, y, shown)
    filled.set_clim(low, high)
    axes.add_image(filled)
    axes.set(xlim=ends[:2], ylim=ends[2:])
    # A scale takes its room where the map leaves some: beside one that is not wide.
    side: Literal["vertical", "horizontal"] = (
        "vertical" if np.ptp(x) < 1.3 * np.ptp(y) else "horizontal"
    )
    scale = axes.figure.colorbar(
        filled, ax=axes, label=label, ticks=MaxNLocator(nbins=5), orientation=side
    )
    if scale.solids is not None:
        scale.solids.set_edgecolor("face")
    axes.grid(visible=False)
    axes.set(aspect="equal", xlabel="x of the finger's centre (mm)", ylabel="y (mm)")


def _places(axes: Axes, area: ActiveArea) -> None:
    """The best and the worst place, and where the criteria lie."""
    assert area.relative_friction is not None, "drawn only where there is a friction"
    assert area.best_place is not None
    assert area.worst_place is not None
    from matplotlib.patches import Rectangle

    shown = np.ma.masked_invalid(area.relative_friction.T)
    within = [criterion for criterion in CRITERIA if shown.min() < criterion < shown.max()]
    if within:
        lines = axes.contour(
            1e3 * area.x, 1e3 * area.y, shown, levels=within, colors=style.PAPER, linewidths=1.4
        )
        axes.clabel(lines, fmt="%.2f", fontsize=9)
    for place, name, look in (
        (area.best_place, "best place", "o"),
        (area.worst_place, "worst place", "X"),
    ):
        x, y = (1e3 * one for one in place)
        said = printable(f"{name}, {place_words(place)}")
        axes.plot([x], [y], look, **_PLACE, label=said)
    side = 1e3 * area.contact_side
    left, bottom = (1e3 * middle - side / 2 for middle in area.best_place)
    axes.add_patch(
        Rectangle(
            (left, bottom),
            side,
            side,
            facecolor="none",
            edgecolor=style.ORANGE,
            lw=2.0,
            label="the finger's contact",
        )
    )
    # A place can lie anywhere on the map: both are named above it.
    axes.legend(
        loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False, borderaxespad=0.2
    )


def _line(axes: Axes, area: ActiveArea) -> None:
    """An area that is a line: amplitude and friction along it."""
    along_x = area.x.size > 1
    place = 1e3 * (area.x if along_x else area.y)
    axes.plot(place, 1e6 * area.amplitude.ravel(), color=style.BLUE, label="amplitude of the face")
    axes.set(xlabel=f"{'x' if along_x else 'y'} of the finger's centre (mm)")
    axes.set(ylabel="amplitude (µm)", ylim=(0, None), xlim=(float(place[0]), float(place[-1])))
    handles, _ = axes.get_legend_handles_labels()
    if area.relative_friction is not None:
        right = axes.twinx()
        name = "relative friction under the pad"
        right.plot(place, area.relative_friction.ravel(), **style.WANTED, label=name)
        right.set(ylabel="relative friction µ′/µ", ylim=(0, 1.02))
        right.grid(visible=False)
        right.xaxis.set_tick_params(labelbottom=False)
        handles = handles + right.get_legend_handles_labels()[0]
    style.legend_below(axes, handles=handles)
