"""A search for designs killed at any moment goes on, ends the same, and computes next to nothing
twice."""

from __future__ import annotations

import collections
import random
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tests.faults.design_child import searched

ROOT = Path(__file__).parents[2]
KILLS = 5


@pytest.mark.slow
def test_a_killed_search_ends_as_one_that_was_left_alone(tmp_path: Path) -> None:
    alone, folder = tmp_path / "alone", tmp_path / "killed"
    alone.mkdir()
    folder.mkdir()
    whole, draw = searched(alone), random.Random(5)
    ended = 0
    for _ in range(KILLS):
        child = subprocess.Popen(
            [sys.executable, "-m", "tests.faults.design_child", folder], cwd=ROOT
        )
        asked = folder / "asked"
        before = asked.stat().st_size if asked.exists() else 0
        # Killed once it has begun to compute, wherever it then is.
        until = time.monotonic() + 60
        while child.poll() is None and time.monotonic() < until:
            if asked.exists() and asked.stat().st_size > before:
                time.sleep(draw.uniform(0.0, 0.2))
                break
            time.sleep(0.01)
        ended += child.poll() is not None
        child.kill()
        child.wait()
    found = searched(folder)
    assert [one.evaluated for one in found.front] == [one.evaluated for one in whole.front]
    assert found.hypervolume == whole.hypervolume
    counts = collections.Counter((folder / "asked").read_text().split("\n"))
    twice = sum(count - 1 for line, count in counts.items() if line and count > 1)
    # What a kill interrupts is one task: of eight designs where they are screened.
    assert twice <= 8 * KILLS
    print(f"{KILLS} kills, {ended} of them too late, {twice} of {len(counts) - 1} computed twice")
