from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from squeezefilm.design.sweep.tradeoffs import (
    dominates,
    front_of,
    hypervolume,
    knee_of,
    layers_of,
)

TABLES = arrays(
    float,
    st.tuples(st.integers(1, 30), st.integers(2, 3)),
    elements=st.sampled_from([0.0, 0.1, 0.25, 0.5, 0.75, 1.0, 2.0, float("inf")]),
)


@given(TABLES)
def test_the_front_is_what_nobody_beats(rows: np.ndarray) -> None:
    front = front_of(rows)
    finite = np.flatnonzero(np.isfinite(rows).all(axis=1))
    beaten = {i for i in finite for j in finite if dominates(rows[j], rows[i])}
    values = {tuple(rows[i]) for i in finite} - {tuple(rows[i]) for i in beaten}
    assert {tuple(rows[i]) for i in front} == values
    assert len(values) == front.size  # of equal ones one


@given(TABLES)
def test_layers_come_one_after_the_other(rows: np.ndarray) -> None:
    finite = int(np.isfinite(rows).all(axis=1).sum())
    taken = layers_of(rows, 5)
    assert len(set(taken.tolist())) == taken.size >= min(5, finite)
    front = front_of(rows)
    assert set(front) <= set(taken)


@pytest.mark.slow
@pytest.mark.parametrize("objectives", [2, 3])
def test_the_hypervolume_is_the_share_of_random_points_that_are_dominated(objectives: int) -> None:
    draw = np.random.default_rng(7)
    rows, worst = draw.random((25, objectives)), np.full(objectives, 0.9)
    points = draw.random((100_000, objectives)) * worst
    share = np.mean([np.any(np.all(rows <= point, axis=1)) for point in points])
    assert hypervolume(rows, worst) == pytest.approx(share, abs=0.006)


def test_a_single_design_commands_a_box() -> None:
    assert hypervolume(np.array([[0.5, 0.25]]), np.array([1.0, 1.0])) == pytest.approx(0.375)
    assert hypervolume(np.array([[1.5, 0.25]]), np.array([1.0, 1.0])) == 0.0
    assert hypervolume(np.array([[np.inf, 0.25]]), np.array([1.0, 1.0])) == 0.0


def test_the_knee_is_between_the_ends() -> None:
    rows = np.array([[0.0, 1.0], [0.2, 0.2], [1.0, 0.0]])
    assert knee_of(rows) == 1
    assert knee_of(rows[:1]) == 0


def test_what_is_infinite_is_dominated_like_any_number() -> None:
    """A reference whose gratings nobody feels has an infinite objective."""
    good, none = np.array([0.3, 1e-3]), np.array([0.3, np.inf])
    assert dominates(good, none)
    assert not dominates(none, good)
    assert not dominates(none, none)
