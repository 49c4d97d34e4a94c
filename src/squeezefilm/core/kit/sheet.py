"""A `Drawing` as a figure of the size of its paper: what SVG and PDF show is what the DXF holds."""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core.formats.drawing import (
    Arc,
    Dimension,
    Drawing,
    Layer,
    Ordinate,
    Polyline,
    Text,
    arrows_outside,
)
from squeezefilm.core.kit import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_INCH, _POINT = 25.4e-3, 25.4e-3 / 72
# Of the font: the height of a capital over the size of the letters.
_CAPITAL = 0.729
# What an AutoCAD index stands for here; that of a CAD program's own palette is near it.
_COLOURS = {
    1: style.ORANGE,
    3: style.GREEN,
    5: style.BLUE,
    6: style.PURPLE,
    7: style.INK,
    8: style.MUTED,
    21: style.MINUS,
    45: style.METAL,
    151: style.PLUS,
}
_DASHES = {"CONTINUOUS": "-", "DASHED": (0, (6, 3)), "DASHDOT": (0, (9, 3, 1.5, 3))}
_THIN = 0.18e-3 / _POINT


def sheet_figure(drawing: Drawing) -> Figure:
    """The drawing on its paper, to scale where it is printed at full size."""
    return _figure((drawing, (0.0, 0.0, *drawing.paper)))


def views_figure(drawing: Drawing) -> Figure:
    """Figure of a drawing's views only, for a page that has tables and notes of its own."""
    return _figure((drawing, drawing.views))


@style.drawn
def _figure(shown: tuple[Drawing, tuple[float, float, float, float]]) -> Figure:
    """A window (left, bottom, right, top in m of paper) of a drawing."""
    from matplotlib.figure import Figure

    drawing, (left, bottom, right, top) = shown
    figure = Figure(figsize=((right - left) / _INCH, (top - bottom) / _INCH))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    (x, y), scale = drawing.corner, drawing.scale
    axes.set(xlim=(x + left / scale, x + right / scale), ylim=(y + bottom / scale, y + top / scale))
    for order, item in enumerate(drawing.items):
        if isinstance(item, Polyline):
            _polyline(axes, item, drawing.layers[item.layer], order)
        elif isinstance(item, Arc):
            _arc(axes, item, drawing.layers[item.layer], order)
        elif isinstance(item, Text):
            _text(
                axes,
                item.text,
                (item.x, item.y),
                item.height * drawing.scale,
                item.angle,
                item.align,
            )
        elif isinstance(item, Dimension):
            _dimension(axes, item, drawing.scale)
        else:
            _ordinate(axes, item, drawing.scale)
    return figure


def pdf(figure: Figure) -> bytes:
    """A figure as a PDF of its own size, without the moment it was made."""
    stream = io.BytesIO()
    with style.rc():
        figure.savefig(stream, format="pdf", metadata={"CreationDate": None})
    return stream.getvalue()


def _look(layer: Layer, closed: bool) -> dict[str, Any]:
    colour, filled = _COLOURS[layer.colour], closed and layer.fill != "none"
    fill = style.PAPER if layer.fill == "paper" else colour
    return {
        "facecolor": fill if filled else "none",
        "edgecolor": style.INK if filled else colour,
        "lw": layer.width / _POINT,
        "ls": _DASHES[layer.line],
    }


def _polyline(axes: Axes, polyline: Polyline, layer: Layer, order: int) -> None:
    from matplotlib.patches import Polygon

    look = _look(layer, polyline.closed)
    points = np.array(polyline.points)
    axes.add_patch(Polygon(points, closed=polyline.closed, zorder=2 + order * 1e-4, **look))


def _arc(axes: Axes, arc: Arc, layer: Layer, order: int) -> None:
    from matplotlib.patches import Arc as Bow
    from matplotlib.patches import Circle

    centre, above = (arc.x, arc.y), 2 + order * 1e-4
    look = _look(layer, arc.is_circle)
    if arc.is_circle:
        axes.add_patch(Circle(centre, arc.radius, zorder=above, **look))
        return
    ends = math.degrees(arc.start), math.degrees(arc.end)
    size = 2 * arc.radius
    bow = Bow(centre, size, size, theta1=ends[0], theta2=ends[1], zorder=above)
    bow.set(edgecolor=look["edgecolor"], lw=look["lw"], ls=look["ls"])
    axes.add_patch(bow)


def _text(
    axes: Axes,
    text: str,
    at: tuple[float, float],
    height: float,
    angle: float = 0.0,
    align: str = "middle",
) -> None:
    """A text whose capitals are so high on paper (m)."""
    axes.text(
        *at,
        style.plain(text, 400),
        fontsize=height / _CAPITAL / _POINT,
        rotation=math.degrees(angle),
        ha={"left": "left", "middle": "center", "right": "right"}[align],
        va="center_baseline",
        rotation_mode="anchor",
        color=style.INK,
        zorder=6,
    )


def _line(axes: Axes, *points: tuple[float, float]) -> None:
    x, y = zip(*points, strict=True)
    axes.plot(x, y, color=style.MUTED, lw=_THIN, ls="-", zorder=5, solid_capstyle="butt")


def _arrow(axes: Axes, tip: tuple[float, float], towards: tuple[float, float]) -> None:
    """An arrow's head (m): its tip, and the vector from its foot to it."""
    from matplotlib.patches import Polygon

    (x, y), (dx, dy) = tip, towards
    foot, across = (x - dx, y - dy), (-dy / 6, dx / 6)
    corners = (
        tip,
        (foot[0] + across[0], foot[1] + across[1]),
        (foot[0] - across[0], foot[1] - across[1]),
    )
    axes.add_patch(Polygon(np.array(corners), facecolor=style.MUTED, edgecolor="none", zorder=5))


def _dimension(axes: Axes, dimension: Dimension, scale: float) -> None:
    size = dimension.height
    if dimension.upright:
        ends = (dimension.y_from, dimension.x_from), (dimension.y_to, dimension.x_to)
    else:
        ends = (dimension.x_from, dimension.y_from), (dimension.x_to, dimension.y_to)

    def turned(along: float, across: float) -> tuple[float, float]:
        return (across, along) if dimension.upright else (along, across)

    for along, across in ends:
        way = math.copysign(0.5 * size, dimension.at - across)
        if abs(dimension.at - across) > size:
            _line(axes, turned(along, across + way), turned(along, dimension.at + way))
    low, high = sorted((ends[0][0], ends[1][0]))
    inside = not arrows_outside(high - low, size)
    beyond = 0.0 if inside else 2.2 * size
    _line(axes, turned(low - beyond, dimension.at), turned(high + beyond, dimension.at))
    way = size if inside else -size
    _arrow(axes, turned(low, dimension.at), turned(-way, 0.0))
    _arrow(axes, turned(high, dimension.at), turned(way, 0.0))
    _text(axes, dimension.said, (dimension.text_x, dimension.text_y), size * scale)


def _ordinate(axes: Axes, ordinate: Ordinate, scale: float) -> None:
    size = ordinate.height
    start = ordinate.x if ordinate.upright else ordinate.y
    way = math.copysign(1.0, ordinate.end - start)
    if ordinate.upright:
        _line(axes, (ordinate.x + 0.5 * size * way, ordinate.y), (ordinate.end, ordinate.y))
        at = (ordinate.end + 0.4 * size * way, ordinate.y)
        _text(axes, ordinate.said, at, size * scale, 0.0, "left" if way > 0 else "right")
        return
    _line(axes, (ordinate.x, ordinate.y + 0.5 * size * way), (ordinate.x, ordinate.end))
    at = (ordinate.x, ordinate.end + 0.4 * size * way)
    _text(axes, ordinate.said, at, size * scale, math.pi / 2, "left" if way > 0 else "right")
