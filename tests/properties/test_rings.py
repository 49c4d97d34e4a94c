"""A ring holds what a queue of bounded length holds, whatever is put and taken."""

from __future__ import annotations

from collections import deque

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from squeezefilm.instruments.session.loop.shared import (
    COUNTERS_SIZE,
    DROPPED,
    ring_put,
    ring_put_all,
    ring_take,
    ring_waiting,
)

CAPACITY, WIDTH = 8, 3
moves = st.lists(
    st.tuples(st.sampled_from(["put", "put_all", "take"]), st.integers(0, 11)), max_size=60
)


@given(moves, st.integers(0, 2**40))
def test_a_ring_is_a_bounded_queue_that_counts_what_it_drops(
    script: list[tuple[str, int]], begun: int
) -> None:
    counters, rows = np.zeros(COUNTERS_SIZE, dtype=np.int64), np.zeros((CAPACITY, WIDTH))
    counters[[0, 16]] = begun
    queue: deque[float] = deque()
    number, dropped = 0.0, 0
    for move, count in script:
        if move == "take":
            out = np.full((count, WIDTH), np.nan)
            got = ring_take(counters, rows, out)
            assert got == min(count, len(queue))
            expected = [queue.popleft() for _ in range(got)]
            assert out[:got, 0].tolist() == expected
            assert np.all(out[:got] == out[:got, :1])
            assert np.all(np.isnan(out[got:]))
            continue
        block = np.repeat(number + np.arange(count)[:, None], WIDTH, axis=1)
        number += count
        fits = min(count, CAPACITY - len(queue))
        if move == "put_all":
            assert ring_put_all(counters, rows, block) == fits
        else:
            assert [ring_put(counters, rows, row) for row in block] == [
                k < fits for k in range(count)
            ]
        queue.extend(block[:fits, 0])
        dropped += count - fits
        assert counters[DROPPED] == dropped
        assert ring_waiting(counters) == len(queue)
