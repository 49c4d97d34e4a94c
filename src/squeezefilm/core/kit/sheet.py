"""A `Drawing` as a figure of the size of its paper: what SVG and PDF show is what the DXF holds."""

from __future__ import annotations

import io
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core.formats.drawing import Drawing, Layer
from squeezefilm.core.kit import style

if TYPE_CHECKING:
    from ezdxf.math import Vec3
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

_INCH, _POINT = 25.4, 25.4 / 72
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
_THIN = 0.18 / _POINT
# The kind of a dimension in a DXF that shows a distance from the origin.
_ORDINATE = 6


def sheet_figure(drawing: Drawing) -> Figure:
    """The drawing on its paper, to scale where it is printed at full size."""
    return _figure(drawing, (0.0, 0.0, *drawing.paper))


def views_figure(drawing: Drawing) -> Figure:
    """Figure of a drawing's views only, for a page that has tables and notes of its own."""
    return _figure(drawing, drawing.views)


@style.drawn
def _figure(drawing: Drawing, window: tuple[float, float, float, float]) -> Figure:
    """A window (left, bottom, right, top in m of paper) of a drawing."""
    from matplotlib.figure import Figure

    # The figure's axes are in millimetres of the thing, as the document is.
    left, bottom, right, top = (1e3 * edge for edge in window)
    figure = Figure(figsize=((right - left) / _INCH, (top - bottom) / _INCH))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    (x, y), scale = (1e3 * place for place in drawing.corner), drawing.scale
    axes.set(xlim=(x + left / scale, x + right / scale), ylim=(y + bottom / scale, y + top / scale))
    entities: Iterable[Any] = drawing.document.modelspace()
    for order, entity in enumerate(entities):
        kind, above = entity.dxftype(), 2 + order * 1e-4
        if kind == "DIMENSION":
            _dimension(axes, entity, scale)
        elif kind == "TEXT":
            align, place, _ = entity.get_placement()
            side = align.name.removeprefix("MIDDLE_").lower()
            _text(
                axes, entity.dxf.text, place, scale * entity.dxf.height, entity.dxf.rotation, side
            )
        else:
            axes.add_patch(_patch(entity, drawing.layers[entity.dxf.layer], above))
    return figure


def pdf(figure: Figure) -> bytes:
    """A figure as a PDF of its own size, without the moment it was made."""
    stream = io.BytesIO()
    with style.rc():
        figure.savefig(stream, format="pdf", metadata={"CreationDate": None})
    return stream.getvalue()


def _patch(entity: Any, layer: Layer, above: float) -> Patch:
    """A line, a circle or an arc of a document in the look of its layer."""
    from matplotlib.patches import Arc, Circle, Polygon

    dxf, kind, colour = entity.dxf, entity.dxftype(), _COLOURS[layer.colour]
    closed = kind == "CIRCLE" or (kind == "LWPOLYLINE" and entity.closed)
    look: dict[str, Any] = {
        "zorder": above,
        "edgecolor": colour,
        "facecolor": "none",
        "lw": 1e3 * layer.width / _POINT,
        "ls": _DASHES[layer.line],
    }
    if closed and layer.fill != "none":
        look |= {
            "edgecolor": style.INK,
            "facecolor": style.PAPER if layer.fill == "paper" else colour,
        }
    if kind == "LWPOLYLINE":
        return Polygon(np.array(entity.get_points("xy")), closed=closed, **look)
    centre, radius = (dxf.center.x, dxf.center.y), dxf.radius
    if kind == "CIRCLE":
        return Circle(centre, radius, **look)
    return Arc(centre, 2 * radius, 2 * radius, theta1=dxf.start_angle, theta2=dxf.end_angle, **look)


def _text(
    axes: Axes, text: str, at: Vec3, height: float, angle: float = 0.0, align: str = "center"
) -> None:
    """A text whose capitals are so high on paper (mm), turned by an angle (degrees)."""
    axes.text(
        at.x,
        at.y,
        style.plain(text, 400),
        fontsize=height / _CAPITAL / _POINT,
        rotation=angle,
        ha=align,
        va="center_baseline",
        rotation_mode="anchor",
        color=style.INK,
        zorder=6,
    )


def _dimension(axes: Axes, dimension: Any, scale: float) -> None:
    """A dimension's lines, arrows and number, as ezdxf has laid them out."""
    from matplotlib.patches import Polygon

    for part in dimension.virtual_entities():
        if part.dxftype() == "LINE":
            x, y, _ = zip(part.dxf.start, part.dxf.end, strict=True)
            axes.plot(x, y, color=style.MUTED, lw=_THIN, ls="-", zorder=5, solid_capstyle="butt")
        elif part.dxftype() == "INSERT":
            for head in part.virtual_entities():
                corners = np.array([corner.vec2 for corner in head.wcs_vertices()])
                axes.add_patch(Polygon(corners, facecolor=style.MUTED, edgecolor="none", zorder=5))
        elif part.dxftype() == "MTEXT":
            said, at, height = part.text.replace("%%c", "⌀"), part.dxf.insert, part.dxf.char_height
            if dimension.dimtype == _ORDINATE:
                # There ezdxf leaves no gap behind the leader.
                at += (at - dimension.dxf.defpoint3).normalize(0.4 * height)
            _text(axes, said, at, scale * height, part.get_rotation())
