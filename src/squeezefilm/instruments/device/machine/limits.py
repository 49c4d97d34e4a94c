"""Limits as a device holds them, and its heat and time on, which it counts against them.

Integers throughout, so that C and Python count the same numbers.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

from squeezefilm.instruments.device.wire.messages import SetLimits

RAMP = 10_000
"""µs in which every stop is at zero."""
TOUCH_LEVEL = 42_000_000
HIGHEST_LEVEL = 2_000_000_000
NO_LEVEL = -1
MICROVOLTS = 1000
MOST = 1 << 62
"""Where the sums saturate; above every budget that the wire can carry."""


@dataclass(frozen=True, slots=True)
class DeviceLimits:
    """Limits as the device holds them, in units that C and Python count alike.

    Voltages are in µV, `slew` in V/s (= µV/µs), `heat` in V²·ms, frequencies in mHz, `duty` in
    permille and `duty_window` in ms. The defaults are the most the wire can ask for; a firmware's
    own are set for its amplifier.
    """

    voltage: int = HIGHEST_LEVEL
    slew: int = 1_000_000_000
    continuous_voltage: int = HIGHEST_LEVEL
    heat: int = 4_000_000_000
    lowest_frequency: int = 1_000
    highest_frequency: int = 1_000_000_000
    duty: int = 1000
    duty_window: int = 3_600_000

    def narrowed(self, asked: SetLimits) -> DeviceLimits | None:
        """The limits asked for, or None if any is outside these or contradicts another."""
        voltage, continuous = level_of(asked.voltage), level_of(asked.continuous_voltage)
        good = (
            0 < voltage <= self.voltage
            and 0 <= continuous <= min(voltage, self.continuous_voltage)
            and asked.slew <= self.slew
            and asked.slew * RAMP >= voltage
            and asked.heat <= self.heat
            and self.lowest_frequency <= asked.lowest_frequency <= asked.highest_frequency
            and asked.highest_frequency <= self.highest_frequency
            and 1 <= asked.duty <= self.duty
            and 1 <= asked.duty_window <= self.duty_window
            and asked.insulated <= 1
            and (voltage <= TOUCH_LEVEL or asked.insulated == 1)
        )
        if not good:
            return None
        given = asdict(asked)
        del given["insulated"]
        return DeviceLimits(**{**given, "voltage": voltage, "continuous_voltage": continuous})

    def levels(self, volts: tuple[float, ...]) -> tuple[int, ...] | None:
        """µV of every amplitude, or None if any is outside the limits: one bad one refuses all."""
        levels = tuple(level_of(volt) for volt in volts)
        if all(0 <= level <= self.voltage for level in levels):
            return levels
        return None


def level_of(volts: float) -> int:
    """µV of a binary32 in V, to the nearest; `NO_LEVEL` if NaN, negative or above 2000 V."""
    if not 0 <= volts <= HIGHEST_LEVEL / 1e6:
        return NO_LEVEL
    # 24 bits times 10⁶ is exact in binary64, so C and Python cut the same number.
    return int(volts * 1e6 + 0.5)


@dataclass(slots=True)
class Loads:
    """Sums of heat and of time on. Not thread-safe.

    Heat is in mV²·µs above the continuous rating, never below zero; time on in µs·permille, as a
    leaky bucket. Both count what the output really did, in every state and over any pause, so that
    stopping and starting again does not reset them.
    """

    heat: int = 0
    used: int = 0

    def count(self, level: int, elapsed: int, continuous: int, duty: int) -> None:
        """Add `elapsed` µs at `level` µV; `continuous` µV and `duty` permille are the limits'."""
        # Rounded to the safe side: the level up, the rating down.
        volts = (level + MICROVOLTS - 1) // MICROVOLTS
        rating = continuous // MICROVOLTS
        self.heat = _moved(self.heat, volts * volts - rating * rating, elapsed)
        self.used = _moved(self.used, (1000 if level > 0 else 0) - duty, elapsed)


def _moved(total: int, rate: int, elapsed: int) -> int:
    return min(MOST, max(0, total + rate * elapsed))
