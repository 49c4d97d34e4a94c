"""A sector's electrode on a drawing: its walls, and its name where there is room for it."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm import load_display
from squeezefilm.design.fabrication.report.plans import LETTER, NUMBER, _electrode
from squeezefilm.design.fabrication.report.sheet_parts import Sheet
from squeezefilm.physics.plate.parts import Sector

UNIT = 1e-3
NAME = SimpleNamespace(name="S1", connection="A", poling=1)
LONG = len("S1 A") * LETTER * NUMBER + 1.0


class Kept(Sheet):
    """A sheet that keeps what is labelled."""

    def __init__(self) -> None:
        # A millimetre of paper is one of the plate's.
        super().__init__(load_display("winfield2007-tpad"), 1.0, (0.0, 0.0))
        self.labels: list[tuple[str, float, float]] = []

    def label(self, text: str, x: float, y: float, angle: float = 0.0) -> None:
        """Keep it."""
        self.labels.append((text, x, y))

    def on(self, layer: str) -> list[Any]:
        """What lies on a layer, lengths in millimetres."""
        return list(self.document.modelspace().query(f'*[layer=="{layer}"]'))


def drawn(inner: float, outer: float, start: float = 0.0, end: float = 2 * math.pi) -> Kept:
    sheet = Kept()
    electrode: Any = NAME
    _electrode(sheet, electrode, Sector(inner * UNIT, outer * UNIT, start, end))
    return sheet


def mark(sheet: Kept) -> tuple[float, float]:
    x, y, _ = sheet.on("POLING")[0].dxf.center
    return x, y


def test_a_sector_has_its_arcs_and_walls() -> None:
    sheet = drawn(20, 40, 0.3, 0.9)
    kinds = [item.dxftype() for item in sheet.on("ELECTRODES")]
    assert kinds == ["ARC", "ARC", "LWPOLYLINE", "LWPOLYLINE"]
    *arcs, first, second = sheet.on("ELECTRODES")
    # Seen from below angles run the other way.
    ends = [(arc.dxf.radius, arc.dxf.start_angle, arc.dxf.end_angle) for arc in arcs]
    assert ends == [pytest.approx((r, math.degrees(-0.9), math.degrees(-0.3))) for r in (40, 20)]
    walls = [wall.get_points("xy") for wall in (first, second)]
    for wall, angle in zip(walls, (0.3, 0.9), strict=True):
        for (x, y), r in zip(wall, (20, 40), strict=True):
            assert (x, y) == pytest.approx((r * math.cos(angle), -r * math.sin(angle)))
    assert len(drawn(0, 40, 0.3, 0.9).on("ELECTRODES")) == 3


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
    assert [circle.dxf.radius for circle in sheet.on("ELECTRODES")] == pytest.approx([40])
    ring = drawn(20, 60)
    assert [circle.dxf.radius for circle in ring.on("ELECTRODES")] == pytest.approx([60, 20])
    ((_, x, y),) = ring.labels
    half = 40 / math.sqrt(2)
    assert (x / UNIT, y / UNIT) == pytest.approx((half, half + 2.2))
