"""Estimator of a finger's place and speed from samples that are noisy, late and irregular.

The finger's acceleration (or jerk) is taken as white noise: over a time h without news its state
(x, v, a) is carried along by x + v h + a h²/2, and its covariance grows by

    white acceleration, density q_a (m²/s³):  Var x += q_a h³/3,  Var v += q_a h
    white jerk, density q_j (m²/s⁵):  Var x += q_j h⁵/20,  Var v += q_j h³/3,  Var a += q_j h

and each sample is blended in by the Kalman gain. For a motion made by that noise and Gaussian
sensor noise no estimator, however built, has a smaller RMS error (R. E. Kalman 1960,
10.1115/1.3662552; Y. Bar-Shalom, X. R. Li, T. Kirubarajan, *Estimation with Applications to
Tracking and Navigation*, 2001, ch. 6). A hand is not white noise: for it the model is a choice
of how fast to forget.

The step itself (`motion_kernel.motion_step`, `motion_at`) is compiled, allocates nothing and
never raises; what it cannot use it counts. `estimate_motion` runs the same code over arrays.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.motion import kernel
from squeezefilm.physics.render.motion.sensor import SensorModel, SensorStream

MetrePerSecondSquared = Annotated[float, si.Unit("m/s2")]
AccelerationDensity = Annotated[float, si.Unit("m2/s3")]
JerkDensity = Annotated[float, si.Unit("m2/s5")]


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class MotionModel:
    """Model of a finger before any sample: how it starts and how it changes.

    Args:
        acceleration_density: of white acceleration, q_a (m²/s³); at least 0.
        jerk_density: of white jerk, q_j (m²/s⁵); at least 0. One of the two must be above 0.
        speed_deviation: standard deviation of the speed at the first sample (m/s); above 0.
        acceleration_deviation: of the acceleration then (m/s²); at least 0, and 0 for a model
            without jerk.

    The default is assumed: white jerk of a strength that fits a hand going to and fro. A
    minimum-jerk pass of 40 mm in 0.4 s has a mean square jerk of 720 L²/T⁶ = 281 (m/s³)² and
    changes its sign about every T/3, which makes a density of some 40 m²/s⁵.

    Raises:
        InputError: a value outside its range.
    """

    acceleration_density: Annotated[AccelerationDensity, si.AtLeast(0.0)] = 0.0
    jerk_density: Annotated[JerkDensity, si.AtLeast(0.0)] = 40.0
    speed_deviation: Annotated[si.MetrePerSecond, si.Above(0.0)] = 0.15
    acceleration_deviation: Annotated[MetrePerSecondSquared, si.AtLeast(0.0)] = 2.0

    def __post_init__(self) -> None:
        if self.acceleration_density == 0.0 and self.jerk_density == 0.0:
            raise InputError(
                "acceleration_density and jerk_density are both 0: such a finger never changes "
                "its motion, and an estimator would stop listening; give one of them"
            )
        if self.jerk_density == 0.0 and self.acceleration_deviation > 0.0:
            raise InputError(
                f"acceleration_deviation = {self.acceleration_deviation:g} m/s2 with jerk_density "
                "= 0: an acceleration without jerk would last for ever; give 0"
            )


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class MotionEstimator:
    """The settings of an estimator; its running state is an array from `new_state`.

    Args:
        model: what is assumed of the finger.
        position_error: standard deviation of a sample's position (m); above 0.
        stamp_error: standard deviation of a sample's time (s), counted as a position error of
            speed × stamp error; at least 0.
        gate: a sample further from its prediction than this many standard deviations is an
            outlier (1); above 0. 5 rejects six good samples in ten million.
        most_rejected: outliers in a row after which the estimator starts anew from the last one;
            1 starts anew at each.
        stall: time without a sample after which the finger counts as lost (s); above 0.

    Raises:
        InputError: a value outside its range.
    """

    model: MotionModel
    position_error: Annotated[si.Metre, si.Above(0.0)]
    stamp_error: Annotated[si.Second, si.AtLeast(0.0)] = 0.0
    gate: Annotated[si.Dimensionless, si.Above(0.0)] = 5.0
    most_rejected: Annotated[int, si.AtLeast(1)] = 3
    stall: Annotated[si.Second, si.Above(0.0)] = 0.1

    @classmethod
    def for_sensor(cls, sensor: SensorModel, model: MotionModel | None = None) -> MotionEstimator:
        """The estimator that knows a sensor's errors; lost after 6 samples or 0.1 s."""
        return cls(
            MotionModel() if model is None else model,
            sensor.position_error,
            sensor.stamp_error,
            stall=max(0.1, 6 / sensor.rate),
        )

    def parameters(self) -> si.FloatArray:
        """The settings as the compiled step takes them (SI), shape (9,)."""
        m = self.model
        return np.array(
            [
                m.acceleration_density,
                m.jerk_density,
                self.position_error**2,
                self.stamp_error**2,
                m.speed_deviation**2,
                m.acceleration_deviation**2,
                self.gate**2,
                self.stall,
                float(self.most_rejected),
            ]
        )

    def new_state(self) -> si.FloatArray:
        """The state before the first sample, shape (19,): see `motion_kernel`."""
        return np.zeros(kernel.STATE_SIZE)


@dataclass(frozen=True, slots=True)
class MotionCounts:
    """Counts of what became of the samples, and of how often the estimator started anew."""

    used: int
    not_finite: int
    duplicate: int
    backwards: int
    outlier: int
    stall: int
    restart: int

    @classmethod
    def of(cls, state: si.FloatArray) -> MotionCounts:
        """The counts in an estimator's state."""
        first = kernel.USED
        return cls(*(int(count) for count in state[first : kernel.STATE_SIZE]))


@dataclass(frozen=True, slots=True, eq=False)
class MotionEstimate:
    """A finger's motion as it was known at each render time; arrays of shape (times,).

    Attributes:
        estimator: the settings that made it.
        time: for which the estimate holds: render time plus what was looked ahead (s).
        position, speed: estimated (m, m/s); speed is signed.
        position_deviation, speed_deviation: what the filter believes its standard deviations to
            be (m, m/s); infinite where there is no fresh sample.
        fresh: whether the estimate rests on a sample younger than the stall limit.
        counts: what became of the samples.
    """

    estimator: MotionEstimator
    time: si.SecondArray
    position: si.MetreArray
    speed: si.MetrePerSecondArray
    position_deviation: si.MetreArray
    speed_deviation: si.MetrePerSecondArray
    fresh: Annotated[NDArray[np.bool_], si.Unit("1")]
    counts: MotionCounts


@si.checked_numbers
def estimate_motion(
    estimator: MotionEstimator,
    stream: SensorStream,
    render: si.SecondArray,
    ahead: Annotated[si.Second, si.AtLeast(0.0)] = 0.0,
) -> MotionEstimate:
    """The finger's motion at each render time, from the samples that had arrived by then.

    The same compiled step as in a loop. Prediction spans the sensor's latency (stamps say how old
    a sample is), the time since the last sample, and `ahead`.

    Args:
        estimator: the settings.
        stream: samples in order of arrival.
        render: times at which the estimate is wanted (s), rising, shape (times,).
        ahead: how far past each render time to predict (s), as for a drive that answers late;
            at least 0.

    Raises:
        InputError: render times that are empty, not finite or falling, or `ahead` below 0.
    """
    times = np.ascontiguousarray(render, dtype=float)
    if times.ndim != 1 or times.size == 0 or bool(np.any(np.diff(times) < 0)):
        raise InputError(
            f"render of shape {times.shape} cannot be used: give at least one time, none before "
            "the one ahead of it"
        )
    state = estimator.new_state()
    out, code = np.empty((4, times.size)), np.empty(times.size, dtype=np.int64)
    settings = estimator.parameters()
    stamp, arrival, position = stream.stamp, stream.arrival, stream.position
    kernel.motion_march(state, settings, stamp, arrival, position, times, ahead, out, code)
    x, v, dx, dv = out
    return MotionEstimate(
        estimator, times + ahead, x, v, dx, dv, code == kernel.FRESH, MotionCounts.of(state)
    )
