"""The section of an assembly, its thicknesses drawn larger than its width, and said so."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si
from squeezefilm.core.formats.drawing import millimetres
from squeezefilm.design.fabrication.report.sheet_parts import (
    LETTER,
    NUMBER,
    SMALL,
    VIEWS,
    Sheet,
    tolerance_said,
)
from squeezefilm.design.fabrication.wiring import ANTIPHASE
from squeezefilm.physics.plate.layout import Actuator, AnnularStator, RectangularPlate
from squeezefilm.physics.plate.parts import Part, Rectangle, Sector

if TYPE_CHECKING:
    from squeezefilm.design.fabrication.fabricate import Fabrication

_STRETCHES = (200, 100, 50, 20, 10, 5, 2, 1)
_LAYERS = {"substrate": "BODY", "ceramic": "CERAMICS", "glue": "GLUE"}


@dataclass(frozen=True)
class Cut:
    """Place of a cut: along x at y = `at` (m), or, `upright`, along y at x = `at`."""

    upright: bool
    at: si.Metre


@si.checked_numbers
def stretch_for(height: si.Metre, scale: si.Dimensionless) -> int:
    """Factor by which thicknesses are drawn larger so that a height (m) fits 34 mm."""
    fits = (stretch for stretch in _STRETCHES if 1e3 * height * scale * stretch <= 34.0)
    return next(fits, 1)


def spans(part: Part, cut: Cut) -> list[tuple[si.Metre, si.Metre]]:
    """Stretches (m) on which a part is met along a cut."""
    shape = part.footprint
    if isinstance(shape, Sector):
        # Through the middle: both sides of it.
        if shape.inner_radius == 0:
            return [(-shape.outer_radius, shape.outer_radius)]
        outer, inner = shape.outer_radius, shape.inner_radius
        return [(-outer, -inner), (inner, outer)]
    assert isinstance(shape, Rectangle)
    low, extent = (shape.x, shape.length) if cut.upright else (shape.y, shape.width)
    if not low <= cut.at <= low + extent:
        return []
    start, along = (shape.y, shape.width) if cut.upright else (shape.x, shape.length)
    return [(start, start + along)]


def best_cut(parts: Sequence[Part]) -> Cut:
    """The cut through the middle of some ceramic that meets most of them; along x, in the plate's
    middle, where that meets as many."""
    base = next(part.footprint for part in parts if part.kind == "substrate")
    if isinstance(base, Sector):
        return Cut(False, 0.0)
    ceramics = [part for part in parts if part.kind == "ceramic"]
    options = [Cut(False, base.width / 2), Cut(True, base.length / 2)]
    for ceramic in ceramics:
        shape = ceramic.footprint
        assert isinstance(shape, Rectangle)
        options.append(Cut(False, shape.y + shape.width / 2))
        options.append(Cut(True, shape.x + shape.length / 2))
    return max(options, key=lambda cut: sum(bool(spans(ceramic, cut)) for ceramic in ceramics))


def section_view(
    sheet: Sheet,
    made: Fabrication,
    parts: Sequence[Part],
    middle: float,
    top: float,
) -> tuple[str, ...]:
    """Draw the best cut through `parts` about a `middle` with its upper face at `top` (mm of
    paper), with the thicknesses of the substrate and, at the right end, of what is bonded to each
    face. Notes of tolerances that have no room beside their numbers."""
    cut = best_cut(parts)
    met = [(part, widths) for part in parts if (widths := spans(part, cut))]
    high, low = max(part.top for part, _ in met), min(part.bottom for part, _ in met)
    stretch = stretch_for(high - low, sheet.scale)
    ends = [end for _, widths in met for span in widths for end in span]
    _, y_top = sheet.at(0.0, top)
    centre, _ = sheet.at(middle, 0.0)
    shift = centre - (min(ends) + max(ends)) / 2
    turned = {
        electrode.ceramic for electrode in made.electrodes if electrode.connection == ANTIPHASE
    }

    def height(z: float) -> float:
        return y_top + stretch * (z - high)

    for part, widths in met:
        other = part.kind == "ceramic" and part.number in turned
        layer = "CERAMICS_B" if other else _LAYERS[part.kind]
        for start, end in widths:
            thick = stretch * part.thickness
            sheet.rectangle(layer, start + shift, height(part.bottom), end - start, thick)
    base, said = met[0][0], []
    right = max(ends) + shift
    for part in (base, *_stacks(met)):
        tooth = part.kind == "substrate" and part is not base
        key = "" if tooth else _key_of_thickness(part, sheet.display.actuator)
        said.append((part, key, tolerance_said(sheet.display, key) if key else ""))
    room = VIEWS[2] + 4.0 - (right / sheet.unit + sheet.origin[0])
    fits = max(end for *_, end in _columns(said)) <= room
    for part, key, tolerance, away, _ in _columns(said if fits else [(*s[:2], "") for s in said]):
        where = max(end for span in spans(part, cut) for end in span) + shift
        sheet.upright(
            height(part.bottom),
            height(part.top),
            where,
            away + (right - where) / sheet.unit,
            key,
            stretch=stretch,
            suffix=f"{_what(part)}{tolerance}",
            beside=True,
        )
    bottom = top - 1e3 * (high - low) * sheet.scale * stretch
    label = "Section A–A" if isinstance(base.footprint, Rectangle) else "Section through the middle"
    larger = f"; heights drawn {stretch} times larger" if stretch > 1 else ""
    sheet.write(f"{label}{larger}", middle, bottom - 6.0, SMALL, "center")
    sheet.end_views(bottom - 12.0)
    stated = [
        f"{part.kind} {millimetres(part.thickness)}{tolerance}"
        for part, _, tolerance in said
        if tolerance
    ]
    return () if fits or not stated else (f"Thicknesses: {'; '.join(stated)}.",)


def _key_of_thickness(part: Part, actuator: Actuator) -> str:
    """Key of the description that a part's thickness has; "" where it states none."""
    if isinstance(actuator, AnnularStator):
        return ""
    of_ceramic = "ceramic_thickness"
    if isinstance(actuator, RectangularPlate):
        of_ceramic = f"patches.{part.number - 1}.thickness"
    keys = {"substrate": "thickness", "ceramic": of_ceramic, "glue": "glue.thickness"}
    return f"actuator.{keys[part.kind]}"


_Said = tuple[Part, str, str]


def _what(part: Part) -> str:
    return " glue" if part.kind == "glue" else ""


def _columns(said: Sequence[_Said]) -> list[tuple[Part, str, str, float, float]]:
    """Each with how far from the section's right end its dimension stands, and where it ends (mm);
    those above the substrate have their own columns over those below it."""
    columns: list[tuple[Part, str, str, float, float]] = []
    first, away, was_above = 7.0, 7.0, False
    for number, (part, key, tolerance) in enumerate(said):
        above = number > 0 and part.kind != "substrate" and part.bottom > 0
        if above and not was_above:
            away = first
        was_above = above
        letters = len(f"{millimetres(part.thickness)}{_what(part)}{tolerance}")
        end = away + (letters * LETTER + 0.6) * NUMBER
        columns.append((part, key, tolerance, away, end))
        away = end + 3.0 * NUMBER
        if part.kind == "substrate":
            first = away
    return columns


def _stacks(met: Sequence[tuple[Part, list[tuple[float, float]]]]) -> list[Part]:
    """A tooth where there are any; of each face the rightmost ceramic that was met, and its glue,
    which is last: its number stands beside its short arrows, where no other line runs."""
    parts = [part for part, _ in met if part.kind == "substrate"][1:2]
    for upper in (False, True):
        ceramics = [
            (max(span), part)
            for part, ends in met
            if part.kind == "ceramic" and (part.bottom > 0) == upper
            for span in ends
        ]
        if ceramics:
            last = max(ceramics, key=lambda pair: pair[0])[1]
            glue = [part for part, _ in met if part.kind == "glue" and part.number == last.number]
            parts += [last, *glue]
    return parts
