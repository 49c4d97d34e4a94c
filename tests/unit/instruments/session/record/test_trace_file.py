"""The bytes of a trace, where a file begins in an unusual way."""

from __future__ import annotations

from squeezefilm.instruments.session.record.trace_file import (
    HEADER_SIZE,
    Block,
    BlockKind,
    TraceGap,
    block_bytes,
    blocks,
    file_header,
    header_version,
)

METADATA = block_bytes(BlockKind.METADATA, 0, b"{}")
ROWS = block_bytes(BlockKind.ROWS, 1, bytes(20))


def kinds(data: bytes) -> list[BlockKind | tuple[int, int]]:
    return [
        found.kind if isinstance(found, Block) else (found.start, found.end)
        for found in blocks(data)
    ]


def test_a_first_block_at_byte_0_is_found_without_a_gap_before_it() -> None:
    # The header was lost whole: what is left begins with a block.
    assert header_version(METADATA + ROWS) is None
    assert kinds(METADATA + ROWS) == [BlockKind.METADATA, BlockKind.ROWS]


def test_a_damaged_header_is_a_gap_and_costs_no_block() -> None:
    header = bytearray(file_header())
    assert kinds(bytes(header) + METADATA) == [BlockKind.METADATA]
    header[3] ^= 1
    assert kinds(bytes(header) + METADATA) == [(0, HEADER_SIZE), BlockKind.METADATA]


def test_what_is_behind_the_last_block_is_a_gap() -> None:
    data = file_header() + METADATA + b"half"
    last = list(blocks(data))[-1]
    assert last == TraceGap(len(data) - 4, len(data))
    assert list(blocks(b"")) == []
