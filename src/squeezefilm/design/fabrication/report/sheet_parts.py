"""Parts of every sheet, in millimetres of paper: its frame, tables, notes and title block."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.distributions import Normal
from squeezefilm.core.formats.drawing import (
    Align,
    Drawing,
    Layer,
    Place,
    arrows_outside,
    millimetres,
)
from squeezefilm.core.kit.numbers import printable
from squeezefilm.core.results import stamp
from squeezefilm.design.fabrication.report.rows import layout_rows
from squeezefilm.physics.display import Display
from squeezefilm.physics.uncertainty.parameters import value_at

if TYPE_CHECKING:
    from squeezefilm.design.fabrication.fabricate import Fabrication

LAYERS = {
    "FRAME": Layer(7, width=0.35e-3),
    "OUTLINE": Layer(7, width=0.5e-3),
    "BODY": Layer(45, width=0.35e-3, fill="own"),
    "CERAMICS": Layer(151, width=0.35e-3, fill="own"),
    "CERAMICS_B": Layer(21, width=0.35e-3, fill="own"),
    "CERAMICS_OTHER_FACE": Layer(8, "DASHED", 0.25e-3),
    "ELECTRODES": Layer(5, width=0.18e-3),
    "GLUE": Layer(3, width=0.18e-3, fill="own"),
    "HOLES": Layer(7, width=0.35e-3, fill="paper"),
    "POLING": Layer(7, width=0.25e-3),
    "SUPPORTS": Layer(6, "DASHED", 0.25e-3),
    "NODAL_LINES": Layer(1, "DASHDOT", 0.18e-3),
    "CENTRE_LINES": Layer(8, "DASHDOT", 0.18e-3),
    "DIMENSIONS": Layer(8, width=0.18e-3),
    "TEXT": Layer(7, width=0.18e-3),
}
"""Layers by their names in the DXF."""

PAPER = (420.0, 297.0)
"""A3, landscape (mm)."""
VIEWS = (14.0, 14.0, 252.0, 283.0)
"""Edges of the room for views: left, bottom, right, top (mm)."""
COLUMN = (258.0, 412.0)
"""The left and right end of the column of tables (mm)."""
NUMBER, SMALL, HEAD = 2.5, 2.0, 2.5
"""Heights of capitals (mm): of dimensions, of tables, of headings."""
_SCALES = (100.0, 50.0, 20.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002)
# The width of a usual letter over the height of a capital; generous, fonts differ.
LETTER = 0.88
# Of a line that labels may interrupt.
_PIECES = 720


@si.checked_numbers
def scale_for(width: si.Metre, height: si.Metre, room: tuple[float, float]) -> si.Dimensionless:
    """The largest usual scale at which something (m) fits a room on paper (mm)."""
    for scale in _SCALES:
        if 1e3 * scale * width <= room[0] and 1e3 * scale * height <= room[1]:
            return scale
    return min(room[0] / (1e3 * width), room[1] / (1e3 * height))


class Sheet(Drawing):
    """A drawing of a `display` as it is composed: `scale` is paper over thing; places on paper are
    in millimetres from its lower left corner, and `origin` is where the thing's own (0, 0) lies
    there. Boxes that are `kept_free` (left, bottom, right, top in m) are not crossed by lines that
    are `interrupted`. `end_views` says where the views end.
    """

    def __init__(self, display: Display, scale: float, origin: tuple[float, float]) -> None:
        self.display, self.origin = display, origin
        self.unit: si.Metre = 1e-3 / scale
        """Length of the thing that a millimetre of paper stands for (m)."""
        self.kept_free: list[tuple[float, float, float, float]] = []
        paper = (1e-3 * PAPER[0], 1e-3 * PAPER[1])
        super().__init__(LAYERS, scale, paper, self.at(0.0, 0.0))
        self.end_views(VIEWS[1])

    def end_views(self, lowest: float) -> None:
        """Let the views end at a height on paper (mm)."""
        left, _, right, top = VIEWS
        self.views = 1e-3 * (left - 4.0), 1e-3 * lowest, 1e-3 * (right + 4.0), 1e-3 * (top + 4.0)

    def at(self, x: float, y: float) -> Place:
        """A place on paper (mm) as one of the thing (m)."""
        return (x - self.origin[0]) * self.unit, (y - self.origin[1]) * self.unit

    def write(
        self,
        text: str,
        x: float,
        y: float,
        height: float = SMALL,
        align: Align = "left",
    ) -> None:
        """A text at a place on paper (mm), capitals so high (mm)."""
        self.text(printable(text), *self.at(x, y), height * self.unit, align)

    def label(self, text: str, x: si.Metre, y: si.Metre, angle: float = 0.0) -> None:
        """A text about a place of the thing (m), which lines then leave free."""
        size = NUMBER * self.unit
        along, across = len(text) * LETTER * size / 2, 0.8 * size
        wide, high = (across, along) if angle else (along, across)
        self.kept_free.append((x - wide, y - high, x + wide, y + high))
        self.text(printable(text), x, y, size, "center", angle)

    def interrupted(self, layer: str, shape: tuple[Place, Place] | float) -> None:
        """A straight line between two places, or a circle of a radius about the origin (m), left
        out where labels are."""
        shares = np.linspace(0.0, 1.0, _PIECES + 1)
        angles = 2 * np.pi * shares
        if isinstance(shape, float):
            x, y = shape * np.cos(angles), shape * np.sin(angles)
        else:
            x, y = (np.interp(shares, (0.0, 1.0), ends) for ends in zip(*shape, strict=True))
        free = np.ones(shares.size, dtype=bool)
        for left, bottom, right, top in self.kept_free:
            free &= ~((left <= x) & (x <= right) & (bottom <= y) & (y <= top))
        # Where what is free begins, and behind its last place.
        edges = np.flatnonzero(np.diff(free, prepend=False, append=False)).reshape(-1, 2)
        for first, last in (edges - (0, 1)).tolist():
            if last == first:
                continue
            if isinstance(shape, float):
                self.arc(layer, 0.0, 0.0, shape, float(angles[first]), float(angles[last]))
            else:
                self.line(layer, tuple((float(x[k]), float(y[k])) for k in (first, last)))

    def box(self, layer: str, left: float, bottom: float, right: float, top: float) -> None:
        """A rectangle on paper (mm)."""
        (x, y), (x_to, y_to) = self.at(left, bottom), self.at(right, top)
        self.rectangle(layer, x, y, x_to - x, y_to - y)

    def rule(self, x: float, y: float, x_to: float, y_to: float, layer: str = "FRAME") -> None:
        """A straight line on paper (mm)."""
        self.line(layer, (self.at(x, y), self.at(x_to, y_to)))

    def across(
        self,
        x_from: si.Metre,
        x_to: si.Metre,
        y: si.Metre,
        away: float,
        key: str,
        *,
        y_to: si.Metre | None = None,
        prefix: str = "",
    ) -> None:
        """A horizontal dimension of two places of the thing at a height (m; the second may be at
        another), its line so many millimetres of paper `away` from it, above where that is
        positive. `key` is that of the description, which may state a tolerance. Its number
        stands over the line, or where it is wider than that, at its right."""
        size, suffix = NUMBER * self.unit, tolerance_said(self.display, key)
        at, said = y + away * self.unit, f"{prefix}{millimetres(abs(x_to - x_from))}{suffix}"
        width, extent = len(said) * LETTER * size, abs(x_to - x_from)
        text_x, text_y = (x_from + x_to) / 2, at + 0.9 * size
        if width > extent:
            beyond = 2.6 * size if arrows_outside(extent, size) else 0.8 * size
            text_x, text_y = max(x_from, x_to) + width / 2 + beyond, at
        ends, number = ((x_from, y), (x_to, y if y_to is None else y_to)), (text_x, text_y)
        self.dimension(*ends, at, number, size, prefix=prefix, suffix=suffix, value_of=key)

    def upright(
        self,
        y_from: si.Metre,
        y_to: si.Metre,
        x: si.Metre,
        away: float,
        key: str,
        *,
        stretch: float = 1.0,
        suffix: str | None = None,
        beside: bool = False,
    ) -> None:
        """A vertical dimension of two places of the thing at an x (m), its line so many millimetres
        of paper `away`, to the right where that is positive; `key` is as in `across`, and a
        `suffix` stands in place of its tolerance. Its number stands across the line on the far side
        of it: `beside` it, or above its upper end where it is short."""
        size = NUMBER * self.unit
        at = x + away * self.unit
        suffix = tolerance_said(self.display, key) if suffix is None else suffix
        said = f"{millimetres(abs(y_to - y_from) / stretch)}{suffix}"
        half = len(said) * size / 2
        # ezdxf takes letters to be as wide as high: at `half` and nearer it interrupts the line.
        beyond = max(half * LETTER + 0.6 * size, 1.01 * half)
        text_x = at + beyond * (1 if away > 0 else -1)
        text_y = (y_from + y_to) / 2
        if not beside and arrows_outside(abs(y_to - y_from), size):
            text_y = max(y_from, y_to) + 1.6 * size
        self.dimension(
            (x, y_from), (x, y_to), at, (text_x, text_y), size,
            upright=True, stretch=stretch, suffix=suffix, value_of=key,
        )  # fmt: skip

    def ordinates(
        self,
        places: Iterable[tuple[si.Metre, si.Metre, str]],
        edge: si.Metre,
        away: float,
        *,
        upright: bool = False,
    ) -> bool:
        """Distances from the origin (m) of places (coordinate, its sign on the sheet as drawn,
        key), at the ends of leaders from an `edge` (m). Those that stand too near to the one before
        are left out; whether none was."""
        size, last, whole = NUMBER * self.unit, None, True
        for coordinate, drawn, key in sorted(places, key=lambda place: place[0]):
            if last is not None and coordinate - last < 1.5 * size:
                whole = False
                continue
            last = coordinate
            end = edge + away * self.unit
            x, y = (edge, drawn) if upright else (drawn, edge)
            self.ordinate(x, y, end, size, upright=upright, value_of=key)
        return whole


def table(
    sheet: Sheet, head: Sequence[str], rows: Sequence[Sequence[str]], top: float, bottom: float
) -> float:
    """A table in the column, its head at `top` (mm); rows that do not fit above `bottom` are
    counted in the last one. Where it ends (mm)."""
    left, right, step = *COLUMN, 4.6
    most = max(1, int((top - bottom) / step) - 2)
    shown = [list(row) for row in rows[:most]]
    weights = [max(len(row[k]) for row in (head, *shown)) + 2 for k in range(len(head))]
    ends = [left]
    for weight in weights:
        ends.append(ends[-1] + weight * (right - left) / sum(weights))
    y = top - step / 2
    for number, row in enumerate((head, *shown)):
        for k, cell in enumerate(row):
            room = max(3, int((ends[k + 1] - ends[k] - 1.5) / (LETTER * SMALL)))
            said = cell if len(cell) <= room else cell[: room - 1] + "…"
            sheet.write(said, ends[k] + 0.8, y)
        y -= step
        if number == 0:
            sheet.rule(left, y + step / 2, right, y + step / 2)
    if len(rows) > most:
        sheet.write(f"and {len(rows) - most} more: electrodes.csv has all", left + 0.8, y)
        y -= step
    return y + step / 2


def notes(sheet: Sheet, texts: Iterable[str], top: float) -> float:
    """Numbered notes in the column from `top` down (mm); where they end (mm)."""
    left, right = COLUMN
    letters = int((right - left - 6) / (LETTER * SMALL))
    y, step = top - 2.0, 3.5
    for number, text in enumerate(texts, 1):
        sheet.notes.append(text)
        for at, line in enumerate(textwrap.wrap(printable(text), letters)):
            if at == 0:
                sheet.write(f"{number}", left + 0.8, y)
            sheet.write(line, left + 5.5, y)
            y -= step
        y -= 0.7
    return y


def title_block(sheet: Sheet, title: str, name: str, rows: Sequence[tuple[str, str]]) -> float:
    """The frame and, in its lower right corner, title, name and rows of what is to be said; where
    it begins (mm)."""
    left, right = COLUMN
    sheet.box("FRAME", 8.0, 8.0, PAPER[0] - 8.0, PAPER[1] - 8.0)
    step, bottom = 4.8, 8.0
    top = bottom + step * len(rows) + 17.0
    sheet.box("FRAME", left, bottom, right, top)
    letters = int((right - left - 4) / (LETTER * HEAD))
    lines = textwrap.wrap(printable(title), letters, max_lines=2, placeholder=" …")
    for number, line in enumerate(lines):
        sheet.write(line, left + 2.0, top - 4.0 - 4.4 * number, HEAD)
    said = textwrap.shorten(printable(name), 70, placeholder=" …")
    sheet.write(said, left + 2.0, top - 14.0, SMALL)
    y = top - 17.0
    room = int((right - left - 36.0) / (LETTER * SMALL))
    for what, value in rows:
        sheet.rule(left, y, right, y)
        sheet.write(what, left + 2.0, y - step / 2)
        told = printable(value)
        sheet.write(
            told if len(told) <= room else told[: room - 1] + "…", left + 34.0, y - step / 2
        )
        y -= step
    sheet.rule(left + 32.0, bottom, left + 32.0, top - 17.0)
    return top


def finished(sheet: Sheet, made: Fabrication, texts: Iterable[str]) -> Sheet:
    """A sheet that has its views, with title block, table of electrodes and notes."""
    origin, scale = stamp(made.display), sheet.scale
    materials = {part.kind: part.material for part in reversed(made.parts)}
    glue = next((millimetres(part.thickness) for part in made.parts if part.kind == "glue"), None)
    ratio = f"{scale:g}:1" if scale >= 1 else f"1:{1 / scale:.6g}"
    block = title_block(
        sheet,
        made.display.title,
        made.display.name,
        [
            ("Scale, sheet", f"{ratio}, A3; lengths in mm"),
            ("Substrate", materials["substrate"]),
            ("Ceramic", materials["ceramic"]),
            ("Glue", "none" if glue is None else f"{glue} mm"),
            ("Mass", f"{1e3 * made.mass:.4g} g, assembled"),
            ("SHA-256", str(origin["config_sha256"])[:32] + " …"),
            ("Drawn by", f"squeezefilm {origin['squeezefilm_version']}"),
            ("Date (UTC)", str(origin["created_utc"])[:10]),
        ],
    )
    y = table(sheet, *layout_rows(made), VIEWS[3], block + 110.0)
    notes(sheet, texts, y - 3.0)
    return sheet


def tolerance_said(display: Display, path: str) -> str:
    """Tolerance that the description gives a length, to stand behind its number: " ±0.1" (two
    standard deviations, or half of an even range), or both ends of another; "" where it says
    nothing."""
    origin = display.provenance.get(path)
    spread = None if origin is None else origin.distribution
    if spread is None:
        return ""
    if isinstance(spread, Normal):
        return f" ±{millimetres(2 * spread.standard_deviation)}"
    low, high = spread.support
    value = value_at(display, path)[0]
    if abs(low + high - 2 * value) < 1e-3 * (high - low):
        return f" ±{millimetres((high - low) / 2)}"
    return f" ({millimetres(low)} to {millimetres(high)})"
