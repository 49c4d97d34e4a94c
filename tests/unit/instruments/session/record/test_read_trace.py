"""What is read of a trace's bytes, made block by block, and what is said of what is missing."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.instruments.session.record.trace import Damage, Trace, TraceEvent, read_trace
from squeezefilm.instruments.session.record.trace_file import (
    VERSION,
    BlockKind,
    block_bytes,
    file_header,
)

METADATA = {"columns": ["time_s", "x_m"], "display": "glass", "texture": "sine"}
UNCLOSED = (
    "the record was not closed: the program ended before; all that was acknowledged and not "
    "damaged since is here"
)


class Made:
    """Blocks one after the other, numbered from 0."""

    def __init__(self, header: bytes | None = None) -> None:
        self.data = file_header() if header is None else header
        self.number = 0

    def block(self, kind: BlockKind, payload: bytes) -> Made:
        self.data += block_bytes(kind, self.number, payload)
        self.number += 1
        return self

    def said(self, kind: BlockKind, value: Any) -> Made:
        return self.block(kind, json.dumps(value).encode())

    def metadata(self) -> Made:
        return self.said(BlockKind.METADATA, METADATA)

    def rows(self, values: Any, width: int | None = None) -> Made:
        table = np.asarray(values, dtype="<f8")
        head = struct.pack("<I", table.shape[1] if width is None else width)
        return self.block(BlockKind.ROWS, head + table.tobytes())

    def closed(self) -> Made:
        return self.block(BlockKind.CLOSING, struct.pack("<QQ", self.number + 1, 0))

    def lost(self, blocks: int = 1) -> Made:
        self.number += blocks
        return self

    def torn(self, count: int) -> Made:
        self.data += b"\x00" * count
        return self

    def read(self, folder: Path) -> Trace:
        file = folder / "trace.sqft"
        file.write_bytes(self.data)
        return read_trace(file)


def test_a_whole_trace_is_read_with_nothing_missing(tmp_path: Path) -> None:
    one, two = [[0.5, 1.0], [0.75, 2.0]], [[2.0, np.nan]]
    made = Made().metadata().rows(one)
    made.said(BlockKind.EVENT, {"kind": "fault", "row": 2, "fields": {"name": "heat"}})
    found = made.rows(two).closed().read(tmp_path)
    assert found.columns == ("time_s", "x_m")
    np.testing.assert_array_equal(found.rows, [*one, *two])
    np.testing.assert_array_equal(found.column("x_m"), [1.0, 2.0, np.nan])
    assert found.events == (TraceEvent("fault", {"name": "heat"}, 2),)
    assert (found.display, found.texture) == ("glass", "sine")
    assert (found.row_count, found.duration) == (3, 1.5)
    assert found.damage == Damage(0, 0, True, ())
    assert found.damage.whole
    assert found.summary() == {
        "columns": ["time_s", "x_m"], "rows": 3, "duration_s": 1.5,
        "events": [{"kind": "fault", "row": 2, "name": "heat"}], "damage": [],
        "metadata": METADATA,
    }  # fmt: skip
    with pytest.raises(InputError, match="no column 'y_m'; there are time_s, x_m"):
        found.column("y_m")


def test_a_trace_is_shown_by_where_it_is_from_and_how_long_it_is(tmp_path: Path) -> None:
    found = Made().metadata().rows([[0.0, 1.0], [2.5, 2.0]]).closed().read(tmp_path)
    for word in ("glass", "sine", "2.5"):
        assert word in repr(found)
    frame = found._table()
    assert list(frame) == ["time_s", "x_m"]
    np.testing.assert_array_equal(frame["x_m"], [1.0, 2.0])


def test_a_trace_that_says_little_claims_nothing(tmp_path: Path) -> None:
    other = {"columns": ["tick", "x_m"]}
    found = Made().said(BlockKind.METADATA, other).rows([[1.0, 2.0]]).read(tmp_path)
    assert (found.display, found.texture, found.duration) == ("", "", 0.0)
    empty = Made().metadata().read(tmp_path)
    assert (empty.row_count, empty.duration) == (0, 0.0)
    assert empty.rows.shape == (0, 2)
    assert empty.damage.sentences == (UNCLOSED,)
    assert not empty.damage.whole


def test_events_that_say_too_little_get_what_is_known(tmp_path: Path) -> None:
    made = Made().metadata().rows([[0.0, 0.0]] * 3)
    for said in ({}, {"kind": 7, "row": "x", "fields": [1]}, {"kind": "a", "row": 1}):
        made.said(BlockKind.EVENT, said)
    found = made.closed().read(tmp_path)
    assert found.events == (
        TraceEvent("", {}, 3), TraceEvent("7", {}, 3), TraceEvent("a", {}, 1),
    )  # fmt: skip


@pytest.mark.parametrize("lost", [1, 4])
def test_what_is_missing_by_number_and_by_bytes_is_said(tmp_path: Path, lost: int) -> None:
    made = Made().metadata().rows([[0.0, 1.0]]).lost(lost)
    start = len(made.data)
    made.torn(20).rows([[1.0, 2.0]]).closed()
    found = made.read(tmp_path)
    assert found.row_count == 2
    assert (found.damage.lost_bytes, found.damage.lost_blocks) == (20, lost)
    assert found.damage.sentences == (
        f"{lost} blocks are missing by their numbers",
        f"bytes {start} to {start + 19} belong to no whole block",
    )
    assert not found.damage.whole


@pytest.mark.parametrize("gaps", [5, 6, 8])
def test_of_many_gaps_five_are_named(tmp_path: Path, gaps: int) -> None:
    made = Made().metadata()
    for _ in range(gaps):
        made.torn(3).rows([[0.0, 0.0]])
    said = made.closed().read(tmp_path).damage.sentences
    assert len([one for one in said if "belong to no whole block" in one]) == 5
    others = [one for one in said if one.startswith("and ")]
    assert others == ([] if gaps == 5 else [f"and {gaps - 5} more such places"])
    assert made.read(tmp_path).damage.lost_bytes == 3 * gaps


def test_a_block_that_comes_again_is_not_taken_twice(tmp_path: Path) -> None:
    made = Made().metadata().rows([[0.0, 1.0]])
    made.number = 1
    found = made.rows([[5.0, 6.0]]).closed().read(tmp_path)
    np.testing.assert_array_equal(found.rows, [[0.0, 1.0]])
    assert found.damage.lost_blocks == 0
    assert found.damage.sentences == (
        "1 blocks are whole but say nothing this program understands",
    )


@pytest.mark.parametrize(
    "payload",
    [
        b"", b"\x02\0\0", struct.pack("<I", 2), struct.pack("<I", 0) + b"\0" * 16,
        struct.pack("<I", 2) + b"\0" * 17, struct.pack("<I", 2) + b"\0" * 8,
    ],
)  # fmt: skip
def test_rows_that_are_no_table_are_counted_and_left_out(tmp_path: Path, payload: bytes) -> None:
    made = Made().metadata().block(BlockKind.ROWS, payload).rows([[1.0, 2.0]])
    made.said(BlockKind.EVENT, {"kind": "a"})
    found = made.closed().read(tmp_path)
    np.testing.assert_array_equal(found.rows, [[1.0, 2.0]])
    assert found.events[0].row == 1
    assert found.damage.sentences == (
        "1 blocks are whole but say nothing this program understands",
    )


def test_rows_of_another_width_are_left_out(tmp_path: Path) -> None:
    made = Made().metadata().rows([[1.0, 2.0, 3.0]]).rows([[1.0, 2.0]]).rows([[4.0]])
    found = made.closed().read(tmp_path)
    np.testing.assert_array_equal(found.rows, [[1.0, 2.0]])
    assert found.damage.sentences == (
        "2 blocks are whole but say nothing this program understands",
    )


@pytest.mark.parametrize("payload", [b"{", b"[1]", b"\xff", b"[" * 20_000])
def test_words_that_are_none_are_counted(tmp_path: Path, payload: bytes) -> None:
    made = Made().block(BlockKind.METADATA, payload).block(BlockKind.EVENT, payload)
    found = made.rows([[1.0, 2.0]]).closed().read(tmp_path)
    # Without metadata the columns have numbers for names.
    assert found.columns == ("column_1", "column_2")
    np.testing.assert_array_equal(found.rows, [[1.0, 2.0]])
    assert found.events == ()
    assert found.damage.sentences == (
        "the metadata are lost, and with them the columns' names",
        "2 blocks are whole but say nothing this program understands",
    )


@pytest.mark.parametrize("columns", [[], "time_s", None, {"a": 1}])
def test_columns_that_are_no_list_of_names_are_numbered(tmp_path: Path, columns: Any) -> None:
    made = Made().said(BlockKind.METADATA, {"columns": columns}).rows([[1.0, 2.0, 3.0]]).closed()
    found = made.read(tmp_path)
    assert found.columns == ("column_1", "column_2", "column_3")
    assert found.row_count == 1
    assert found.damage.whole


def test_a_header_that_is_damaged_or_newer_is_said_and_the_rest_is_read(tmp_path: Path) -> None:
    import zlib

    head = struct.pack("<8sI", b"SQFTRACE", VERSION + 1)
    newer = Made(head + struct.pack("<I", zlib.crc32(head)))
    found = newer.metadata().rows([[1.0, 2.0]]).closed().read(tmp_path)
    assert found.row_count == 1
    assert found.damage.sentences == (
        f"the file is of version {VERSION + 1}; this program reads {VERSION}",
    )
    broken = Made(b"SQFTRACE" + b"\0" * 8).metadata().rows([[1.0, 2.0]]).closed().read(tmp_path)
    assert broken.row_count == 1
    assert broken.damage.sentences == (
        "the file's header is missing or damaged", "bytes 0 to 15 belong to no whole block",
    )  # fmt: skip


def test_an_empty_file_is_no_trace_and_no_error(tmp_path: Path) -> None:
    (tmp_path / "trace.sqft").write_bytes(b"")
    found = read_trace(tmp_path / "trace.sqft")
    assert found.rows.shape == (0, 0)
    assert found.columns == found.events == ()
    assert found.damage.sentences == (
        "the file's header is missing or damaged",
        "the metadata are lost, and with them the columns' names",
        UNCLOSED,
    )
    with pytest.raises(InputError, match=r"none\.sqft"):
        read_trace(tmp_path / "none.sqft")
    with pytest.raises(InputError):
        read_trace(tmp_path)


def test_a_file_that_cannot_be_mapped_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from squeezefilm.instruments.session.record import trace

    def refused(*_: Any, **__: Any) -> None:
        raise OSError("no memory to map it")

    (tmp_path / "trace.sqft").write_bytes(file_header())
    monkeypatch.setattr(trace.mmap, "mmap", refused)
    with pytest.raises(InputError, match=r"cannot read the trace .*trace\.sqft: no memory to map"):
        read_trace(tmp_path / "trace.sqft")
