"""Friction against amplitude, speed and force, out of the strokes of a bench.

The unit of evidence is a stroke: thousands of samples of one stroke tell of that stroke only, and a
finger differs from stroke to stroke. All intervals are of the spread between strokes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import (
    Adequacy,
    Estimate,
    FitResult,
    Observation,
    adequacy_of,
    guarded_fit,
    interval_around,
    observed,
)
from squeezefilm.measure.fits.least_squares import SeparableFit, linear_fit
from squeezefilm.measure.recordings.assembled_friction import smoothed
from squeezefilm.measure.recordings.kinds import FrictionBench, finite

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
    t, normal, tangential, position, amplitude = finite(
        recording.time,
        recording.normal_force,
        recording.tangential_force,
        recording.position,
        recording.vibration_amplitude,
    )
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


# By the degree in time; a finger sweats or dries.
_DRIFT = ("drift", "bend of the drift")
_Flags = np.ndarray[tuple[int, ...], np.dtype[np.bool]]
# Amplitudes nearer than this share of the largest are one level.
_LEVEL = 0.04
_MOST_LEVELS = 24
# Speeds or forces that vary less (one standard deviation of the logarithm) tell of no exponent.
_VARIED = 0.08
# Below this share of the friction at the least amplitude a finger as good as floats: what a sensor
# reads there is its own noise, whose logarithm says nothing.
_FLOATING = 0.03
# Where drift makes an interval wider by so much, it went with the amplitude.
_CONFOUNDED = 3.0


@dataclass(frozen=True, eq=False, repr=False)
class FrictionBenchFit(FitResult):
    """µ of a finger by amplitude, at the bench's usual `speed` (m/s) and `normal_force` (N).

    `amplitudes` (m) are the levels; `coefficients` µ at each, as it was in the middle of the
    session; `relative_friction` µ′/µ at each but the first, over the level without vibration (empty
    where there was none). `speed_exponent` and `force_exponent` are d ln µ/d ln v and
    d ln µ/d ln F without vibration, None where the bench hardly varied them. `drift` (1) is how
    much ln µ rose from the first stroke to the last, all else being equal. `between_strokes` is
    the standard deviation of ln µ between strokes that should be alike.
    """

    recording: FrictionBench
    strokes: Strokes
    amplitudes: si.MetreArray
    speed: si.MetrePerSecond
    normal_force: si.Newton
    coefficients: tuple[Estimate, ...]
    relative_friction: tuple[Estimate, ...]
    speed_exponent: Estimate | None
    force_exponent: Estimate | None
    drift: Estimate
    between_strokes: si.Dimensionless

    @property
    def observations(self) -> tuple[Observation, ...]:
        """Observations for a calibration: µ without vibration, and µ′/µ at every amplitude; none
        where the fit is not adequate."""
        at = {"finger_speed": self.speed, "normal_force": self.normal_force}
        if self.recording.frequency is not None:
            at |= {"frequency": self.recording.frequency}
        if not self.relative_friction or not self.adequacy.adequate:
            return ()
        seen = list(observed(at, friction_coefficient=self.coefficients[0]))
        for amplitude, estimate in zip(self.amplitudes[1:], self.relative_friction, strict=True):
            vibrating = at | {"vibration_amplitude": float(amplitude)}
            seen += observed(vibrating, relative_friction=estimate)
        return tuple(seen)


@guarded_fit
def fit_friction_bench(recording: FrictionBench) -> FrictionBenchFit:
    """µ and µ′/µ against amplitude (m), speed (m/s) and force (N), drift of the finger taken out.

    ln µ of every stroke is a level for its amplitude, exponents of speed and force (and how these
    change with the amplitude), a square polynomial in time for a finger that sweats or
    dries, and the direction of the stroke (a force sensor's zero). What is left is the spread
    between strokes, of which intervals are made. Amplitude and drift are told apart only where
    amplitudes came in a mixed order: where they did not, `adequacy` says so. Needs more strokes
    than numbers to fit. Raises `InputError` for too few strokes, more than 24 amplitudes, or no
    friction at the least amplitude. Amplitudes at which a stroke has none are left out, and said.
    """
    strokes = sliding_strokes(recording)
    strokes, floating = _touching(strokes)
    fit = _Fitted.of(strokes).read(recording)
    if not floating:
        return fit
    shown = " and ".join(f"{1e6 * amplitude:.3g} µm" for amplitude in floating)
    said = (
        f"At {shown} strokes have next to no friction; what floats has no coefficient "
        "on a logarithmic scale, and these amplitudes are left out. "
    )
    adequacy = replace(fit.adequacy, sentence=said + fit.adequacy.sentence)
    return replace(fit, adequacy=adequacy)


def _touching(strokes: Strokes) -> tuple[Strokes, tuple[si.Metre, ...]]:
    """The strokes of amplitudes at which all have friction, and the other amplitudes (m).

    Raises `InputError` where the least amplitude is among these.
    """
    coefficient = strokes.column("coefficient")
    levels, number = _levels(strokes.column("amplitude"))
    own = [coefficient[number == i] for i in range(levels.size)]
    little = _FLOATING * float(np.median(own[0]))
    none = [i for i, row in enumerate(own) if np.min(row) <= 0 or np.median(row) < little]
    if 0 in none:
        at = strokes.rows[int(np.argmin(np.where(number == 0, coefficient, np.inf)))]
        raise InputError(
            f"the stroke at {at.time:.4g} s, at the least amplitude, has a friction coefficient of "
            f"{at.coefficient:.3g}; it must be above 0: check the zero and the sign of the "
            "tangential force"
        )
    rows = tuple(row for row, i in zip(strokes.rows, number, strict=True) if i not in none)
    return replace(strokes, rows=rows), tuple(float(levels[i]) for i in none)


def _levels(amplitude: si.MetreArray) -> tuple[si.MetreArray, si.IntArray]:
    """The amplitudes that were set, and which of them each stroke had."""
    order = np.argsort(amplitude, kind="stable")
    steps = np.diff(amplitude[order]) > _LEVEL * max(float(amplitude.max()), 1e-12)
    number = np.empty(amplitude.size, dtype=np.int64)
    number[order] = np.concatenate([[0], np.cumsum(steps)])
    count = int(number.max()) + 1
    if count > _MOST_LEVELS:
        raise InputError(
            f"the strokes have {count} different amplitudes; at most {_MOST_LEVELS} are fitted: "
            "hold the amplitude at set levels"
        )
    return np.array([amplitude[number == i].mean() for i in range(count)]), number


@dataclass(frozen=True, eq=False)
class _Fitted:
    """ln µ of `strokes` by the columns of a `matrix`: first one for each of the `levels`, then
    those whose `names` say it."""

    strokes: Strokes
    levels: si.MetreArray
    middle: Mapping[str, float]
    names: tuple[str, ...]
    matrix: si.FloatArray
    fit: SeparableFit

    @classmethod
    def of(cls, strokes: Strokes) -> _Fitted:
        """Raises `InputError` for too few strokes, or columns that cannot be told apart."""
        levels, number = _levels(strokes.column("amplitude"))
        share = levels[number] / max(levels[-1], 1e-15)
        columns = {f"level {i}": (number == i).astype(float) for i in range(levels.size)}
        middle = {}
        for name in ("speed", "force"):
            logs = np.log(strokes.column(name))
            middle[name] = float(np.exp(np.mean(logs)))
            if np.std(logs) > _VARIED:
                columns[name] = logs - logs.mean()
                if levels.size > 1:
                    columns[f"{name} by amplitude"] = columns[name] * share
        t = strokes.column("time")
        place = 2 * (t - t[0]) / max(t[-1] - t[0], 1e-12) - 1
        # Orthogonal over the strokes, so that levels are those of the session's middle.
        basis = np.polynomial.legendre.legvander(place, len(_DRIFT))[:, 1:]
        columns |= dict(zip(_DRIFT, (basis - basis.mean(axis=0)).T, strict=True))
        direction = strokes.column("direction")
        if np.ptp(direction) > 0:
            columns["direction"] = direction - direction.mean()
        matrix = np.stack(list(columns.values()), axis=1)
        if len(strokes.rows) < len(columns) + 2:
            raise InputError(
                f"{len(strokes.rows)} strokes were recorded; {levels.size} amplitudes, "
                f"drift and what else varied need at least {len(columns) + 2}"
            )
        if np.linalg.matrix_rank(matrix) < len(columns):
            raise InputError(
                "amplitude, speed, force and time of the strokes went together, so that none can "
                "be told from the others; vary them in a mixed order"
            )
        fit = linear_fit(matrix, np.log(strokes.column("coefficient")))
        return cls(strokes, levels, middle, tuple(columns), matrix, fit)

    @property
    def drifts(self) -> _Flags:
        """Flags of the drift's columns."""
        return np.isin(self.names, _DRIFT)

    def sum(self, row: si.FloatArray, *, exponential: bool = False) -> Estimate:
        """A weighted sum of the fitted numbers, or e to that."""
        error = math.sqrt(max(float(row @ self.fit.covariance @ row), 0.0))
        value, freedom = float(row @ self.fit.weights), self.fit.freedom
        return interval_around(value, error, freedom, "1", logarithmic=exponential)

    def read(self, recording: FrictionBench) -> FrictionBenchFit:
        count, alone = self.levels.size, np.eye(self.matrix.shape[1])
        still = self.levels[0] < _LEVEL * self.levels[-1] or count == 1
        exponents = {name: self.sum(row) for name, row in zip(self.names, alone, strict=True)}
        return FrictionBenchFit(
            recording=recording,
            strokes=self.strokes,
            amplitudes=self.levels,
            speed=self.middle["speed"],
            normal_force=self.middle["force"],
            coefficients=tuple(self.sum(row, exponential=True) for row in alone[:count]),
            relative_friction=tuple(
                self.sum(row - alone[0], exponential=True) for row in alone[1:count] if still
            ),
            speed_exponent=exponents.get("speed"),
            force_exponent=exponents.get("force"),
            drift=self.sum((self.matrix[-1] - self.matrix[0]) * self.drifts),
            between_strokes=float(np.sqrt(np.sum(self.fit.residual**2) / self.fit.freedom)),
            adequacy=self._adequacy(),
        )

    def _adequacy(self) -> Adequacy:
        friction = self.strokes.column("coefficient")
        adequacy = adequacy_of(
            friction,
            friction - np.exp(self.fit.model),
            lambda i: f"at {self.strokes.rows[i].time:.4g} s",
            remedy="The finger changed otherwise than by a slow drift: leave out what went wrong.",
        )
        confounded = self._confounded()
        if confounded is None:
            return adequacy
        where = f"at {1e6 * self.levels[confounded]:.3g} µm"
        sentence = (
            "Amplitude and time went together: the drift of the finger makes the interval "
            f"{where} more than {_CONFOUNDED:g} times as wide. Repeat it with amplitudes in a "
            f"mixed order. {adequacy.sentence}"
        )
        return replace(adequacy, adequate=False, where=where, sentence=sentence)

    def _confounded(self) -> int | None:
        """The level whose difference from the first one drift widens most, if by too much."""
        count = self.levels.size
        if count < 2:
            return None
        # In units of the noise: what the columns alone do, of which those of levels come first.
        apart = np.eye(count)[1:] - np.eye(count)[0]
        whole, without = (
            np.diag(apart @ np.linalg.pinv(m.T @ m)[:count, :count] @ apart.T)
            for m in (self.matrix, self.matrix[:, ~self.drifts])
        )
        ratio = np.sqrt(whole / without)
        worst = int(np.argmax(ratio))
        return worst + 1 if ratio[worst] > _CONFOUNDED else None
