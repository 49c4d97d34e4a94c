"""Matrices gathered from elements, and their modes nearest to a shift."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy import sparse
from scipy.linalg import eigh

from squeezefilm.core.errors import ConvergenceError
from squeezefilm.physics.plate.ring.elements import entries, gathered, nearest_modes

SPRING = np.array([[1.0, -1.0], [-1.0, 1.0]])


def chain(count: int) -> sparse.csc_matrix:
    """Springs between `count` masses; the first on the ground, which is held."""
    return gathered([entries(np.array([k - 1, k]), SPRING) for k in range(count)], count)


def system(K: sparse.csc_matrix, M: sparse.csc_matrix) -> Any:
    """What is asked of a harmonic's system."""
    return SimpleNamespace(matrix=K, mass=M, displacements=M.shape[0], harmonic=3)


def test_held_unknowns_are_left_out_and_shared_ones_summed() -> None:
    expected = np.diag([2.0, 2.0, 1.0]) - np.eye(3, k=1) - np.eye(3, k=-1)
    assert chain(3).toarray() == pytest.approx(expected)


def test_the_modes_nearest_to_a_shift_rise_and_have_unit_mass() -> None:
    K, M = chain(40), sparse.diags_array(np.linspace(1.0, 2.0, 40)).tocsc()
    every = eigh(K.toarray(), M.toarray(), eigvals_only=True)
    squares, vectors = nearest_modes(system(K, M), float(np.sqrt(every[6]) + 1e-4) / (2 * np.pi), 3)
    assert squares == pytest.approx(every[5:8], rel=1e-10)
    assert vectors.T @ (M @ vectors) == pytest.approx(np.eye(3), abs=1e-9)


def test_unknowns_without_mass_are_condensed() -> None:
    # A massless third unknown between the second and the ground: two springs in a row.
    K = np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 2.0]])
    M = sparse.eye_array(2).tocsc()
    condensed = K[:2, :2] - np.outer(K[:2, 2], K[2, :2]) / K[2, 2]
    squares, _ = nearest_modes(system(sparse.csc_matrix(K), M), 0.0, 1)
    assert squares == pytest.approx(eigh(condensed, eigvals_only=True)[:1])


def test_what_is_not_found_is_named() -> None:
    none = system(sparse.csc_matrix((4, 4)), sparse.eye_array(4).tocsc())
    named = r"^the modes of harmonic 3 near 0 Hz did not converge \(.*ask for fewer"
    with pytest.raises(ConvergenceError, match=named):
        nearest_modes(none, 0.0, 1)
