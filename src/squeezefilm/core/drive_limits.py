"""Limits of a display's drive: limits that are refused, never clipped.

They are set on the device, and the device holds them: the host's copy only tells a mistake earlier.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

TOUCH_VOLTAGE: si.Volt = 42.0
"""Peak voltage above which a display must name the insulation on the side that is touched."""


HIGHEST_VOLTAGE: si.Volt = 2000.0


WATCHDOG: si.Second = 50e-3
"""Silence after which a device stops by itself."""


STOP_RAMP: si.Second = 10e-3
"""Longest time in which a device's output goes to zero; `slew` must be fast enough for it."""


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class Limits:
    """Limits that a device never exceeds. All voltages are zero-to-peak amplitudes of the carrier.

    `slew` bounds the amplitude's rate. Heat is I²t-like: a piezo's current is in proportion to
    the voltage at one frequency, so the device sums V² − continuous_voltage² over time (never
    below zero) and stops above `heat`. Time on is at most duty·(T + duty_window) in any time T.
    `insulation` names the insulation on the touched side, required above 42 V.

    Raises:
        InputError: a limit outside what the wire carries, or limits that contradict each other.
    """

    voltage: Annotated[si.Volt, si.AtLeast(0.001), si.AtMost(HIGHEST_VOLTAGE)]
    slew: Annotated[si.VoltPerSecond, si.AtLeast(1), si.AtMost(1000000000.0)]
    continuous_voltage: Annotated[si.Volt, si.AtLeast(0), si.AtMost("voltage")]
    heat: Annotated[si.SquareVoltSecond, si.AtLeast(0), si.AtMost(4000000.0)]
    lowest_frequency: Annotated[si.Hertz, si.AtLeast(1), si.AtMost(1000000.0)]
    highest_frequency: Annotated[si.Hertz, si.AtLeast("lowest_frequency"), si.AtMost(1000000.0)]
    duty: Annotated[si.Dimensionless, si.AtLeast(0.001), si.AtMost(1)] = 1.0
    duty_window: Annotated[si.Second, si.AtLeast(0.001), si.AtMost(3600)] = 10.0
    insulation: str = ""

    def __post_init__(self) -> None:
        if int(self.slew) * STOP_RAMP < self.voltage:
            raise InputError(
                f"slew is {self.slew:g} V/s; to stop from {self.voltage:g} V within 10 ms it must "
                f"be at least {self.voltage / STOP_RAMP:g} V/s; raise it or lower voltage",
                quantity="slew",
            )
        if self.voltage > TOUCH_VOLTAGE and not self.insulation.strip():
            raise InputError(
                f"voltage is {self.voltage:g} V; above {TOUCH_VOLTAGE:g} V peak the display must "
                'name its touch-side insulation, e.g. insulation = "0.5 mm glass, 4 kV tested"',
                quantity="insulation",
            )
