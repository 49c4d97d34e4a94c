"""The models of friction that one can ask for by name, and what each makes of film and skin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

from squeezefilm.core import quantities as si

FrictionModel = Literal[
    "paper2008",
    "paper2008-printed",
    "levitation-2016",
    "levitation-ridges",
    "partial-levitation",
    "levitation",
]
DEFAULT_MODEL: FrictionModel = "levitation"
"""The film lifts the contact off over a length fitted to people (decision 0018)."""


class ModelKind(NamedTuple):
    """Kind of a friction model by what it makes of film and skin.

    `friction` is what the model takes: the paper's closed form at an infinite squeeze number and a
    gap that does not yield ("asymptote"); or films that carry the finger together with asperities,
    at the gap where both balance the load. Of that it takes the part that asperities carry
    ("load"), or the closed form of 2016 ("lift"), while the balance only says what the plate feels
    of the finger. `fitted` is whether that has the finger's length, fitted to people and growing
    with the speed, or the constants published in 2016; `ridges`, whether it takes the solved film
    over each ridge in place of the closed form.
    """

    friction: Literal["asymptote", "load", "lift"]
    fitted: bool = False
    ridges: bool = False

    @property
    def shares_load(self) -> bool:
        """True where film and asperities share the load, at a gap that yields."""
        return self.friction != "asymptote"


MODEL_KINDS: dict[FrictionModel, ModelKind] = {
    "paper2008": ModelKind("asymptote"),
    "paper2008-printed": ModelKind("asymptote"),
    "levitation-2016": ModelKind("lift"),
    "levitation-ridges": ModelKind("lift", fitted=True, ridges=True),
    "partial-levitation": ModelKind("load"),
    "levitation": ModelKind("lift", fitted=True),
}


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class FrictionLimits:
    """Relative friction µ′/µ (dimensionless) at amplitudes (m) in the two limits of the skin; how
    far they are apart belongs in the uncertainty of µ′/µ.

    `own`: each ridge at its own balance (a skin compliant at rest, the default); `one_gap`: all
    ridges tied to one mean gap.
    """

    amplitude: si.MetreArray
    own: si.DimensionlessArray
    one_gap: si.DimensionlessArray
