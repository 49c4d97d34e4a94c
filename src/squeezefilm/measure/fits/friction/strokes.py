"""The sliding parts of a friction bench's recording, one row of numbers to a stroke."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.recordings.assembled_friction import smoothed
from squeezefilm.measure.recordings.kinds import FrictionBench

_FEWEST_POINTS = 100
# Of what is usual in the recording: slower is turning around, lighter is lifting off.
_MOVING, _TOUCHING = 0.6, 0.4
_SHORTEST: si.Second = 0.1
# Left out at each end of a stroke, where the skin is still being stretched.
_TRIMMED = 0.15
# An amplitude counts as kept within this share of the largest.
_SAME_AMPLITUDE = 0.05
_FEWEST_OF_A_STROKE = 10


class Stroke(NamedTuple):
    """Means over a stroke's sliding part: `time` (s) of its middle, `coefficient` of friction,
    `amplitude` (m), `speed` (m/s), `force` (N), `direction` (1 or −1 along the position)."""

    time: si.Second
    coefficient: si.Dimensionless
    amplitude: si.Metre
    speed: si.MetrePerSecond
    force: si.Newton
    direction: float


@dataclass(frozen=True)
class Strokes:
    """The strokes of a recording in order of time, and the share of its points that are in them."""

    rows: tuple[Stroke, ...]
    used: si.Dimensionless

    def column(self, name: str) -> si.FloatArray:
        """Column of one number of every stroke, by its name."""
        return np.array([getattr(row, name) for row in self.rows])


def sliding_strokes(recording: FrictionBench) -> Strokes:
    """Strokes in which a finger or probe slides in one direction at an even amplitude, and what it
    felt.

    Sliding is at least 60 % of the usual speed under at least 40 % of the usual force, for at
    least 0.1 s, less 15 % at each end; where the amplitude changes on the way, the longest even
    part. The coefficient is the mean tangential over the mean normal force, so that noise on the
    normal force does not bias it. Raises `InputError` for a recording without two such strokes.
    """
    t, normal, tangential, position, amplitude = _finite(recording)
    if t.size < _FEWEST_POINTS or np.any(np.diff(t) <= 0):
        raise InputError(
            f"the friction bench has {t.size} usable points; at least {_FEWEST_POINTS} are wanted, "
            "their time rising from one to the next"
        )
    # Its noise averaged over some hundredths of a second.
    speed = smoothed(t, np.gradient(position, t))
    size = np.abs(speed)
    usual, pressed = _usual(size), _usual(normal)
    sliding = (size > _MOVING * usual) & (normal > _TOUCHING * pressed)
    which = np.where(sliding, np.sign(speed), 0.0)
    # A gap in the recording ends a stroke.
    gap = np.diff(t) > 10 * np.median(np.diff(t))
    edges = np.flatnonzero((np.diff(which) != 0) | gap) + 1
    tolerated = _SAME_AMPLITUDE * max(float(np.max(amplitude)), 1e-12)
    rows, used = [], 0
    for part in np.split(np.arange(t.size), edges):
        if which[part[0]] == 0 or t[part[-1]] - t[part[0]] < _SHORTEST:
            continue
        even = _even_part(part, amplitude, tolerated)
        if even.size >= _FEWEST_OF_A_STROKE:
            used += even.size
            rows.append((even, which[part[0]]))
    if len(rows) < 2:
        raise InputError(
            f"the friction bench has {len(rows)} sliding strokes of at least 0.1 s at an even "
            "amplitude; at least 2 are wanted: look at its position, force and amplitude"
        )
    against = -np.sign(sum(way * float(np.sum(tangential[part])) for part, way in rows)) or -1.0
    strokes = tuple(
        Stroke(
            time=float(np.mean(t[part])),
            coefficient=float(-against * way * np.mean(tangential[part]) / np.mean(normal[part])),
            amplitude=float(np.mean(amplitude[part])),
            speed=float(np.mean(size[part])),
            force=float(np.mean(normal[part])),
            direction=float(way),
        )
        for part, way in rows
    )
    return Strokes(strokes, used / t.size)


def _finite(recording: FrictionBench) -> tuple[si.FloatArray, ...]:
    """Time, both forces, position and amplitude where all are finite."""
    columns = np.array(
        [
            recording.time,
            recording.normal_force,
            recording.tangential_force,
            recording.position,
            recording.vibration_amplitude,
        ],
        dtype=float,
    )
    return tuple(columns[:, np.all(np.isfinite(columns), axis=0)])


def _usual(values: si.FloatArray) -> float:
    """The median of what is well above nothing; infinite where nothing is."""
    large = values[values > max(0.3 * float(np.percentile(values, 95)), 0.0)]
    return float(np.median(large)) if large.size else float("inf")


def _even_part(part: si.IntArray, amplitude: si.MetreArray, tolerated: float) -> si.IntArray:
    """The points of a stroke without its ends, where the amplitude is even for longest."""
    cut = int(_TRIMMED * part.size)
    part = part[cut : part.size - cut]
    own = amplitude[part]
    edges = [0, *(np.flatnonzero(np.abs(np.diff(own)) > tolerated) + 1), own.size]
    longest = int(np.argmax(np.diff(edges)))
    even = slice(edges[longest], edges[longest + 1])
    # An amplitude that creeps has no step, and is still none.
    return part[even] if np.ptp(own[even]) <= 4 * tolerated else part[:0]
