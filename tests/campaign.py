"""Statistics that take hours: each answer is kept, with its commit, and not asked for again.

    pytest -p tests.campaign -m campaign --answers campaigns/statistics.jsonl

A line of the file says of one test what came out, what it printed and of which source (a digest of
`src` and of the tests); a run that was cut off goes on with those that have no line for the source
as it is. The tests draw from seeds of their own, which stand in them.
"""

from __future__ import annotations

import hashlib
import json
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def pytest_addoption(parser: pytest.Parser) -> None:
    """Where answers are kept."""
    parser.addoption("--answers", type=Path, required=True, help="the file of answers")


def pytest_configure(config: pytest.Config) -> None:
    """Workers leave out the same; reports arrive in the process that began them."""
    keeps = not hasattr(config, "workerinput")
    config.pluginmanager.register(Answers(config.getoption("--answers"), keeps), "answers")


class Answers:
    """The file of answers, and what of it belongs to the source as it is."""

    def __init__(self, path: Path, keeps: bool) -> None:
        self._path, self._keeps = path, keeps
        self._source = source_digest(ROOT)
        commit = ["git", "rev-parse", "--short", "HEAD"]
        self._commit = subprocess.run(
            commit, cwd=ROOT, capture_output=True, text=True, check=True
        ).stdout.strip()
        lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
        answers = [json.loads(line) for line in lines if line.endswith("}")]
        self._known = {one["test"] for one in answers if one["source"] == self._source}

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(
        self, config: pytest.Config, items: list[pytest.Item]
    ) -> None:
        """Leave out what has its answer."""
        known = [item for item in items if item.nodeid in self._known]
        if known:
            items[:] = [item for item in items if item.nodeid not in self._known]
            config.hook.pytest_deselected(items=known)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Append an answer as soon as it is there."""
        if not self._keeps or report.when != "call" or report.outcome == "skipped":
            return
        line = {
            "test": report.nodeid, "outcome": report.outcome, "seconds": round(report.duration),
            "commit": self._commit, "source": self._source, "printed": report.capstdout,
        }  # fmt: skip
        self._path.parent.mkdir(parents=True, exist_ok=True)
        with self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line, ensure_ascii=False) + "\n")


def source_digest(root: Path) -> str:
    """A digest of all that can change an answer."""
    found = hashlib.sha256()
    for path in sorted([*root.glob("src/**/*.py"), *root.glob("tests/**/*.py")]):
        found.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes())
    return found.hexdigest()[:12]
