"""The drawing of a disc or of a motor's stator: plan from the ceramic's side, section, sectors."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from squeezefilm.core.formats.drawing import Drawing, millimetres
from squeezefilm.design.fabrication.report.rectangular_sheet import poling_mark
from squeezefilm.design.fabrication.report.section_view import section_view
from squeezefilm.design.fabrication.report.sheet_parts import (
    LETTER,
    NUMBER,
    VIEWS,
    Sheet,
    finished,
    scale_for,
)
from squeezefilm.design.fabrication.wiring import Electrode
from squeezefilm.physics.plate.layout import AnnularStator, DiscPlate
from squeezefilm.physics.plate.parts import Part, Sector, teeth_of

if TYPE_CHECKING:
    from squeezefilm.design.fabrication.fabricate import Fabrication

_ROOM = (160.0, 145.0)
_MIDDLE = 118.0
_ABOVE = 24.0


def round_sheet(made: Fabrication, common: Sequence[str]) -> Drawing:
    """The drawing of a disc or a stator; `common` are notes that every sheet has."""
    actuator = made.display.actuator
    assert isinstance(actuator, DiscPlate | AnnularStator)
    shape = _ring(made.parts, "substrate")
    outer = shape.outer_radius
    scale = scale_for(2 * outer, 2 * outer, _ROOM)
    reach = 1e3 * scale * outer
    sheet = Sheet(made.display, scale, (_MIDDLE, VIEWS[3] - _ABOVE - reach))
    _plan(sheet, made, shape)
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
    extra = section_view(sheet, made, shown, _MIDDLE, low)
    said = [*_said(made), *extra, *common]
    return finished(sheet, made, said)


def _ring(parts: Sequence[Part], kind: str) -> Sector:
    shape = next(part.footprint for part in parts if part.kind == kind)
    assert isinstance(shape, Sector)
    return shape


def _polar(radius: float, angle: float) -> tuple[float, float]:
    """A place, seen from below: angles go round clockwise."""
    return radius * math.cos(angle), -radius * math.sin(angle)


def _plan(sheet: Sheet, made: Fabrication, body: Sector) -> None:
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


def _said(made: Fabrication) -> Iterable[str]:
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
