"""Ways, speeds and forces of a finger: closed forms on simple motions."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.errors import InputError
from squeezefilm.study.record.exploration import exploration


def test_steady_motion() -> None:
    t = np.linspace(0, 2, 201)
    found = exploration(t, 0.03 * t, 0.04 * t, np.full(201, 0.5))
    assert found.path_length == pytest.approx(0.1)
    assert found.mean_speed == pytest.approx(0.05)
    assert found.moving_speed == pytest.approx(0.05)
    assert found.moving_share == pytest.approx(1)
    assert found.reversals == 0
    assert (found.mean_force, found.force_spread) == pytest.approx((0.5, 0), abs=1e-12)


def test_to_and_fro_with_a_rest() -> None:
    # 1 s there, 2 s rest, 1 s back, 1 s there again; uneven samples.
    t = np.array([0, 0.5, 1.0, 1.7, 3.0, 4.0, 4.2, 5.0])
    x = np.interp(t, [0, 1, 3, 4, 5], [0, 0.08, 0.08, 0, 0.08])
    found = exploration(t, x)
    assert found.path_length == pytest.approx(0.24)
    assert found.moving_share == pytest.approx(0.6)
    assert found.moving_speed == pytest.approx(0.08)
    assert found.mean_speed == pytest.approx(0.048)
    assert found.reversals == 2
    assert math.isnan(found.mean_force)


def test_the_spread_of_a_force_is_over_time() -> None:
    # 1 N for three seconds, 3 N for one, and nothing in between.
    t = np.array([0.0, 3.0, 3.0 + 1e-9, 4.0])
    found = exploration(t, 0.01 * t, None, np.array([1.0, 1.0, 3.0, 3.0]))
    assert found.mean_force == pytest.approx(1.5)
    assert found.force_spread == pytest.approx(math.sqrt((3 * 0.5**2 + 1.5**2) / 4))


def test_a_finger_that_never_moved() -> None:
    found = exploration([0.0, 1.0], [0.0, 0.0])
    assert found.path_length == 0
    assert math.isnan(found.moving_speed)


@pytest.mark.parametrize(
    ("time", "x", "force"),
    [([0, 0], [0, 1], None), ([0], [0], None), ([0, 1], [0, 1], [1, -1]), ([0, 1], [0], None)],
)
def test_traces_that_cannot_be_are_refused(time: list, x: list, force: list | None) -> None:
    with pytest.raises(InputError):
        exploration(time, x, None, force)


def test_traces_of_two_samples_are_enough_and_say_where_they_lie() -> None:
    found = exploration([1.0, 3.0], [0.0, 0.3], [0.0, 0.4], [1.0, 2.0])
    assert (found.duration, found.path_length) == (2.0, pytest.approx(0.5))
    assert (found.mean_force, found.force_spread) == (1.5, 0.0)
    for wrong in (math.nan, math.inf):
        with pytest.raises(InputError, match="x ="):
            exploration([0.0, 1.0], [0.0, wrong])
        with pytest.raises(InputError, match="y ="):
            exploration([0.0, 1.0], [0.0, 1.0], [0.0, wrong])
        with pytest.raises(InputError, match="time"):
            exploration([0.0, wrong], [0.0, 1.0])
    with pytest.raises(InputError, match="at least 2 samples"):
        exploration([[0.0, 1.0]], [[0.0, 1.0]])
    with pytest.raises(InputError, match="time must rise"):
        exploration([0.0, 1.0, 1.0], [0.0, 1.0, 2.0])
