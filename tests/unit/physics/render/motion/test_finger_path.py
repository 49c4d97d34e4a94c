"""A free motion in the plane: its way, its places beyond the ends, and what is none."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.motion.stroke import FingerPath, OverPath

# Three millimetres along x, a rest, four along y.
PATH = FingerPath(
    np.array([2.0, 2.1, 2.3, 2.5]), np.array([1e-3, 4e-3, 4e-3, 4e-3]),
    np.array([0.0, 0.0, 0.0, 4e-3]),
)  # fmt: skip


def test_a_motion_begins_at_time_zero_and_knows_its_way() -> None:
    assert PATH.time == pytest.approx([0.0, 0.1, 0.3, 0.5])
    assert PATH.duration == pytest.approx(0.5)
    assert PATH.length == pytest.approx(7e-3)
    t = np.array([0.0, 0.05, 0.2, 0.4, 0.5])
    assert PATH.travelled(t) == pytest.approx([0, 1.5e-3, 3e-3, 5e-3, 7e-3])
    x, y = PATH.place(t)
    assert x == pytest.approx([1e-3, 2.5e-3, 4e-3, 4e-3, 4e-3])
    assert y == pytest.approx([0, 0, 0, 2e-3, 4e-3])
    assert PATH.position(t) == pytest.approx(x)
    over = OverPath(PATH)
    assert over.duration == PATH.duration
    assert over.position(0.4) == pytest.approx(5e-3)
    assert repr(over) == "FingerPath of 4 samples, 0.007 m in 0.5 s"


def test_a_way_before_the_start_and_past_the_end_goes_straight_on() -> None:
    x, y = PATH.place_after(np.array([-2e-3, 0.0, 1e-3, 5e-3, 7e-3, 8e-3]))
    assert x == pytest.approx([-1e-3, 1e-3, 2e-3, 4e-3, 4e-3, 4e-3])
    assert y == pytest.approx([0, 0, 0, 2e-3, 4e-3, 5e-3])


def test_only_a_motion_on_the_axis_keeps_to_it() -> None:
    t = np.array([0.0, 1.0])
    assert not PATH.along_x
    assert FingerPath(t, t, np.zeros(2)).along_x
    assert not FingerPath(t, t, np.ones(2)).along_x


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"x": np.zeros(2)}, "arrays of equal length"),
        (dict.fromkeys("xy", np.ones((3, 1))) | {"time": np.ones((3, 1))}, "one row of at least 2"),
        (dict.fromkeys("xy", np.ones(1)) | {"time": np.ones(1)}, "one row of at least 2"),
        ({"time": np.array([0.0, 1.0, 1.0])}, "must rise"),
        ({"x": np.ones(3), "y": np.ones(3)}, "does not move at all"),
        ({"x": np.array([0.0, 11.0, 0.0])}, "x"),
        ({"y": np.array([0.0, np.nan, 0.0])}, "y"),
    ],
)
def test_what_is_no_motion_is_refused(changes: dict[str, Any], says: str) -> None:
    good = {"time": np.arange(3.0), "x": np.arange(3.0), "y": np.zeros(3)}
    FingerPath(**good)
    with pytest.raises(InputError, match=says):
        FingerPath(**{**good, **changes})


@pytest.mark.parametrize("t", [-1e-6, 0.5001])
def test_a_time_outside_the_motion_is_refused(t: float) -> None:
    for ask in (PATH.position, PATH.place, PATH.travelled, OverPath(PATH).position):
        with pytest.raises(InputError, match="t ="):
            ask(t)
