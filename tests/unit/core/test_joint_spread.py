"""The table of draws of a calibrated display."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.calibration_record import JointSpread
from squeezefilm.core.errors import InputError

PATHS = ("a", "b")
_Z = np.random.default_rng(1).multivariate_normal([0.5, 0], [[1, -0.9], [-0.9, 1]], 400)


def table() -> JointSpread:
    from scipy.special import ndtr

    return JointSpread(PATHS, draws=tuple(tuple(float(x) for x in row) for row in ndtr(_Z)))


def test_picked_points_are_rows_and_others_stay() -> None:
    joint = table()
    points = np.random.default_rng(2).random((50, 3))
    found = joint.picked(("b", "free", "a"), points)
    np.testing.assert_array_equal(found[:, 1], points[:, 1])
    rows = {(row[1], row[0]) for row in joint.draws}
    assert all((row[0], row[2]) in rows for row in found.tolist())
    np.testing.assert_array_equal(joint.picked(("free",), points[:, :1]), points[:, :1])
    np.testing.assert_array_equal(JointSpread().picked(("a",), points[:, :1]), points[:, :1])


def test_moved_points_have_the_means_and_correlation_of_the_draws() -> None:
    from scipy.special import ndtri

    points = np.random.default_rng(3).random((20000, 2))
    scores = ndtri(table().moved(PATHS, points))
    np.testing.assert_allclose(scores.mean(axis=0), _Z.mean(axis=0), atol=0.03)
    np.testing.assert_allclose(np.cov(scores.T), np.cov(_Z.T), atol=0.05)


@pytest.mark.parametrize(
    ("paths", "draws", "says"),
    [
        (("a",), ((0.1, 0.2),), "every row"),
        (("a", "a"), ((0.1, 0.2),), "every row"),
        (("a",), ((1.1,),), "at most 1"),
        (("a",), ((0.5,),) * 4097, "at most 4096"),
    ],
)
def test_what_is_no_table_is_refused(
    paths: tuple[str, ...], draws: tuple[tuple[float, ...], ...], says: str
) -> None:
    with pytest.raises(InputError, match=says):
        JointSpread(paths, draws=draws)
