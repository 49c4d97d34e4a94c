"""The drawing of a rectangular plate: plan from the ceramics' side, section, table of ceramics."""

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
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.parts import Rectangle

if TYPE_CHECKING:
    from squeezefilm.design.fabrication.fabricate import Fabrication

_ROOM = (172.0, 150.0)
_MIDDLE = 122.0
_ABOVE = 26.0


def rectangular_sheet(made: Fabrication, common: Sequence[str]) -> Drawing:
    """The drawing of a plate; `common` are notes that every sheet has."""
    plate = made.display.actuator
    assert isinstance(plate, RectangularPlate)
    below = sum(patch.face == "bottom" for patch in plate.patches) * 2 >= len(plate.patches)
    face = "bottom" if below else "top"
    scale = scale_for(plate.length, plate.width, _ROOM)
    size_x, size_y = 1e3 * scale * plate.length, 1e3 * scale * plate.width
    top = VIEWS[3] - _ABOVE
    # Seen from below, y runs down the sheet.
    sign = -1.0 if below else 1.0
    sheet = Sheet(made.display, scale, (_MIDDLE - size_x / 2, top if below else top - size_y))
    cut = best_cut(made.parts)
    _plan(sheet, made, plate, face, sign)
    _cut_marks(sheet, plate, cut, sign)
    whole = _dimensions(sheet, plate, sign)
    low = top - size_y - 34.0
    extra = section_view(sheet, made, made.parts, _MIDDLE, low)
    said = [*_said(plate, face, whole), *extra, *common]
    return finished(sheet, made, said)


def _plan(sheet: Sheet, made: Fabrication, plate: RectangularPlate, face: str, sign: float) -> None:
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
        paper = (place[0] / u + sheet.origin[0], place[1] / u + sheet.origin[1])
        sheet.write("A", *paper, NUMBER, "center")


def _dimensions(sheet: Sheet, plate: RectangularPlate, sign: float) -> bool:
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


def _said(plate: RectangularPlate, face: str, whole: bool) -> Iterable[str]:
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
