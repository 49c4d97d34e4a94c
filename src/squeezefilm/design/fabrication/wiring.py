"""Electrodes of a display, how they are connected, where its face stands still, and the bill of
materials: what drawing, page and test plan have in common."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from squeezefilm.core import quantities as si
from squeezefilm.core.formats.drawing import millimetres
from squeezefilm.physics.plate.layout import Actuator, AnnularStator, DiscPlate, RectangularPlate
from squeezefilm.physics.plate.parts import Footprint, Part, Rectangle, Sector, parts_of
from squeezefilm.physics.plate.ring.body import nodal_circles, ring_body
from squeezefilm.physics.plate.working_mode import WorkingMode

IN_PHASE, ANTIPHASE, GROUND, OPEN = "A", "B", "ground", "open"


@dataclass(frozen=True)
class Electrode:
    """The outer electrode of a ceramic, or of a sector of it; it covers all of its footprint.

    `connection` is "A" (driven in phase), "B" (driven in antiphase), "ground", "open" or "shunt n"
    with its own `shunt_resistance` to ground. `poling` is +1 where the ceramic is poled away from
    the plate. The bonded side of every ceramic is ground.
    """

    name: str
    ceramic: int
    footprint: Footprint
    face: str
    connection: str
    poling: int
    thickness: si.Metre
    shunt_resistance: si.Ohm | None = None


def electrodes_of(actuator: Actuator, parts: Sequence[Part] | None = None) -> tuple[Electrode, ...]:
    """The outer electrodes of an actuator, as the solver has them; `parts` spares computing these.

    A disc with nodal diameters and a stator have sectors of one ceramic that are poled in turn
    under one connection, which does what sectors poled alike and driven in turn would do. Raises as
    `parts_of`.
    """
    if isinstance(actuator, RectangularPlate):
        return _of_plate(actuator)
    ceramic = next(part for part in parts or parts_of(actuator) if part.kind == "ceramic")
    ring = ceramic.footprint
    assert isinstance(ring, Sector), "a round body has a round ceramic"
    return tuple(
        Electrode(
            f"E{number}",
            1,
            Sector(ring.inner_radius, ring.outer_radius, start, end),
            "bottom",
            IN_PHASE,
            sign,
            ceramic.thickness,
        )
        for number, (start, end, sign) in enumerate(ring_body(actuator).drive.sectors, 1)
    )


def _of_plate(plate: RectangularPlate) -> tuple[Electrode, ...]:
    electrodes, shunts = [], 0
    for number, patch in enumerate(plate.patches, 1):
        connection = IN_PHASE if patch.polarity > 0 else ANTIPHASE
        if patch.electrode == "shunted":
            shunts += 1
            connection = f"shunt {shunts}"
        elif patch.electrode != "driven":
            connection = {"shorted": GROUND, "open": OPEN}[patch.electrode]
        where = Rectangle(patch.x, patch.y, patch.length, patch.width)
        electrodes.append(
            Electrode(
                f"E{number}",
                number,
                where,
                patch.face,
                connection,
                patch.poling,
                patch.thickness,
                patch.shunt_resistance,
            )
        )
    return tuple(electrodes)


@dataclass(frozen=True)
class Lead:
    """A wire: what it joins, and how many electrodes hang on it."""

    name: str
    electrodes: tuple[str, ...]
    to: str


def leads_of(electrodes: Sequence[Electrode]) -> tuple[Lead, ...]:
    """A lead for each connection, and one of the bonded sides, which are ground."""
    by: dict[str, list[str]] = {}
    for electrode in electrodes:
        if electrode.connection != OPEN:
            by.setdefault(electrode.connection, []).append(electrode.name)
    ends = {
        IN_PHASE: "amplifier output A, +V",
        ANTIPHASE: "amplifier output B, −V: the same voltage, its sign reversed",
        GROUND: "ground",
    }
    shunts = {
        electrode.connection: "ground through "
        + si.format_quantity(electrode.shunt_resistance or 0.0, si.Unit("ohm"))
        for electrode in electrodes
        if electrode.shunt_resistance is not None
    }
    leads = [Lead(name, tuple(names), (ends | shunts)[name]) for name, names in sorted(by.items())]
    return (
        *leads,
        Lead("bonded sides", tuple(electrode.name for electrode in electrodes), "ground"),
    )


def wiring_said(electrodes: Sequence[Electrode]) -> tuple[str, ...]:
    """Sentences on how the electrodes are driven."""
    groups = {electrode.connection for electrode in electrodes}
    said = [
        "The bonded side of every ceramic is ground. On a substrate that does not conduct, order "
        "ceramics whose electrode wraps around, or bond a foil under each."
    ]
    if {IN_PHASE, ANTIPHASE} <= groups:
        said.append(
            "Group B is driven with the same voltage as group A, its sign reversed: two amplifier "
            "outputs, or a transformer. One output does for both where the ceramics of group B are "
            "bonded with their poling the other way round; the layout above is not drawn so."
        )
    if any(
        isinstance(electrode.footprint, Sector) and not electrode.footprint.is_whole
        for electrode in electrodes
    ):
        said.append(
            "The sectors are poled in turn and joined to one output. Sectors that are all poled "
            "alike do the same where neighbours are driven with opposite signs."
        )
    if OPEN in groups:
        said.append("Open electrodes are joined to nothing.")
    return tuple(said)


@dataclass(frozen=True, eq=False)
class NodalLines:
    """Straight lines square to x or y at `positions` (m) along `axis`, circles of `radii` (m) about
    the middle, and radial lines at `angles` (rad); none of a kind where it is empty.

    Those of a plate are taken where the line through the best antinode crosses them: they may bend
    elsewhere. Radial lines are those that the driven sectors put there.
    """

    axis: str = ""
    positions: tuple[si.Metre, ...] = ()
    radii: tuple[si.Metre, ...] = ()
    angles: tuple[si.Radian, ...] = ()


def nodal_lines_of(actuator: Actuator, mode: WorkingMode) -> NodalLines:
    """The nodal lines of a display's working mode."""
    if isinstance(actuator, RectangularPlate):
        axis = "x" if actuator.lines_across == "length" else "y"
        line = mode.line
        places = () if line is None else tuple(map(float, line.nodal_positions))
        return NodalLines(axis=axis, positions=places)
    if isinstance(actuator, DiscPlate):
        radii = () if mode.disc is None else tuple(map(float, nodal_circles(mode.disc)))
        return NodalLines(radii=radii, angles=_radial(actuator.nodal_diameters))
    assert isinstance(actuator, AnnularStator), "there are three kinds of actuator"
    return NodalLines(angles=_radial(round(actuator.wavelengths_around)))


def _radial(diameters: int) -> tuple[si.Radian, ...]:
    """Angles at the ends of the sectors, which begin at the angle 0."""
    return tuple(k * math.pi / diameters for k in range(2 * diameters))


CUT = "cut to size"


@dataclass(frozen=True)
class BillRow:
    """A row of the bill: `mass` (kg) is that of all `count` of it, None where the display does not
    say; `in_mass` whether it counts in the display's own mass."""

    what: str
    count: int
    material: str = ""
    size: str = ""
    made: str = ""
    mass: si.Kilogram | None = None
    in_mass: bool = False
    remark: str = ""


def bill_of(
    actuator: Actuator, parts: Sequence[Part], electrodes: Sequence[Electrode]
) -> tuple[BillRow, ...]:
    """Substrate, ceramics by size, glue, foam, clamps, leads and resistors, in this order.

    The rows that are `in_mass` add up to the mass of all `parts`. What of a substrate stands on it
    (teeth) is machined from the same piece and is in its row.
    """
    substrate = [part for part in parts if part.kind == "substrate"]
    base, teeth = substrate[0], substrate[1:]
    remark = base.assumed
    if teeth:
        height = millimetres(teeth[0].thickness)
        remark = f"with {len(teeth)} teeth of {height} mm height; {remark}"
    rows = [
        _row("Substrate", 1, substrate, _size(base), CUT, remark),
        *_ceramics(parts),
        *_glue(parts),
        *_held(actuator),
    ]
    for lead in leads_of(electrodes):
        joined = f"{', '.join(lead.electrodes)} to {lead.to}"
        if len(lead.electrodes) > 8:
            joined = f"{len(lead.electrodes)} electrodes to {lead.to}"
        rows.append(BillRow(f"Lead {lead.name}", 1, "wire", remark=joined))
    for electrode in electrodes:
        if electrode.shunt_resistance is not None:
            size = si.format_quantity(electrode.shunt_resistance, si.Unit("ohm"))
            rows.append(BillRow("Shunt resistor", 1, size=size, remark=f"at {electrode.name}"))
    return tuple(rows)


def _row(
    what: str, count: int, pieces: Sequence[Part], size: str, made: str, remark: str
) -> BillRow:
    """A row of pieces of one material that count in the display's mass."""
    mass = math.fsum(part.mass for part in pieces)
    return BillRow(what, count, pieces[0].material, size, made, mass, True, remark)


def _size(part: Part) -> str:
    """Size in millimetres, as a workshop reads it."""
    shape = part.footprint
    if isinstance(shape, Rectangle):
        sides = f"{millimetres(shape.length)} × {millimetres(shape.width)}"
    else:
        sides = f"⌀{millimetres(2 * shape.outer_radius)}"
        if shape.inner_radius > 0:
            sides += f" / ⌀{millimetres(2 * shape.inner_radius)}"
    return f"{sides} × {millimetres(part.thickness)} mm"


def _ceramics(parts: Sequence[Part]) -> list[BillRow]:
    """The pieces of ceramic, those of one size in one row."""
    pieces = [part for part in parts if part.kind == "ceramic"]
    by: dict[tuple[str, str], list[Part]] = {}
    for piece in pieces:
        by.setdefault((piece.material, _size(piece)), []).append(piece)
    rows = []
    for (_, size), same in by.items():
        each = same[0].assumed or f"each {1e3 * same[0].mass:.3g} g; electrodes on both faces"
        rows.append(_row("Ceramic", len(same), same, size, CUT, each))
    return rows


def _glue(parts: Sequence[Part]) -> list[BillRow]:
    layers = [part for part in parts if part.kind == "glue"]
    if not layers:
        return []
    area = math.fsum(layer.footprint.area for layer in layers)
    thick = sorted({millimetres(layer.thickness) for layer in layers})
    size = f"{1e6 * area:.4g} mm² × {' or '.join(thick)} mm"
    volume = 1e9 * math.fsum(layer.volume for layer in layers)
    where = f"{volume:.3g} µl cured, between each ceramic and the substrate"
    return [_row("Glue", len(layers), layers, size, "", where)]


def _held(actuator: Actuator) -> list[BillRow]:
    if not isinstance(actuator, RectangularPlate):
        return []
    sizes = Counter(
        " × ".join(map(millimetres, (support.length, support.width, support.thickness))) + " mm"
        for support in actuator.supports
    )
    told = "its mass is not described, and neglected"
    clamps = [
        BillRow("Clamp", 1, remark=f"holds the {edge} edge, taken as rigid")
        for edge in actuator.clamped_edges
    ]
    return [
        *(
            BillRow("Support", count, "foam", size, CUT, remark=told)
            for size, count in sizes.items()
        ),
        *clamps,
    ]
