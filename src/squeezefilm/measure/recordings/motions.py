"""Motion out of columns: displacement or velocity, by amplitude and phase, by parts, from moment to
moment, over volts or with the voltage beside."""

from __future__ import annotations

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.measure.recordings.quantities_read import Reading, require_rising

# Less drives nothing that an instrument sees.
_LEAST_VOLTAGE: si.Volt = 1e-9


def motion_per_volt(
    reading: Reading, frequency: si.HertzArray
) -> tuple[si.ComplexArray, si.FloatArray | None]:
    """Displacement per volt (m/V), and the drive's voltage (V) where it is known."""
    name = moved_quantity(reading)
    if not reading.has("phase") and not reading.has(f"{name}_imaginary"):
        raise reading.wanting("phase", "a response to a drive needs it, or the imaginary part")
    per_volt = reading.per_volt(name)
    motion = motion_of(reading, frequency, amplitude=not per_volt)
    voltage = _voltage(reading)
    if per_volt:
        reading.facts.append(
            ("assumed", "motion and voltage of the quotient are given in the same way")
        )
        return motion, voltage
    if voltage is None:
        raise reading.wanting(
            "voltage",
            "the motion is not over volts, so that the drive's voltage is needed, as a column or "
            'as voltage = { amplitude = "10 V", given_as = "zero-to-peak" }',
        )
    still = np.flatnonzero(np.abs(voltage) < _LEAST_VOLTAGE)
    if still.size:
        at = int(still[0])
        raise reading.refuse("voltage", "nothing responds to no voltage; leave the row out", at)
    return motion / voltage, voltage


def _voltage(reading: Reading) -> si.FloatArray | None:
    """The drive's voltage (V) in each row, from its column or told once for all."""
    given = getattr(reading.said, "voltage", None)
    if reading.has("voltage"):
        if given is not None:
            raise reading.description.error(
                "the voltage is named as a column and told once for all; keep one of the two",
                ["voltage"],
            )
        return reading.take("voltage", amplitude=True)
    if given is None:
        return None
    return np.full(reading.table.values.shape[0], reading.given_voltage(given))


def moved_quantity(reading: Reading) -> str:
    """Displacement or velocity, whichever was recorded."""
    named = [name for name in ("displacement", "velocity") if reading.has(name)]
    if len(named) == 1:
        return named[0]
    if not named:
        raise reading.wanting("displacement", "displacement or velocity is needed")
    raise reading.description.error(
        "displacement and velocity are both named; name the one that was recorded", ["columns"]
    )


def motion_of(reading: Reading, frequency: si.HertzLike, *, amplitude: bool) -> si.ComplexArray:
    """The complex displacement (m, or m/V) in each row; real where no phase was recorded."""
    name = moved_quantity(reading)
    value = reading.take(name, amplitude=amplitude).astype(complex)
    if reading.has(f"{name}_imaginary"):
        if reading.has("phase"):
            raise reading.description.error(
                "phase and imaginary part are both named; name one of them", ["columns", "phase"]
            )
        value = value + 1j * reading.take(f"{name}_imaginary", amplitude=amplitude)
    elif reading.has("phase"):
        value = value * np.exp(1j * reading.take("phase"))
    if name == "velocity":
        value = value / (2j * np.pi * np.asarray(frequency))
        reading.facts.append(("displacement", "the velocity over iω"))
    return value


def moment_by_moment(reading: Reading, time: si.SecondArray) -> si.MetreArray:
    """Displacement (m) against time, a recorded velocity integrated."""
    from scipy.integrate import cumulative_simpson

    name = moved_quantity(reading)
    value = reading.take(name)
    if name == "displacement":
        return value
    require_rising(reading, "time", time)
    moved = cumulative_simpson(value - value.mean(), x=time, initial=0.0)
    reading.facts.append(("displacement", "the velocity less its mean, integrated, less its mean"))
    return np.asarray(moved - moved.mean())
