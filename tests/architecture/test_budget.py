"""A budget that only falls: lines and modules of each part.

`budget.toml` beside this file has what each part may have. Lower a number when a part became
smaller; raising one needs a decision record that says what the growth bought. How much processor
time the tests take by folder is in `docs/development/test-costs.md`.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[2] / "src" / "squeezefilm"
BUDGET: Mapping[str, Mapping[str, int]] = tomllib.loads(
    (Path(__file__).parent / "budget.toml").read_text("utf-8")
)
SLACK = 1.005
"""A share of a part that needs no new number."""


def spent(part: str) -> dict[str, int]:
    """Lines and modules of a part; of `top` those beside the parts."""
    files = list(SOURCE.glob("*.py") if part == "top" else (SOURCE / part).rglob("*.py"))
    lines = sum(file.read_text("utf-8").count("\n") for file in files)
    return {"lines": lines, "modules": len(files)}


def test_every_part_has_a_budget() -> None:
    parts = {file.parent.name for file in SOURCE.glob("*/__init__.py")}
    parts |= {file.parent.parent.name for file in SOURCE.glob("*/*/__init__.py")}
    assert set(BUDGET) == (parts - {SOURCE.name}) | {"top"}


@pytest.mark.parametrize("part", sorted(BUDGET))
def test_no_part_is_larger_than_its_budget(part: str) -> None:
    for what, count in spent(part).items():
        allowed = BUDGET[part][what]
        assert count <= SLACK * allowed, (
            f"{part} has {count} {what}, and {allowed} are its budget: make it smaller. Raising a "
            "line of tests/architecture/budget.toml needs a decision record"
        )
