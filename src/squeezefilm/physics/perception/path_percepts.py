"""What a finger's own path over a surface would have felt like, through the whole chain.

The path goes through the loop, the friction and the skin as a simulated stroke does (`percepts`),
and the same senses look at the same lines along its way, run by run. Runs along x and
runs along y are felt apart. Nothing is tuned for it: of the simulated stroke itself, given as a
path, this is the percept of that stroke.

A period is felt on runs that hold it twice. Of the runs in one direction those count that are at
least half as long as the longest: a short one tells periods apart so badly that it would blur the
lines of the others. The skin is dragged along the path: what it does across
it, where the finger turns, is left out with the first two millimetres of each run.

Runs are stretches that are straight and go one way. A rhythm is felt along a run, at the spacing
that the surface has in that direction: a finger that crosses a grating of period λ at an angle θ to
its axis meets λ/cos θ, and one that goes along the ridges meets none. A run ends where the finger
turns back, or leaves the straight line from where the run began to where it ends, by more than
`TURN`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.chain.rendered_texture import RenderAnalysis, render_texture
from squeezefilm.physics.display import Display
from squeezefilm.physics.perception.observer import FingerClass, Observer
from squeezefilm.physics.perception.percepts import (
    CONTROL_RATE,
    Apparatus,
    Percept,
    with_finger,
)
from squeezefilm.physics.perception.senses import (
    SETTLING,
    SPACING,
    candidates,
    channel_gains,
    evidence,
    line_amplitudes,
    line_periods,
)
from squeezefilm.physics.render.motion.finger_path import FingerPath
from squeezefilm.physics.texture_files.texture_file import TextureFile

TURN: si.Metre = 1e-3
"""A finger that comes back, or strays from the straight, by less has not turned (m); assumed: a
tenth of a contact, and far above a sensor's noise."""
SHORTEST_RUN: si.Metre = 4e-3
"""Of a shorter run nothing is told: two millimetres of it go by while the pad is stretched (m)."""


@dataclass(frozen=True, slots=True)
class Run:
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


def straight_runs(path: FingerPath, shortest: si.Metre = SHORTEST_RUN) -> tuple[Run, ...]:
    """The runs of a path that are at least `shortest` (m) long, in their order.

    The cuts do not change where path and axes are shifted or turned together.
    """
    place = np.stack([path.x, path.y], axis=1)
    found = []
    for begin, end in _one_way(place):
        for first, last in _straight(place, begin, end):
            dx, dy = (float(one) for one in place[last] - place[first])
            length = math.hypot(dx, dy)
            if length >= shortest:
                found.append(Run(first, last, length, math.atan2(dy, dx)))
    return tuple(found)


def _one_way(place: si.FloatArray) -> list[tuple[int, int]]:
    """Stretches on which the finger does not come back towards where it began."""
    found, begin, end = [], 0, place.shape[0] - 1
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
        found.append((begin, last))
        begin = last
    return found


def _straight(place: si.FloatArray, begin: int, end: int) -> list[tuple[int, int]]:
    """Parts of a stretch that keep to the straight line between their ends (Douglas and Peucker
    1973, 10.3138/FM57-6770-U75U-7727)."""
    todo, found = [(begin, end)], []
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
            found.append((first, last))
    return found


_SEED = 0
_ROUNDING: si.Metre = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class RunPercept:
    """What the runs in one direction give the senses.

    Attributes:
        percept: evidence by period along the runs, and the rhythms that compete.
        runs: how many count.
        way: their length together (m).
        mean_speed: along them (m/s).
        asked_swing, felt_swing: standard deviation along them of the relative friction that the
            surface asks for, and of the one that the finger meets (1).
    """

    percept: Percept
    runs: int
    way: si.Metre
    mean_speed: si.MetrePerSecond
    asked_swing: si.Dimensionless
    felt_swing: si.Dimensionless

    @property
    def clearest_period(self) -> si.Metre:
        """Of the most evident rhythm (m); NaN where there is none."""
        found = self.percept.candidates
        return float(found.period[0]) if np.isfinite(found.d_prime[0]) else math.nan

    @property
    def clearest_d_prime(self) -> si.Dimensionless:
        """Its evidence (1); 0 where there is none."""
        return max(float(self.percept.candidates.d_prime[0]), 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class PathPercept:
    """What a path over a surface gives the senses: on its runs `along` x and `across`, along y;
    None where there is no run. `played` is how each part of the path was rendered."""

    along: RunPercept | None
    across: RunPercept | None
    played: tuple[RenderAnalysis, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _OneRun:
    """Samples of a run, evenly along its way."""

    along_x: bool
    stretch: si.MetreArray
    speed: si.MetrePerSecondArray
    asked: si.DimensionlessArray
    felt: si.DimensionlessArray
    length: si.Metre
    duration: si.Second


def path_percept(
    display: Display,
    surface: TextureFile,
    observer: Observer,
    finger: FingerClass,
    paths: Sequence[FingerPath],
    apparatus: Apparatus | None = None,
) -> PathPercept:
    """What a finger gets of a surface on a display along a path of its own.

    Args:
        display: what renders.
        surface: what is played.
        observer: whose senses.
        finger: contact, moisture and force; its speed is the path's.
        paths: what the finger did while it touched, a path for each touch.
        apparatus: how the display is run.

    Raises:
        InputError: no path, a path that holds no run of 4 mm, or what `render_texture` refuses.
    """
    run = apparatus or Apparatus()
    played, found = [], []
    for path in paths:
        one = render_texture(
            with_finger(display, finger),
            surface,
            path,
            normal_force=finger.normal_force,
            sensor=run.sensor,
            compensation=run.compensation,
            braking=run.braking,
            wave=run.wave,
            control_rate=CONTROL_RATE,
            seed=_SEED,
        )
        played.append(one)
        found += _runs_of(one, path)
    if not found:
        raise InputError(
            "the path has no straight run of 4 mm or more, along which a rhythm could be felt; "
            "check its unit (x_m in metres), or give a longer one"
        )
    along, across = ([one for one in found if one.along_x is which] for which in (True, False))
    return PathPercept(_felt(observer, along), _felt(observer, across), tuple(played))


def _runs_of(played: RenderAnalysis, path: FingerPath) -> list[_OneRun]:
    force, motion = played.force, played.finger
    speed = np.gradient(motion.way, force.time_step)
    found = []
    for run in straight_runs(path):
        begin, end = float(path.time[run.begin]), float(path.time[run.end])
        rate = 1.0 / force.time_step
        rows = slice(math.ceil(begin * rate - 1e-6), math.floor(end * rate + 1e-6) + 1)
        start, stop = (float(motion.trajectory.position(t)) for t in (begin, end))
        forth = 1.0 if stop >= start else -1.0
        here = forth * (motion.way[rows] - start)
        if here.size < 2:
            continue
        rising = np.concatenate([[True], np.diff(np.maximum.accumulate(here)) > 0.0])
        even = np.arange(SETTLING, abs(stop - start) - _ROUNDING, SPACING)

        def along(
            values: si.FloatArray,
            sign: float = 1.0,
            even: si.FloatArray = even,
            here: si.FloatArray = here[rising],
            rows: slice = rows,
            rising: si.Array = rising,
        ) -> si.FloatArray:
            return np.asarray(np.interp(even, here, sign * values[rows][rising]))

        found.append(
            _OneRun(
                along_x=run.along_x,
                # The skin trails the bone.
                stretch=along(force.stretch, -forth),
                speed=np.maximum(along(speed, forth), 0.0),
                asked=along(played.asked),
                felt=along(played.stroke.relative_friction_rendered),
                length=abs(stop - start),
                duration=end - begin,
            )
        )
    return found


def _felt(observer: Observer, runs: list[_OneRun]) -> RunPercept | None:
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
    way, speed, asked, felt = (
        np.concatenate([getattr(run, name) for run in runs])
        for name in ("stretch", "speed", "asked", "felt")
    )
    mean = abs(float(np.mean(way)))
    found = evidence(observer, amplitude, channel_gains(observer, speed), mean)
    lengths = np.array([run.length for run in runs])
    rhythms = candidates(observer, found, float(share @ lengths / share.sum()))
    return RunPercept(
        percept=Percept(found, rhythms, mean),
        runs=len(runs),
        way=float(lengths.sum()),
        mean_speed=float(lengths.sum() / sum(run.duration for run in runs)),
        asked_swing=float(np.std(asked)),
        felt_swing=float(np.std(felt)),
    )
