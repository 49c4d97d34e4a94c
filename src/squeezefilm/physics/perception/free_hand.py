"""Way of a simulated finger that explores a face freely: sweeps in two directions. Assumed.

Nobody was measured for it. The finger goes to and fro along x on lines spread over a square of the
observer's stroke, or over the face where that is smaller, then along y in the same way; as many
lines each way as the observer's strokes have passes, each of least jerk at the finger's own mean
speed, and so are the steps between lines.
"""

from __future__ import annotations

import itertools
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.observer import FingerClass, Observer
from squeezefilm.physics.render.motion.finger_path import FingerPath
from squeezefilm.physics.render.motion.stroke import MinimumJerkStroke

SAYS = (
    "Free exploration is a plain hand: sweeps to and fro along x and then along y, on lines spread "
    "over a square of the observer's stroke; nobody was measured for it."
)
"""Sentence that results which rest on this hand repeat."""
_SAMPLE: si.Second = 2e-3


@si.checked_numbers
def free_exploration(
    observer: Observer,
    finger: FingerClass,
    face: tuple[
        Annotated[si.Metre, si.AtLeast(0.01), si.AtMost(10.0)],
        Annotated[si.Metre, si.AtLeast(0.01), si.AtMost(10.0)],
    ],
) -> FingerPath:
    """The path of a finger that explores a face of that length and width (m); see the module.

    It keeps to x and y from 0 to the stroke's length, or to the face's own where that is shorter.
    Raises `InputError` for a face outside of 1 cm to 10 m.
    """
    width, height = (min(observer.stroke_length, side) for side in face)
    spread = (np.arange(observer.passes) + 0.5) / observer.passes
    corners = [(0.0, height * spread[0])]
    for place in height * spread:
        # To the line, then along it to the other end.
        corners += [(corners[-1][0], place), (width - corners[-1][0], place)]
    far = width if corners[-1][0] > width / 2 else 0.0
    columns = width * (spread[::-1] if far else spread)
    corners += [(columns[0], corners[-1][1]), (columns[0], height)]
    for place in columns:
        corners += [(place, corners[-1][1]), (place, height - corners[-1][1])]
    return _led_through(np.array(corners), finger.speed)


def _led_through(corners: si.FloatArray, speed: si.MetrePerSecond) -> FingerPath:
    """A path through corners (m), shape (n, 2), each part of least jerk at a mean speed."""
    times, places = [np.zeros(1)], [corners[:1]]
    now = 0.0
    for begin, end in itertools.pairwise(corners):
        length = float(np.hypot(*(end - begin)))
        if length < _SAMPLE * speed:
            continue
        part = MinimumJerkStroke(length, length / speed, 1)
        count = max(int(np.ceil(part.duration / _SAMPLE)), 2)
        t = part.duration * np.arange(1, count + 1) / count
        times.append(now + t)
        places.append(begin + (end - begin) * (part.position(t) / length)[:, None])
        now += part.duration
    path = np.concatenate(places)
    return FingerPath(np.concatenate(times), path[:, 0], path[:, 1])
