"""The plain hand of free exploration: where it goes, how fast, and in which directions."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.perception.path_percepts import free_exploration, straight_runs

OBSERVER = load_observer()
FINGER = OBSERVER.median_finger()


@pytest.mark.parametrize("face", [(0.083, 0.049), (0.03, 0.05), (0.2, 0.02)])
def test_it_sweeps_the_face_both_ways_and_keeps_to_it(face: tuple[float, float]) -> None:
    path = free_exploration(OBSERVER, FINGER, face)
    width, height = (min(OBSERVER.stroke_length, one) for one in face)
    assert (path.x.min(), path.x.max()) == pytest.approx((0.0, width))
    assert path.y.min() >= 0.0
    assert path.y.max() == pytest.approx(height)
    runs = straight_runs(path)
    along = [run for run in runs if run.along_x and run.length > 0.99 * width]
    across = [run for run in runs if not run.along_x and run.length > 0.99 * height]
    assert (len(along), len(across)) == (OBSERVER.passes, OBSERVER.passes)
    # On lines a quarter of the square apart, the outer ones an eighth from its edge.
    rows = sorted(path.y[run.begin] for run in along)
    assert np.diff(rows) == pytest.approx([height / OBSERVER.passes] * 3)
    assert rows[0] == pytest.approx(height / OBSERVER.passes / 2)


def test_every_part_has_the_fingers_mean_speed() -> None:
    path = free_exploration(OBSERVER, FINGER, (0.083, 0.049))
    assert path.length / path.duration == pytest.approx(FINGER.speed)


def test_a_face_that_is_none_is_refused() -> None:
    with pytest.raises(InputError, match="face"):
        free_exploration(OBSERVER, FINGER, (0.001, 0.05))
