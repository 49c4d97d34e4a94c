"""An element eliminated by halves against the same elimination in one."""

from typing import Any

import numpy as np
import pytest

from squeezefilm.physics.plate.elements.elimination import (
    SliceMatrices,
    mirrored_element,
    partial_ldl,
)
from squeezefilm.physics.plate.elements.lobatto import line_matrices


def slice_matrices(order: int, turned: int, straight: int, seed: int) -> SliceMatrices:
    """Random matrices with the structure of a slice of two elements along y: P1 couples u with what
    is not u, and what is inside one element meets nothing beyond its sides."""
    rng = np.random.default_rng(seed)
    n = turned + straight
    signs = np.ones(n)
    signs[rng.permutation(n)[:turned]] = -1.0
    same = signs[:, None] * signs > 0
    # Side, inside the first, side, inside the second, side.
    place = rng.permutation(n) % 5
    low, high = place <= 2, place >= 2
    meet = low[:, None] & low | high[:, None] & high
    groups = tuple(
        (np.flatnonzero(place == k), np.flatnonzero(abs(place - k) == 1)) for k in (1, 3)
    )

    def symmetric() -> Any:
        a = rng.standard_normal((n, n))
        return np.where(same & meet, a + a.T + 9 * n * np.eye(n), 0.0)

    P1 = np.where(same | ~meet, 0.0, rng.standard_normal((n, n)))
    lines = line_matrices(0.7, order)
    return SliceMatrices(symmetric(), P1, -symmetric(), *lines, signs, groups)


def whole(made: SliceMatrices) -> Any:
    """The element's matrix, inner slices first, then the first and the last."""
    order = made.mass.shape[0] - 1
    places = [*range(1, order), 0, order]
    return np.block(
        [
            [
                made.stiffness[a, b] * made.P2
                + made.mass[a, b] * made.P0
                + made.slope[a, b] * made.P1
                + made.slope[b, a] * made.P1.T
                for b in places
            ]
            for a in places
        ]
    )


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5, 8])
def test_halves_give_what_the_whole_gives(order: int) -> None:
    made = slice_matrices(order, 5, 9, order)
    A, n = whole(made), made.signs.size
    pivots = n * (order - 1)
    halves, left = mirrored_element(made)
    one, expected = partial_ldl(A, pivots)
    assert np.allclose(left, expected, rtol=1e-9, atol=1e-9 * np.abs(A).max())
    assert halves.negative == one.negative
    if order == 1:
        return  # It has no inner slice.
    rng = np.random.default_rng(order)
    inside, outside = rng.standard_normal((pivots, 3)), rng.standard_normal((2 * n, 3))
    reduced, update = halves.forward(inside)
    assert np.allclose(update, A[pivots:, :pivots] @ np.linalg.solve(A[:pivots, :pivots], inside))
    expected = np.linalg.solve(A[:pivots, :pivots], inside - A[:pivots, pivots:] @ outside)
    assert np.allclose(halves.backward(reduced, outside), expected)


def test_the_matrices_are_those_of_a_mirrored_element() -> None:
    # What the halves rest on: the element is its own image when u is turned.
    made = slice_matrices(4, 3, 4, 1)
    A, n = whole(made), made.signs.size
    turn = np.zeros_like(A)
    for k, image in enumerate((2, 1, 0, 4, 3)):
        turn[k * n : (k + 1) * n, image * n : (image + 1) * n] = np.diag(made.signs)
    assert np.allclose(turn @ A @ turn.T, A)
