"""Which columns of Saltelli's design are drawn to the end."""

from __future__ import annotations

import numpy as np

from squeezefilm.analysis.influences import followed


def _design(weights: list[float], rows: int) -> np.ndarray:
    """What an additive model gives on A, A with each column of B, B, and two mixtures."""
    random = np.random.default_rng(1)
    a, b = random.random((2, rows, len(weights)))
    columns = [a]
    for k in range(len(weights)):
        mixed = a.copy()
        mixed[:, k] = b[:, k]
        columns.append(mixed)
    return np.stack([one @ np.array(weights) for one in (*columns, b, a, b)], axis=1)


def test_inputs_that_explain_next_to_nothing_are_left() -> None:
    found = followed(_design([1.0, 0.001, 0.5, 0.0], 8))
    assert found.tolist() == [0, 1, 3, 5, 6, 7]


def test_rows_with_a_refused_draw_tell_nothing() -> None:
    frictions = _design([1.0, 0.001], 8)
    frictions[:7, 2] = np.nan
    frictions[7] = np.nan
    assert followed(frictions).tolist() == [0, 1, 2, 3, 4, 5]
