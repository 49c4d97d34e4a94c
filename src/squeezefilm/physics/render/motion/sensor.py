"""Finger sensors as numbers, and what such a sensor would report of a motion.

A touch panel samples the finger seldom, late and irregularly; a displacement transducer samples it
often and at once. `SensorModel` holds what matters of either, `sensor_stream` plays it on any
motion, with a seed. The presets are assumed: their numbers are typical of such devices, none was
measured or published for one.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import MOTION_SAMPLES, require_motion


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
