"""Run the standing gate of reliability and print its table.

    python tools/gate.py [NAME ...]

Each row of ``gate.toml`` names a kind of fault, the tests that stand for it, what they cover and
what they leave out. A row passes when its tests passed and at least one of them ran; a test that
was skipped is counted. The exit code is 1 if a row did not pass, 2 if a row is wrong or unknown.
"""

from __future__ import annotations

import os
import sys
import tomllib
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from rich.console import Console
from rich.table import Table

ROOT = Path(__file__).parents[1]
ROWS = Path(__file__).with_name("gate.toml")


@dataclass(frozen=True)
class Row:
    """One kind of fault and the tests that stand for it."""

    name: str
    covers: str
    leaves_out: str
    tests: tuple[str, ...]

    def holds(self, node: str) -> bool:
        """Whether a test, by its pytest node, belongs to the row."""
        return any(
            node == test or node.startswith((f"{test}::", f"{test}[")) for test in self.tests
        )


def read_rows(file: Path = ROWS) -> tuple[Row, ...]:
    """The rows of the gate, in the order of the file."""
    with file.open("rb") as stream:
        rows = tomllib.load(stream)["row"]
    return tuple(Row(**{**row, "tests": tuple(row["tests"])}) for row in rows)


@dataclass(eq=False)
class Outcomes:
    """Collects how each test ended (a pytest plugin)."""

    ended: dict[str, str] = field(default_factory=dict)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Keep the worst phase: a failing teardown fails a test that passed."""
        if report.failed or (report.when == "call" and self.ended.get(report.nodeid) != "failed"):
            self.ended[report.nodeid] = "failed" if report.failed else report.outcome
        elif report.skipped:
            self.ended[report.nodeid] = "skipped"

    def of(self, row: Row) -> Counter[str]:
        """How many tests of a row passed, failed and were skipped."""
        return Counter(outcome for node, outcome in self.ended.items() if row.holds(node))


def has_passed(counts: Counter[str]) -> bool:
    """Whether a row of these counts passed."""
    return counts["passed"] > 0 and not counts["failed"]


def show(rows: Iterable[Row], outcomes: Outcomes, console: Console) -> None:
    """Print a row per kind of fault."""
    table = Table("gate", "verdict", "passed", "failed", "skipped", "covers", "leaves out")
    for row in rows:
        counts = outcomes.of(row)
        verdict = "passed" if has_passed(counts) else "FAILED" if counts["failed"] else "NOT RUN"
        numbers = [str(counts[outcome]) for outcome in ("passed", "failed", "skipped")]
        table.add_row(row.name, verdict, *numbers, row.covers, row.leaves_out)
    console.print(table)


def main(names: Sequence[str]) -> int:
    """Run the rows of these names, or all; the exit code."""
    rows = read_rows()
    if unknown := set(names) - {row.name for row in rows}:
        known = ", ".join(row.name for row in rows)
        print(f"no gate is called {', '.join(sorted(unknown))}; there are {known}", file=sys.stderr)
        return 2
    chosen = [row for row in rows if not names or row.name in names]
    outcomes = Outcomes()
    os.chdir(ROOT)
    nodes = sorted({test for row in chosen for test in row.tests})
    code = pytest.main(["-q", "-m", "not nightly and not campaign", *nodes], plugins=[outcomes])
    show(chosen, outcomes, Console(width=160))
    if code in (pytest.ExitCode.USAGE_ERROR, pytest.ExitCode.INTERRUPTED):
        return 2
    return 0 if all(has_passed(outcomes.of(row)) for row in chosen) else 1


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
