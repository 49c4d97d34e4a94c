"""The shapes that a search may build: what is chosen of each, and the plate that follows from it.

- "strips": a rectangle with full-width ceramics of alternating sign along its length, one fewer
  than the nodal lines (the paper's monomorph); with `both_faces` a bimorph.
- "edge_strips": a rectangle, usually of glass, with a strip along each long edge, driving lines
  that run along its length.
- "disc": a disc on a ceramic disc, in a mode of nodal circles.
- "ring": a ring on a ceramic ring of sectors poled in turn, in a mode of nodal diameters.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Literal

from squeezefilm.core import hard_limits as hard
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import GeometryError, InputError
from squeezefilm.design.search.space import Setting, Variable, number, step
from squeezefilm.design.search.stock import (
    CUT,
    Body,
    CeramicStock,  # noqa: F401 - of the inherited fields, whose annotations are read here
    PlateRoom,
    Shape,
    StockSheet,  # noqa: F401
    as_drawn,
    counts,
    cut_to_step,
)
from squeezefilm.physics.plate.layout import (
    CeramicPatch,
    DiscPlate,
    FoamSupport,
    GlueLayer,
    RectangularPlate,
)

Lines = Annotated[int, si.AtLeast(2), si.AtMost(60)]

# Nothing thinner than this is sawn: below it ceramics would touch.
_LEAST_PIECE: si.Metre = 1e-3


@si.checked_numbers
@dataclass(frozen=True)
class Gasket:
    """Foam of a width (m) all round the rim, between the touched face and a bezel."""

    width: Annotated[si.Metre, hard.SIDE]
    thickness: Annotated[si.Metre, hard.LAYER]
    young_modulus: Annotated[si.Pascal, hard.MODULUS]
    quality_factor: Annotated[si.Dimensionless, hard.QUALITY] = 3.0


@si.checked_numbers
@dataclass(frozen=True)
class Strips(Shape):
    """A rectangle with full-width ceramics along its length, `gap` (m) apart, of alternating sign,
    one fewer than its nodal lines; `both_faces` makes it a bimorph, whose upper ceramics, driven
    against the lower ones, lie under the finger. `least_cover` is the least share of the
    room between two gaps that a ceramic takes (1: all of it)."""

    least_lines: Lines
    most_lines: Annotated[Lines, si.AtLeast("least_lines")]
    gap: Annotated[si.Metre, hard.PLACE] = 1e-3
    both_faces: bool = False
    least_cover: Annotated[si.Dimensionless, si.AtLeast(0.2), si.AtMost(1.0)] = 1.0
    glue: GlueLayer | None = None
    type: Literal["strips"] = "strips"

    def variables(self, room: PlateRoom) -> tuple[Variable, ...]:
        """Variables. A catalogue's ceramics make the length, which is chosen otherwise."""
        (length, width), (longest, widest) = room.least, room.most
        own = self.catalogue
        return (
            *self.stock(),
            counts("nodal_lines", self.least_lines, self.most_lines),
            number("width", width, widest, "m"),
            *(
                (
                    number("length", length, longest, "m"),
                    number("cover", self.least_cover, 1.0, "1"),
                )
                if own is None
                else (step("ceramic_length", own, "m", "ceramic"),)
            ),
        )

    def body(
        self, values: Mapping[str, Setting], own: Body, quality: float, room: PlateRoom
    ) -> Body:
        """The plate of a choice. Raises `GeometryError` for ceramics that do not fit."""
        lines, width = int(values["nodal_lines"]), float(values["width"])
        count = lines - 1
        if "ceramic_length" in values:
            piece = float(values["ceramic_length"])
            length = max(room.least[0], count * piece + (count - 1) * self.gap)
            if length > room.most[0] + 1e-9:
                raise GeometryError(
                    f"{count} ceramics of {1e3 * piece:.4g} mm, {1e3 * self.gap:.4g} mm apart, are "
                    f"{1e3 * length:.4g} mm long, more than the {1e3 * room.most[0]:.4g} mm allowed"
                )
        else:
            length = float(values["length"])
            full = (length + self.gap) / count - self.gap
            piece = _cut_within(full, float(values["cover"]))
            # An odd number has one in the middle, which lies on a step only so.
            if count % 2 and cut_to_step((length - piece) / 2) != as_drawn((length - piece) / 2):
                piece = cut_to_step(piece - CUT)
        pitch = (length + self.gap) / count
        if not _LEAST_PIECE - 1e-9 <= piece <= pitch - self.gap + 1e-9:
            raise GeometryError(
                f"{count} ceramics on {1e3 * length:.4g} mm are {1e3 * piece:.3g} mm long, and at "
                f"least {1e3 * _LEAST_PIECE:g} mm and a gap of {1e3 * self.gap:.3g} mm are needed"
            )
        # Those that fill the plate begin at its edge, though they are cut to a step.
        inset = 0.0 if values.get("cover") == 1 else max(0.0, (pitch - self.gap - piece) / 2)
        thickness = float(values["ceramic_thickness"])
        below = [
            CeramicPatch(
                x=x,
                y=0.0,
                length=piece,
                width=width,
                thickness=thickness,
                polarity=1 if number % 2 == 0 else -1,
            )
            for number, x in enumerate(_places(count, piece, length, inset))
        ]
        above = [
            replace(patch, polarity=-1 if patch.polarity == 1 else 1, face="top")
            for patch in below
            if self.both_faces
        ]
        return RectangularPlate(
            **self.common(values, own, quality),
            length=length,
            width=width,
            nodal_lines=lines,
            patches=(*below, *above),
            glue=self.glue,
        )


def _cut_within(full: si.Metre, cover: si.Dimensionless) -> si.Metre:
    """The length of a piece that covers a share of the room of a full one: cut to a step, and no
    longer than that."""
    piece = cut_to_step(full * cover)
    return piece if piece <= full + 1e-9 else cut_to_step(piece - CUT)


def _places(count: int, piece: si.Metre, length: si.Metre, inset: si.Metre) -> list[si.Metre]:
    """Places where pieces begin along a length (m), evenly from an inset to its mirror image: on a
    step, and the second half as the first seen from the other end."""
    spacing = (length - piece - 2 * inset) / (count - 1) if count > 1 else 0.0
    first = [cut_to_step(inset + number * spacing) for number in range(count // 2)]
    middle = [as_drawn((length - piece) / 2)] * (count % 2)
    return [*first, *middle, *(as_drawn(length - piece - x) for x in reversed(first))]


@si.checked_numbers
@dataclass(frozen=True)
class EdgeStrips(Shape):
    """A rectangle with a strip of ceramic along each long edge, for nodal lines along its length.

    The strips are `least_strip` to `most_strip` wide (m), of like sign for an even number of lines
    and of opposite sign for an odd one.
    """

    least_lines: Lines
    most_lines: Annotated[Lines, si.AtLeast("least_lines")]
    least_strip: Annotated[si.Metre, hard.SIDE] = 3e-3
    most_strip: Annotated[si.Metre, hard.SIDE] = 10e-3
    glue: GlueLayer | None = None
    gasket: Gasket | None = None
    type: Literal["edge_strips"] = "edge_strips"

    def variables(self, room: PlateRoom) -> tuple[Variable, ...]:
        """Variables; the strips' width from a catalogue where ceramics have lengths."""
        (length, width), (longest, widest) = room.least, room.most
        own = self.catalogue
        return (
            *self.stock(),
            counts("nodal_lines", self.least_lines, self.most_lines),
            number("length", length, longest, "m"),
            number("width", width, widest, "m"),
            number("strip", self.least_strip, self.most_strip, "m")
            if own is None
            else step("strip", own, "m", "ceramic"),
        )

    def body(
        self, values: Mapping[str, Setting], own: Body, quality: float, room: PlateRoom
    ) -> Body:
        """The plate of a choice. Raises `GeometryError` for strips that do not fit."""
        lines, strip = int(values["nodal_lines"]), float(values["strip"])
        length, width = float(values["length"]), float(values["width"])
        thickness = float(values["ceramic_thickness"])
        if 2 * strip >= width:
            raise GeometryError(
                f"two strips of {1e3 * strip:.3g} mm leave nothing of a width of "
                f"{1e3 * width:.4g} mm"
            )
        even = lines % 2 == 0
        patches = (
            CeramicPatch(0.0, 0.0, length, strip, thickness),
            CeramicPatch(
                0.0, as_drawn(width - strip), length, strip, thickness, polarity=1 if even else -1
            ),
        )
        return RectangularPlate(
            **self.common(values, own, quality),
            length=length,
            width=width,
            nodal_lines=lines,
            lines_across="width",
            patches=patches,
            glue=self.glue,
            supports=() if self.gasket is None else _rim(self.gasket, length, width),
        )


def _rim(gasket: Gasket, length: si.Metre, width: si.Metre) -> tuple[FoamSupport, ...]:
    """The gasket as four strips on the touched face."""
    w = gasket.width
    places = (
        (0.0, 0.0, length, w),
        (0.0, as_drawn(width - w), length, w),
        (0.0, w, w, as_drawn(width - 2 * w)),
        (as_drawn(length - w), w, w, as_drawn(width - 2 * w)),
    )
    foam = gasket.thickness, gasket.young_modulus, gasket.quality_factor
    return tuple(FoamSupport(*place, *foam, face="top") for place in places)


@si.checked_numbers
@dataclass(frozen=True)
class Disc(Shape):
    """A disc on a ceramic disc of `least_cover` to all of its diameter, in a mode of
    `least_circles` to `most_circles` nodal circles. The workspace's longer side, with half a
    contact beyond either end, is its least diameter."""

    least_circles: Annotated[int, si.AtLeast(1), si.AtMost(20)] = 1
    most_circles: Annotated[int, si.AtLeast("least_circles"), si.AtMost(20)] = 1
    least_cover: Annotated[si.Dimensionless, si.AtLeast(0.2), si.AtMost(1.0)] = 0.6
    glue: GlueLayer | None = None
    type: Literal["disc"] = "disc"

    def variables(self, room: PlateRoom) -> tuple[Variable, ...]:
        """Variables; the ceramic's diameter from a catalogue where ceramics have lengths."""
        own = self.catalogue
        return (
            *self.stock(),
            counts("nodal_circles", self.least_circles, self.most_circles),
            number("diameter", max(room.least), min(room.most), "m"),
            number("cover", self.least_cover, 1.0, "1")
            if own is None
            else step("ceramic_diameter", own, "m", "ceramic"),
        )

    def body(
        self, values: Mapping[str, Setting], own: Body, quality: float, room: PlateRoom
    ) -> Body:
        """The disc of a choice. Raises `GeometryError` for a ceramic that overhangs."""
        diameter = float(values["diameter"])
        return DiscPlate(
            **self.common(values, own, quality),
            diameter=diameter,
            ceramic_outer_diameter=float(values["ceramic_diameter"])
            if "ceramic_diameter" in values
            else cut_to_step(diameter * float(values["cover"])),
            ceramic_thickness=float(values["ceramic_thickness"]),
            nodal_circles=int(values["nodal_circles"]),
            glue=self.glue,
        )


@si.checked_numbers
@dataclass(frozen=True)
class Ring(Shape):
    """A ring on a ceramic ring of sectors poled in turn, in a mode of `least_diameters` to
    `most_diameters` nodal diameters. The workspace's length goes once round its mean circumference,
    its width is the track's, which a finger follows."""

    least_diameters: Annotated[int, si.AtLeast(2), si.AtMost(40)] = 3
    most_diameters: Annotated[int, si.AtLeast("least_diameters"), si.AtMost(40)] = 12
    glue: GlueLayer | None = None
    type: Literal["ring"] = "ring"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.catalogue is not None:
            raise InputError(
                "the ceramics of a ring have lengths, but they are rings made to its track; leave "
                "lengths out",
                quantity="lengths",
            )

    def variables(self, room: PlateRoom) -> tuple[Variable, ...]:
        """Variables."""
        (around, track), (longest, widest) = room.least, room.most
        return (
            *self.stock(),
            counts("nodal_diameters", self.least_diameters, self.most_diameters),
            number("mean_diameter", *_mean_diameters(around, longest), "m"),
            number("radial_width", track, widest, "m"),
        )

    def body(
        self, values: Mapping[str, Setting], own: Body, quality: float, room: PlateRoom
    ) -> Body:
        """The ring of a choice. Raises `GeometryError` for a track that closes the hole."""
        mean, track = float(values["mean_diameter"]), float(values["radial_width"])
        if track >= mean:
            raise GeometryError(
                f"a track of {1e3 * track:.3g} mm closes a ring of {1e3 * mean:.3g} mm in the mean"
            )
        m = int(values["nodal_diameters"])
        return DiscPlate(
            **self.common(values, own, quality),
            diameter=as_drawn(mean + track),
            ceramic_outer_diameter=as_drawn(mean + track),
            ceramic_thickness=float(values["ceramic_thickness"]),
            inner_diameter=as_drawn(mean - track),
            ceramic_inner_diameter=as_drawn(mean - track),
            nodal_circles=0,
            nodal_diameters=m,
            sectors=2 * m,
            glue=self.glue,
        )


def _mean_diameters(around: si.Metre, longest: si.Metre) -> tuple[si.Metre, si.Metre]:
    """The least and the most mean diameter (m) of rings whose circumference lies between two, on a
    step where there is one between them."""
    least, most = around / math.pi, longest / math.pi
    low, high = (step_ * CUT for step_ in (math.ceil(least / CUT), math.floor(most / CUT)))
    return (as_drawn(low), as_drawn(high)) if low <= high else (least, most)


AnyShape = Strips | EdgeStrips | Disc | Ring


def shape_called(shape: AnyShape) -> str:
    """Name that people have for a shape."""
    if isinstance(shape, Strips):
        return f"strips on {'both faces' if shape.both_faces else 'one face'}"
    return shape.type.replace("_", " ")
