"""A finger's motion as a display knows it: what a sensor reports of it, noisy, late and
irregular, and the place and speed that are estimated from this.

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

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import MOTION_SAMPLES, require_motion


# Finger sensors as numbers. A touch panel samples the finger seldom, late and irregularly; a
# displacement transducer samples it often and at once. `SensorModel` holds what matters of either,
# `sensor_stream` plays it on any motion, with a seed. The presets are assumed: their numbers are
# typical of such devices, none was measured or published for one.
@si.checked_numbers
@dataclass(frozen=True, slots=True)
class SensorModel:
    """A sensor of finger position: how often, how late, how irregular and how noisy it is.

    Args:
        name: what it is called.
        rate: samples taken per second (Hz); above 0.
        latency: mean time from taking a sample to having it (s); at least 0.
        jitter: standard deviation of that time, Gaussian, never below zero delay (s); at least 0.
        noise: standard deviation of position, Gaussian and white (m); at least 0.
        quantisation: step of the positions reported (m); 0 for none.
        loss: share of the samples that never arrive (1); at least 0, below 1.
        stamped: whether samples carry the time at which they were taken. If not, the host takes
            arrival minus `latency` for it, which is wrong by the jitter.
        evidence: where the numbers are from.

    Raises:
        InputError: a value outside its range, or a sensor whose positions have no error at all
            (no estimator's covariance exists then).
    """

    name: str
    rate: Annotated[si.Hertz, si.Above(0.0)]
    latency: Annotated[si.Second, si.AtLeast(0.0)]
    jitter: Annotated[si.Second, si.AtLeast(0.0)] = 0.0
    noise: Annotated[si.Metre, si.AtLeast(0.0)] = 0.0
    quantisation: Annotated[si.Metre, si.AtLeast(0.0)] = 0.0
    loss: Annotated[si.Dimensionless, si.AtLeast(0.0), si.Below(1.0)] = 0.0
    stamped: bool = True
    evidence: str = "assumed"

    def __post_init__(self) -> None:
        if self.noise == 0.0 and self.quantisation == 0.0:
            raise InputError(
                f"sensor '{self.name}' has noise = 0 m and quantisation = 0 m: no sensor is exact; "
                "give one of them"
            )

    @property
    def position_error(self) -> si.Metre:
        """Standard deviation of a position reported (m): noise and quantisation step/√12."""
        return math.hypot(self.noise, self.quantisation / math.sqrt(12))

    @property
    def stamp_error(self) -> si.Second:
        """Standard deviation of the time a sample is taken to be from (s)."""
        return 0.0 if self.stamped else self.jitter


TOUCH_PANEL_60_HZ = SensorModel(
    "touch panel 60 Hz", 60.0, 20e-3, jitter=2e-3, noise=50e-6, quantisation=50e-6, stamped=False
)
"""A plain touch screen, read through an operating system (assumed)."""

TOUCH_PANEL_120_HZ = SensorModel(
    "touch panel 120 Hz", 120.0, 12e-3, jitter=1e-3, noise=40e-6, quantisation=50e-6, stamped=False
)
"""A fast touch screen (assumed)."""

TOUCH_PANEL_240_HZ = SensorModel(
    "touch panel 240 Hz", 240.0, 8e-3, jitter=0.5e-3, noise=30e-6, quantisation=25e-6
)
"""A touch controller read directly, with stamps (assumed)."""

LVDT_10_KHZ = SensorModel("LVDT 10 kHz", 10e3, 0.2e-3, noise=2e-6, quantisation=1e-6)
"""A displacement transducer tied to the finger, on an instrument's converter (assumed)."""

SENSORS: dict[str, SensorModel] = {
    sensor.name: sensor
    for sensor in (TOUCH_PANEL_60_HZ, TOUCH_PANEL_120_HZ, TOUCH_PANEL_240_HZ, LVDT_10_KHZ)
}
"""The presets by name; all assumed."""


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class SensorStream:
    """Samples that a sensor reported, in the order of arrival; arrays of shape (samples,).

    Attributes:
        sensor, seed: the inputs.
        taken: when each sample was really taken (s); nobody but a simulation knows.
        stamp: when it is said to have been taken (s).
        arrival: when it was there to be used (s); never falls.
        position: reported (m).
    """

    sensor: SensorModel
    seed: int
    taken: si.SecondArray
    stamp: si.SecondArray
    arrival: si.SecondArray
    position: si.MetreArray


@si.checked_numbers
def sensor_stream(
    sensor: SensorModel,
    position: Callable[[si.SecondArray], si.MetreArray],
    duration: Annotated[si.Second, si.Above(0.0)],
    seed: Annotated[int, si.AtLeast(0)],
) -> SensorStream:
    """Samples that a sensor reports of a motion.

    The first sample is taken at its start, as if the sensor had woken to the touch. Samples arrive
    in the order in which they were taken, as over one wire.

    Args:
        sensor: the sensor.
        position: times (s, shape (n,)) → true positions (m, the same shape).
        duration: of the motion (s); above 0.
        seed: of noise, jitter and loss.

    Raises:
        InputError: a duration not above 0, more than 20 million samples, or positions that are
            not finite or have another shape than the times.
    """
    steps = duration * sensor.rate * (1 + 1e-12)
    require_motion(MOTION_SAMPLES, steps + 2, duration, sensor.rate)
    count = math.floor(steps) + 1
    random = np.random.default_rng(seed)
    taken = np.minimum(np.arange(count) / sensor.rate, duration)
    true = si.returned("position", position(taken), taken, "one position per time")
    si.require("a value returned by position", true, si.Unit("m"))
    seen = true + sensor.noise * random.standard_normal(count)
    if sensor.quantisation > 0.0:
        seen = sensor.quantisation * np.round(seen / sensor.quantisation)
    delay = np.maximum(sensor.latency + sensor.jitter * random.standard_normal(count), 0.0)
    arrival = np.maximum.accumulate(taken + delay)
    stamp = taken if sensor.stamped else arrival - sensor.latency
    there = random.random(count) >= sensor.loss
    return SensorStream(
        sensor, seed, taken[there], stamp[there].copy(), arrival[there], seen[there]
    )


def sensor_named(name: str) -> SensorModel:
    """The sensor of a name such as "touch-panel-60-hz" or "LVDT 10 kHz".

    Raises `InputError` for a name that is not known.
    """
    known = {_slug(label): sensor for label, sensor in SENSORS.items()}
    if _slug(name) not in known:
        raise InputError(
            f"the sensor '{name}' is not known.{si.did_you_mean(_slug(name), known)} Sensors: "
            f"{', '.join(known)}"
        )
    return known[_slug(name)]


def _slug(name: str) -> str:
    return "-".join(name.lower().replace("_", " ").replace("-", " ").split())


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
        from squeezefilm.physics.render.motion import kernel

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
        from squeezefilm.physics.render.motion import kernel

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
    from squeezefilm.physics.render.motion import kernel

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
