"""Percept of a finger's own path, or of a free hand's, over a surface, through the whole chain.

The path goes through the loop, the friction and the skin as a simulated stroke does (`percepts`),
and the same senses look at the same lines along its way, run by run. Runs along x and
runs along y are felt apart. Nothing is tuned for it: of the simulated stroke itself, given as a
path, this is the percept of that stroke.

A period is felt on runs that hold it twice. Of the runs in one direction those count that are at
least half as long as the longest: a short one tells periods apart so badly that it would blur the
lines of the others. The skin is dragged along the path: what it does across
it, where the finger turns, is left out with the first two millimetres of each run.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.display import Display
from squeezefilm.physics.perception.observer import FingerClass, Observer
from squeezefilm.physics.perception.percepts import Apparatus, Percept, interpolated, rendered
from squeezefilm.physics.perception.senses import (
    SETTLING,
    SPACING,
    candidates,
    channel_gains,
    evidence,
    line_amplitudes,
    line_periods,
)
from squeezefilm.physics.render.motion.stroke import FingerPath, MinimumJerkStroke
from squeezefilm.physics.texture_files.texture_file import TextureFile

if TYPE_CHECKING:
    from squeezefilm.physics.chain.rendered_texture import RenderAnalysis

# A rhythm is felt along a run, at the spacing that the surface has in that direction: a finger that
# crosses a grating of period λ at an angle θ to its axis meets λ/cos θ, and one that goes along the
# ridges meets none. A run ends where the finger turns back, or leaves the straight line from where
# the run began to where it ends, by more than `TURN`.
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


_ROUNDING: si.Metre = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class PathPercept:
    """Percept of a path over a surface: on its runs `along` x and `across`, along y; None where
    there is no run."""

    along: Percept | None
    across: Percept | None


@dataclass(frozen=True, slots=True, eq=False)
class _OneRun:
    """Samples of a run, evenly along its way."""

    along_x: bool
    stretch: si.MetreArray
    speed: si.MetrePerSecondArray
    length: si.Metre


def path_percept(
    display: Display,
    surface: TextureFile,
    observer: Observer,
    finger: FingerClass,
    paths: Sequence[FingerPath],
    apparatus: Apparatus | None = None,
) -> PathPercept:
    """Percept of a surface on a display along a finger's own path.

    Args:
        display: what renders.
        surface: what is played.
        observer: whose senses.
        finger: contact, moisture and force; its speed is the path's.
        paths: what the finger did while it touched, a path for each touch.
        apparatus: how the display is run.

    Raises:
        InputError: no path, a path that holds no run of 4 mm, or what `rendered` refuses.
    """
    runs = []
    for path in paths:
        runs += _runs_of(rendered(display, surface, finger, path, apparatus), path)
    if not runs:
        raise InputError(
            "the path has no straight run of 4 mm or more, along which a rhythm could be felt; "
            "check its unit (x_m in metres), or give a longer one"
        )
    along, across = ([run for run in runs if run.along_x is which] for which in (True, False))
    return PathPercept(_felt(observer, along), _felt(observer, across))


def _runs_of(played: RenderAnalysis, path: FingerPath) -> list[_OneRun]:
    force, motion = played.force, played.finger
    speed = np.gradient(motion.way, force.time_step)
    runs = []
    for run in straight_runs(path):
        begin, end = float(path.time[run.begin]), float(path.time[run.end])
        rate = 1.0 / force.time_step
        rows = slice(math.ceil(begin * rate - 1e-6), math.floor(end * rate + 1e-6) + 1)
        start, stop = (float(motion.trajectory.position(t)) for t in (begin, end))
        forth = 1.0 if stop >= start else -1.0
        here = forth * (motion.way[rows] - start)
        if here.size < 2:
            continue
        even = np.arange(SETTLING, abs(stop - start) - _ROUNDING, SPACING)
        # The skin trails the bone.
        stretch = interpolated(even, here, -forth * force.stretch[rows])
        pace = np.maximum(interpolated(even, here, forth * speed[rows]), 0.0)
        runs.append(_OneRun(run.along_x, stretch, pace, abs(stop - start)))
    return runs


def _felt(observer: Observer, runs: list[_OneRun]) -> Percept | None:
    if not runs:
        return None
    longest = max(run.length for run in runs)
    runs = [run for run in runs if run.length >= longest / 2]
    share = np.array([run.stretch.size for run in runs], dtype=float)
    power, weight = np.zeros(line_periods().size), np.zeros(line_periods().size)
    for run, size in zip(runs, share, strict=True):
        holds = 2.0 * line_periods() <= run.length + _ROUNDING
        power += size * holds * line_amplitudes(run.stretch[None, :]) ** 2
        weight += size * holds
    amplitude = np.sqrt(power / np.maximum(weight, 1.0))
    speed = np.concatenate([run.speed for run in runs])
    mean = abs(float(np.mean(np.concatenate([run.stretch for run in runs]))))
    heard = evidence(observer, amplitude, channel_gains(observer, speed), mean)
    lengths = np.array([run.length for run in runs])
    rhythms = candidates(observer, heard, float(share @ lengths / share.sum()))
    return Percept(heard, rhythms, mean)


# Nobody was measured for it. The finger goes to and fro along x on lines spread over a square of
# the observer's stroke, or over the face where that is smaller, then along y in the same way; as
# many lines each way as the observer's strokes have passes, each of least jerk at the finger's own
# mean speed, and so are the steps between lines.
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
