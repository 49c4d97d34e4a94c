"""The hand: where it wants the finger, and how hard it presses, at each µs of the twin's time.

The arm leads the finger along a motion through a spring and a damper, so that friction drags it.
Motions repeat: one that does not end where it began is gone back along.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.render.motion.stroke import FingerPath
from squeezefilm.physics.texture_files.trajectories import Motion, motion_from

EXPLORING = "60 mm in 0.75 s"
"""A pass of least jerk with a mean speed of 80 mm/s: people explore at 77 to 86 mm/s with 0.5 to
0.64 N (Smith, Gosselin and Houde 2002, s00221-002-1240-4)."""
_MOST_SAMPLES = 2_000_000
_LONGEST: si.Second = 86_400.0

# Places in the plan's array, all µs but the last two.
BEGIN, PASS, LIFT, PRESS, SAMPLE, MIRRORED = range(6)


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class Hand:
    """A finger led along a motion, again and again.

    Args:
        motion: one pass or more, see `motion_from`.
        normal_force: it presses with (N); above 0.
        begin: when it touches and sets off (s); at least 0.
        lift: how long it stays in the air at the end of each repeat (s); 0 keeps it down.
        press: how long it takes to press and to let go (s); above 0.

    Raises:
        InputError: a value outside its range, or a motion longer than a day.
    """

    motion: Motion
    normal_force: Annotated[si.Newton, si.Above(0.0), si.AtMost(20.0)] = 0.5
    begin: Annotated[si.Second, si.AtLeast(0.0), si.AtMost(_LONGEST)] = 0.1
    lift: Annotated[si.Second, si.AtLeast(0.0), si.AtMost(_LONGEST)] = 0.0
    press: Annotated[si.Second, si.AtLeast(1e-06), si.AtMost(_LONGEST)] = 0.05

    def __post_init__(self) -> None:
        si.require("the motion's duration", self.motion.duration, si.Unit("s"), at_most=_LONGEST)

    def path(self, tick: int) -> tuple[si.FloatArray, NDArray[np.int64]]:
        """One motion as places (m), shape (2, n), and the plan, shape (6,), for `wanted`.

        `tick` (µs) is the time between places, longer where they would be more than two million.
        """
        duration = self.motion.duration
        length = max(round(duration * 1e6), 1)
        sample = tick * max(1, math.ceil(length / (tick * _MOST_SAMPLES)))
        count = math.ceil(length / sample) + 1
        times = np.minimum(np.arange(count) * (sample * 1e-6), duration)
        if isinstance(self.motion, FingerPath):
            x, y = self.motion.place(times)
        else:
            x = self.motion.position(times)
            y = np.zeros(count)
        places = np.ascontiguousarray(np.stack([x, y]), dtype=float)
        apart = float(np.hypot(x[-1] - x[0], y[-1] - y[0]))
        plan = [
            round(self.begin * 1e6),
            length,
            round(self.lift * 1e6),
            max(1, round(self.press * 1e6)),
            sample,
            int(apart > 1e-6),
        ]
        return places, np.array(plan, dtype=np.int64)


def hand_from(stroke: str | Path = EXPLORING, **how: Any) -> Hand:
    """The hand that makes a motion in words or from a CSV file (`motion_from`).

    `how` are the other arguments of `Hand`. Raises `InputError` or `ConfigError` for a motion that
    cannot be used.
    """
    return Hand(motion_from(stroke), **how)


@compiled()
def wanted(time: int, places: si.Array, plan: si.Array) -> Any:
    """x, y (m), and the force over the full one (1), that the hand wants at a time (µs)."""
    since = time - plan[BEGIN]
    last = places.shape[1] - 1
    if since < 0:
        return places[0, 0], places[1, 0], 0.0
    cycle = plan[PASS] + plan[LIFT]
    number = since // cycle
    part = min(since - number * cycle, plan[PASS])
    # Without a lift it presses once and stays down.
    down = min(part, plan[PASS] - part) if plan[LIFT] > 0 else since
    if plan[MIRRORED] == 1 and number % 2 == 1:
        part = plan[PASS] - part
    k = min(part // plan[SAMPLE], last - 1)
    span = min(plan[SAMPLE], plan[PASS] - k * plan[SAMPLE])
    share = (part - k * plan[SAMPLE]) / span
    x = places[0, k] + share * (places[0, k + 1] - places[0, k])
    y = places[1, k] + share * (places[1, k + 1] - places[1, k])
    return x, y, max(0.0, min(1.0, down / plan[PRESS]))
