"""What compiled solvers of every film are given, in records."""

from __future__ import annotations

from typing import NamedTuple


class Gas(NamedTuple):
    """Polytropic exponent, Knudsen number at ambient pressure and reference gap, law of slip."""

    polytropic_exponent: float
    knudsen_number: float
    law: int


class Aim(NamedTuple):
    """A relative tolerance, and the most Newton steps to reach it in."""

    tolerance: float
    most: int
