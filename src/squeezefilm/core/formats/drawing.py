"""A drawing as lines, circles, dimensions and texts on layers: one description, whatever it is
written as, and DXF of it, by ezdxf. Lengths are those of the thing itself (m); what is on the paper
is `scale` times that.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from squeezefilm.core import quantities as si

LineType = Literal["CONTINUOUS", "DASHED", "DASHDOT"]
Place = tuple[float, float]


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class Layer:
    """The look of a layer: colour (AutoCAD index), type of its lines, their width on paper (m),
    and with what closed shapes on it are filled where the format fills: nothing, the layer's own
    colour, or the paper's."""

    colour: Annotated[int, si.AtLeast(0), si.AtMost(256)]
    line: LineType = "CONTINUOUS"
    width: Annotated[si.Metre, si.Above(0.0)] = 0.25e-3
    fill: Literal["none", "own", "paper"] = "none"


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class Polyline:
    """Straight lines through `points` (x, y in m)."""

    layer: str
    points: tuple[Place, ...]
    closed: bool = False


@si.checked_numbers
def rectangle(layer: str, x: si.Metre, y: si.Metre, width: si.Metre, height: si.Metre) -> Polyline:
    """A closed rectangle (m): lower left corner, width along x, height along y."""
    corners = (x, y), (x + width, y), (x + width, y + height), (x, y + height)
    return Polyline(layer, corners, closed=True)


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class Arc:
    """An arc about a centre (m), anticlockwise from `start` to `end` (rad); a circle where it goes
    all round."""

    layer: str
    x: si.Metre
    y: si.Metre
    radius: Annotated[si.Metre, si.Above(0.0)]
    start: si.Radian = 0.0
    end: si.Radian = 6.283185307179586

    @property
    def is_circle(self) -> bool:
        """True where it goes all round."""
        return self.end - self.start > 6.2831853


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class Text:
    """A line of text (m): where its middle (or its end) is, the height of a capital, the angle
    (rad) that it is turned by."""

    text: str
    x: si.Metre
    y: si.Metre
    height: Annotated[si.Metre, si.Above(0.0)] = 2.5e-3
    align: Literal["left", "middle", "right"] = "left"
    angle: si.Radian = 0.0
    layer: str = "TEXT"


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class Dimension:
    """The distance of two places along x (or, `upright`, along y), measured by whoever opens the
    drawing: the number is not written here.

    The places are (`x_from`, `y_from`) and (`x_to`, `y_to`); the dimension's line runs through `at`
    (a y, or where it is upright an x), its number stands at (`text_x`, `text_y`). `stretch` is by
    how much its direction is drawn larger than the rest (a section's thickness); `prefix` and
    `suffix` stand about the number, `value_of` is the key of the description that it shows.
    """

    x_from: si.Metre
    y_from: si.Metre
    x_to: si.Metre
    y_to: si.Metre
    at: si.Metre
    text_x: si.Metre
    text_y: si.Metre
    height: Annotated[si.Metre, si.Above(0.0)] = 1.5e-3
    upright: bool = False
    stretch: Annotated[si.Dimensionless, si.Above(0.0)] = 1.0
    prefix: str = ""
    suffix: str = ""
    value_of: str = ""

    @property
    def measured(self) -> si.Metre:
        """The distance that it shows (m)."""
        ends = (self.y_from, self.y_to) if self.upright else (self.x_from, self.x_to)
        return abs(ends[1] - ends[0]) / self.stretch

    @property
    def said(self) -> str:
        """The text on the paper, in millimetres."""
        return f"{self.prefix}{millimetres(self.measured)}{self.suffix}"


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class Ordinate:
    """The distance of a place from the origin along x (or, `upright`, along y), at the end of a
    leader that runs square to that direction to `end` (a y, or where it is upright an x) (m)."""

    x: si.Metre
    y: si.Metre
    end: si.Metre
    height: Annotated[si.Metre, si.Above(0.0)] = 1.5e-3
    upright: bool = False
    value_of: str = ""

    @property
    def measured(self) -> si.Metre:
        """The distance that it shows (m)."""
        return abs(self.y if self.upright else self.x)

    @property
    def said(self) -> str:
        """The text on the paper, in millimetres."""
        return millimetres(self.measured)


Item = Polyline | Arc | Text | Dimension | Ordinate


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class Drawing:
    """A drawing and its paper. The paper's lower left corner lies at `corner` (x, y in m), its
    `paper` is width and height (m), and `scale` is paper over thing; the order of the items is that
    in which they are drawn. `views` is the part of the paper without tables and title (left,
    bottom, right, top in m of paper), `notes` what is written beside it: for pages that show only
    these.
    """

    layers: Mapping[str, Layer]
    items: Sequence[Item] = ()
    scale: Annotated[si.Dimensionless, si.Above(0.0)] = 1.0
    paper: Place = (0.42, 0.297)
    corner: Place = field(default=(0.0, 0.0))
    views: tuple[float, float, float, float] = (0.0, 0.0, 0.42, 0.297)
    notes: tuple[str, ...] = ()


@si.checked_numbers
def millimetres(length: si.Metre) -> str:
    """A length as drawings have it: millimetres without their unit, to a ten thousandth."""
    return f"{round(1e3 * length, 4):.10g}"


@si.checked_numbers
def arrows_outside(extent: si.Metre, height: si.Metre) -> bool:
    """True where a dimension so long, with a number so high (m), has no room for its arrows."""
    return extent < 3.2 * height


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
    # ezdxf adds these from a set, whose order is another one in every process.
    document.classes.add_required_classes(document.dxfversion)
    document.classes.classes = dict(sorted(document.classes.classes.items()))
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
