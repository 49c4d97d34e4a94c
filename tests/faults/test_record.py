"""A record under faults: a killed writer, a cut or damaged file, a disk that is full."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core.errors import InputError, RecordError
from squeezefilm.instruments.session.record import trace_file
from squeezefilm.instruments.session.record.trace import Trace, read_trace
from squeezefilm.instruments.session.record.trace_file import TraceWriter

COLUMNS = ("tick", "x_m", "level_V")

WRITER = """
import os, sys
import numpy as np
from squeezefilm.instruments.session.record import trace_file

trace_file.SYNC_PERIOD = 0.01
path, seed = sys.argv[1], int(sys.argv[2])
random = np.random.default_rng(seed)
writer = trace_file.TraceWriter(path, ("tick", "x_m", "level_V"), {"seed": seed})
row = 0
while True:
    count = int(random.integers(1, 200))
    ticks = np.arange(row, row + count, dtype=float)
    row = writer.append(np.column_stack([ticks, 2 * ticks, -ticks]))
    os.write(1, row.to_bytes(8, "little"))
    if random.random() < 0.1:
        writer.event("mark", {"row": row})
"""


def rows_of(count: int, first: int = 0) -> np.ndarray:
    ticks = np.arange(first, first + count, dtype=float)
    return np.column_stack([ticks, 2 * ticks, -ticks])


def killed_at_random(folder: Path, seed: int) -> tuple[int, Trace]:
    path = folder / f"{seed}.sqft"
    chance = random.Random(seed)
    child = subprocess.Popen(
        [sys.executable, "-c", WRITER, str(path), str(seed)], stdout=subprocess.PIPE
    )
    assert child.stdout is not None
    told = child.stdout.read(8 * chance.randint(1, 40))
    # A pause of a random length, so that the kill falls anywhere within a write.
    for _ in range(chance.randrange(20_000)):
        pass
    os.kill(child.pid, signal.SIGKILL)
    told += child.stdout.read()
    child.wait()
    child.stdout.close()
    whole = len(told) // 8 * 8
    acknowledged = int.from_bytes(told[whole - 8 : whole], "little")
    return acknowledged, read_trace(path)


def kills(folder: Path, count: int) -> None:
    most = 0
    for seed in range(count):
        acknowledged, trace = killed_at_random(folder, seed)
        assert acknowledged > 0
        assert len(trace.rows) >= acknowledged
        np.testing.assert_array_equal(trace.rows, rows_of(len(trace.rows)))
        assert not trace.damage.closed
        assert not trace.damage.lost_blocks
        most = max(most, acknowledged)
    print(f"{count} kills, up to {most} rows acknowledged, none lost")


@pytest.mark.slow
def test_a_killed_writer_loses_nothing_it_acknowledged(tmp_path: Path) -> None:
    kills(tmp_path, 12)


@pytest.mark.nightly
def test_two_hundred_killed_writers_lose_nothing_they_acknowledged(tmp_path: Path) -> None:
    kills(tmp_path, 200)


def small_trace(path: Path, blocks: int = 5, rows: int = 3) -> bytes:
    with TraceWriter(path, COLUMNS, {"seed": 7}) as writer:
        for block in range(blocks):
            writer.append(rows_of(rows, block * rows))
            writer.event("mark", {"block": block})
    return path.read_bytes()


def test_a_trace_comes_back_as_it_was_written(tmp_path: Path) -> None:
    small_trace(tmp_path / "whole.sqft")
    trace = read_trace(tmp_path / "whole.sqft")
    assert trace.damage.whole
    assert trace.damage.sentences == ()
    assert trace.columns == COLUMNS
    assert trace.metadata["seed"] == 7
    np.testing.assert_array_equal(trace.rows, rows_of(15))
    assert [event.row for event in trace.events] == [3, 6, 9, 12, 15]
    assert trace.events[2].fields == {"block": 2}


def test_a_trace_cut_at_any_byte_keeps_every_whole_block(tmp_path: Path) -> None:
    data = small_trace(tmp_path / "whole.sqft")
    ends = [
        part.start + part.length + 4
        for part in trace_file.blocks(data)
        if isinstance(part, trace_file.Block) and part.kind is trace_file.BlockKind.ROWS
    ]
    cut = tmp_path / "cut.sqft"
    for size in range(len(data)):
        cut.write_bytes(data[:size])
        trace = read_trace(cut)
        whole = sum(end <= size for end in ends)
        assert len(trace.rows) == 3 * whole
        if whole:
            np.testing.assert_array_equal(trace.rows, rows_of(3 * whole))
        assert not trace.damage.closed
        assert trace.damage.sentences


def test_a_flipped_bit_costs_its_own_block_and_is_told(tmp_path: Path) -> None:
    data = small_trace(tmp_path / "whole.sqft", blocks=3)
    hurt = tmp_path / "hurt.sqft"
    chance = random.Random(3)
    for at in range(len(data)):
        changed = bytearray(data)
        changed[at] ^= 1 << chance.randrange(8)
        hurt.write_bytes(changed)
        trace = read_trace(hurt)
        assert trace.damage.sentences
        assert trace.columns == COLUMNS, "the metadata stand twice"
        assert len(trace.rows) + len(trace.events) >= 9 + 3 - 3
        # What is left is what was written: a block's rows are all there or none is.
        starts = trace.column("tick")
        assert set(starts.tolist()) <= set(range(9))
        np.testing.assert_array_equal(trace.column("x_m"), 2 * starts)
        for block in range(3):
            assert np.count_nonzero((starts // 3) == block) in (0, 3)


def test_noise_in_the_middle_costs_what_it_covers(tmp_path: Path) -> None:
    data = small_trace(tmp_path / "whole.sqft", blocks=50, rows=8)
    noise = np.random.default_rng(5)
    hurt = tmp_path / "hurt.sqft"
    for _ in range(60):
        start = int(noise.integers(0, len(data) - 400))
        changed = bytearray(data)
        changed[start : start + 400] = noise.bytes(400)
        hurt.write_bytes(changed)
        trace = read_trace(hurt)
        assert len(trace.rows) >= 400 - 8 * 5
        assert trace.damage.lost_bytes >= 400 or start < trace_file.HEADER_SIZE
        np.testing.assert_array_equal(trace.column("level_V"), -trace.column("tick"))


@pytest.mark.parametrize("content", [b"", b"SQFT", b"\0" * 5000, trace_file.MARKER * 4000])
def test_a_file_that_is_no_trace_is_read_as_one_that_lost_all(
    tmp_path: Path, content: bytes
) -> None:
    (tmp_path / "none.sqft").write_bytes(content)
    trace = read_trace(tmp_path / "none.sqft")
    assert trace.rows.size == 0
    assert "header" in trace.damage.sentences[0]
    assert trace.damage.lost_bytes == len(content)


def test_a_file_that_is_not_there_is_the_callers_mistake(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_trace(tmp_path / "none.sqft")


LIMITED = """
import resource, sys
import numpy as np
from squeezefilm.core.errors import RecordError
from squeezefilm.instruments.session.record.trace_file import TraceWriter

resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, resource.RLIM_INFINITY))
writer = TraceWriter(sys.argv[1], ("tick", "x_m", "level_V"), {})
try:
    while True:
        ticks = np.arange(writer.acknowledged, writer.acknowledged + 37, dtype=float)
        writer.append(np.column_stack([ticks, 2 * ticks, -ticks]))
except RecordError as error:
    print(writer.acknowledged, error)
resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
writer.append(np.array([[-1.0, -2.0, 1.0]]))
writer.close()
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no limit on a file's size")
def test_a_file_that_may_not_grow_ends_with_its_last_acknowledged_row(tmp_path: Path) -> None:
    path = tmp_path / "full.sqft"
    done = subprocess.run(
        [sys.executable, "-c", LIMITED, str(path)], capture_output=True, text=True, check=True
    )
    acknowledged, message = done.stdout.split(" ", 1)
    assert "rows are acknowledged" in message
    trace = read_trace(path)
    assert trace.damage.whole, "half a block is taken back, so that writing could go on"
    np.testing.assert_array_equal(trace.rows[:-1], rows_of(int(acknowledged)))
    assert trace.rows[-1, 0] == -1


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_full_disk_is_told_and_acknowledges_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # By a link: a fault that takes the file away, and a test run as root, would take the device.
    full = tmp_path / "full.sqft"
    full.symlink_to("/dev/full")
    opened = os.open
    monkeypatch.setattr(os, "open", lambda p, how, *more: opened(p, how & ~os.O_EXCL, *more))
    with pytest.raises(RecordError, match=r"No space left on device; 0 rows are acknowledged"):
        TraceWriter(full, COLUMNS, {})


def test_a_record_is_never_written_over(tmp_path: Path) -> None:
    small_trace(tmp_path / "one.sqft")
    with pytest.raises(RecordError, match="never written over"):
        TraceWriter(tmp_path / "one.sqft", COLUMNS, {})
