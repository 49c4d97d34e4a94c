"""The gate: its rows name tests that exist, and a row's verdict follows from what ran."""

from __future__ import annotations

import ast
import io
from collections import Counter
from types import SimpleNamespace

import pytest
from rich.console import Console

import gate

ROWS = gate.read_rows()
NAMES = [
    "crash", "kill", "disk", "I/O errors", "clock", "stop", "fuzz of files", "fuzz of sockets",
    "token", "traversal", "injection", "merge", "deletion", "watchdog", "sanitizers", "licences",
    "install", "resume", "soak", "two writers", "slow reader",
]  # fmt: skip


def test_the_rows_are_the_kinds_of_fault() -> None:
    assert [row.name for row in ROWS] == NAMES
    assert all(row.covers and row.leaves_out and row.tests for row in ROWS)


def test_every_test_of_a_row_exists() -> None:
    for test in (test for row in ROWS for test in row.tests):
        path, _, function = test.partition("::")
        tree = ast.parse((gate.ROOT / path).read_text("utf-8"))
        functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
        assert not function or function in functions, test


def test_a_test_belongs_to_its_row_with_all_its_parameters() -> None:
    row = gate.Row("a", "b", "c", ("tests/a.py::test_one", "tests/b.py"))
    assert row.holds("tests/a.py::test_one")
    assert row.holds("tests/a.py::test_one[3]")
    assert row.holds("tests/b.py::test_two[3]")
    assert not row.holds("tests/a.py::test_one_more")


@pytest.mark.parametrize(
    ("ended", "passes", "verdict"),
    [
        (["passed", "skipped"], True, "passed"),
        (["passed", "failed"], False, "FAILED"),
        (["skipped"], False, "NOT RUN"),
        ([], False, "NOT RUN"),
    ],
)
def test_a_row_needs_a_test_that_ran_and_none_that_failed(
    ended: list[str], passes: bool, verdict: str
) -> None:
    row = gate.Row("a", "b", "c", ("t",))
    outcomes = gate.Outcomes({f"t::{number}": outcome for number, outcome in enumerate(ended)})
    assert outcomes.of(row) == Counter(ended)
    assert gate.has_passed(outcomes.of(row)) is passes
    text = io.StringIO()
    gate.show([row], outcomes, Console(file=text, width=120))
    assert verdict in text.getvalue()


def test_a_teardown_that_fails_fails_its_test() -> None:
    outcomes = gate.Outcomes()
    for when, outcome in (("setup", "passed"), ("call", "passed"), ("teardown", "failed")):
        failed, skipped = outcome == "failed", outcome == "skipped"
        report = SimpleNamespace(
            nodeid="t", when=when, outcome=outcome, failed=failed, skipped=skipped
        )
        outcomes.pytest_runtest_logreport(report)
    assert outcomes.ended == {"t": "failed"}


def test_an_unknown_name_is_refused_with_the_names(capsys: pytest.CaptureFixture[str]) -> None:
    assert gate.main(["power cut"]) == 2
    assert "two writers" in capsys.readouterr().err
