"""A finger's path over a face cut into runs: stretches that are straight and go one way.

A rhythm is felt along a run, at the spacing that the surface has in that direction: a finger that
crosses a grating of period λ at an angle θ to its axis meets λ/cos θ, and one that goes along the
ridges meets none. A run ends where the finger turns back, or leaves the straight line from where
the run began to where it ends, by more than `TURN`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.render.motion.finger_path import FingerPath

TURN: si.Metre = 1e-3
"""A finger that comes back, or strays from the straight, by less has not turned (m); assumed: a
tenth of a contact, and far above a sensor's noise."""
SHORTEST_RUN: si.Metre = 4e-3
"""Shortest run that is told of: two millimetres go by while the pad is stretched (m)."""


@dataclass(frozen=True, slots=True)
class PathRun:
    """A straight stretch of a path.

    Attributes:
        begin, end: numbers of its first and its last sample.
        length: from its begin to its end (m).
        heading: direction in which it goes, from x towards y (rad), −π to π.
    """

    begin: int
    end: int
    length: si.Metre
    heading: si.Radian

    @property
    def along_x(self) -> bool:
        """True where it goes along x more than along y; at 45° it counts as along x."""
        return abs(math.cos(self.heading)) >= abs(math.sin(self.heading)) - 1e-9


def straight_runs(path: FingerPath, shortest: si.Metre = SHORTEST_RUN) -> tuple[PathRun, ...]:
    """The runs of a path that are at least `shortest` (m) long, in their order.

    The cuts do not change where path and axes are shifted or turned together.
    """
    place = np.stack([path.x, path.y], axis=1)
    runs = []
    for begin, end in _one_way(place):
        for first, last in _straight(place, begin, end):
            dx, dy = (float(one) for one in place[last] - place[first])
            length = math.hypot(dx, dy)
            if length >= shortest:
                runs.append(PathRun(first, last, length, math.atan2(dy, dx)))
    return tuple(runs)


def _one_way(place: si.FloatArray) -> list[tuple[int, int]]:
    """Stretches on which the finger does not come back towards where it began."""
    stretches, begin, end = [], 0, place.shape[0] - 1
    while begin < end:
        away = np.hypot(*(place[begin:] - place[begin]).T)
        farthest = np.maximum.accumulate(away)
        back = np.flatnonzero(farthest - away > TURN)
        if not back.size:
            last = begin + int(np.argmax(away))
        else:
            last = begin + int(np.argmax(away[: back[0] + 1]))
        if last == begin:
            break
        stretches.append((begin, last))
        begin = last
    return stretches


def _straight(place: si.FloatArray, begin: int, end: int) -> list[tuple[int, int]]:
    """Parts of a stretch that keep to the straight line between their ends (Douglas and Peucker
    1973, 10.3138/FM57-6770-U75U-7727)."""
    todo, pieces = [(begin, end)], []
    while todo:
        first, last = todo.pop()
        along = place[last] - place[first]
        off = place[first : last + 1] - place[first]
        length = math.hypot(float(along[0]), float(along[1]))
        aside = np.abs(off[:, 0] * along[1] - off[:, 1] * along[0]) / max(length, 1e-12)
        widest = int(np.argmax(aside))
        if aside[widest] > TURN and 0 < widest < last - first:
            todo += [(first + widest, last), (first, first + widest)]
        else:
            pieces.append((first, last))
    return pieces
