"""Drawings of plates, discs and stators: plan from the ceramics' side, section, table."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si
from squeezefilm.core.formats.drawing import Drawing, millimetres
from squeezefilm.design.fabrication.report.section_view import Cut, best_cut, section_view
from squeezefilm.design.fabrication.report.sheet_parts import (
    LETTER,
    NUMBER,
    VIEWS,
    Sheet,
    finished,
    scale_for,
)
from squeezefilm.design.fabrication.wiring import ANTIPHASE, Electrode
from squeezefilm.physics.plate.layout import AnnularStator, DiscPlate, RectangularPlate
from squeezefilm.physics.plate.parts import Part, Rectangle, Sector, teeth_of

if TYPE_CHECKING:
    from squeezefilm.design.fabrication.fabricate import Fabrication

_PLATE_ROOM = (172.0, 150.0)
_PLATE_MIDDLE = 122.0
_PLATE_ABOVE = 26.0


def rectangular_sheet(made: Fabrication, common: Sequence[str]) -> Drawing:
    """The drawing of a plate; `common` are notes that every sheet has."""
    plate = made.display.actuator
    assert isinstance(plate, RectangularPlate)
    below = sum(patch.face == "bottom" for patch in plate.patches) * 2 >= len(plate.patches)
    face = "bottom" if below else "top"
    scale = scale_for(plate.length, plate.width, _PLATE_ROOM)
    size_x, size_y = 1e3 * scale * plate.length, 1e3 * scale * plate.width
    top = VIEWS[3] - _PLATE_ABOVE
    # Seen from below, y runs down the sheet.
    sign = -1.0 if below else 1.0
    sheet = Sheet(made.display, scale, (_PLATE_MIDDLE - size_x / 2, top if below else top - size_y))
    cut = best_cut(made.parts)
    _plate_plan(sheet, made, plate, face, sign)
    _cut_marks(sheet, plate, cut, sign)
    whole = _plate_dimensions(sheet, plate, sign)
    low = top - size_y - 34.0
    extra = section_view(sheet, made, made.parts, _PLATE_MIDDLE, low)
    said = [*_plate_said(plate, face, whole), *extra, *common]
    return finished(sheet, made, said)


def _plate_plan(
    sheet: Sheet, made: Fabrication, plate: RectangularPlate, face: str, sign: float
) -> None:
    def place(layer: str, x: float, y: float, length: float, width: float) -> None:
        sheet.rectangle(layer, x, y if sign > 0 else -y - width, length, width)

    place("BODY", 0.0, 0.0, plate.length, plate.width)
    place("OUTLINE", 0.0, 0.0, plate.length, plate.width)
    for electrode in made.electrodes:
        shape = electrode.footprint
        assert isinstance(shape, Rectangle)
        at = (shape.x, shape.y, shape.length, shape.width)
        if electrode.face != face:
            place("CERAMICS_OTHER_FACE", *at)
            continue
        layer = "CERAMICS_B" if electrode.connection == ANTIPHASE else "CERAMICS"
        if plate.glue is not None:
            place("GLUE", *at)
        place(layer, *at)
        place("ELECTRODES", *at)
        _label(sheet, electrode, shape, sign)
    for held in plate.supports:
        place("SUPPORTS", held.x, held.y, held.length, held.width)
    over = 3.0 * sheet.unit
    for at_ in made.nodal.positions:
        if made.nodal.axis == "x":
            ends = (at_, -sign * over), (at_, sign * (plate.width + over))
        else:
            ends = (-over, sign * at_), (plate.length + over, sign * at_)
        sheet.interrupted("NODAL_LINES", ends)


def poling_mark(sheet: Sheet, x: si.Metre, y: si.Metre, towards_viewer: bool) -> None:
    """A circle with a dot (the arrow's tip, towards the viewer) or with a cross (its feathers)."""
    r = 1.1 * sheet.unit
    sheet.kept_free.append((x - 1.4 * r, y - 1.4 * r, x + 1.4 * r, y + 1.4 * r))
    sheet.arc("POLING", x, y, r)
    if towards_viewer:
        sheet.arc("POLING", x, y, 0.25 * r)
        return
    d = r * math.sqrt(0.5)
    sheet.line("POLING", ((x - d, y - d), (x + d, y + d)))
    sheet.line("POLING", ((x - d, y + d), (x + d, y - d)))


def _label(sheet: Sheet, electrode: Electrode, shape: Rectangle, sign: float) -> None:
    """Number and connection in the middle of a ceramic, and its poling, where there is room."""
    x, y = shape.x + shape.length / 2, sign * (shape.y + shape.width / 2)
    # One pole looks at the viewer, who sees the outer face.
    said = f"{electrode.ceramic} {electrode.connection}"
    wide, high = shape.length / sheet.unit, shape.width / sheet.unit
    long = len(said) * LETTER * NUMBER + 1.0
    u = sheet.unit
    if wide >= long and high >= 9.0:
        places, angle = ((x, y + 2.2 * u), (x, y - 2.2 * u)), 0.0
    elif wide >= long + 4.0 and high >= NUMBER + 0.5:
        places, angle = ((x - 2.0 * u, y), (x + (long / 2 + 0.6) * u, y)), 0.0
    elif high >= long + 4.0 and wide >= NUMBER + 0.5:
        places, angle = ((x, y - 2.0 * u), (x, y + (long / 2 + 0.6) * u)), math.pi / 2
    else:
        return
    text, mark = places
    sheet.label(said, *text, angle)
    poling_mark(sheet, *mark, electrode.poling > 0)


def _cut_marks(sheet: Sheet, plate: RectangularPlate, cut: Cut, sign: float) -> None:
    """Mark where the section is taken: a short line and a letter on each side."""
    u, reach = sheet.unit, 6.0
    for end, way in ((0.0, -1.0), (plate.length if not cut.upright else plate.width, 1.0)):
        if cut.upright:
            y = sign * (end + way * reach * u)
            line = ((cut.at, sign * (end + way * 0.5 * u)), (cut.at, y))
            place = (cut.at + 2.2 * u, sign * (end + way * (reach - 1.5) * u))
        else:
            y = sign * cut.at
            line = ((end + way * 0.5 * u, y), (end + way * reach * u, y))
            place = (end + way * (reach - 1.5) * u, y + 2.2 * u)
        sheet.line("CENTRE_LINES", line)
        sheet.text("A", *place, NUMBER * u, "center")


def _plate_dimensions(sheet: Sheet, plate: RectangularPlate, sign: float) -> bool:
    """Sizes of plate and first ceramic, places of all of them; whether all places have a number."""
    low, high = min(0.0, sign * plate.width), max(0.0, sign * plate.width)
    sheet.across(0.0, plate.length, high, 17.0, "actuator.length")
    sheet.upright(low, high, 0.0, -17.0, "actuator.width")
    first, path = plate.patches[0], "actuator.patches.0"
    sheet.across(first.x, first.x + first.length, high, 9.5, f"{path}.length")
    if first.width < plate.width - 1e-9:
        low_y, high_y = sorted((sign * first.y, sign * (first.y + first.width)))
        sheet.upright(low_y, high_y, 0.0, -8.0, f"{path}.width")
    patches = list(enumerate(plate.patches))
    x = {patch.x: (patch.x, patch.x, f"actuator.patches.{n}.x") for n, patch in reversed(patches)}
    y = {
        patch.y: (patch.y, sign * patch.y, f"actuator.patches.{n}.y")
        for n, patch in reversed(patches)
    }
    whole = sheet.ordinates(x.values(), low, -7.5)
    if len(y) > 1 or 0.0 not in y:
        whole &= sheet.ordinates(y.values(), plate.length, 8.5, upright=True)
    return whole


def _plate_said(plate: RectangularPlate, face: str, whole: bool) -> Iterable[str]:
    """Notes of a plate."""
    other = sum(patch.face != face for patch in plate.patches)
    side = "below, where x runs right and y down" if face == "bottom" else "above"
    yield f"Plan seen from {side}. Places are from the corner of the plate at x = y = 0."
    if other:
        hidden = "the upper face" if face == "bottom" else "the lower face"
        yield f"Dashed: {other} ceramics on {hidden}."
    if not whole:
        yield "Places too near to each other for a number are in the table only."
    if plate.supports:
        thick = " or ".join(sorted({millimetres(support.thickness) for support in plate.supports}))
        faces = " and ".join(sorted({support.face for support in plate.supports}))
        yield f"Dashed, violet: foam, {thick} mm thick, on the {faces} face."
    if plate.clamped_edges:
        yield f"Clamped edges: {', '.join(plate.clamped_edges)}."


_ROUND_ROOM = (160.0, 145.0)
_ROUND_MIDDLE = 118.0
_ROUND_ABOVE = 24.0


def round_sheet(made: Fabrication, common: Sequence[str]) -> Drawing:
    """The drawing of a disc or a stator; `common` are notes that every sheet has."""
    actuator = made.display.actuator
    assert isinstance(actuator, DiscPlate | AnnularStator)
    shape = _ring(made.parts, "substrate")
    outer = shape.outer_radius
    scale = scale_for(2 * outer, 2 * outer, _ROUND_ROOM)
    reach = 1e3 * scale * outer
    sheet = Sheet(made.display, scale, (_ROUND_MIDDLE, VIEWS[3] - _ROUND_ABOVE - reach))
    _round_plan(sheet, made, shape)
    lines = _diameters(actuator)
    for number, (diameter, key, prefix) in enumerate(lines):
        half = diameter / 2
        # From where it leaves the body, so that its lines cross nothing.
        rim = -math.sqrt(max(outer**2 - half**2, 0.0))
        away = -(reach + 8.0 + 7.0 * number) - rim / sheet.unit
        sheet.across(-half, half, rim, away, key, prefix=prefix)
    if isinstance(actuator, AnnularStator):
        ends = shape.inner_radius, shape.outer_radius
        rim = math.sqrt(outer**2 - ends[0] ** 2)
        away = reach + 8.0 - rim / sheet.unit
        sheet.across(*ends, rim, away, "actuator.radial_width", y_to=0.0)
    # Of the teeth one stands for all of them.
    teeth = [part for part in made.parts if part.kind == "substrate"][1:]
    shown = [part for part in made.parts if part not in teeth[1:]]
    low = sheet.origin[1] - reach - 16.0 - 7.0 * len(lines)
    extra = section_view(sheet, made, shown, _ROUND_MIDDLE, low)
    said = [*_round_said(made), *extra, *common]
    return finished(sheet, made, said)


def _ring(parts: Sequence[Part], kind: str) -> Sector:
    shape = next(part.footprint for part in parts if part.kind == kind)
    assert isinstance(shape, Sector)
    return shape


def _polar(radius: float, angle: float) -> tuple[float, float]:
    """A place, seen from below: angles go round clockwise."""
    return radius * math.cos(angle), -radius * math.sin(angle)


def _round_plan(sheet: Sheet, made: Fabrication, body: Sector) -> None:
    ceramic, actuator = _ring(made.parts, "ceramic"), made.display.actuator
    for layer in ("BODY", "OUTLINE"):
        sheet.arc(layer, 0.0, 0.0, body.outer_radius)
    if any(part.kind == "glue" for part in made.parts):
        sheet.arc("GLUE", 0.0, 0.0, ceramic.outer_radius)
    sheet.arc("CERAMICS", 0.0, 0.0, ceramic.outer_radius)
    if ceramic.inner_radius > body.inner_radius + 1e-9:
        sheet.arc("BODY", 0.0, 0.0, ceramic.inner_radius)
    if body.inner_radius > 0:
        sheet.arc("HOLES", 0.0, 0.0, body.inner_radius)
    for electrode in made.electrodes:
        shape = electrode.footprint
        assert isinstance(shape, Sector)
        _electrode(sheet, electrode, shape)
    if isinstance(actuator, AnnularStator):
        sheet.interrupted("CENTRE_LINES", actuator.mean_diameter / 2)
        # The teeth are on the other face: their walls, beyond the rim.
        over = body.outer_radius + 2.0 * sheet.unit
        for ends in teeth_of(actuator):
            for angle in ends:
                line = _polar(body.outer_radius, angle), _polar(over, angle)
                sheet.line("CERAMICS_OTHER_FACE", line)
    for radius in made.nodal.radii:
        sheet.interrupted("NODAL_LINES", radius)
    for angle in made.nodal.angles:
        beyond = body.outer_radius + 3.0 * sheet.unit
        ray = _polar(body.inner_radius, angle), _polar(beyond, angle)
        sheet.interrupted("NODAL_LINES", ray)
    if body.inner_radius == 0:
        r = body.outer_radius + 4.0 * sheet.unit
        sheet.line("CENTRE_LINES", ((0.0, -r), (0.0, r)))


def _electrode(sheet: Sheet, electrode: Electrode, shape: Sector) -> None:
    u = sheet.unit
    if shape.is_whole:
        sheet.arc("ELECTRODES", 0.0, 0.0, shape.outer_radius)
        if shape.inner_radius > 0:
            sheet.arc("ELECTRODES", 0.0, 0.0, shape.inner_radius)
    else:
        ends = (-shape.end, -shape.start)
        for radius in (shape.outer_radius, shape.inner_radius):
            if radius > 0:
                sheet.arc("ELECTRODES", 0.0, 0.0, radius, *ends)
        for angle in (shape.start, shape.end):
            wall = _polar(shape.inner_radius, angle), _polar(shape.outer_radius, angle)
            sheet.line("ELECTRODES", wall)
    middle = (shape.inner_radius + shape.outer_radius) / 2
    angle = (shape.start + shape.end) / 2
    if shape.is_whole:
        # Beside the nodal circle of a full disc, and on a ring's own middle.
        angle = -math.pi / 4
    x, y = _polar(middle, angle)
    said = f"{electrode.name} {electrode.connection}"
    wide = (shape.end - shape.start) * middle / u
    deep = (shape.outer_radius - shape.inner_radius) / u
    if min(wide, deep) < len(said) * LETTER * NUMBER + 1.0 or deep < 8.0:
        poling_mark(sheet, x, y, electrode.poling > 0)
        return
    sheet.label(said, x, y + 2.2 * u)
    poling_mark(sheet, x, y - 2.2 * u, electrode.poling > 0)


def _diameters(actuator: DiscPlate | AnnularStator) -> list[tuple[float, str, str]]:
    """Diameters (m), the smallest first, with their keys and what stands before the number."""
    if isinstance(actuator, AnnularStator):
        mean, width = actuator.mean_diameter, actuator.radial_width
        return [
            (mean - width, "", "⌀"),
            (mean, "actuator.mean_diameter", "mean ⌀"),
            (mean + width, "", "⌀"),
        ]
    diameters = [
        (actuator.ceramic_inner_diameter, "actuator.ceramic_inner_diameter", "ceramic ⌀"),
        (actuator.inner_diameter, "actuator.inner_diameter", "⌀"),
        (actuator.ceramic_outer_diameter, "actuator.ceramic_outer_diameter", "ceramic ⌀"),
        (actuator.diameter, "actuator.diameter", "⌀"),
    ]
    return sorted((row for row in diameters if row[0] > 0), key=lambda row: row[0])


def _round_said(made: Fabrication) -> Iterable[str]:
    """Notes of a round body."""
    yield "Plan seen from below. Angles are from x to the right, clockwise as seen here."
    actuator = made.display.actuator
    if isinstance(actuator, AnnularStator):
        count = len(teeth_of(actuator))
        if count:
            pitch, slot = (
                millimetres(length or 0.0) for length in (actuator.tooth_pitch, actuator.slot_width)
            )
            yield (
                f"{count} teeth on the upper face, a pitch of {pitch} mm on the mean diameter, "
                f"slots of {slot} mm: ticks beyond the rim are their walls."
            )
    assumed = sorted({part.assumed for part in made.parts if part.assumed})
    for text in assumed:
        yield f"NOT TO BE MADE BY THESE THICKNESSES: {text}."
    if len(made.electrodes) > 1:
        yield "Neighbouring sectors are poled in opposite directions and joined to one output."
