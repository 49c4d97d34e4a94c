"""A sector's electrode on a drawing: its walls, and its name where there is room for it."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.core.formats.drawing import Arc, Polyline
from squeezefilm.design.fabrication.report.round_sheet import LETTER, NUMBER, _electrode
from squeezefilm.physics.plate.parts import Sector

UNIT = 1e-3
"""A millimetre of paper is one of the plate's."""
NAME = SimpleNamespace(name="S1", connection="A", poling=1)
LONG = len("S1 A") * LETTER * NUMBER + 1.0


class Sheet:
    """A sheet that keeps what is drawn and written."""

    def __init__(self) -> None:
        self.unit = UNIT
        self.items: list[Any] = []
        self.labels: list[tuple[str, float, float]] = []
        self.kept_free: list[Any] = []

    def add(self, item: Any) -> None:
        """Keep it."""
        self.items.append(item)

    def label(self, text: str, x: float, y: float) -> None:
        """Keep it."""
        self.labels.append((text, x, y))


def drawn(inner: float, outer: float, start: float = 0.0, end: float = 2 * math.pi) -> Sheet:
    sheet: Any = Sheet()
    electrode: Any = NAME
    _electrode(sheet, electrode, Sector(inner * UNIT, outer * UNIT, start, end))
    return sheet  # type: ignore[no-any-return]


def mark(sheet: Sheet) -> tuple[float, float]:
    circle = next(item for item in sheet.items if item.layer == "POLING")
    return circle.x / UNIT, circle.y / UNIT


def test_a_sector_has_its_arcs_and_walls() -> None:
    sheet = drawn(20, 40, 0.3, 0.9)
    arcs = [item for item in sheet.items if isinstance(item, Arc) and item.layer == "ELECTRODES"]
    # Seen from below angles run the other way.
    assert [(arc.radius, arc.start, arc.end) for arc in arcs] == [
        (pytest.approx(r * UNIT), -0.9, -0.3) for r in (40, 20)
    ]
    walls = [item for item in sheet.items if isinstance(item, Polyline)][:2]
    for wall, angle in zip(walls, (0.3, 0.9), strict=True):
        for (x, y), r in zip(wall.points, (20, 40), strict=True):
            assert (x, y) == pytest.approx(
                (r * UNIT * math.cos(angle), -r * UNIT * math.sin(angle))
            )
    assert len([arc for arc in drawn(0, 40, 0.3, 0.9).items if arc.layer == "ELECTRODES"]) == 3


def test_a_name_stands_above_the_mark_where_both_have_room() -> None:
    sheet = drawn(20, 60, 0.0, 1.0)
    ((text, x, y),) = sheet.labels
    assert text == "S1 A"
    middle = 40 * math.cos(0.5), -40 * math.sin(0.5)
    assert (x / UNIT, y / UNIT) == pytest.approx((middle[0], middle[1] + 2.2))
    assert mark(sheet) == pytest.approx((middle[0], middle[1] - 2.2))


@pytest.mark.parametrize(
    ("inner", "outer", "wide", "named"),
    [
        # Along the arc in the middle as long as the name, and 8 deep.
        (30.0, 50.0, 1.01 * LONG, True),
        (30.0, 50.0, 0.99 * LONG, False),
        (30.0, 30.0 + max(8.01, 1.01 * LONG), 2 * LONG, True),
        (30.0, 37.99, 2 * LONG, False),
    ],
)
def test_where_there_is_no_room_the_mark_stands_alone(
    inner: float, outer: float, wide: float, named: bool
) -> None:
    middle = (inner + outer) / 2
    angle = wide / middle
    sheet = drawn(inner, outer, 0.0, angle)
    assert bool(sheet.labels) is named
    off = 2.2 if named else 0.0
    expected = middle * math.cos(angle / 2), -middle * math.sin(angle / 2) - off
    assert mark(sheet) == pytest.approx(expected)


def test_a_whole_electrode_is_named_beside_the_nodal_circle() -> None:
    sheet = drawn(0, 40)
    circles = [item for item in sheet.items if item.layer == "ELECTRODES"]
    assert [circle.radius for circle in circles] == [pytest.approx(40 * UNIT)]
    ring = drawn(20, 60)
    circles = [item for item in ring.items if item.layer == "ELECTRODES"]
    assert [circle.radius / UNIT for circle in circles] == pytest.approx([60, 20])
    ((_, x, y),) = ring.labels
    half = 40 / math.sqrt(2)
    assert (x / UNIT, y / UNIT) == pytest.approx((half, half + 2.2))
