"""Part of a matrix eliminated by blocks: the same as dense algebra, with pivots counted."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.errors import ConvergenceError
from squeezefilm.physics.plate.elements.elimination import Matrix, partial_ldl


def symmetric(size: int, dtype: type = float) -> Matrix:
    """An indefinite matrix whose leading blocks are regular."""
    rng = np.random.default_rng(size)
    A = rng.normal(size=(size, size)) / np.sqrt(size)
    if dtype is complex:
        A = A + 1j * rng.normal(size=(size, size)) / np.sqrt(size)
    signs = np.where(np.arange(size) % 3 == 1, -4.0, 4.0)
    return np.asarray(A + A.T + np.diag(signs)).astype(dtype)


# One block, whole blocks, a part of a block at the end; a rest of one and of several blocks.
SIZES = [(40, 70), (64, 100), (65, 66), (128, 300), (150, 310), (200, 200)]


@pytest.mark.parametrize(("pivots", "size"), SIZES)
@pytest.mark.parametrize("dtype", [float, complex])
def test_what_is_left_is_the_schur_complement(pivots: int, size: int, dtype: type) -> None:
    A = symmetric(size, dtype)
    kept = A.copy()
    made, left = partial_ldl(A, pivots)
    inner, cross, rest = A[:pivots, :pivots], A[:pivots, pivots:], A[pivots:, pivots:]
    exact = rest - cross.T @ np.linalg.solve(inner, cross)
    np.testing.assert_allclose(left, exact, atol=1e-12)
    np.testing.assert_array_equal(A, kept)
    assert made.pivots == pivots
    assert left.shape == (size - pivots, size - pivots)


@pytest.mark.parametrize(("pivots", "size"), SIZES)
@pytest.mark.parametrize("dtype", [float, complex])
def test_forward_and_backward_solve(pivots: int, size: int, dtype: type) -> None:
    A = symmetric(size, dtype)
    exact = np.random.default_rng(1).normal(size=(size, 2))
    right = A @ exact
    kept = right.copy()
    made, left = partial_ldl(A, pivots)
    reduced, taken = made.forward(right[:pivots])
    np.testing.assert_array_equal(right, kept)
    outside = np.linalg.solve(left, right[pivots:] - taken)
    np.testing.assert_allclose(outside, exact[pivots:], atol=1e-11)
    np.testing.assert_allclose(made.backward(reduced, outside), exact[:pivots], atol=1e-11)


@pytest.mark.parametrize("pivots", [30, 64, 150])
def test_negative_pivots_are_those_of_the_eliminated_part(pivots: int) -> None:
    A = symmetric(pivots + 20)
    made, _ = partial_ldl(A, pivots)
    assert made.negative == np.sum(np.linalg.eigvalsh(A[:pivots, :pivots]) < 0) > 0


def test_a_singular_block_says_what_to_do() -> None:
    A = symmetric(100)
    A[70] = 0.0
    A[:, 70] = 0.0
    with pytest.raises(ConvergenceError, match="a frequency a little beside it"):
        partial_ldl(A, 90)
