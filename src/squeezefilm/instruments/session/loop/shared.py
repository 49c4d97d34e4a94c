"""The memory that a loop and its host share: control words, a histogram and three rings.

One stretch of memory, mapped by both. Control words are int64 on cache lines of their own; each is
written by one side only. An aligned 64-bit word is read whole or not at all on x86-64 and ARM64;
what must be ordered (rings, PHASE) goes through `atomics`.
"""

from __future__ import annotations

import mmap
from typing import Any, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.instruments.session.loop import lateness, ring, rows

_LINE = 8
# Written by the host.
STOP, MUTE, HOST_BEAT, EPOCH = (place * _LINE for place in range(4))
# Written by the loop: how far it is, what it did, and what it was given.
(PHASE, BEAT, NEXT, LOST, LONGEST, SPUN, CPU, REFUSED, REALTIME, LOCKED, PACING) = (
    place * _LINE for place in range(4, 15)
)
CONTROL_SIZE = 16 * _LINE

PHASE_NEW, PHASE_READY, PHASE_GO, PHASE_ENDED = range(4)
PACING_COMPILED, PACING_PORTABLE = 1, 2

SAMPLES, COMMANDS, ROWS = 8192, 4096, 32768
"""Rows that each ring holds; at 10 kHz 0.8 s of samples, 0.4 s of commands, 3.3 s of rows."""

_RINGS = (
    (SAMPLES, len(rows.SAMPLE_COLUMNS)),
    (COMMANDS, len(rows.COMMAND_COLUMNS)),
    (ROWS, len(rows.COLUMNS)),
)


class Shared(NamedTuple):
    """Views of the shared memory. A plain tuple of arrays, so that compiled code can take it."""

    control: si.Array
    histogram: si.Array
    sample_counters: si.Array
    samples: si.Array
    command_counters: si.Array
    commands: si.Array
    row_counters: si.Array
    rows: si.Array


def shared_size() -> int:
    """Number of bytes that the shared memory takes."""
    words = CONTROL_SIZE + lateness.CLASSES
    words += sum(ring.COUNTERS_SIZE + capacity * width for capacity, width in _RINGS)
    # The histogram's length need not end a cache line; what follows it begins a new one.
    return 8 * (words + 2 * _LINE)


def shared_views(memory: mmap.mmap | bytearray) -> Shared:
    """The parts of a stretch of `shared_size` bytes, zeros at first."""
    place = 0

    def part(kind: Any, *shape: int) -> si.Array:
        nonlocal place
        array = np.frombuffer(memory, kind, int(np.prod(shape)), place).reshape(shape)
        place += -(-array.nbytes // 64) * 64
        return array

    control = part(np.int64, CONTROL_SIZE)
    histogram = part(np.int64, lateness.CLASSES)
    rings = []
    for capacity, width in _RINGS:
        rings += [part(np.int64, ring.COUNTERS_SIZE), part(np.float64, capacity, width)]
    return Shared(control, histogram, *rings)


def private_views() -> Shared:
    """The same parts in memory of this process alone."""
    return shared_views(bytearray(shared_size()))
