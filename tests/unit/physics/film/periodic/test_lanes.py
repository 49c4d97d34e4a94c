"""Eight doubles at once: each operation, lane by lane, against NumPy; one compile for all."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit

from squeezefilm.physics.film.periodic.lanes import (
    LANES,
    add,
    broadcast,
    div,
    fma,
    largest_magnitude,
    load,
    mul,
    peak,
    store,
    sub,
    total,
)

NAMES = ("copy", "all", "add", "sub", "mul", "div", "fma", "largest")


@njit
def _every(a: np.ndarray, b: np.ndarray, c: np.ndarray, out: np.ndarray) -> tuple[float, float]:
    one, two, three = load(a, 1), load(b, 2), load(c, 0)
    store(out, 1, one)
    store(out, 9, broadcast(a[3]))
    store(out, 17, add(one, two))
    store(out, 25, sub(one, two))
    store(out, 33, mul(one, two))
    store(out, 41, div(one, two))
    store(out, 49, fma(one, two, three))
    store(out, 57, largest_magnitude(one, two))
    return total(two), peak(two)


def run(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> tuple[dict[str, np.ndarray], float, float]:
    """The lanes of all operations on a[1:9], b[2:10] and c[0:8], and the sum and peak of b's."""
    out = np.full(66, -7.0)
    summed, highest = _every(a, b, c, out)
    # Not a lane beyond those asked for is written.
    assert out[0] == out[65] == -7.0
    return dict(zip(NAMES, out[1:65].reshape(8, 8), strict=True)), summed, highest


RNG = np.random.default_rng(0)
A, B, C = (RNG.normal(size=12) for _ in range(3))


def test_arithmetic_is_lane_by_lane() -> None:
    found, summed, _ = run(A, B, C)
    a, b, c = A[1:9], B[2:10], C[:8]
    assert LANES == 8
    assert np.array_equal(found["copy"], a)
    assert np.array_equal(found["all"], np.full(8, A[3]))
    assert np.array_equal(found["add"], a + b)
    assert np.array_equal(found["sub"], a - b)
    assert np.array_equal(found["mul"], a * b)
    assert np.array_equal(found["div"], a / b)
    assert found["fma"] == pytest.approx(a * b + c, rel=1e-14)
    assert summed == pytest.approx(b.sum(), rel=1e-14)


def test_the_larger_magnitude_is_that_of_the_second_or_the_first_as_it_is() -> None:
    first = np.array([1.0, 1.0, 1.0, 0.0, -1.0, 2.0, -3.0, 5.0])
    second = np.array([-2.0, 2.0, 0.5, 0.0, 0.5, -2.0, 1.0, -4.0])
    found, _, _ = run(np.append(9.0, first), np.concatenate([[9.0, 9.0], second]), C)
    assert found["largest"] == pytest.approx([2.0, 2.0, 1.0, 0.0, 0.5, 2.0, 1.0, 5.0])


@pytest.mark.parametrize("lane", range(8))
def test_sum_and_peak_miss_no_lane(lane: int) -> None:
    for value in (3.0, 1e-3):
        b = np.full(12, -1.0)
        b[:2] = b[10:] = 100.0
        b[2 + lane] = value
        _, summed, highest = run(A, b, C)
        assert highest == value
        assert summed == pytest.approx(value - 7.0)


def test_a_product_is_added_without_rounding_in_between() -> None:
    # (1 + ε)² − 1 − 2ε is ε², which rounding of the square would lose.
    small = 2.0**-30
    found, _, _ = run(np.full(12, 1 + small), np.full(12, 1 + small), np.full(12, -1 - 2 * small))
    assert np.array_equal(found["fma"], np.full(8, small**2))
