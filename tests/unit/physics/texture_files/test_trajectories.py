"""Finger motions from CSV and from words."""

import math
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.physics.render.motion.stroke import FingerPath, MinimumJerkStroke, OverPath, Stroke
from squeezefilm.physics.texture_files.trajectories import (
    motion_from,
    read_trajectory,
    stroke_from_text,
)


def test_strokes_in_words() -> None:
    assert stroke_from_text("60 mm/s over 4 cm") == Stroke(0.06, 0.04)
    assert stroke_from_text("60 mm/s over 4 cm, 3 passes, from 5 mm") == Stroke(0.06, 0.04, 3, 5e-3)
    assert stroke_from_text("60 mm/s over 4 cm, 2 turns") == Stroke(0.06, 0.04, 3)
    assert stroke_from_text("4 cm in 0.5 s, 2 passes") == MinimumJerkStroke(0.04, 0.5, 2)


def test_a_slanted_stroke_keeps_its_speed_and_turns() -> None:
    path = stroke_from_text("50 mm/s over 2 cm, 2 passes, at 30 deg, from 5 mm, y 2 mm")
    assert isinstance(path, FingerPath)
    assert path.duration == pytest.approx(0.8)
    assert path.length == pytest.approx(0.04)
    x, y = path.place(np.array([0.0, 0.2, 0.4, 0.8]))
    along = np.array([0.0, 0.01, 0.02, 0.0])
    assert x == pytest.approx(5e-3 + along * math.cos(math.pi / 6))
    assert y == pytest.approx(2e-3 + along * math.sin(math.pi / 6))
    assert path.travelled(0.6) == pytest.approx(0.03)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("60 over 4 cm", "has no unit"),
        ("60 mm/s over 4 s", "wrong dimension"),
        ("fast", "is no stroke"),
        ("60 mm/s over 4 cm, backwards", "'backwards'"),
        ("60 mm/s over 4 cm, 0 passes", "passes = 0"),
        ("60 m/s over 4 cm", "speed = 60"),
        ("4 cm in 0.5 s, at 30 deg", "runs along x"),
    ],
)
def test_words_that_are_no_stroke(text: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        motion_from(text)


@pytest.mark.parametrize(
    ("rows", "says"),
    [
        ("time_s,x_m\n0,0\n0.1,nan\n", r"line 3: x_m: is no number"),
        ("time_s,x_m\n0,0\n0.1,\n", r"line 3: x_m: is no number"),
        ("# {}\ntime_s,x_m\n0,0\n0.1,nan\n", r"line 4: x_m"),
        ("time_s,x_m\n0,0\n0.2,0.01\n0.1,0.02\n", r"line 4: time_s: 0\.1 s does not come after"),
        ("time_s,x_m\n0,0\n0,0.01\n", r"line 3: time_s"),
        ("time_s,x_mm\n0,0\n1,1\n", r"'x_mm' is not known.*'x_m'"),
        ("time_s,y_m\n0,0\n1,1\n", r"line 1: the column 'x_m' is missing"),
        ("time_s,x_m\n0,0\n0.1,40\n", r"line 3: the finger would move at 400 m/s"),
        ("time_s,x_m\n0,0\n1,0\n", "does not move"),
        ("time_s,x_m\n0,0\n", "fewer than two"),
    ],
)
def test_files_that_are_no_motion(rows: str, says: str, tmp_path: Path) -> None:
    path = tmp_path / "s.csv"
    path.write_text(rows)
    with pytest.raises(ConfigError, match=says):
        motion_from(str(path))


def test_a_motion_in_the_plane(tmp_path: Path) -> None:
    path = tmp_path / "s.csv"
    path.write_text("time_s,x_m,y_m\n1,0,0\n2,0.03,0.04\n3,0.03,0.04\n4,0.03,0\n")
    motion = read_trajectory(path)
    assert motion.duration == 3.0
    assert not motion.along_x
    way = OverPath(motion)
    assert way.position(np.array([0.0, 1.0, 1.5, 2.0, 3.0])) == pytest.approx(
        [0, 0.05, 0.05, 0.05, 0.09]
    )
    # Straight on before the start and past the end.
    x, y = motion.place_after(np.array([-0.01, 0.025, 0.05, 0.07, 0.1]))
    assert x == pytest.approx([-0.006, 0.015, 0.03, 0.03, 0.03])
    assert y == pytest.approx([-0.008, 0.02, 0.04, 0.02, -0.01])
    with pytest.raises(InputError, match="at most 3"):
        motion.place(3.1)
