"""What a campaign keeps of its tests, and what it asks again."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import tests.campaign

TESTS = """
def test_a(): print("0.95 of 2000")
def test_b(): assert False
"""


@pytest.mark.slow
def test_an_answer_is_kept_and_asked_for_again_only_of_another_source(tmp_path: Path) -> None:
    folder = tmp_path / "tests"
    folder.mkdir()
    (folder / "__init__.py").touch()
    (folder / "test_some.py").write_text(TESTS)
    shutil.copy(tests.campaign.__file__, folder)
    for command in ("git init -q", "git -c user.name=x -c user.email=x commit -qm x --allow-empty"):
        subprocess.run(command.split(), cwd=tmp_path, check=True)

    def run() -> list[dict[str, str]]:
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
        subprocess.run(
            [*command, "-p", "tests.campaign", "--answers", "out/answers.jsonl", "tests"],
            cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(tmp_path)}, capture_output=True,
            check=False,
        )  # fmt: skip
        lines = (tmp_path / "out" / "answers.jsonl").read_text().splitlines()
        return [json.loads(line) for line in lines]

    first, second = run()
    assert (first["outcome"], second["outcome"]) == ("passed", "failed")
    assert "0.95 of 2000" in first["printed"]
    assert len(run()) == 2
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "changed.py").touch()
    assert len(run()) == 4
