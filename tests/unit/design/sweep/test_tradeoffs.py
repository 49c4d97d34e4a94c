"""The points that no other beats, against the definition."""

import numpy as np

from squeezefilm.design.sweep.tradeoffs import non_dominated


def test_it_is_the_definition_point_by_point() -> None:
    values = np.random.default_rng(1).integers(0, 8, size=(200, 3)).astype(float)
    values[7] = np.nan
    values[8, 1] = np.nan
    found = non_dominated(values)
    for k, one in enumerate(values):
        beaten = any((other <= one).all() and (other < one).any() for other in values)
        assert found[k] == (np.isfinite(one).all() and not beaten), k


def test_equal_points_are_all_kept_and_of_one_number_the_least() -> None:
    assert non_dominated(np.array([[1.0, 2.0], [1.0, 2.0], [2.0, 2.0]])).tolist() == [
        True, True, False,
    ]  # fmt: skip
    assert non_dominated(np.array([[3.0], [1.0], [2.0]])).tolist() == [False, True, False]
    assert non_dominated(np.empty((0, 2))).tolist() == []
