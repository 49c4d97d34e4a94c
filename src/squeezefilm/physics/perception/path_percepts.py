"""Percept of a finger's own path over a surface, through the whole chain.

The path goes through the loop, the friction and the skin as a simulated stroke does (`percepts`),
and the same senses look at the same lines along its way, run by run (`path_runs`). Runs along x and
runs along y are felt apart. Nothing is tuned for it: of the simulated stroke itself, given as a
path, this is the percept of that stroke.

A period is felt on runs that hold it twice. Of the runs in one direction those count that are at
least half as long as the longest: a short one tells periods apart so badly that it would blur the
lines of the others. The skin is dragged along the path: what it does across
it, where the finger turns, is left out with the first two millimetres of each run.
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
from squeezefilm.physics.perception.path_runs import straight_runs
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

_SEED = 0
_ROUNDING: si.Metre = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class RunPercept:
    """Percept of the runs in one direction.

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
        """Period of the most evident rhythm (m); NaN where there is none."""
        rhythms = self.percept.candidates
        return float(rhythms.period[0]) if np.isfinite(rhythms.d_prime[0]) else math.nan

    @property
    def clearest_d_prime(self) -> si.Dimensionless:
        """Evidence of the most evident rhythm (1); 0 where there is none."""
        return max(float(self.percept.candidates.d_prime[0]), 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class PathPercept:
    """Percept of a path over a surface: on its runs `along` x and `across`, along y; None where
    there is no run. `played` is how each part of the path was rendered."""

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
    """Percept of a surface on a display along a finger's own path.

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
    played, runs = [], []
    for path in paths:
        rendered = render_texture(
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
        played.append(rendered)
        runs += _runs_of(rendered, path)
    if not runs:
        raise InputError(
            "the path has no straight run of 4 mm or more, along which a rhythm could be felt; "
            "check its unit (x_m in metres), or give a longer one"
        )
    along, across = ([run for run in runs if run.along_x is which] for which in (True, False))
    return PathPercept(_felt(observer, along), _felt(observer, across), tuple(played))


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

        runs.append(
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
    return runs


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
    heard = evidence(observer, amplitude, channel_gains(observer, speed), mean)
    lengths = np.array([run.length for run in runs])
    rhythms = candidates(observer, heard, float(share @ lengths / share.sum()))
    return RunPercept(
        percept=Percept(heard, rhythms, mean),
        runs=len(runs),
        way=float(lengths.sum()),
        mean_speed=float(lengths.sum() / sum(run.duration for run in runs)),
        asked_swing=float(np.std(asked)),
        felt_swing=float(np.std(felt)),
    )
