"""Two processes on one ring at full speed: no row torn, lost, doubled or out of order."""

from __future__ import annotations

import mmap
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.instruments.session.loop import shared
from squeezefilm.instruments.session.loop.shared import ring_take

WRITER = """
import mmap, sys
import numpy as np
from squeezefilm.instruments.session.loop import shared
from squeezefilm.instruments.session.loop.shared import ring_put_all

total = int(sys.argv[2])
with open(sys.argv[1], "r+b") as file:
    memory = shared.shared_views(mmap.mmap(file.fileno(), shared.shared_size()))
width = memory.rows.shape[1]
number, size = 0, 1
while number < total:
    size = size * 7 % 509
    rows = np.arange(number, min(number + size, total), dtype=float)
    # Every column tells the row's number, so that halves of two rows cannot pass for one.
    block = rows[:, None] * (1.0 + np.arange(width))
    number += ring_put_all(memory.row_counters, memory.rows, block)
"""


@pytest.mark.slow
@pytest.mark.parametrize("total", [100_000, pytest.param(1_000_000, marks=pytest.mark.nightly)])
def test_no_row_is_torn_lost_or_doubled_between_processes(tmp_path: Path, total: int) -> None:
    path = tmp_path / "ring"
    path.write_bytes(bytes(shared.shared_size()))
    with path.open("r+b") as file:
        memory = shared.shared_views(mmap.mmap(file.fileno(), shared.shared_size()))
    width = memory.rows.shape[1]
    out, seen, most = np.empty((4096, width)), 0, 0
    with subprocess.Popen([sys.executable, "-c", WRITER, str(path), str(total)]) as writer:
        while seen < total:
            count = ring_take(memory.row_counters, memory.rows, out)
            if count == 0:
                assert writer.poll() in (None, 0), "the writer died"
                continue
            expected = np.arange(seen, seen + count)[:, None] * (1.0 + np.arange(width))
            assert np.array_equal(out[:count], expected)
            seen, most = seen + count, max(most, count)
        assert writer.wait(60) == 0
    assert ring_take(memory.row_counters, memory.rows, out) == 0
    print(f"{seen} rows of {width} numbers whole and in order; at most {most} at once")
