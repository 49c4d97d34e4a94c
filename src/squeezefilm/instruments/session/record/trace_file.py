"""The bytes of a trace: blocks that are whole or not there, whatever happens to the file.

A file begins with `SQFTRACE`, a version (u32) and the CRC-32 of both. Then come blocks, each
``marker, kind u32, number u32, length u32, payload, CRC-32 u32``, little-endian; the CRC covers
kind, number, length and payload. Numbers count up from 0, so that a reader knows what is missing,
and the marker lets it find the next block behind a damaged one. Block 0 is the metadata.

Payloads: metadata and events are UTF-8 JSON; rows are a u32, the count of columns, and float64
after float64, row by row; the closing block is two u64, the counts of blocks and of rows.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import IntEnum
from mmap import mmap

MAGIC = b"SQFTRACE"
VERSION = 1
MARKER = b"\xabSQ\x1a"
LONGEST_PAYLOAD = 1 << 20
"""Bytes of one block; longer rows are cut into several, so that a damaged one costs little."""

_PIECE = 1 << 26
"""Bytes that are searched at once: some hundredths of a second."""

_HEADER = struct.Struct("<8sII")
_BLOCK = struct.Struct("<4sIII")
_CRC = struct.Struct("<I")
ROW_HEAD = struct.Struct("<I")
CLOSING = struct.Struct("<QQ")
HEADER_SIZE = _HEADER.size


class BlockKind(IntEnum):
    """Kind of what a block carries."""

    METADATA = 1
    ROWS = 2
    EVENT = 3
    CLOSING = 4


@dataclass(frozen=True, slots=True)
class Block:
    """A whole block: what it carries, its number, and where its payload lies in the file."""

    kind: BlockKind
    number: int
    start: int
    length: int


@dataclass(frozen=True, slots=True)
class TraceGap:
    """Bytes of a file, from `start` to before `end`, that belong to no whole block."""

    start: int
    end: int


def file_header() -> bytes:
    """The first bytes of a trace."""
    head = struct.pack("<8sI", MAGIC, VERSION)
    return head + _CRC.pack(zlib.crc32(head))


def block_bytes(kind: BlockKind, number: int, payload: bytes) -> bytes:
    """Bytes of a block as it stands in the file. `payload` has at most `LONGEST_PAYLOAD` bytes."""
    head = _BLOCK.pack(MARKER, kind, number & 0xFFFFFFFF, len(payload))
    crc = zlib.crc32(payload, zlib.crc32(head[len(MARKER) :]))
    return head + payload + _CRC.pack(crc)


def header_version(data: bytes | mmap) -> int | None:
    """The version that a file's header gives, or None where the header is missing or damaged."""
    if len(data) < HEADER_SIZE:
        return None
    magic, version, crc = _HEADER.unpack(data[:HEADER_SIZE])
    if magic != MAGIC or zlib.crc32(data[: HEADER_SIZE - _CRC.size]) != crc:
        return None
    return int(version)


def blocks(
    data: bytes | mmap, looked_at: Callable[[int], object] = lambda _: None
) -> Iterator[Block | TraceGap]:
    """Every whole block in the order of the file, and the gaps between them. Raises nothing.

    A block is believed only by its CRC, so it does not matter what the bytes before it were.
    `looked_at` is told, time and again, how many bytes were gone through.
    """
    at = HEADER_SIZE if header_version(data) is not None else 0
    lost_from = at
    while True:
        marker = _marker(data, at, looked_at)
        if marker < 0:
            break
        block = _block_at(data, marker)
        if block is None:
            at = marker + 1
            continue
        if marker > lost_from:
            yield TraceGap(lost_from, marker)
        yield block
        at = lost_from = block.start + block.length + _CRC.size
    if len(data) > lost_from:
        yield TraceGap(lost_from, len(data))


def _marker(data: bytes | mmap, at: int, looked_at: Callable[[int], object]) -> int:
    """The place of the next marker from `at` on; -1 for none. In pieces, between which Ctrl-C is
    heard: a file may have any length without one."""
    while at < len(data):
        looked_at(at)
        place = data.find(MARKER, at, at + _PIECE + len(MARKER) - 1)
        if place >= 0:
            return place
        at += _PIECE
    return -1


def _block_at(data: bytes | mmap, at: int) -> Block | None:
    start = at + _BLOCK.size
    if start > len(data):
        return None
    _, kind, number, length = _BLOCK.unpack(data[at:start])
    end = start + length
    if length > LONGEST_PAYLOAD or end + _CRC.size > len(data) or kind not in _KINDS:
        return None
    (crc,) = _CRC.unpack(data[end : end + _CRC.size])
    if zlib.crc32(data[at + len(MARKER) : end]) != crc:
        return None
    return Block(BlockKind(kind), number, start, length)


_KINDS = frozenset(int(kind) for kind in BlockKind)
