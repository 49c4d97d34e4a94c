"""A ring of rows between one writer and one reader, in two processes if wished; it never waits.

The writer fills a row and then raises HEAD with release; the reader sees HEAD with acquire, copies
and then raises TAIL with release. So a row that is seen is whole, on x86-64 and on ARM64, and a
process killed at any instruction leaves a ring that the other can go on with: a row half written
was never published, a row half read is read again. Both sides must go through these functions.
A full ring takes no more rows; the row is dropped and counted. HEAD and TAIL only grow and do not
wrap within the life of anything (2^63 rows).
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled

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
