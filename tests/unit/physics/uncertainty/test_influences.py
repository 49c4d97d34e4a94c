"""Shares of the variance, of inputs and groups; which columns are drawn to the end."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from squeezefilm.physics.uncertainty.intervals import followed, groups_of, influences_of


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


def _curved(x: np.ndarray) -> np.ndarray:
    """A product, of which the first two inputs are the one group and the last two the other."""
    made = (1 + x[:, 0]) * (1 + 0.6 * x[:, 1]) * (1 + 0.9 * x[:, 2]) * (1 + 0.2 * x[:, 3])
    return np.asarray(made)


def _shares(rows: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """By themselves and in all, of inputs (in order) and groups: share and error, (parts, 2)."""
    a, b = np.random.default_rng(seed).normal(size=(2, rows, 4)) * 0.5
    taken = [[False] * 4, *np.eye(4, dtype=bool), [True] * 4]
    taken += [[True, True, False, False], [False, False, True, True]]
    design = np.stack([_curved(np.where(one, b, a)) for one in taken], axis=1)
    names: Any = ("0", "1", "2", "3")
    inputs = sorted(influences_of(names, design), key=lambda one: str(one.parameter))
    groups = groups_of(design)
    return (
        np.array([(one.first_order, one.first_order_error) for one in inputs]),
        np.array([(one.total, one.total_error) for one in inputs]),
        np.array([(one.alone, one.alone_error) for one in groups]),
        np.array([(one.total, one.error) for one in groups]),
    )


def test_shares_are_those_of_a_product_within_their_errors() -> None:
    """Of Π(1 + c x) with x of variance v the variance is Π(1 + c² v) − 1, a part's by itself the
    same product over it, and a part's in all what is left without the others'."""
    grown = 0.25 * np.array([1.0, 0.6, 0.9, 0.2]) ** 2
    whole = np.prod(1 + grown) - 1
    pairs = np.array([np.prod(1 + grown[:2]), np.prod(1 + grown[2:])])
    exact = (
        grown / whole,
        1 - (np.prod(1 + grown) / (1 + grown) - 1) / whole,
        (pairs - 1) / whole,
        1 - (pairs[::-1] - 1) / whole,
    )
    inside = [
        np.abs(found[:, 0] - true) < found[:, 1]
        for seed in range(100)
        for found, true in zip(_shares(128, seed), exact, strict=True)
    ]
    assert 0.9 < np.mean(np.concatenate(inside)) < 0.98


@pytest.mark.parametrize("rows", [32, 128])
def test_no_member_has_more_than_its_group_but_for_the_errors(rows: int) -> None:
    above = []
    for seed in range(60):
        first, total, alone, group = _shares(rows, seed)
        for member, whole in ((first, alone), (total, group)):
            excess = member[:, 0] - np.repeat(whole[:, 0], 2)
            above.append(excess > np.hypot(member[:, 1], np.repeat(whole[:, 1], 2)))
    assert np.mean(above) < 0.01
