"""Drawings as DXF, which workshops cut and etch from; written by ezdxf, in millimetres."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated

from squeezefilm import quantities as si

MILLIMETRES = 4
"""$INSUNITS of a drawing in millimetres."""


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class DxfRectangle:
    """A closed rectangle on a layer (m): lower left corner, width along x, height along y."""

    layer: str
    x: si.Metre
    y: si.Metre
    width: Annotated[si.Metre, si.Above(0.0)]
    height: Annotated[si.Metre, si.Above(0.0)]


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class DxfDimension:
    """A horizontal dimension between two places (m), drawn `y` (m) high; the number is measured by
    whoever opens the drawing, and is not written here."""

    x_from: si.Metre
    x_to: si.Metre
    y: si.Metre


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class DxfText:
    """A line of text (m): where it begins, and its height."""

    text: str
    x: si.Metre
    y: si.Metre
    height: Annotated[si.Metre, si.Above(0.0)] = 2.5e-3


@dataclass(frozen=True, slots=True)
class DxfDrawing:
    """What a drawing shows; layers by name with their colour (AutoCAD index)."""

    layers: dict[str, int]
    rectangles: Sequence[DxfRectangle] = ()
    dimensions: Sequence[DxfDimension] = ()
    texts: Sequence[DxfText] = field(default=())


# What ezdxf says of itself, with the moment.
_MADE = re.compile(r"^(\d+(?:\.\d+)+\S*) @ \d{4}-\d\d-\d\dT\S+$", re.MULTILINE)


def dxf_text(drawing: DxfDrawing) -> str:
    """A drawing as the text of a DXF file (R2010).

    Raises `InputError` for a drawing in which ezdxf's own audit finds an error.
    """
    from ezdxf._options import options
    from ezdxf.filemanagement import new

    from squeezefilm.errors import InputError

    found = new("R2010", setup=True)
    found.header["$INSUNITS"] = MILLIMETRES
    for name, colour in {**drawing.layers, "DIMENSIONS": 8, "TEXT": 7}.items():
        found.layers.add(name, color=colour)
    space = found.modelspace()
    for one in drawing.rectangles:
        x, y, width, height = (1e3 * value for value in (one.x, one.y, one.width, one.height))
        corners = [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": one.layer})
    for line in drawing.dimensions:
        ends = (1e3 * line.x_from, 1e3 * line.y), (1e3 * line.x_to, 1e3 * line.y)
        space.add_linear_dim(
            base=(0, 1e3 * line.y + 4),
            p1=ends[0],
            p2=ends[1],
            dimstyle="EZDXF",
            override={"dimtxt": 1.5, "dimdec": 3, "dimscale": 1, "dimlfac": 1},
            dxfattribs={"layer": "DIMENSIONS"},
        ).render()
    for text in drawing.texts:
        space.add_text(
            text.text, height=1e3 * text.height, dxfattribs={"layer": "TEXT"}
        ).set_placement((1e3 * text.x, 1e3 * text.y))
    audit = found.audit()
    if audit.has_errors:
        raise InputError(f"the drawing is not sound: {audit.errors[0].message}")
    stream = io.StringIO()
    # Without the moment and a random identifier: a drawing of the same things is the same file.
    fixed = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        found.write(stream)
    finally:
        options.write_fixed_meta_data_for_testing = fixed
    return _MADE.sub(r"\1", stream.getvalue())
