"""The gas of a film, and what compiled solvers of every film are given, in records."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from squeezefilm import quantities as si
from squeezefilm.film.slip import slip_law


class Gas(NamedTuple):
    """Polytropic exponent, Knudsen number at ambient pressure and reference gap, law of slip."""

    polytropic_exponent: float
    knudsen_number: float
    law: int


@si.checked_numbers
@dataclass(frozen=True)
class FilmGas:
    """How a film's gas answers: `polytropic_exponent` from 1 (isothermal) to 5/3, `knudsen_number`
    the free path at ambient pressure over H0, used locally as Kn/(P H) in the law `slip` (see
    `flow_factor`)."""

    polytropic_exponent: si.Dimensionless = 1.0
    knudsen_number: si.Dimensionless = 0.0
    slip: str = "first"

    def compiled(self) -> Gas:
        """As compiled code knows it. Raises `InputError` for a law of slip that is not known."""
        law = slip_law(self.slip, self.knudsen_number)
        return Gas(float(self.polytropic_exponent), float(self.knudsen_number), law)


ISOTHERMAL = FilmGas()
"""An isothermal gas that does not slip."""


class Aim(NamedTuple):
    """A relative tolerance, and the most Newton steps to reach it in."""

    tolerance: float
    most: int
