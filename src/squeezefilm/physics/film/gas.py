"""The gas of a film: laws of slip, what no solver has, and what compiled solvers are given of it.

The laws of slip are known by name, and to compiled code by numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, NamedTuple

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

NO_SLIP, FIRST, SECOND, FUKUI_KANEKO, VEIJOLA = range(5)

SLIP_LAWS = {
    "first": FIRST,
    "second": SECOND,
    "fukui-kaneko": FUKUI_KANEKO,
    "veijola": VEIJOLA,
}
"""The names users write, and the numbers the compiled code knows them by.

Each gives the factor φ of H³ by which slip raises the flow at a *local* Knudsen number, mean free
path over gap. The free path goes with 1/p, so it is Kn/(P H) where the film is compressed.

- ``"first"``: 1 + 6 Kn, Burgdorfer 1959 (J. Basic Eng. 81, 94); good below Kn ≈ 0.1.
- ``"second"``: 1 + 6 Kn + 6 Kn², Hsia & Domoto 1983 (J. Lubr. Technol. 105, 120).
- ``"fukui-kaneko"``: the fitted Poiseuille flow rates of the linearised Boltzmann equation, full
  accommodation, Fukui & Kaneko 1990 (10.1115/1.2920234), for 0.01 ≤ √π/(2 Kn); their three ranges
  are blended over ±20 % of the joints at 0.15 and 5.
  The coefficients were not compared with the printed paper; they give its Knudsen minimum.
- ``"veijola"``: 1 + 9.638 Kn^1.159, a fit for 0 ≤ Kn ≤ 880, Veijola et al. 1995
  (10.1016/0924-4247(95)00995-7).
"""


def slip_law(slip: str, knudsen_number: float) -> int:
    """The number of a slip law; `NO_SLIP` where the Knudsen number is zero.

    Raises `InputError` for an unknown name or a Knudsen number that is negative or not finite.
    """
    si.require("knudsen_number", knudsen_number, at_least=0.0)
    if slip not in SLIP_LAWS:
        raise InputError(
            f"slip = '{slip}' is no slip law.{si.did_you_mean(slip, SLIP_LAWS)} "
            f"Use one of {', '.join(SLIP_LAWS)}"
        )
    return SLIP_LAWS[slip] if knudsen_number > 0.0 else NO_SLIP


LEAST_SQUEEZE_NUMBER: si.Dimensionless = 1e-10
"""Smallest squeeze number: below, the over-pressure, which goes with σ², drowns in rounding and a
solver would refine for ever; `film.closed` has it in closed form. (A strip at ε = 0.2 is solved at
1e-10, not at 1e-12.)"""

MOST_SQUEEZE_NUMBER: si.Dimensionless = 1e9
"""Largest squeeze number: above, the edge's layer is thinner than 1e-4 of the film and a solve
takes minutes, or for ever; the load there is that of an infinite squeeze number to four digits."""

MOST_KNUDSEN: si.Dimensionless = 1e6
"""Largest Knudsen number, of a gap narrower than surfaces are flat: molecules fly from about 10."""

SQUEEZE_NUMBER = (si.AtLeast(LEAST_SQUEEZE_NUMBER), si.AtMost(MOST_SQUEEZE_NUMBER))
POLYTROPIC_EXPONENT = (si.AtLeast(1.0), si.AtMost(5.0 / 3.0))
KNUDSEN_NUMBER = (si.AtLeast(0.0), si.AtMost(MOST_KNUDSEN))
EXCURSION_RATIO = (si.Above(-1.0), si.Below(1.0))
TOLERANCE = (si.AtLeast(1e-9), si.AtMost(0.05))
"""Bounds of the films that solvers here have."""


class CompiledGas(NamedTuple):
    """Polytropic exponent, Knudsen number at ambient pressure and reference gap, law of slip."""

    polytropic_exponent: float
    knudsen_number: float
    law: int


@si.checked_numbers
@dataclass(frozen=True)
class FilmGas:
    """Gas of a film: `polytropic_exponent` from 1 (isothermal) to 5/3, `knudsen_number` the free
    path at ambient pressure over H0, used locally as Kn/(P H) in the law `slip` (see
    `SLIP_LAWS`)."""

    polytropic_exponent: Annotated[si.Dimensionless, *POLYTROPIC_EXPONENT] = 1.0
    knudsen_number: Annotated[si.Dimensionless, *KNUDSEN_NUMBER] = 0.0
    slip: str = "first"

    def compiled(self) -> CompiledGas:
        """Gas for compiled code. Raises `InputError` for a law of slip that is not known."""
        law = slip_law(self.slip, self.knudsen_number)
        return CompiledGas(float(self.polytropic_exponent), float(self.knudsen_number), law)


ISOTHERMAL = FilmGas()
"""An isothermal gas that does not slip."""
