"""What a plate or a stator is made of and where: geometry, checked when it is built."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal, TypeVar

from squeezefilm.errors import GeometryError, InputError
from squeezefilm.materials import ElasticMaterial, Piezoceramic
from squeezefilm.quantities import (
    Dimensionless,
    Hertz,
    KilogramPerCubicMetre,
    Metre,
    Ohm,
    Pascal,
    SquareMetre,
    Unit,
    Volt,
    checked_numbers,
    format_quantity,
    require,
)

_M = Unit("m")


Face = Literal["bottom", "top"]
Electrode = Literal["driven", "shorted", "open", "shunted"]
Edge = Literal["left", "right", "front", "back"]


@checked_numbers
@dataclass(frozen=True)
class CeramicPatch:
    """One rectangular ceramic on a face of the plate.

    `x` and `y` are the distances of its near edges from the plate's corner. The bonded side is
    grounded; `electrode` says what happens to the outer side: driven (with `polarity` as sign),
    shorted to ground, open, or shunted to ground by `shunt_resistance`. `poling` is +1 where the
    ceramic is poled away from the plate; like polarity it turns the sign of the response.
    """

    x: Metre
    y: Metre
    length: Metre
    width: Metre
    thickness: Metre
    polarity: Literal[1, -1] = 1
    face: Face = "bottom"
    electrode: Electrode = "driven"
    poling: Literal[1, -1] = 1
    shunt_resistance: Ohm | None = None

    def __post_init__(self) -> None:
        require("x", self.x, _M, at_least=0)
        require("y", self.y, _M, at_least=0)
        for name in ("length", "width", "thickness"):
            require(name, getattr(self, name), _M, above=0)
        if self.shunt_resistance is not None:
            require("shunt_resistance", self.shunt_resistance, Unit("ohm"), above=0)
        if (self.electrode == "shunted") != (self.shunt_resistance is not None):
            raise InputError(
                f"electrode = '{self.electrode}' and shunt_resistance do not go together; a "
                "shunted electrode needs one, the others have none",
                quantity="shunt_resistance",
            )


@checked_numbers
@dataclass(frozen=True)
class GlueLayer:
    """The glue between every ceramic and the plate, as an isotropic layer."""

    thickness: Metre
    young_modulus: Pascal
    poisson_ratio: Dimensionless = 0.38
    density: KilogramPerCubicMetre = 1150.0
    quality_factor: Dimensionless = 20.0

    def __post_init__(self) -> None:
        require("thickness", self.thickness, _M, above=0)
        require("young_modulus", self.young_modulus, Unit("Pa"), above=0)
        require("poisson_ratio", self.poisson_ratio, above=-1, below=0.5)
        require("density", self.density, Unit("kg/m3"), above=0)
        require("quality_factor", self.quality_factor, above=0.5)


@checked_numbers
@dataclass(frozen=True)
class FoamSupport:
    """A strip of foam or gasket under (or over) the plate, as springs spread over a rectangle.

    `x`, `y`, `length` and `width` say where; the foam of `thickness` h and `young_modulus` E holds
    the face with E/h per area across it and `shear_modulus`/h along it (E/3 where it is None). Its
    mass is neglected: valid for foam thin against the wave in it. A narrow strip along a line is
    the support at a nodal line. Foam under a ceramic is not provided.
    """

    x: Metre
    y: Metre
    length: Metre
    width: Metre
    thickness: Metre
    young_modulus: Pascal
    quality_factor: Dimensionless = 3.0
    shear_modulus: Pascal | None = None
    face: Face = "bottom"

    def __post_init__(self) -> None:
        require("x", self.x, _M, at_least=0)
        require("y", self.y, _M, at_least=0)
        for name in ("length", "width", "thickness"):
            require(name, getattr(self, name), _M, above=0)
        require("young_modulus", self.young_modulus, Unit("Pa"), above=0)
        require("quality_factor", self.quality_factor, above=0.5)
        if self.shear_modulus is not None:
            require("shear_modulus", self.shear_modulus, Unit("Pa"), at_least=0)

    @property
    def stiffness_per_area(self) -> tuple[float, float, float]:
        """Along x, y and z (Pa/m)."""
        shear = self.young_modulus / 3 if self.shear_modulus is None else self.shear_modulus
        along = shear / self.thickness
        return along, along, self.young_modulus / self.thickness


@checked_numbers
def rim_supports(
    length: Metre, width: Metre, strip: Metre, thickness: Metre, young_modulus: Pascal,
    quality_factor: Dimensionless = 3.0, face: Face = "bottom",
) -> tuple[FoamSupport, ...]:  # fmt: skip
    """Four strips of foam of breadth `strip` around the rim of a plate of `length` × `width`."""

    def one(x: float, y: float, a: float, b: float) -> FoamSupport:
        return FoamSupport(x, y, a, b, thickness, young_modulus, quality_factor, None, face)

    return (
        one(0, 0, length, strip),
        one(0, width - strip, length, strip),
        one(0, strip, strip, width - 2 * strip),
        one(length - strip, strip, strip, width - 2 * strip),
    )


_Part = TypeVar("_Part", CeramicPatch, FoamSupport)


@checked_numbers
@dataclass(frozen=True)
class RectangularPlate:
    """A rectangular plate with ceramics bonded to its faces.

    `nodal_lines` picks the working mode: that many nodal lines across the length, none along it;
    with `lines_across` = "width" that many across the width, as strips along the long edges drive.
    `quality_factor` is that of the whole assembly; it holds for every material unless the
    substrate has its own, and then ceramic and glue have theirs too. Edges are free but for
    `supports` and `clamped_edges` (left and right: x = 0 and x = length; front and back: y).

    Raises `GeometryError` for ceramics that overlap each other or overhang the plate.
    """

    length: Metre
    width: Metre
    thickness: Metre
    nodal_lines: int
    quality_factor: Dimensionless
    substrate: ElasticMaterial
    ceramic: Piezoceramic
    patches: tuple[CeramicPatch, ...]
    type: Literal["rectangular_plate"] = "rectangular_plate"
    glue: GlueLayer | None = None
    supports: tuple[FoamSupport, ...] = ()
    clamped_edges: tuple[Edge, ...] = ()
    lines_across: Literal["length", "width"] = "length"

    def __post_init__(self) -> None:
        for name in ("length", "width", "thickness"):
            require(name, getattr(self, name), _M, above=0)
        require("nodal_lines", self.nodal_lines, at_least=2)
        require("quality_factor", self.quality_factor, above=0.5)
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
                        f"{format_quantity(start + extent, _M)} along its {axis}, the plate at "
                        f"{format_quantity(limit, _M)}; move it or make it shorter"
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
    def area(self) -> SquareMetre:
        """The surface a finger can explore."""
        return self.length * self.width

    @property
    def ceramic_thickness(self) -> Metre:
        """The ceramics' thickness, their mean by area where they differ: for laminates and
        drawings; the solid model takes each patch's own."""
        area = sum(patch.length * patch.width for patch in self.patches)
        volume = sum(patch.length * patch.width * patch.thickness for patch in self.patches)
        same = len({patch.thickness for patch in self.patches}) == 1
        return self.patches[0].thickness if same else volume / area

    @property
    def coverage(self) -> Dimensionless:
        """The area of all ceramics over that of one face."""
        return sum(patch.length * patch.width for patch in self.patches) / self.area


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


def _overlap(a: CeramicPatch | FoamSupport, b: CeramicPatch | FoamSupport) -> str | None:
    x = min(a.x + a.length, b.x + b.length) - max(a.x, b.x)
    y = min(a.y + a.width, b.y + b.width) - max(a.y, b.y)
    if x > 1e-9 and y > 1e-9:
        return f"{format_quantity(x, _M)} × {format_quantity(y, _M)}"
    return None


@checked_numbers
@dataclass(frozen=True)
class AnnularStator:
    """The ring of an ultrasonic motor fed on one channel: a standing wave of known frequency and
    length. Its amplitude is not computed but measured, at `reference_voltage`, and scales with it.
    The surface may be toothed: `tooth_pitch` along the circumference, slots of `slot_width`.
    """

    mean_diameter: Metre
    radial_width: Metre
    wavelength: Metre
    resonance_frequency: Hertz
    quality_factor: Dimensionless
    reference_amplitude: Metre
    reference_voltage: Volt
    tooth_pitch: Metre | None = None
    slot_width: Metre | None = None
    type: Literal["annular_stator"] = "annular_stator"

    def __post_init__(self) -> None:
        for name in ("mean_diameter", "radial_width", "wavelength", "reference_amplitude"):
            require(name, getattr(self, name), _M, above=0)
        require("resonance_frequency", self.resonance_frequency, Unit("Hz"), above=0)
        require("quality_factor", self.quality_factor, above=0.5)
        require("reference_voltage", self.reference_voltage, Unit("V"), above=0)
        if self.radial_width >= self.mean_diameter:
            raise GeometryError(
                f"radial_width = {format_quantity(self.radial_width, _M)} is not smaller than "
                f"mean_diameter = {format_quantity(self.mean_diameter, _M)}; a ring needs a hole"
            )
        if (self.tooth_pitch is None) != (self.slot_width is None):
            raise GeometryError(
                "tooth_pitch and slot_width belong together; give both, or neither for a plain ring"
            )
        if self.tooth_pitch is not None and self.slot_width is not None:
            require("tooth_pitch", self.tooth_pitch, _M, above=0)
            require("slot_width", self.slot_width, _M, above=0, below=self.tooth_pitch)
        waves = self.wavelengths_around
        if abs(waves - round(waves)) > 0.05 or round(waves) < 1:
            raise GeometryError(
                f"{waves:.2f} wavelengths of {format_quantity(self.wavelength, _M)} fit on the "
                f"mean diameter of {format_quantity(self.mean_diameter, _M)}; a standing wave "
                "needs a whole number (within 0.05)"
            )

    @property
    def wavelengths_around(self) -> Dimensionless:
        """How many wavelengths fit on the mean circumference."""
        return math.pi * self.mean_diameter / self.wavelength


@checked_numbers
@dataclass(frozen=True)
class DiscPlate:
    """A disc (or an annulus, with an `inner_diameter`) with a ceramic disc or ring bonded below.

    The working mode B(`nodal_circles`, `nodal_diameters`) is solved, nothing of it is measured.
    Without nodal diameters one electrode covers the whole ceramic; with m of them the ceramic has
    `sectors` neighbouring sectors of π/m, poled in turn (2m go all round). `quality_factor` is that
    of the whole assembly; it holds for every material unless the substrate has its own. The disc is
    free everywhere.

    Raises `GeometryError` for a ceramic that overhangs, `InputError` for sectors that do not fit.
    """

    diameter: Metre
    thickness: Metre
    quality_factor: Dimensionless
    substrate: ElasticMaterial
    ceramic: Piezoceramic
    ceramic_outer_diameter: Metre
    ceramic_thickness: Metre
    inner_diameter: Metre = 0.0
    ceramic_inner_diameter: Metre = 0.0
    nodal_circles: int = 1
    nodal_diameters: int = 0
    sectors: int = 0
    glue: GlueLayer | None = None
    type: Literal["disc"] = "disc"

    def __post_init__(self) -> None:
        for name in ("diameter", "thickness", "ceramic_outer_diameter", "ceramic_thickness"):
            require(name, getattr(self, name), _M, above=0)
        require("inner_diameter", self.inner_diameter, _M, at_least=0, below=self.diameter)
        require(
            "ceramic_inner_diameter", self.ceramic_inner_diameter, _M,
            at_least=0, below=self.ceramic_outer_diameter,
        )  # fmt: skip
        require("quality_factor", self.quality_factor, above=0.5)
        require("nodal_circles", self.nodal_circles, at_least=0)
        require("nodal_diameters", self.nodal_diameters, at_least=0)
        self._check_ceramic()
        m = self.nodal_diameters
        if m == 0 and self.sectors:
            raise InputError(
                f"sectors = {self.sectors} drive no mode without nodal diameters; leave them out "
                "for one electrode all round, or give nodal_diameters",
                quantity="sectors",
            )
        if m > 0 and not 1 <= self.sectors <= 2 * m:
            raise InputError(
                f"sectors = {self.sectors} is not allowed with {m} nodal diameters: from 1 to "
                f"{2 * m} sectors of half a wave fit round the disc",
                quantity="sectors",
            )
        if self.nodal_circles == 0 and m < 2:
            raise InputError(
                f"B(0,{m}) is a motion of the rigid disc; give a nodal circle, or two nodal "
                "diameters",
                quantity="nodal_circles",
            )

    def _check_ceramic(self) -> None:
        if self.ceramic_outer_diameter > self.diameter + 1e-9:
            raise GeometryError(
                f"the ceramic of {format_quantity(self.ceramic_outer_diameter, _M)} overhangs the "
                f"disc of {format_quantity(self.diameter, _M)}; make it smaller",
                quantity="ceramic_outer_diameter",
            )
        if self.ceramic_inner_diameter < self.inner_diameter - 1e-9:
            raise GeometryError(
                f"the ceramic begins at a diameter of "
                f"{format_quantity(self.ceramic_inner_diameter, _M)} and overhangs the hole of "
                f"{format_quantity(self.inner_diameter, _M)}; give it a larger "
                "ceramic_inner_diameter",
                quantity="ceramic_inner_diameter",
            )

    @property
    def nodal_lines(self) -> int:
        """Nodal circles and diameters together."""
        return self.nodal_circles + self.nodal_diameters


Actuator = RectangularPlate | AnnularStator | DiscPlate
