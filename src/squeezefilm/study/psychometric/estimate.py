"""A number with its interval."""

from __future__ import annotations

from dataclasses import dataclass

from squeezefilm.core import quantities as si


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number with its interval of `level`; `low` and `high` are NaN where there is none."""

    value: float
    low: float
    high: float
    level: si.Dimensionless
    method: str
