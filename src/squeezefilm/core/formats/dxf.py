"""Drawings as DXF, which workshops cut and etch from; written by ezdxf, in millimetres."""

from __future__ import annotations

import io
import math
import re
from typing import Any

from squeezefilm.core.formats.drawing import Arc, Dimension, Drawing, Item, Ordinate, Polyline, Text

MILLIMETRES = 4
"""$INSUNITS of a drawing in millimetres."""
APPLICATION = "SQUEEZEFILM"
"""Name under which a dimension keeps the key of the value that it shows."""

# What ezdxf says of itself, with the moment.
_MADE = re.compile(r"^(\d+(?:\.\d+)+\S*) @ \d{4}-\d\d-\d\dT\S+$", re.MULTILINE)
_BESIDE = {"DIMENSIONS": 8, "TEXT": 7}
_WIDTHS = (0, 5, 9, 13, 15, 18, 20, 25, 30, 35, 40, 50, 53, 60, 70)


def dxf_text(drawing: Drawing) -> str:
    """A drawing as the text of a DXF file (R2010), at full size.

    Dimensions are entities of their own, which keep `value_of` as extended data of `APPLICATION`.
    Raises `InputError` for a drawing in which ezdxf's own audit finds an error.
    """
    from squeezefilm.core.errors import InputError, optional

    with optional("design", "a DXF file"):
        from ezdxf._options import options
        from ezdxf.filemanagement import new

    document = new("R2010", setup=True)
    document.header["$INSUNITS"] = MILLIMETRES
    # Dashes are as long on paper whatever the scale.
    document.header["$LTSCALE"] = 0.2 / drawing.scale
    document.appids.add(APPLICATION)
    for name, layer in drawing.layers.items():
        width = min(_WIDTHS, key=lambda known: abs(known - 1e5 * layer.width))
        document.layers.add(name, color=layer.colour, linetype=layer.line, lineweight=width)
    for name, colour in _BESIDE.items():
        if name not in drawing.layers:
            document.layers.add(name, color=colour)
    space = document.modelspace()
    for item in drawing.items:
        _draw(space, item)
    audit = document.audit()
    if audit.has_errors:
        raise InputError(f"the drawing is not sound: {audit.errors[0].message}")
    stream = io.StringIO()
    # Without the moment and a random identifier: a drawing of the same things is the same file.
    fixed = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        document.write(stream)
    finally:
        options.write_fixed_meta_data_for_testing = fixed
    return _MADE.sub(r"\1", stream.getvalue())


def _draw(space: Any, item: Item) -> None:
    if isinstance(item, Polyline):
        points = [(1e3 * x, 1e3 * y) for x, y in item.points]
        space.add_lwpolyline(points, close=item.closed, dxfattribs={"layer": item.layer})
    elif isinstance(item, Arc):
        _arc(space, item)
    elif isinstance(item, Text):
        _text(space, item)
    elif isinstance(item, Dimension):
        _dimension(space, item)
    else:
        _ordinate(space, item)


def _arc(space: Any, arc: Arc) -> None:
    centre, radius, layer = (1e3 * arc.x, 1e3 * arc.y), 1e3 * arc.radius, {"layer": arc.layer}
    if arc.is_circle:
        space.add_circle(centre, radius, dxfattribs=layer)
    else:
        ends = math.degrees(arc.start), math.degrees(arc.end)
        space.add_arc(centre, radius, *ends, dxfattribs=layer)


def _text(space: Any, text: Text) -> None:
    from ezdxf.enums import TextEntityAlignment as Align

    # In its middle: so a text stands where it does in every program, whatever font that has.
    align = {
        "left": Align.MIDDLE_LEFT,
        "middle": Align.MIDDLE_CENTER,
        "right": Align.MIDDLE_RIGHT,
    }[text.align]
    space.add_text(
        text.text,
        height=1e3 * text.height,
        rotation=math.degrees(text.angle),
        dxfattribs={"layer": text.layer},
    ).set_placement((1e3 * text.x, 1e3 * text.y), align=align)


def _look(height: float) -> dict[str, Any]:
    """The style of a dimension whose numbers are so high (mm): no zeros behind the last digit."""
    return {
        "dimtxt": height,
        "dimasz": height,
        # Filled arrows, not strokes.
        "dimtsz": 0,
        "dimblk": "",
        "dimexe": 0.5 * height,
        "dimexo": 0.5 * height,
        "dimgap": 0.3 * height,
        "dimdec": 4,
        "dimzin": 8,
        "dimscale": 1,
        "dimlfac": 1,
    }


def _keep(style: Any, dimension: Dimension | Ordinate) -> None:
    style.render()
    if dimension.value_of:
        style.dimension.set_xdata(APPLICATION, [(1000, dimension.value_of)])


def _dimension(space: Any, dimension: Dimension) -> None:
    base = (1e3 * dimension.at, 0) if dimension.upright else (0, 1e3 * dimension.at)
    style = space.add_linear_dim(
        base=base,
        p1=(1e3 * dimension.x_from, 1e3 * dimension.y_from),
        p2=(1e3 * dimension.x_to, 1e3 * dimension.y_to),
        location=(1e3 * dimension.text_x, 1e3 * dimension.text_y),
        text=f"{dimension.prefix}<>{dimension.suffix}".replace("⌀", "%%c"),
        angle=90 if dimension.upright else 0,
        text_rotation=0,
        dimstyle="EZDXF",
        override=_look(1e3 * dimension.height) | {"dimlfac": 1 / dimension.stretch},
        dxfattribs={"layer": "DIMENSIONS"},
    )
    _keep(style, dimension)


def _ordinate(space: Any, ordinate: Ordinate) -> None:
    add = space.add_ordinate_y_dim if ordinate.upright else space.add_ordinate_x_dim
    reach = 1e3 * (ordinate.end - ordinate.x if ordinate.upright else ordinate.end - ordinate.y)
    style = add(
        (1e3 * ordinate.x, 1e3 * ordinate.y),
        (reach, 0) if ordinate.upright else (0, reach),
        dimstyle="EZDXF",
        override=_look(1e3 * ordinate.height) | {"dimtad": 0},
        dxfattribs={"layer": "DIMENSIONS"},
    )
    _keep(style, ordinate)
