"""Bill, electrodes, expected numbers and test plan as rows of text, for page, terminal and CSV."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si
from squeezefilm.core.formats.drawing import millimetres
from squeezefilm.core.kit.folder import csv_text
from squeezefilm.core.kit.numbers import shown
from squeezefilm.core.results import to_json
from squeezefilm.design.fabrication.wiring import leads_of
from squeezefilm.measure.calibration.solved_answers import FRICTION
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.parts import Rectangle

if TYPE_CHECKING:
    from squeezefilm.design.fabrication.fabricate import Fabrication
    from squeezefilm.design.fabrication.test_plan import Check
    from squeezefilm.design.fabrication.wiring import BillRow

CERAMICS = ("No.", "x", "y", "Length", "Width", "Thick", "Joined to", "Poled")
SECTORS = ("Sector", "From", "To", "Joined to", "Poled")
BILL = ("Item", "What", "Count", "Material", "Size", "Made", "Mass", "Remark")
STEP = ("Read", "As described", "Expected", "Measured", "Inside", "Remark")
EXPECTED = ("Quantity", "As described", "Expected", "Remark")
_PLAN = (
    "step",
    "what to do",
    "kind of recording",
    "file",
    "read",
    "answer",
    "conditions (SI)",
    "as described (SI)",
    "low (SI)",
    "high (SI)",
    "level",
    "unit",
    "measured (SI)",
    "inside",
)
_KEY = ("resonance_frequency", "amplitude_per_volt", "quality_factor", "mass", FRICTION)


def said(value: float | None, unit: str, digits: int = 4) -> str:
    """A value as people read it; a dash where it is not known."""
    if value is not None and unit == "kg":
        return f"{1e3 * value:.{digits}g} g"
    return shown(value, si.Unit(unit), digits)


def expected_said(check: Check) -> str:
    """The interval of a check in words; a dash without one."""
    if check.interval is None:
        return "–"
    low, high = (said(end, check.unit, 3) for end in check.interval)
    level = "" if check.level is None else f" ({si.percent(check.level)})"
    return f"{low} to {high}{level}"


def expected_rows(made: Fabrication) -> list[tuple[str, ...]]:
    """The numbers that one looks for first, once each, in the order of the plan."""
    rows: dict[tuple[str, str], tuple[str, ...]] = {}
    for step in made.steps:
        for check in step.checks:
            key = check.answer in _KEY or check.what.startswith(("Amplitude at", "Free amplitude"))
            if key and check.value is not None:
                value, expected = said(check.value, check.unit), expected_said(check)
                row = (check.what, value, expected, check.remark)
                rows.setdefault((check.what, check.unit), row)
    return list(rows.values())


def step_rows(checks: Iterable[Check]) -> list[tuple[str, ...]]:
    """Rows of what is to be read in one step, with empty places for what is measured."""
    return [
        (check.what, said(check.value, check.unit), expected_said(check), "", "☐", check.remark)
        for check in checks
    ]


def bill_rows(bill: Sequence[BillRow]) -> list[tuple[str, ...]]:
    """The bill, and its sum."""
    rows = [
        (
            f"{number}",
            row.what,
            f"{row.count}",
            row.material,
            row.size,
            row.made,
            said(row.mass, "kg"),
            row.remark,
        )
        for number, row in enumerate(bill, 1)
    ]
    total = sum(row.mass or 0.0 for row in bill if row.in_mass)
    return [*rows, ("", "Sum", "", "", "", "", said(total, "kg"), "of what the display is made of")]


def bill_csv(bill: Sequence[BillRow]) -> str:
    """The bill as CSV, masses in kilograms."""
    rows = [
        {"item": number, **to_json(row), "in_mass": "yes" if row.in_mass else "no"}
        for number, row in enumerate(bill, 1)
    ]
    return csv_text(list(rows[0]), [list(row.values()) for row in rows])


def layout_rows(made: Fabrication) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Head and rows of the electrodes: where each ceramic lies, in millimetres, or where its sector
    begins and ends; what its outer side is joined to, and how it is poled."""
    rows = []
    for electrode in made.electrodes:
        shape = electrode.footprint
        if isinstance(shape, Rectangle):
            where = "" if electrode.face == "bottom" else " (top)"
            sizes = (shape.x, shape.y, shape.length, shape.width, electrode.thickness)
            cells = (f"{electrode.ceramic}{where}", *map(millimetres, sizes))
        else:
            ends = (f"{math.degrees(angle):.6g}°" for angle in (shape.start, shape.end))
            cells = (electrode.name, *ends)
        poled = "away" if electrode.poling > 0 else "towards"
        rows.append((*cells, electrode.connection, poled))
    return CERAMICS if isinstance(made.display.actuator, RectangularPlate) else SECTORS, rows


def lead_rows(made: Fabrication) -> list[tuple[str, ...]]:
    """Rows of what is joined to what."""
    return [(lead.name, ", ".join(lead.electrodes), lead.to) for lead in leads_of(made.electrodes)]


def plan_csv(made: Fabrication) -> str:
    """The plan as CSV in SI units, with empty columns for what is measured."""
    rows = []
    for step in made.steps:
        for check in step.checks:
            low, high = check.interval or (None, None)
            under = "; ".join(f"{name}={value:.9g}" for name, value in check.conditions)
            numbers = ("" if end is None else f"{end:.9g}" for end in (check.value, low, high))
            rows.append(
                (
                    step.name,
                    step.do,
                    step.kind,
                    step.file,
                    check.what,
                    check.answer,
                    under,
                    *numbers,
                    "" if check.level is None else f"{check.level:g}",
                    check.unit,
                    "",
                    "",
                )
            )
    return csv_text(_PLAN, rows)
