"""Modes near a shift, of springs and masses that hang on nothing: their values are known."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import ConvergenceError
from squeezefilm.physics.plate.elements import slab_modes
from squeezefilm.physics.plate.elements.slab_modes import modes_near

VALUES = np.arange(1.0, 201.0)
MASS = np.linspace(1.0, 3.0, 200)


class Springs:
    """Two hundred masses on springs of their own."""

    unknowns = 200

    def mass_times(self, x: np.ndarray) -> np.ndarray:
        """M x."""
        return MASS[:, None] * x


SLABS: Any = Springs()


def solve_about(shift: float) -> Any:
    return lambda right: right / (MASS * (VALUES - shift))[:, None]


START = np.random.default_rng(2).standard_normal((200, 4))


def between(low: float, high: float) -> Any:
    return lambda values: np.flatnonzero((values > low) & (values < high))


def test_those_that_are_wanted_are_found_with_unit_mass() -> None:
    pairs = modes_near(SLABS, solve_about(10.2), 10.2, between(7.5, 12.5), START, tolerance=1e-12)
    assert pairs.values == pytest.approx([8.0, 9.0, 10.0, 11.0, 12.0])
    assert pairs.vectors.T @ SLABS.mass_times(pairs.vectors) == pytest.approx(np.eye(5), abs=1e-8)
    for value, vector in zip(pairs.values, pairs.vectors.T, strict=True):
        at = round(float(value)) - 1
        assert abs(vector[at]) == pytest.approx(MASS[at] ** -0.5, rel=1e-5)


def test_those_that_move_like_others_come_in_their_order() -> None:
    """One for each, whatever their values are."""
    asked = [22, 18, 20]
    like = np.eye(200)[:, asked] + 0.01 * START[:, :3]
    pairs = modes_near(SLABS, solve_about(20.3), 20.3, None, like, tolerance=1e-12)
    assert pairs.values == pytest.approx([VALUES[at] for at in asked])
    for at, vector in zip(asked, pairs.vectors.T, strict=True):
        assert int(np.argmax(np.abs(vector))) == at


def test_where_none_is_wanted_there_is_none() -> None:
    pairs = modes_near(SLABS, solve_about(10.2), 10.2, between(10.1, 10.9), START, tolerance=1e-9)
    assert (pairs.values.size, pairs.vectors.shape) == (0, (200, 0))


def test_one_that_does_not_settle_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(slab_modes, "_MOST_STEPS", 3)
    with pytest.raises(ConvergenceError, match="did not converge in 3 steps; ask for a narrower"):
        modes_near(SLABS, solve_about(20.3), 20.3, between(5.5, 35.5), START, tolerance=1e-14)


def test_a_space_that_is_used_up_has_its_modes_exactly() -> None:
    """Three blocks of four span all that twelve masses can do; what is left then is rounding."""
    few: Any = Springs()
    few.unknowns, few.mass_times = 12, lambda x: MASS[:12, None] * x

    def solve(right: np.ndarray) -> np.ndarray:
        return right / (MASS[:12] * (VALUES[:12] - 5.3))[:, None]

    pairs = modes_near(few, solve, 5.3, between(0.5, 12.5), START[:12], tolerance=1e-300)
    assert pairs.values == pytest.approx(VALUES[:12], rel=1e-10)
    assert pairs.vectors.T @ few.mass_times(pairs.vectors) == pytest.approx(np.eye(12), abs=1e-9)
