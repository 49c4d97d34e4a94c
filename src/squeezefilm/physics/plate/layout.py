"""Parts of a plate or a stator: geometry, checked when it is built."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Literal, TypeVar

from squeezefilm.core import hard_limits as hard
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import GeometryError, InputError
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.plate.round_layout import AnnularStator, DiscPlate, GlueLayer

__all__ = [
    "Actuator",
    "AnnularStator",
    "CeramicPatch",
    "DiscPlate",
    "Edge",
    "Electrode",
    "Face",
    "FoamSupport",
    "GlueLayer",
    "RectangularPlate",
    "turned",
]

_M = si.Unit("m")


Face = Literal["bottom", "top"]
Electrode = Literal["driven", "shorted", "open", "shunted"]
Edge = Literal["left", "right", "front", "back"]


@si.checked_numbers
@dataclass(frozen=True)
class CeramicPatch:
    """A rectangular ceramic on a face of the plate.

    `x` and `y` are the distances of its near edges from the plate's corner. The bonded side is
    grounded; `electrode` says what happens to the outer side: driven (with `polarity` as sign),
    shorted to ground, open, or shunted to ground by `shunt_resistance`. `poling` is +1 where the
    ceramic is poled away from the plate; like polarity it turns the sign of the response.
    """

    x: Annotated[si.Metre, hard.PLACE]
    y: Annotated[si.Metre, hard.PLACE]
    length: Annotated[si.Metre, hard.SIDE]
    width: Annotated[si.Metre, hard.SIDE]
    thickness: Annotated[si.Metre, hard.LAYER]
    polarity: Literal[1, -1] = 1
    face: Face = "bottom"
    electrode: Electrode = "driven"
    poling: Literal[1, -1] = 1
    shunt_resistance: Annotated[si.Ohm, hard.RESISTANCE] | None = None

    def __post_init__(self) -> None:
        if (self.electrode == "shunted") != (self.shunt_resistance is not None):
            raise InputError(
                f"electrode = '{self.electrode}' and shunt_resistance do not go together; a "
                "shunted electrode needs one, the others have none",
                quantity="shunt_resistance",
            )

    @property
    def drive_sign(self) -> int:
        """Sign of the bending by the drive: polarity times poling, 0 where it is not driven."""
        return self.polarity * self.poling if self.electrode == "driven" else 0


@si.checked_numbers
@dataclass(frozen=True)
class FoamSupport:
    """A strip of foam or gasket under (or over) the plate, as springs spread over a rectangle.

    `x`, `y`, `length` and `width` say where; the foam of `thickness` h and `young_modulus` E holds
    the face with E/h per area across it and `shear_modulus`/h along it (E/3 where it is None). Its
    mass is neglected: valid for foam thin against the wave in it. A narrow strip along a line is
    the support at a nodal line. Foam under a ceramic is not provided.
    """

    x: Annotated[si.Metre, hard.PLACE]
    y: Annotated[si.Metre, hard.PLACE]
    length: Annotated[si.Metre, hard.SIDE]
    width: Annotated[si.Metre, hard.SIDE]
    thickness: Annotated[si.Metre, hard.LAYER]
    young_modulus: Annotated[si.Pascal, hard.MODULUS]
    quality_factor: Annotated[si.Dimensionless, hard.QUALITY] = 3.0
    shear_modulus: Annotated[si.Pascal, hard.SHEAR_MODULUS] | None = None
    face: Face = "bottom"

    @property
    def stiffness_per_area(self) -> tuple[float, float, float]:
        """Stiffness along x, y and z (Pa/m)."""
        shear = self.young_modulus / 3 if self.shear_modulus is None else self.shear_modulus
        along = shear / self.thickness
        return along, along, self.young_modulus / self.thickness


_Part = TypeVar("_Part", CeramicPatch, FoamSupport)


@si.checked_numbers
@dataclass(frozen=True)
class RectangularPlate:
    """A rectangular plate with ceramics bonded to its faces.

    `nodal_lines` picks the working mode: that many nodal lines across the length, none along it;
    with `lines_across` = "width" that many across the width, as strips along the long edges drive.
    Where several modes have these lines, the one nearest to `working_frequency` is taken (where
    none there has them, the nearest that is driven), without one the most strongly driven.
    `quality_factor` is that of the whole assembly; it holds for every material unless the substrate
    has its own, and then ceramic and glue have theirs too. Edges are free but for `supports` and
    `clamped_edges` (left and right: x = 0 and x = length; front and back: y).

    Raises `GeometryError` for ceramics that overlap each other or overhang the plate.
    """

    length: Annotated[si.Metre, hard.SIDE]
    width: Annotated[si.Metre, hard.SIDE]
    thickness: Annotated[si.Metre, hard.LAYER]
    nodal_lines: Annotated[int, hard.NODAL_LINES]
    quality_factor: Annotated[si.Dimensionless, hard.QUALITY]
    substrate: ElasticMaterial
    ceramic: Piezoceramic
    patches: tuple[CeramicPatch, ...]
    type: Literal["rectangular_plate"] = "rectangular_plate"
    glue: GlueLayer | None = None
    supports: tuple[FoamSupport, ...] = ()
    clamped_edges: tuple[Edge, ...] = ()
    lines_across: Literal["length", "width"] = "length"
    working_frequency: Annotated[si.Hertz, hard.FREQUENCY] | None = None

    def __post_init__(self) -> None:
        hard.require_within(hard.PARTS_OF_A_PLATE, len(self.patches), "number of patches")
        hard.require_within(hard.PARTS_OF_A_PLATE, len(self.supports), "number of supports")
        if not self.patches:
            raise GeometryError("patches is empty; a plate needs at least one ceramic to drive it")
        self._check_overhang()
        self._check_overlap()

    def _check_overhang(self) -> None:
        # A nanometre of slack, so that 7 × 11 mm + 6 × 1 mm is not longer than 83 mm in floats.
        parts: list[tuple[str, CeramicPatch | FoamSupport]] = [
            *((f"ceramic {n}", patch) for n, patch in enumerate(self.patches, 1)),
            *((f"support {n}", support) for n, support in enumerate(self.supports, 1)),
        ]
        for name, part in parts:
            for axis, start, extent, limit in (
                ("length", part.x, part.length, self.length),
                ("width", part.y, part.width, self.width),
            ):
                if start + extent > limit + 1e-9:
                    raise GeometryError(
                        f"{name} overhangs the plate: it ends at "
                        f"{si.format_quantity(start + extent, _M)} along its {axis}, the plate at "
                        f"{si.format_quantity(limit, _M)}; move it or make it shorter"
                    )

    def _check_overlap(self) -> None:
        for i, a in enumerate(self.patches):
            for j, b in enumerate(self.patches[:i]):
                if a.face == b.face and (overlap := _overlap(a, b)):
                    raise GeometryError(
                        f"ceramics {j + 1} and {i + 1} overlap by {overlap}; move one of them"
                    )
            for k, support in enumerate(self.supports, 1):
                if a.face == support.face and (overlap := _overlap(a, support)):
                    raise GeometryError(
                        f"ceramic {i + 1} and support {k} overlap by {overlap}; foam under a "
                        "ceramic is not provided, move one of them"
                    )

    @property
    def working_label(self) -> tuple[int, int]:
        """The working mode by its nodal lines across length and width: (n, 0) or (0, n)."""
        return (self.nodal_lines, 0) if self.lines_across == "length" else (0, self.nodal_lines)

    @property
    def extent(self) -> tuple[si.Metre, si.Metre]:
        """Extent of what there is to touch along x and along y (m)."""
        return self.length, self.width

    @property
    def area(self) -> si.SquareMetre:
        """The surface a finger can explore."""
        return self.length * self.width

    @property
    def ceramic_thickness(self) -> si.Metre:
        """The ceramics' thickness, their mean by area where they differ: for laminates and
        drawings; the solid model takes each patch's own."""
        return _mean_thickness(self.patches)

    def ceramic_thickness_on(self, face: Face) -> si.Metre:
        """Thickness of the ceramics on one face, their mean by area; 0 where it carries none."""
        return _mean_thickness([patch for patch in self.patches if patch.face == face])

    def coverage_of(self, face: Face) -> si.Dimensionless:
        """The share of one face that carries ceramic."""
        on_it = (patch for patch in self.patches if patch.face == face)
        return sum(patch.length * patch.width for patch in on_it) / self.area

    @property
    def coverage(self) -> si.Dimensionless:
        """The share of the plate, seen from above, that carries ceramic on one face or on both."""
        both = sum(
            max(0.0, _shared(a.x, a.length, b.x, b.length))
            * max(0.0, _shared(a.y, a.width, b.y, b.width))
            for a in self.patches
            for b in self.patches
            if (a.face, b.face) == ("top", "bottom")
        )
        return self.coverage_of("bottom") + self.coverage_of("top") - both / self.area

    @si.checked_numbers
    def ceramics_at(self, x: si.Metre, y: si.Metre) -> tuple[si.Metre, si.Metre]:
        """The thickness (m) of the ceramic above and below a place (m from the plate's corner);
        0 where there is none."""
        there = {
            patch.face: patch.thickness
            for patch in self.patches
            if patch.x <= x <= patch.x + patch.length and patch.y <= y <= patch.y + patch.width
        }
        return there.get("top", 0.0), there.get("bottom", 0.0)


def _mean_thickness(patches: Sequence[CeramicPatch]) -> si.Metre:
    thicknesses = {patch.thickness for patch in patches}
    if len(thicknesses) < 2:
        return max(thicknesses, default=0.0)
    area = sum(patch.length * patch.width for patch in patches)
    return sum(patch.length * patch.width * patch.thickness for patch in patches) / area


def turned(plate: RectangularPlate) -> RectangularPlate:
    """The same plate with x and y exchanged: its length is the other's width.

    What was computed along the length can so be computed along the width.
    """
    other: dict[Edge, Edge] = {"left": "front", "right": "back", "front": "left", "back": "right"}

    def swapped(part: _Part) -> _Part:
        return replace(part, x=part.y, y=part.x, length=part.width, width=part.length)

    return replace(
        plate,
        length=plate.width,
        width=plate.length,
        patches=tuple(swapped(patch) for patch in plate.patches),
        supports=tuple(swapped(support) for support in plate.supports),
        clamped_edges=tuple(other[edge] for edge in plate.clamped_edges),
        lines_across="width" if plate.lines_across == "length" else "length",
    )


def resized(
    body: RectangularPlate | DiscPlate, sides: Mapping[str, si.Metre]
) -> RectangularPlate | DiscPlate:
    """The same plate or disc with another `length`, `width` or `diameter` (m, by these names), and
    what lies on it in proportion."""
    if not sides.keys() & {"length", "width", "diameter"}:
        return body
    if isinstance(body, DiscPlate):
        larger = sides.get("diameter", body.diameter) / body.diameter
        every = ("diameter", "inner_diameter", "ceramic_outer_diameter", "ceramic_inner_diameter")
        return replace(body, **{name: larger * getattr(body, name) for name in every})
    length, width = sides.get("length", body.length), sides.get("width", body.width)
    x, y = length / body.length, width / body.width

    def scaled(part: _Part) -> _Part:
        return replace(
            part, x=x * part.x, y=y * part.y, length=x * part.length, width=y * part.width
        )

    patches, supports = map(scaled, body.patches), map(scaled, body.supports)
    return replace(
        body, length=length, width=width, patches=tuple(patches), supports=tuple(supports)
    )


def _shared(start: float, extent: float, other: float, other_extent: float) -> float:
    """Length over which two intervals overlap; negative for how far they lie apart."""
    return min(start + extent, other + other_extent) - max(start, other)


def _overlap(a: CeramicPatch | FoamSupport, b: CeramicPatch | FoamSupport) -> str | None:
    x = _shared(a.x, a.length, b.x, b.length)
    y = _shared(a.y, a.width, b.y, b.width)
    if x > 1e-9 and y > 1e-9:
        return f"{si.format_quantity(x, _M)} × {si.format_quantity(y, _M)}"
    return None


Actuator = RectangularPlate | AnnularStator | DiscPlate
