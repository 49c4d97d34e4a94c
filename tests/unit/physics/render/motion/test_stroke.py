"""Strokes: where the finger is, and every refusal."""

import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.motion.stroke import Stroke


def test_one_pass_of_four_centimetres() -> None:
    stroke = Stroke(0.1)
    assert stroke.length == 0.04
    assert stroke.duration == pytest.approx(0.4)
    assert stroke.position(np.array([0.0, 0.1, 0.4])) == pytest.approx([0.0, 0.01, 0.04])


def test_there_and_back() -> None:
    stroke = Stroke(0.1, 0.04, passes=3, start=0.01)
    assert stroke.duration == pytest.approx(1.2)
    assert stroke.pass_duration == pytest.approx(0.4)
    times = np.array([0.0, 0.4, 0.5, 0.8, 1.0, 1.2])
    assert stroke.position(times) == pytest.approx([0.01, 0.05, 0.04, 0.01, 0.03, 0.05])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"speed": 0.0}, "speed = 0 m/s"),
        ({"speed": -0.1}, "at least 1 nm/s"),
        ({"speed": 60.0}, "at most 5 m/s"),
        ({"speed": math.nan}, "speed = nan"),
        ({"speed": 0.1, "length": 0.0}, "length = 0 m"),
        ({"speed": 0.1, "length": 40.0}, "at most 10 m"),
        ({"speed": 0.1, "start": math.inf}, "start = inf"),
        ({"speed": 0.1, "passes": 0}, "passes = 0 .*at least 1"),
        ({"speed": 0.1, "passes": 1.5}, "passes = 1.5 .*whole number"),
        ({"speed": 0.1, "passes": True}, "passes = True"),
    ],
)
def test_a_stroke_out_of_range_is_refused(arguments: dict, said: str) -> None:
    with pytest.raises(InputError, match=said):
        Stroke(**arguments)


@pytest.mark.parametrize("t", [-1e-6, 0.41, math.nan])
def test_a_time_outside_the_stroke_is_refused(t: float) -> None:
    with pytest.raises(InputError, match="t = "):
        Stroke(0.1).position(t)
