"""Processor time of the tests, as a table of folders and of files.

    pytest -p tests.costs --costs docs/development/test-costs.md
    pytest -p tests.costs --within 10                           # none is begun after 10 s

The time of a test is user and system time of its process and of the children that ended meanwhile,
its fixtures included: what several tests share is counted with the first of them.
"""

from __future__ import annotations

import os
from collections import defaultdict
from pathlib import Path

import pytest

LEAST = 1.0
"""Files below this time (s) are summed in their folder's row only."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare what is written where."""
    parser.addoption("--costs", type=Path, help="the Markdown file of the table")
    parser.addoption("--within", type=float, help="processor time (s) after which none is begun")


def pytest_configure(config: pytest.Config) -> None:
    """Measure in every process; write in the one that hears all reports."""
    config.pluginmanager.register(Stopwatch(config.getoption("--within")), "stopwatch")
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(Costs(config.getoption("--costs")), "costs")


def processor_time() -> float:
    """User and system time (s) of this process and of its children that have ended."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


class Stopwatch:
    """Attaches to each report the processor time since the one before, and ends the run in time."""

    def __init__(self, within: float | None) -> None:
        self._before, self._within = processor_time(), within

    def pytest_collection_finish(self) -> None:
        """Leave imports and collection out."""
        self._before = processor_time()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item: pytest.Item) -> object:
        """Measure one phase of one test."""
        report = yield
        now = processor_time()
        report.processor_time, self._before = now - self._before, now
        report.is_slow = item.get_closest_marker("slow") is not None
        if self._within is not None and now > self._within:
            item.session.shouldstop = f"{self._within:g} s of processor time are spent"
        return report


class Costs:
    """Sums what tests took and writes it at the end."""

    def __init__(self, costs: Path | None) -> None:
        self._costs = costs
        self._times: dict[str, dict[bool, float]] = defaultdict(lambda: {False: 0.0, True: 0.0})
        self._tests: dict[str, int] = defaultdict(int)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Add one phase of one test to its file."""
        file, spent = report.nodeid.partition("::")[0], getattr(report, "processor_time", 0.0)
        self._times[file][getattr(report, "is_slow", False)] += spent
        self._tests[file] += report.when == "call"

    def pytest_sessionfinish(self) -> None:
        """Write the table."""
        if self._costs is not None:
            self._costs.write_text(table(self._times, self._tests), encoding="utf-8")


def table(times: dict[str, dict[bool, float]], tests: dict[str, int]) -> str:
    """The Markdown table of times (s) of quick (False) and slow (True) tests by file."""
    folders: dict[str, list[str]] = defaultdict(list)
    for file in times:
        parts = file.split("/")
        depth = min(len(parts) - 1, 4) if parts[1] == "unit" else 2
        folders["/".join(parts[1:depth])].append(file)

    def total(files: list[str], is_slow: bool) -> float:
        return sum(times[file][is_slow] for file in files)

    def row(name: str, files: list[str]) -> str:
        cells = [name, str(sum(tests[file] for file in files))]
        return " | ".join([*cells, *(f"{total(files, kind):.1f}" for kind in ran)])

    def cost(files: list[str]) -> float:
        return total(files, False) + total(files, True)

    ran = [kind for kind in (False, True) if total([*times], kind)]
    names = " | ".join("slow, s" if kind else "quick, s" for kind in ran)
    head = f"{{}} | tests | {names}\n---|---{'|---' * len(ran)}"
    by_folder = sorted(folders.items(), key=lambda pair: -cost(pair[1]))
    by_file = sorted((file for file in times if cost([file]) >= LEAST), key=lambda f: -cost([f]))
    return "\n".join(
        [
            "# Processor time of the tests",
            "",
            "User and system time, children included. Collection and the tests in real time are",
            "left out. Written by `make costs`; slow tests stand in it if they were run.",
            "",
            head.format("folder"),
            *(row(name, files) for name, files in by_folder),
            row("**all**", list(times)),
            "",
            head.format(f"file of {LEAST:g} s and more"),
            *(row(file.removeprefix("tests/"), [file]) for file in by_file),
            "",
        ]
    )
