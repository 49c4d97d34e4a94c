"""The range of film numbers that every solver of this room takes, stated once."""

from __future__ import annotations

from squeezefilm import quantities as si

LEAST_SQUEEZE_NUMBER: si.Dimensionless = 1e-10
"""Below, the over-pressure, which goes with σ², drowns in rounding and a solver would refine for
ever; `film.linear` has it in closed form. (A strip at ε = 0.2 is solved at 1e-10, not at 1e-12.)"""

MOST_SQUEEZE_NUMBER: si.Dimensionless = 1e9
"""Above, the layer at the edge is thinner than 1e-4 of the film and a solve takes minutes, or for
ever; the load there is that of an infinite squeeze number to four digits."""

MOST_KNUDSEN: si.Dimensionless = 1e6
"""Above, a gap far narrower than any surface is flat: molecules fly freely from about 10."""


def require_film(
    squeeze_number: si.DimensionlessLike,
    polytropic_exponent: si.DimensionlessLike,
    knudsen_number: si.DimensionlessLike,
) -> None:
    """Refuse a gas film that no solver here has: raises `InputError` with the offending value."""
    si.require(
        "squeeze_number",
        squeeze_number,
        at_least=LEAST_SQUEEZE_NUMBER,
        at_most=MOST_SQUEEZE_NUMBER,
    )
    si.require("polytropic_exponent", polytropic_exponent, at_least=1.0, at_most=5.0 / 3.0)
    si.require("knudsen_number", knudsen_number, at_least=0.0, at_most=MOST_KNUDSEN)
