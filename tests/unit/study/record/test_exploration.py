"""Ways and speeds of a finger: closed forms on simple motions."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.motion.stroke import FingerPath
from squeezefilm.study.record.exploration import coverage, exploration, touches


def test_steady_motion() -> None:
    t = np.linspace(0, 2, 201)
    found = exploration(t, 0.03 * t, 0.04 * t)
    assert found.path_length == pytest.approx(0.1)
    assert found.mean_speed == pytest.approx(0.05)


def test_to_and_fro_with_a_rest() -> None:
    # 1 s there, 2 s rest, 1 s back, 1 s there again; uneven samples.
    t = np.array([0, 0.5, 1.0, 1.7, 3.0, 4.0, 4.2, 5.0])
    x = np.interp(t, [0, 1, 3, 4, 5], [0, 0.08, 0.08, 0, 0.08])
    found = exploration(t, x)
    assert found.path_length == pytest.approx(0.24)
    assert found.mean_speed == pytest.approx(0.048)


def test_a_finger_that_never_moved() -> None:
    found = exploration([0.0, 1.0], [0.0, 0.0])
    assert found.path_length == 0
    assert found.mean_speed == 0


@pytest.mark.parametrize(("time", "x"), [([0, 0], [0, 1]), ([0], [0]), ([0, 1], [0])])
def test_traces_that_cannot_be_are_refused(time: list, x: list) -> None:
    with pytest.raises(InputError):
        exploration(time, x)


def test_traces_of_two_samples_are_enough_and_say_where_they_lie() -> None:
    found = exploration([1.0, 3.0], [0.0, 0.3], [0.0, 0.4])
    assert (found.duration, found.path_length) == (2.0, pytest.approx(0.5))
    for wrong in (math.nan, math.inf):
        with pytest.raises(InputError, match="x ="):
            exploration([0.0, 1.0], [0.0, wrong])
        with pytest.raises(InputError, match="y ="):
            exploration([0.0, 1.0], [0.0, 1.0], [0.0, wrong])
        with pytest.raises(InputError, match="time"):
            exploration([0.0, wrong], [0.0, 1.0])
    with pytest.raises(InputError, match="one row of at least 2"):
        exploration([[0.0, 1.0]], [[0.0, 1.0]])
    with pytest.raises(InputError, match=r"time .* must rise"):
        exploration([0.0, 1.0, 1.0], [0.0, 1.0, 2.0])


def _raster(lines: int, length: float, apart: float, offset: float) -> FingerPath:
    """Lines to and fro along x, joined at their ends."""
    corners = []
    for number in range(lines):
        ends = (0.0, length) if number % 2 == 0 else (length, 0.0)
        corners += [(end, offset + number * apart) for end in ends]
    places = np.array(corners)
    return FingerPath(np.arange(float(len(places))), places[:, 0], places[:, 1])


@pytest.mark.parametrize(("lines", "apart"), [(4, 0.01), (8, 0.005), (3, 0.015), (16, 0.0025)])
def test_the_coverage_of_a_raster_is_that_of_its_rows_of_cells(lines: int, apart: float) -> None:
    # Lines in the middle of rows of 5 mm cells, 8 cells long; the joints go through the cells
    # between two rows, at the ends, one column of them at each side.
    found = coverage([_raster(lines, 0.0399, apart, 0.00251)], (0.08, 0.05))
    rows = {math.floor((0.00251 + number * apart) / 0.005) for number in range(lines)}
    between = max(rows) + 1 - len(rows)
    assert found == pytest.approx((8 * len(rows) + between) / 160)


def test_coverage_is_the_same_wherever_whole_cells_away_and_at_most_all() -> None:
    path = _raster(4, 0.0399, 0.01, 0.0025)
    moved = FingerPath(path.time, path.x + 0.015, path.y - 0.035)
    assert coverage([path], (0.08, 0.05)) == coverage([moved], (0.08, 0.05))
    assert coverage([path, path], (0.08, 0.05)) == coverage([path], (0.08, 0.05))
    assert coverage([path], (0.01, 0.01)) == 1.0
    assert coverage([], (0.08, 0.05)) == 0.0


def test_passes_peak_speed_and_directions_of_a_raster() -> None:
    path = _raster(4, 0.04, 0.01, 0.0)
    found = exploration(path.time, path.x, path.y, face=(0.08, 0.05))
    # Four lines and three joints, a second each.
    assert found.passes == 7
    assert found.along_x_share == pytest.approx(0.16 / 0.19)
    assert (found.peak_speed, found.mean_speed) == pytest.approx((0.04, 0.19 / 7))
    assert found.touched == found.duration == 7.0
    assert math.isnan(exploration(path.time, path.x, path.y).coverage)


def test_what_the_finger_does_in_the_air_is_left_out() -> None:
    # A second down, a second up and 5 cm away, a second down; samples every 10 ms.
    t = np.concatenate([np.linspace(0, 1, 101), np.linspace(2, 3, 101)])
    x = np.concatenate([0.02 * np.linspace(0, 1, 101), 0.07 + 0.02 * np.linspace(0, 1, 101)])
    found = exploration(t, x, longest_step=0.015)
    assert (found.duration, found.touched) == pytest.approx((3.0, 2.0))
    assert (found.path_length, found.mean_speed) == pytest.approx((0.04, 0.02))
    assert found.peak_speed == pytest.approx(0.02)
    assert found.passes == 2
    assert len(touches(t, x, np.zeros(202), 0.015)) == 2
    assert len(touches(t, x, np.zeros(202))) == 1
