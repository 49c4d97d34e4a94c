"""The section of an assembly, its thicknesses drawn larger than its width, and said so."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from squeezefilm import quantities as si
from squeezefilm.formats.drawing import rectangle
from squeezefilm.plate.parts import Part, Rectangle, Sector
from squeezefilm.report.fabrication.sheet_parts import LETTER, NUMBER, SMALL, Sheet

_STRETCHES = (200, 100, 50, 20, 10, 5, 2, 1)
_LAYERS = {"substrate": "BODY", "ceramic": "CERAMICS", "glue": "GLUE"}


@dataclass(frozen=True)
class Cut:
    """Where an assembly is cut: along x at y = `at` (m), or, `upright`, along y at x = `at`."""

    upright: bool
    at: si.Metre


@si.checked_numbers
def stretch_for(height: si.Metre, scale: si.Dimensionless, room: float = 34.0) -> int:
    """How many times larger thicknesses are drawn so that a height (m) fits the room (mm)."""
    fits = (one for one in _STRETCHES if 1e3 * height * scale * one <= room)
    return next(fits, 1)


def spans(part: Part, cut: Cut) -> list[tuple[si.Metre, si.Metre]]:
    """From where to where a part is met along a cut (m)."""
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
    base = next(one.footprint for one in parts if one.kind == "substrate")
    if isinstance(base, Sector):
        return Cut(False, 0.0)
    ceramics = [one for one in parts if one.kind == "ceramic"]
    options = [Cut(False, base.width / 2), Cut(True, base.length / 2)]
    for one in ceramics:
        shape = one.footprint
        assert isinstance(shape, Rectangle)
        options.append(Cut(False, shape.y + shape.width / 2))
        options.append(Cut(True, shape.x + shape.length / 2))
    return max(options, key=lambda cut: sum(bool(spans(one, cut)) for one in ceramics))


def section_view(
    sheet: Sheet,
    parts: Sequence[Part],
    cut: Cut,
    middle: float,
    top: float,
    sizes: dict[int, str],
    antiphase: frozenset[int] = frozenset(),
) -> tuple[int, float]:
    """Draw the section about a `middle` with its upper face at `top` (mm of paper), with the
    thicknesses of substrate, and of one glue layer and one ceramic at the right end; `sizes` are
    their keys by what they are of (0: the substrate, −n: the glue of ceramic n, n: ceramic n). How
    many times larger thicknesses are drawn, and where it ends (mm)."""
    met = [(one, spans(one, cut)) for one in parts]
    met = [(one, found) for one, found in met if found]
    high, low = max(one.top for one, _ in met), min(one.bottom for one, _ in met)
    stretch = stretch_for(high - low, sheet.scale)
    ends = [end for _, found in met for span in found for end in span]
    _, y_top = sheet.at(0.0, top)
    centre, _ = sheet.at(middle, 0.0)
    shift = centre - (min(ends) + max(ends)) / 2
    upwards = y_top - stretch * high

    def height(z: float) -> float:
        return upwards + stretch * z

    for one, found in met:
        for start, end in found:
            bottom = height(one.bottom)
            other = one.kind == "ceramic" and one.number in antiphase
            layer = "CERAMICS_B" if other else _LAYERS[one.kind]
            box = rectangle(layer, start + shift, bottom, end - start, height(one.top) - bottom)
            sheet.add(box)
    right = max(ends) + shift
    away = 7.0
    base = next(one for one, _ in met if one.kind == "substrate")
    for one in (base, *_last_stack(met)):
        number = 0 if one is base else (one.number if one.kind == "ceramic" else -one.number)
        where = right if one is base else max(spans(one, cut))[1] + shift
        what = {"substrate": "", "ceramic": "", "glue": " glue"}[one.kind]
        reach = away + (right - where) / sheet.unit
        sheet.upright(
            height(one.bottom), height(one.top), where, reach,
            stretch=stretch, value_of=sizes.get(number, ""), suffix=what, beside=True,
        )  # fmt: skip
        said = 1e3 * one.thickness
        away += (len(f"{said:.6g}{what}") * LETTER + 3.6) * NUMBER
    bottom = top - 1e3 * (high - low) * sheet.scale * stretch
    label = "Section A–A" if isinstance(base.footprint, Rectangle) else "Section through the middle"
    larger = f"; heights drawn {stretch} times larger" if stretch > 1 else ""
    sheet.write(f"{label}{larger}", middle, bottom - 6.0, SMALL, "middle")
    return stretch, bottom - 8.0


def _last_stack(met: Sequence[tuple[Part, list[tuple[float, float]]]]) -> list[Part]:
    """The rightmost ceramic of those met, with its glue, and teeth where there are any."""
    ceramics = [(max(found)[1], one) for one, found in met if one.kind == "ceramic"]
    if not ceramics:
        return []
    last = max(ceramics, key=lambda pair: pair[0])[1]
    glue = [one for one, _ in met if one.kind == "glue" and one.number == last.number]
    teeth = [one for one, _ in met if one.kind == "substrate"][1:]
    return [*teeth[:1], last, *glue]
