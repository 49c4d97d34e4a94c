"""The round shapes that a search may build: discs and rings."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import GeometryError, InputError
from squeezefilm.design.search.shape import CUT, Body, Room, Shape, counts
from squeezefilm.design.search.space import Setting, Variable, number, step
from squeezefilm.design.search.stock import (
    CeramicStock,  # noqa: F401 - of the inherited fields, whose annotations are read here
    Sheet,  # noqa: F401
    ceramic_named,
    substrate_named,
)
from squeezefilm.physics.plate.layout import DiscPlate, GlueLayer


@si.checked_numbers
@dataclass(frozen=True)
class Disc(Shape):
    """A disc on a ceramic disc of `least_cover` to all of its diameter, in a mode of
    `least_circles` to `most_circles` nodal circles. The workspace's longer side is its least
    diameter."""

    least_circles: Annotated[int, si.AtLeast(1), si.AtMost(20)] = 1
    most_circles: Annotated[int, si.AtLeast(1), si.AtMost(20)] = 1
    least_cover: Annotated[si.Dimensionless, si.AtLeast(0.2), si.AtMost(1.0)] = 0.6
    glue: GlueLayer | None = None
    type: Literal["disc"] = "disc"

    def variables(self, room: Room) -> tuple[Variable, ...]:
        """What is chosen; the ceramic's diameter from a catalogue where ceramics have lengths."""
        own = self.catalogue
        return (
            *self.stock(),
            counts("nodal_circles", self.least_circles, self.most_circles),
            number("diameter", max(room.least), min(room.most), "m"),
            number("cover", self.least_cover, 1.0, "1")
            if own is None
            else step("ceramic_diameter", own, "m", "ceramic"),
        )

    def body(self, values: Mapping[str, Setting], own: Body, quality: float, room: Room) -> Body:
        """The disc of a choice. Raises `GeometryError` for a ceramic that overhangs."""
        diameter = float(values["diameter"])
        return DiscPlate(
            diameter=diameter,
            thickness=float(values["thickness"]),
            quality_factor=quality,
            substrate=substrate_named(str(values["substrate"]), own),
            ceramic=ceramic_named(str(values["ceramic"]), own),
            ceramic_outer_diameter=float(values["ceramic_diameter"])
            if "ceramic_diameter" in values
            else round(diameter * float(values["cover"]) / CUT) * CUT,
            ceramic_thickness=float(values["ceramic_thickness"]),
            nodal_circles=int(values["nodal_circles"]),
            glue=self.glue,
        )


@si.checked_numbers
@dataclass(frozen=True)
class Ring(Shape):
    """A ring on a ceramic ring of sectors poled in turn, in a mode of `least_diameters` to
    `most_diameters` nodal diameters. The workspace's length goes once round its mean circumference,
    its width across the track."""

    least_diameters: Annotated[int, si.AtLeast(2), si.AtMost(40)] = 3
    most_diameters: Annotated[int, si.AtLeast(2), si.AtMost(40)] = 12
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

    def variables(self, room: Room) -> tuple[Variable, ...]:
        """What is chosen."""
        (around, track), (longest, widest) = room.least, room.most
        return (
            *self.stock(),
            counts("nodal_diameters", self.least_diameters, self.most_diameters),
            number("mean_diameter", around / math.pi, longest / math.pi, "m"),
            number("radial_width", track, widest, "m"),
        )

    def body(self, values: Mapping[str, Setting], own: Body, quality: float, room: Room) -> Body:
        """The ring of a choice. Raises `GeometryError` for a track that closes the hole."""
        mean, track = float(values["mean_diameter"]), float(values["radial_width"])
        if track >= mean:
            raise GeometryError(
                f"a track of {1e3 * track:.3g} mm closes a ring of {1e3 * mean:.3g} mm in the mean"
            )
        m = int(values["nodal_diameters"])
        return DiscPlate(
            diameter=mean + track,
            thickness=float(values["thickness"]),
            quality_factor=quality,
            substrate=substrate_named(str(values["substrate"]), own),
            ceramic=ceramic_named(str(values["ceramic"]), own),
            ceramic_outer_diameter=mean + track,
            ceramic_thickness=float(values["ceramic_thickness"]),
            inner_diameter=mean - track,
            ceramic_inner_diameter=mean - track,
            nodal_circles=0,
            nodal_diameters=m,
            sectors=2 * m,
            glue=self.glue,
        )
