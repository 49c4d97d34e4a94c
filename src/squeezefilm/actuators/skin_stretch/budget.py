"""Budget of an array: mass, volume, power, lines. A check against stated limits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Literal

from squeezefilm.actuators.skin_stretch.bimorph import Bender, Bimorph
from squeezefilm.core import quantities as si

Lines = Literal["direct", "matrix", "daisy_chain"]

CubicMetre = Annotated[float, si.Unit("m3")]

PUBLISHED_MASS: si.Kilogram = 60e-3
PUBLISHED_VOLUME: CubicMetre = 150e-6
PUBLISHED_AREA: si.SquareMetre = 1e-4
"""Area of the source paper's array of 60. It prints "150 cm2" for the volume and "10 mm2" for the
surface; 150 cm³ and about 1 cm² are taken, since 60 g fill no area, and 60 contactors a millimetre
apart span 1 cm², not 10 mm²."""


@si.checked_numbers
def lines_needed(count: Annotated[int, si.AtLeast(1)], lines: Lines) -> int:
    """Number of wires to the array that drive `count` actuators: each its own and a common one
    ("direct"); rows and columns of a matrix as square as can be, which holds only what is refreshed
    one row at a time; or clock, data, enable and two of supply for a daisy chain of driver chips,
    whatever the number."""
    if lines == "direct":
        return count + 1
    if lines == "matrix":
        rows = math.isqrt(count)
        while count % rows:
            rows -= 1
        return rows + count // rows
    return 5


@si.checked_numbers
def charging_power(
    bender: Bender,
    count: Annotated[int, si.AtLeast(1)],
    voltage: si.Volt,
    rate: Annotated[si.Hertz, si.AtLeast(0)],
) -> si.Watt:
    """Power that drivers which do not recover charge burn (W) when every actuator goes from
    −`voltage` to +`voltage` (V) and back `rate` times a second: count · C (2V)² · rate."""
    return count * bender.capacitance * (2 * voltage) ** 2 * rate


@si.checked_numbers
def loss_power(
    actuator: Bimorph,
    bender: Bender,
    voltage: si.Volt,
    frequency: Annotated[si.Hertz, si.AtLeast(0)],
) -> si.Watt:
    """The heat in one actuator (W) of a sinusoidal voltage (V, zero to peak), π f C tan δ V².

    Well below its resonance. Raises `OutOfRangeError` beyond the voltage that undoes the poling.
    """
    actuator.require_voltage(voltage)
    return math.pi * frequency * bender.capacitance * actuator.loss_tangent * voltage**2


@si.checked_numbers
@dataclass(frozen=True)
class Budget:
    """The actuators' own `mass` and `volume`, the `area` that they serve, and limits on these, by
    default those of the published array. `over` names, in sentences, what is exceeded. What is left
    is for clamps, cradle, drivers and housing, which are not modelled."""

    mass: si.Kilogram
    volume: CubicMetre
    area: si.SquareMetre
    most_mass: Annotated[si.Kilogram, si.Above(0)] = PUBLISHED_MASS
    most_volume: Annotated[CubicMetre, si.Above(0)] = PUBLISHED_VOLUME
    wanted_area: Annotated[si.SquareMetre, si.Above(0)] = PUBLISHED_AREA

    @property
    def over(self) -> tuple[str, ...]:
        """Sentences on what does not fit, one each."""
        sentences = []
        if self.mass > self.most_mass:
            sentences.append(
                f"The actuators weigh {1e3 * self.mass:.3g} g; {1e3 * self.most_mass:.3g} g are "
                "allowed for all."
            )
        if self.volume > self.most_volume:
            sentences.append(
                f"The actuators fill {1e6 * self.volume:.3g} cm³; {1e6 * self.most_volume:.3g} cm³ "
                "are allowed for all."
            )
        if not 0.5 <= self.area / self.wanted_area <= 2:
            sentences.append(
                f"The contactors span {1e4 * self.area:.3g} cm² where about "
                f"{1e4 * self.wanted_area:.3g} cm² are wanted."
            )
        return tuple(sentences)
