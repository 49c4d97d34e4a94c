"""The bill of materials of a display: what is bought or cut, how many of it, what it weighs."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from squeezefilm.core import quantities as si
from squeezefilm.core.formats.drawing import millimetres
from squeezefilm.design.fabrication.wiring import Electrode, leads_of
from squeezefilm.physics.plate.layout import Actuator, RectangularPlate
from squeezefilm.physics.plate.parts import Part, Rectangle

CUT = "cut to size"


@dataclass(frozen=True)
class BillRow:
    """A row of the bill: `mass` (kg) is that of all `count` of it, None where the display does not
    say; `in_mass` whether it counts in the display's own mass."""

    what: str
    count: int
    material: str
    size: str
    made: str
    mass: si.Kilogram | None
    in_mass: bool
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
        BillRow(
            "Substrate",
            1,
            base.material,
            _size(base),
            CUT,
            math.fsum(part.mass for part in substrate),
            True,
            remark,
        ),
        *_ceramics(parts),
        *_glue(parts),
        *_held(actuator),
    ]
    for lead in leads_of(electrodes):
        joined = f"{', '.join(lead.electrodes)} to {lead.to}"
        if len(lead.electrodes) > 8:
            joined = f"{len(lead.electrodes)} electrodes to {lead.to}"
        rows.append(BillRow(f"Lead {lead.name}", 1, "wire", "", "", None, False, joined))
    return tuple(rows)


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
    return [
        BillRow(
            "Ceramic",
            len(same),
            material,
            size,
            CUT,
            math.fsum(part.mass for part in same),
            True,
            same[0].assumed or f"each {1e3 * same[0].mass:.3g} g; electrodes on both faces",
        )
        for (material, size), same in by.items()
    ]


def _glue(parts: Sequence[Part]) -> list[BillRow]:
    layers = [part for part in parts if part.kind == "glue"]
    if not layers:
        return []
    area = math.fsum(layer.footprint.area for layer in layers)
    thick = sorted({millimetres(layer.thickness) for layer in layers})
    return [
        BillRow(
            "Glue",
            len(layers),
            layers[0].material,
            f"{1e6 * area:.4g} mm² × {' or '.join(thick)} mm",
            "",
            math.fsum(layer.mass for layer in layers),
            True,
            f"{1e9 * math.fsum(layer.volume for layer in layers):.3g} µl cured, between "
            "each ceramic and the substrate",
        )
    ]


def _held(actuator: Actuator) -> list[BillRow]:
    if not isinstance(actuator, RectangularPlate):
        return []
    sizes = Counter(
        " × ".join(map(millimetres, (support.length, support.width, support.thickness))) + " mm"
        for support in actuator.supports
    )
    told = "its mass is not described, and neglected"
    clamps = [
        BillRow("Clamp", 1, "", "", "", None, False, f"holds the {edge} edge, taken as rigid")
        for edge in actuator.clamped_edges
    ]
    return [
        *(
            BillRow("Support", count, "foam", size, CUT, None, False, told)
            for size, count in sizes.items()
        ),
        *clamps,
    ]
