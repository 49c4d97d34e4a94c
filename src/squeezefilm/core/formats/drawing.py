"""A drawing as lines, circles, dimensions and texts on layers: one description, whatever it is
written as. Lengths are those of the thing itself (m); what is on the paper is `scale` times that.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

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
