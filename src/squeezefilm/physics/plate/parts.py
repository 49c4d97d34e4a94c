"""The solid bodies that a plate, a disc or a stator is put together from: where each one is, of
what, and what it weighs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.layout import Actuator, AnnularStator, DiscPlate, RectangularPlate
from squeezefilm.physics.plate.ring.body import ring_body

PartKind = Literal["substrate", "ceramic", "glue"]
WHOLE_TURN: si.Radian = 2 * math.pi


@si.checked_numbers
@dataclass(frozen=True)
class Rectangle:
    """A footprint: `x` and `y` of the near corner (m), its extents along x and y."""

    x: si.Metre
    y: si.Metre
    length: Annotated[si.Metre, si.Above(0.0)]
    width: Annotated[si.Metre, si.Above(0.0)]

    @property
    def area(self) -> si.SquareMetre:
        """Area (m²)."""
        return self.length * self.width


@si.checked_numbers
@dataclass(frozen=True)
class Sector:
    """A footprint about the origin: a disc, a ring, or what lies of one between two angles."""

    inner_radius: Annotated[si.Metre, si.AtLeast(0.0)]
    outer_radius: Annotated[si.Metre, si.Above(0.0), si.Above("inner_radius")]
    start: si.Radian = 0.0
    end: Annotated[si.Radian, si.Above("start")] = WHOLE_TURN

    def __post_init__(self) -> None:
        si.require("end", self.end, si.Unit("rad"), at_most=self.start + WHOLE_TURN + 1e-9)

    @property
    def is_whole(self) -> bool:
        """True where it goes all round."""
        return self.end - self.start > WHOLE_TURN - 1e-9

    @property
    def area(self) -> si.SquareMetre:
        """Area (m²)."""
        return (self.end - self.start) / 2 * (self.outer_radius**2 - self.inner_radius**2)


Footprint = Rectangle | Sector


@si.checked_numbers
@dataclass(frozen=True)
class Part:
    """A body: a footprint between two heights (m). Height 0 is the substrate's lower face.

    `number` counts the ceramics from 1 as the description has them, and a glue layer has that of
    its ceramic; a substrate has 0. `assumed` says why nobody should cut it by these numbers.
    """

    kind: PartKind
    number: int
    material: str
    density: Annotated[si.KilogramPerCubicMetre, si.Above(0.0)]
    footprint: Footprint
    bottom: si.Metre
    top: Annotated[si.Metre, si.Above("bottom")]
    assumed: str = ""

    @property
    def thickness(self) -> si.Metre:
        """Top minus bottom (m)."""
        return self.top - self.bottom

    @property
    def volume(self) -> si.CubicMetre:
        """Volume (m³)."""
        return self.footprint.area * self.thickness

    @property
    def mass(self) -> si.Kilogram:
        """Mass (kg)."""
        return self.volume * self.density


def parts_of(actuator: Actuator) -> tuple[Part, ...]:
    """The bodies of an actuator: substrate, then each ceramic with its glue. Foam supports, whose
    mass is neglected, are none.

    A stator's metal, teeth and ceramic are those of the ring that was fitted to its frequency (see
    `fit_stator`), and say so; its teeth have radial walls. Raises `UnreachableError` for a stator
    that nothing fits.
    """
    if isinstance(actuator, RectangularPlate):
        return _of_plate(actuator)
    return _of_disc(actuator) if isinstance(actuator, DiscPlate) else _of_stator(actuator)


def assembly_mass(actuator: Actuator) -> si.Kilogram:
    """Mass of an actuator with its ceramics and their glue (kg). Raises as `parts_of`."""
    return math.fsum(part.mass for part in parts_of(actuator))


def _of_plate(plate: RectangularPlate) -> tuple[Part, ...]:
    base = Rectangle(0.0, 0.0, plate.length, plate.width)
    body = plate.substrate
    bodies = [Part("substrate", 0, body.name, body.density, base, 0.0, plate.thickness)]
    for number, patch in enumerate(plate.patches, 1):
        where = Rectangle(patch.x, patch.y, patch.length, patch.width)
        up = patch.face == "top"
        face = plate.thickness if up else 0.0
        layers = [("ceramic", plate.ceramic.name, plate.ceramic.density, patch.thickness)]
        if plate.glue is not None:
            glue = plate.glue
            layers.insert(0, ("glue", glue.name, glue.density, glue.thickness))
        for kind, material, density, thick in layers:
            far = face + thick if up else face - thick
            ends = (min(face, far), max(face, far))
            bodies.append(Part(kind, number, material, density, where, *ends))  # type: ignore[arg-type] # a PartKind
            face = far
    return tuple(bodies)


def _of_disc(disc: DiscPlate) -> tuple[Part, ...]:
    body, half = disc.substrate, disc.inner_diameter / 2
    bodies = [
        Part(
            "substrate",
            0,
            body.name,
            body.density,
            Sector(half, disc.diameter / 2),
            0.0,
            disc.thickness,
        )
    ]
    under = Sector(disc.ceramic_inner_diameter / 2, disc.ceramic_outer_diameter / 2)
    low = 0.0
    if disc.glue is not None:
        low = -disc.glue.thickness
        bodies.append(Part("glue", 1, disc.glue.name, disc.glue.density, under, low, 0.0))
    ceramic = disc.ceramic
    bottom = low - disc.ceramic_thickness
    bodies.append(Part("ceramic", 1, ceramic.name, ceramic.density, under, bottom, low))
    return tuple(bodies)


_FITTED = "thickness fitted to the frequency; ceramic, metal and height of the teeth are assumed"


def _of_stator(stator: AnnularStator) -> tuple[Part, ...]:
    fit = ring_body(stator).fit
    assert fit is not None, "a stator is a fitted body"
    a = fit.assumptions
    ring = Sector(
        (stator.mean_diameter - stator.radial_width) / 2,
        (stator.mean_diameter + stator.radial_width) / 2,
    )
    metal, ceramic = (a.metal.name, a.metal.density), (a.ceramic.name, a.ceramic.density)
    top = fit.ring_thickness
    bodies = [Part("substrate", 0, *metal, ring, 0.0, top, _FITTED)]
    for start, end in teeth_of(stator):
        tooth = Sector(ring.inner_radius, ring.outer_radius, start, end)
        bodies.append(Part("substrate", 0, *metal, tooth, top, top + a.tooth_height, _FITTED))
    return (*bodies, Part("ceramic", 1, *ceramic, ring, -a.ceramic_thickness, 0.0, _FITTED))


def teeth_of(stator: AnnularStator) -> tuple[tuple[si.Radian, si.Radian], ...]:
    """The angles between which each tooth of a stator stands; none for a plain ring.

    As many as come nearest to the pitch on the mean circumference, slots of their share of it.
    """
    if stator.tooth_pitch is None or stator.slot_width is None:
        return ()
    count = max(1, round(math.pi * stator.mean_diameter / stator.tooth_pitch))
    pitch = WHOLE_TURN / count
    half_slot = pitch * stator.slot_width / stator.tooth_pitch / 2
    return tuple((k * pitch + half_slot, (k + 1) * pitch - half_slot) for k in range(count))
