"""The memory that a loop and its host share: control words, a histogram of lateness,
three rings of rows.

One stretch of memory, mapped by both. Control words are int64 on cache lines of their own; each is
written by one side only. An aligned 64-bit word is read whole or not at all on x86-64 and ARM64;
what must be ordered (rings, PHASE) goes through `load_acquire` and `store_release`.

A ring has one writer and one reader, in two processes if wished, and never waits. The writer fills
a row and then raises HEAD with release; the reader sees HEAD with acquire, copies and then raises
TAIL with release. So a row that is seen is whole, and a process killed at any instruction leaves a
ring that the other can go on with: a row half written was never published, a row half read is read
again. A full ring takes no more rows; the row is dropped and counted. HEAD and TAIL only grow and
do not wrap within the life of anything (2^63 rows).
"""

from __future__ import annotations

import math
import mmap
from dataclasses import dataclass
from typing import Any, NamedTuple

import numba
import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.core.results import to_json
from squeezefilm.instruments.session.loop.rows import COLUMNS, COMMAND_COLUMNS, SAMPLE_COLUMNS

CLASSES_PER_DECADE = 20
_DECADES = 8
_FIRST_NS = 100.0
CLASSES = CLASSES_PER_DECADE * _DECADES + 2
"""Classes of the histogram: below 100 ns, 20 per decade up to 10 s, and above."""


@compiled()
def lateness_class(late: float) -> int:
    """The class of the histogram that a lateness (ns) falls into."""
    if not late >= _FIRST_NS:
        return 0
    return min(1 + int(CLASSES_PER_DECADE * math.log10(late / _FIRST_NS)), CLASSES - 1)


def class_ends() -> si.SecondArray:
    """The upper end of every class (s), the last infinite; shape (CLASSES,)."""
    decades = np.arange(CLASSES - 1) / CLASSES_PER_DECADE
    return np.append(_FIRST_NS * 1e-9 * 10.0**decades, math.inf)


@dataclass(frozen=True, slots=True, eq=False)
class Lateness:
    """Lateness of ticks, and the number of those that were not made at all.

    A tick is late by the time from when it was due to when it was begun. One that could not begin
    before the next was due is lost: it is not made up for, and stands in no class.

    Attributes:
        rate: of the ticks (Hz).
        made, lost: ticks; together those that were due.
        longest: greatest time by which the loop was late at any moment (s), those that cost ticks
            included.
        counts: ticks made in each class, see `class_ends`.
    """

    rate: si.Hertz
    made: int
    lost: int
    longest: si.Second
    counts: NDArray[np.int64]

    @property
    def share_made(self) -> si.Dimensionless:
        """Share of the ticks due that were made (1); not a number before the first."""
        due = self.made + self.lost
        return self.made / due if due else math.nan

    def quantile(self, share: si.Dimensionless) -> si.Second:
        """The lateness (s) that a share of the ticks made did not exceed; NaN if none was made.

        The upper end of its class, at most 12 % too high; never above `longest`.
        """
        if self.made == 0:
            return math.nan
        place = int(np.searchsorted(np.cumsum(self.counts), math.ceil(share * self.made)))
        return min(float(class_ends()[place]), self.longest)

    def to_json(self) -> dict[str, Any]:
        """Plain JSON values: the fields, and the figures that people ask for."""
        values: dict[str, Any] = to_json(self)
        figures: dict[str, float] = {
            "share_made": self.share_made,
            "p50_s": self.quantile(0.5),
            "p99_s": self.quantile(0.99),
            "p99_9_s": self.quantile(0.999),
        }
        return {**values, **to_json(figures)}


# A number written with `store_release` and seen by `load_acquire`, in any process that maps the
# same memory, makes everything visible that the writer wrote before it. Compiled, they are LLVM's
# atomic load and store with these orderings: plain instructions on x86-64, `ldar` and `stlr` on
# ARM64, and neither compiler nor processor moves rows across them. Interpreted (with
# NUMBA_DISABLE_JIT, for debugging) they are plain accesses, which are ordered so on x86-64 only.
_INT64_BYTES = 8
_item_pointer: Any = cgutils.get_item_pointer


def _place(context: Any, builder: Any, kind: Any, array: Any, index: Any, index_type: Any) -> Any:
    """The address of one item of an array of 64-bit whole numbers."""
    view = context.make_array(kind)(context, builder, array)
    whole = context.cast(builder, index, index_type, types.intp)
    return _item_pointer(context, builder, kind, view, [whole])


@intrinsic
def _load_acquire(typing_context: Any, array: Any, index: Any) -> Any:
    def codegen(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kind, index_type = signature.args
        place = _place(context, builder, kind, values[0], values[1], index_type)
        return builder.load_atomic(place, "acquire", _INT64_BYTES)

    return types.int64(array, index), codegen


@intrinsic
def _store_release(typing_context: Any, array: Any, index: Any, value: Any) -> Any:
    def codegen(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kind, index_type, _ = signature.args
        place = _place(context, builder, kind, values[0], values[1], index_type)
        builder.store_atomic(values[2], place, "release", _INT64_BYTES)
        return context.get_dummy_value()

    return types.void(array, index, types.int64), codegen


if numba.config.DISABLE_JIT:  # type: ignore[attr-defined]

    def load_acquire(array: si.Array, index: int) -> int:
        """`array[index]`, interpreted."""
        return int(array[index])

    def store_release(array: si.Array, index: int, value: int) -> None:
        """`array[index] = value`, interpreted."""
        array[index] = value

else:

    @compiled()
    def load_acquire(array: si.Array, index: int) -> int:
        """`array[index]` of an int64 array; no later access is done before it."""
        return _load_acquire(array, index)  # type: ignore[call-arg]

    @compiled()
    def store_release(array: si.Array, index: int, value: int) -> None:
        """`array[index] = value` in an int64 array; no earlier access is done after it."""
        _store_release(array, index, value)  # type: ignore[call-arg]


# Written by the writer (HEAD, DROPPED) and by the reader (TAIL), on cache lines of their own.
HEAD, DROPPED, TAIL = 0, 1, 16
COUNTERS_SIZE = 32


@compiled()
def ring_put(counters: si.Array, rows: si.Array, row: si.Array) -> bool:
    """Append a row; False, and one more dropped, if the ring is full.

    `rows` has the shape (capacity, width), its capacity a power of two; `row` (width,).
    """
    head = counters[HEAD]
    if head - load_acquire(counters, TAIL) >= rows.shape[0]:
        counters[DROPPED] += 1
        return False
    slot = head & (rows.shape[0] - 1)
    for column in range(rows.shape[1]):
        rows[slot, column] = row[column]
    store_release(counters, HEAD, head + 1)
    return True


@compiled()
def ring_take(counters: si.Array, rows: si.Array, out: si.Array) -> int:
    """Move the oldest rows into `out`, shape (n, width); returns how many, at most n."""
    tail = counters[TAIL]
    count = min(load_acquire(counters, HEAD) - tail, out.shape[0])
    for k in range(count):
        slot = (tail + k) & (rows.shape[0] - 1)
        for column in range(rows.shape[1]):
            out[k, column] = rows[slot, column]
    store_release(counters, TAIL, tail + count)
    return int(count)


@compiled()
def ring_put_all(counters: si.Array, rows: si.Array, block: si.Array) -> int:
    """Append the rows of a block, shape (n, width), as far as they fit; returns how many did."""
    for k in range(block.shape[0]):
        if not ring_put(counters, rows, block[k]):
            counters[DROPPED] += block.shape[0] - k - 1
            return k
    return int(block.shape[0])


@compiled()
def ring_waiting(counters: si.Array) -> int:
    """Number of rows that wait to be read."""
    return int(load_acquire(counters, HEAD) - load_acquire(counters, TAIL))


def taken(counters: si.Array, rows: si.Array) -> si.FloatArray:
    """All rows that wait in a ring."""
    out = np.empty((ring_waiting(counters), rows.shape[1]))
    return out[: ring_take(counters, rows, out)]


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
    (SAMPLES, len(SAMPLE_COLUMNS)),
    (COMMANDS, len(COMMAND_COLUMNS)),
    (ROWS, len(COLUMNS)),
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
    words = CONTROL_SIZE + CLASSES
    words += sum(COUNTERS_SIZE + capacity * width for capacity, width in _RINGS)
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
    histogram = part(np.int64, CLASSES)
    rings = []
    for capacity, width in _RINGS:
        rings += [part(np.int64, COUNTERS_SIZE), part(np.float64, capacity, width)]
    return Shared(control, histogram, *rings)


def private_views() -> Shared:
    """The same parts in memory of this process alone."""
    return shared_views(bytearray(shared_size()))
