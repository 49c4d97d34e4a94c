"""Recordings of friction out of tables and descriptions, one function a kind."""

from __future__ import annotations

from typing import Any, get_args

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.measure.recordings import kinds
from squeezefilm.measure.recordings.quantities_read import (
    QUANTITIES,
    Reading,
    quantity,
    require_rising,
    words,
)


def bench(reading: Reading) -> kinds.FrictionBench:
    """Strokes of a finger or probe. Raises `ConfigError` at its key or column."""
    time = reading.take("time")
    require_rising(reading, "time", time)
    normal, tangential = (reading.take(name) for name in ("normal_force", "tangential_force"))
    position = _position(reading, time, tangential)
    if reading.has("vibration_amplitude"):
        vibration = reading.take("vibration_amplitude", amplitude=True)
    elif reading.has("voltage") and reading.said.amplitude_per_volt is not None:
        vibration = reading.said.amplitude_per_volt * reading.take("voltage", amplitude=True)
        shown = quantity(reading.said.amplitude_per_volt, si.Unit("m/V"))
        reading.facts.append(("vibration amplitude", f"the voltage times {shown}, as told"))
    else:
        raise reading.wanting(
            "vibration_amplitude", "it is needed, or the voltage with amplitude_per_volt beside"
        )
    frequency = _condition(reading, "frequency")
    return kinds.FrictionBench(
        time, normal, tangential, position, vibration, reading.told(), frequency
    )


def _position(reading: Reading, time: si.SecondArray, tangential: si.NewtonArray) -> si.MetreArray:
    """The recorded place, or that of a finger that slides at the told speed, the way that the
    tangential force has, averaged over some hundredths of a second."""
    speed: float | None = reading.said.speed
    if (speed is None) != reading.has("position"):
        raise reading.wanting(
            "position", 'it is needed, or in its place the speed of the finger, speed = "50 mm/s"'
        )
    if speed is None:
        return reading.take("position")
    reading.doubts.append(
        "the place was not recorded: the finger is taken to slide at the told speed wherever it is "
        "pressed, and to turn where the tangential force changes its sign; leave rests out"
    )
    way = np.sign(smoothed(time, tangential))
    return np.asarray(speed * np.cumsum(way * np.gradient(time)))


def smoothed(time: si.SecondArray, values: si.FloatArray) -> si.FloatArray:
    """Values (points,) averaged over some hundredths of a second."""
    width = int(np.clip(_SMOOTHED / np.median(np.diff(time)), 1, time.size // 4)) | 1
    padded = np.pad(values, width // 2, mode="edge")
    return np.asarray(np.convolve(padded, np.ones(width) / width, mode="valid"))


_SMOOTHED: si.Second = 0.02
_CONDITIONS = ("frequency", "normal_force", "speed")
_FRICTIONS = get_args(kinds.FrictionQuantity)


def curve(reading: Reading) -> kinds.FrictionCurve:
    """Friction over the vibration amplitude. Raises `ConfigError` at its key or column."""
    named = [name for name in _FRICTIONS if reading.has(name)]
    if len(named) != 1:
        raise reading.description.error(
            f"a friction curve has one column of {', '.join(_FRICTIONS)}; named are "
            f"{', '.join(named) or 'none'} (the file has {reading.table.columns_in_words})",
            ["columns"],
        )
    amplitude = reading.take("vibration_amplitude", amplitude=True)
    order = np.argsort(amplitude, kind="stable")
    friction = reading.take(named[0])
    spread = None
    if reading.has("spread"):
        spread = reading.take("spread", like=named[0])[order]
    conditions = {name: _condition(reading, name) for name in _CONDITIONS}
    if conditions["frequency"] is None:
        raise reading.description.error(
            "the key 'frequency' is missing; write frequency = \"30 kHz\", or name its column",
            ["frequency"],
        )
    for name in ("finger", "surface", "moisture"):
        if getattr(reading.said, name):
            reading.facts.append((name, getattr(reading.said, name)))
    return kinds.FrictionCurve(
        amplitude[order],
        friction[order],
        spread=spread,
        quantity=named[0],
        told=reading.told(),
        display=_display(reading),
        finger=reading.said.finger,
        reading_error=reading.said.reading_error * float(np.max(np.abs(friction))),
        **{name: value[order] if np.ndim(value) else value for name, value in conditions.items()},
    )


def _condition(reading: Reading, name: str) -> Any:
    """A condition of a recording: a column's values (rows,), one value, or None."""
    value = getattr(reading.said, name)
    if reading.has(name):
        if value is not None:
            raise reading.description.error(
                f"the {words(name)} has a column and a value; delete one of them", [name]
            )
        return reading.take(name)
    if value is not None:
        reading.facts.append((words(name), quantity(value, QUANTITIES[name].unit)))
    return value


def decays(reading: Reading) -> kinds.FrictionDecays:
    """Published fits of friction over the amplitude. Raises `ConfigError` at its key or column."""
    return kinds.FrictionDecays(
        reading.take("decay_amplitude", amplitude=True),
        reading.take("friction_coefficient"),
        told=reading.told(),
        display=_display(reading),
        **{name: _condition(reading, name) for name in _CONDITIONS},
    )


def touches(reading: Reading) -> kinds.FingertipImpedances:
    """Published impedances of fingertips. Raises `ConfigError` at its key or column."""
    return kinds.FingertipImpedances(
        reading.take("damping"),
        reading.take("mass"),
        told=reading.told(),
        display=_display(reading),
        **{name: _condition(reading, name) for name in _CONDITIONS[:2]},
    )


def detection(reading: Reading) -> kinds.DetectionThresholds:
    """Published detection thresholds. Raises `ConfigError` at its key or column."""
    return kinds.DetectionThresholds(
        reading.take("spatial_period"),
        reading.take("friction_coefficient"),
        told=reading.told(),
        people=reading.said.people,
        **{name: _condition(reading, name) for name in _CONDITIONS[1:]},
    )


def _display(reading: Reading) -> str:
    """The display that is named, the path of a file from where the description stands."""
    path = reading.description.path
    if reading.said.display.endswith(".toml") and path is not None:
        return str(path.parent / reading.said.display)
    return str(reading.said.display)
