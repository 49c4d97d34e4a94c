"""A budget that only falls: lines and modules of each part; and sizes that none may pass.

`budget.toml` beside this file has what each part may have. Lower a number when a part became
smaller; raising one needs a decision record that says what the growth bought. How much processor
time the tests take by folder is in `docs/development/test-costs.md`.
"""

from __future__ import annotations

import ast
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


def test_no_module_or_function_is_too_long_and_no_call_too_wide() -> None:
    long: list[str] = []
    wide: list[str] = []
    lines = functions = longer = unformatted = 0
    for file in SOURCE.rglob("*.py"):
        text = file.read_text("utf-8")
        lines += text.count("\n")
        if text.count("\n") >= 400:
            long.append(str(file.relative_to(SOURCE)))
        unformatted += text.count("fmt: skip")
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                functions += 1
                assert node.end_lineno is not None
                longer += node.end_lineno - node.lineno >= 60
                given = node.args.posonlyargs + node.args.args + node.args.kwonlyargs
                if (
                    len([argument for argument in given if argument.arg not in ("self", "cls")])
                    > 10
                ):
                    wide.append(f"{file.name}: {node.name}")
    assert lines <= 112_020, f"the package has {lines} lines: 112 020 are its budget"
    assert not long, f"400 lines are too many for a module: split {', '.join(long)}"
    assert not wide, f"more than 10 parameters: give a record in {', '.join(wide)}"
    assert longer <= 0.006 * functions, f"{longer} of {functions} functions have over 60 lines"
    assert unformatted < 20, f"{unformatted} lines are kept from the formatter"
