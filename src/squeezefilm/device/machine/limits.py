"""Limits as a device holds them: integers, and what it takes of the limits that a host asks for.

µV, V/s (= µV/µs), V²·ms, mHz, permille and ms, so that C and Python count the same numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

from squeezefilm.device.wire.messages import SetLimits

RAMP = 10_000
"""µs in which every stop is at zero."""
TOUCH_LEVEL = 42_000_000
HIGHEST_LEVEL = 2_000_000_000
NO_LEVEL = -1


@dataclass(frozen=True, slots=True)
class DeviceLimits:
    """Limits as the device holds them: µV, V/s (= µV/µs), µV, V²·ms, mHz, permille, ms.

    The defaults are the most the wire can ask for; a firmware's own are set for its amplifier.
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
        return DeviceLimits(
            voltage,
            asked.slew,
            continuous,
            asked.heat,
            asked.lowest_frequency,
            asked.highest_frequency,
            asked.duty,
            asked.duty_window,
        )

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
