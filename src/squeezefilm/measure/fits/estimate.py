"""What a fit says: a value with its interval, whether the model is adequate, what was observed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

from squeezefilm.core import quantities as si

LEVEL: si.Dimensionless = 0.95
"""Of an interval, unless said."""


@dataclass(frozen=True)
class Estimate:
    """A fitted value with its standard error and interval, in the value's own `unit`."""

    value: float
    standard_error: float
    interval: tuple[float, float]
    unit: str
    level: si.Dimensionless = LEVEL


@dataclass(frozen=True)
class Adequacy:
    """Whether the fitted model describes what was recorded.

    `residual` is the mean distance |data − model| / |data|; `noise` what noise alone would leave;
    `where` names the place of the worst misfit in words; `sentence` says all of it to a person.
    """

    adequate: bool
    residual: si.Dimensionless
    noise: si.Dimensionless
    where: str
    sentence: str


@si.checked_numbers
@dataclass(frozen=True)
class Observation:
    """One number that a calibration may use: an `answer` of the display by its name in the
    library (`resonance_frequency`, …) in SI units, its standard error, and under which
    `conditions` (SI, by name: voltage, normal_force, vibration_amplitude, finger_speed, x, y).
    `recording` is the name of the file that it was read from, where there is one."""

    answer: str
    value: float
    standard_error: Annotated[float, si.AtLeast(0.0)]
    conditions: Mapping[str, float] = field(default_factory=dict)
    recording: str = ""

    def __post_init__(self) -> None:
        for name, value in self.conditions.items():
            si.require(name, value)
