"""A drawing of lines, circles, dimensions and texts on layers, as a document of ezdxf, and DXF of
it. Lengths are those of the thing itself (m); what is on the paper is `scale` times that.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any, Literal

from squeezefilm.core import quantities as si

if TYPE_CHECKING:
    from ezdxf.document import Drawing as Document
    from ezdxf.entities.dimstyleoverride import DimStyleOverride

LineType = Literal["CONTINUOUS", "DASHED", "DASHDOT"]
Align = Literal["left", "center", "right"]
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


@si.checked_numbers
@dataclass(eq=False)
class Drawing:
    """A drawing as a `document` of ezdxf, in millimetres of the thing, and its paper; what draws
    takes metres. Raises `MissingPackageError` where ezdxf is not installed.

    The paper's lower left corner lies at `corner` (x, y in m), its `paper` is width and height (m),
    and `scale` is paper over thing; what is drawn later lies over what was before. `views` is the
    part of the paper without tables and title (left, bottom, right, top in m of paper), `notes`
    what is written beside it: for pages that show only these.
    """

    layers: Mapping[str, Layer]
    scale: Annotated[si.Dimensionless, si.Above(0.0)] = 1.0
    paper: Place = (0.42, 0.297)
    corner: Place = (0.0, 0.0)
    views: tuple[float, float, float, float] = (0.0, 0.0, 0.42, 0.297)
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        from squeezefilm.core.errors import optional

        with optional("design", "a DXF drawing"):
            from ezdxf.filemanagement import new

        document = new("R2010", setup=True)
        document.header["$INSUNITS"] = MILLIMETRES
        # Dashes are as long on paper whatever the scale.
        document.header["$LTSCALE"] = 0.2 / self.scale
        document.appids.add(APPLICATION)
        for name, layer in self.layers.items():
            width = min(_WIDTHS, key=lambda known: abs(known - 1e5 * layer.width))
            document.layers.add(name, color=layer.colour, linetype=layer.line, lineweight=width)
        for name, colour in _BESIDE.items():
            if name not in self.layers:
                document.layers.add(name, color=colour)
        self.document: Document = document
        self._space = document.modelspace()

    @si.checked_numbers
    def line(self, layer: str, points: tuple[Place, ...], *, closed: bool = False) -> None:
        """Straight lines through `points` (x, y in m)."""
        places = [(1e3 * x, 1e3 * y) for x, y in points]
        self._space.add_lwpolyline(places, close=closed, dxfattribs={"layer": layer})

    @si.checked_numbers
    def rectangle(
        self, layer: str, x: si.Metre, y: si.Metre, width: si.Metre, height: si.Metre
    ) -> None:
        """A closed rectangle (m): lower left corner, width along x, height along y."""
        corners = (x, y), (x + width, y), (x + width, y + height), (x, y + height)
        self.line(layer, corners, closed=True)

    @si.checked_numbers
    def arc(
        self,
        layer: str,
        x: si.Metre,
        y: si.Metre,
        radius: Annotated[si.Metre, si.Above(0.0)],
        start: si.Radian = 0.0,
        end: si.Radian = 2 * math.pi,
    ) -> None:
        """An arc about a centre (m), anticlockwise from `start` to `end` (rad); a circle where it
        goes all round."""
        centre, look = (1e3 * x, 1e3 * y), {"layer": layer}
        if end - start > 6.2831853:
            self._space.add_circle(centre, 1e3 * radius, dxfattribs=look)
        else:
            ends = math.degrees(start), math.degrees(end)
            self._space.add_arc(centre, 1e3 * radius, *ends, dxfattribs=look)

    @si.checked_numbers
    def text(
        self,
        text: str,
        x: si.Metre,
        y: si.Metre,
        height: Annotated[si.Metre, si.Above(0.0)] = 2.5e-3,
        align: Align = "left",
        angle: si.Radian = 0.0,
    ) -> None:
        """A line of text (m): where its middle (or its end) is, the height of a capital, the angle
        (rad) that it is turned by."""
        from ezdxf.enums import TextEntityAlignment

        # In its middle: so a text stands where it does in every program, whatever font that has.
        self._space.add_text(
            text,
            height=1e3 * height,
            rotation=math.degrees(angle),
            dxfattribs={"layer": "TEXT"},
        ).set_placement((1e3 * x, 1e3 * y), align=TextEntityAlignment[f"MIDDLE_{align.upper()}"])

    @si.checked_numbers
    def dimension(
        self,
        start: Place,
        end: Place,
        at: si.Metre,
        number: Place,
        height: Annotated[si.Metre, si.Above(0.0)] = 1.5e-3,
        *,
        upright: bool = False,
        stretch: Annotated[si.Dimensionless, si.Above(0.0)] = 1.0,
        prefix: str = "",
        suffix: str = "",
        value_of: str = "",
    ) -> None:
        """The distance of two places (m) along x (or, `upright`, along y), measured by whoever
        opens the drawing: the number is not written here.

        The dimension's line runs through `at` (a y, or where it is upright an x), the middle of its
        `number` stands at a place. `stretch` is by how much its direction is drawn larger than the
        rest (a section's thickness); `prefix` and `suffix` stand about the number, `value_of` is
        the key of the description that it shows.
        """
        style = self._space.add_linear_dim(
            base=(1e3 * at, 0) if upright else (0, 1e3 * at),
            p1=(1e3 * start[0], 1e3 * start[1]),
            p2=(1e3 * end[0], 1e3 * end[1]),
            location=(1e3 * number[0], 1e3 * number[1]),
            text=f"{prefix}<>{suffix}".replace("⌀", "%%c"),
            angle=90 if upright else 0,
            text_rotation=0,
            dimstyle="EZDXF",
            override=_look(1e3 * height) | {"dimlfac": 1 / stretch},
            dxfattribs={"layer": "DIMENSIONS"},
        )
        _keep(style, value_of)

    @si.checked_numbers
    def ordinate(
        self,
        x: si.Metre,
        y: si.Metre,
        end: si.Metre,
        height: Annotated[si.Metre, si.Above(0.0)] = 1.5e-3,
        *,
        upright: bool = False,
        value_of: str = "",
    ) -> None:
        """The distance of a place (m) from the origin along x (or, `upright`, along y), at the end
        of a leader that runs square to that direction to `end` (a y, or where it is upright an x).
        """
        add = self._space.add_ordinate_y_dim if upright else self._space.add_ordinate_x_dim
        reach = 1e3 * (end - x if upright else end - y)
        style = add(
            (1e3 * x, 1e3 * y),
            (reach, 0) if upright else (0, reach),
            dimstyle="EZDXF",
            override=_look(1e3 * height) | {"dimtad": 0},
            dxfattribs={"layer": "DIMENSIONS"},
        )
        _keep(style, value_of)


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


def _keep(style: DimStyleOverride, value_of: str) -> None:
    style.render()
    if value_of:
        style.dimension.set_xdata(APPLICATION, [(1000, value_of)])


def dxf_text(drawing: Drawing) -> str:
    """A drawing as the text of a DXF file (R2010), at full size.

    Dimensions are entities of their own, which keep `value_of` as extended data of `APPLICATION`.
    Raises `InputError` for a drawing in which ezdxf's own audit finds an error.
    """
    from ezdxf._options import options

    from squeezefilm.core.errors import InputError

    document = drawing.document
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
