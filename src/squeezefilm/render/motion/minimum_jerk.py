"""A hand going to and fro: passes of least jerk, which speed up, slow down and turn softly.

Reaching movements of a hand follow x = L (10 s³ − 15 s⁴ + 6 s⁵), s = t/T, closely (T. Flash and
N. Hogan 1985, 10.1523/JNEUROSCI.05-07-01688.1985). As a trajectory it is what an estimator that
believes in white jerk has to live with.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Protocol

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.hard_limits import PASS_DURATION, STROKE_LENGTH, STROKE_START


class Trajectory(Protocol):
    """A finger's motion along x: how long it lasts and where it is. `Stroke` is one."""

    @property
    def duration(self) -> si.Second:
        """Time the motion takes (s)."""
        ...

    @si.checked_numbers
    def position(self, t: si.SecondLike, /) -> si.MetreArray:
        """Position at time t (m), 0 ≤ t ≤ duration, in the shape of `t`."""
        ...


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class MinimumJerkStroke:
    """A finger's motion along x: `passes` passes of `length`, each of least jerk, to and fro.

    Args:
        length: of one pass (m); above 0, at most 10 m.
        pass_duration: time one pass takes (s); above 0.
        passes: 1 is there, 2 there and back, and so on.
        start: x where the first pass begins (m); it goes towards +x.

    Raises:
        InputError: a value outside its range.
    """

    length: Annotated[si.Metre, STROKE_LENGTH] = 0.04
    pass_duration: Annotated[si.Second, PASS_DURATION] = 0.4
    passes: Annotated[int, si.AtLeast(1)] = 2
    start: Annotated[si.Metre, STROKE_START] = 0.0

    @property
    def duration(self) -> si.Second:
        """Time the whole motion takes (s)."""
        return self.passes * self.pass_duration

    @si.checked_numbers
    def position(self, t: si.SecondLike) -> si.MetreArray:
        """Position x of the finger at time `t` since the motion began (m), in the shape of `t`.

        Raises:
            InputError: a time before the motion or after its end.
        """
        si.require("t", t, si.Unit("s"), at_least=0.0, at_most=self.duration * (1 + 1e-12))
        passed = np.asarray(t, dtype=float) / self.pass_duration
        done = np.minimum(np.floor(passed), self.passes - 1)
        s = np.clip(passed - done, 0.0, 1.0)
        along = self.length * s**3 * (10 + s * (6 * s - 15))
        return np.asarray(self.start + np.where(done % 2 == 0, along, self.length - along))
