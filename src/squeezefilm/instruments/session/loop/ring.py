"""A ring of rows between one writer and one reader, in two processes if wished; it never waits.

The writer fills a row and then raises HEAD with release; the reader sees HEAD with acquire, copies
and then raises TAIL with release. So a row that is seen is whole, on x86-64 and on ARM64, and a
process killed at any instruction leaves a ring that the other can go on with: a row half written
was never published, a row half read is read again. Both sides must go through these functions.
A full ring takes no more rows; the row is dropped and counted. HEAD and TAIL only grow and do not
wrap within the life of anything (2^63 rows).
"""

from __future__ import annotations

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.instruments.session.loop.atomics import load_acquire, store_release

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
