"""The models of friction that one can ask for by name, and what each makes of film and skin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

from squeezefilm import quantities as si
from squeezefilm.contact.sharing.pad import Limit

FrictionModel = Literal[
    "paper2008",
    "paper2008-printed",
    "film-sealed",
    "film-open",
    "film-plateau",
    "film-smooth",
    "partial-levitation",
    "partial-levitation-one-gap",
    "partial-levitation-shear",
    "levitation",
]
DEFAULT_MODEL: FrictionModel = "levitation"
"""The film lifts the contact off over a length fitted to people (decision 0018)."""


class ModelKind(NamedTuple):
    """What a friction model makes of the film, and in which limit it takes the skin.

    "asymptote": the paper's closed form at an infinite squeeze number; "held": a film solved (a
    hundred times slower) at a gap that does not yield; "shared": films that carry the finger
    together with asperities, at the gap where both balance the load. Of what is shared `friction`
    takes the part that asperities carry, all of it slipping ("load"); that part, elastic until it
    slips ("shear"); or the closed form of 2016 with the finger's fitted length ("lift"), while the
    balance only says what the plate feels of the finger.
    """

    film: Literal["asymptote", "held", "shared"]
    limit: Limit = "own"
    friction: Literal["load", "shear", "lift"] = "load"

    @property
    def knows_speed(self) -> bool:
        """Whether friction depends on the finger's speed."""
        return self.friction != "load"


MODEL_KINDS: dict[FrictionModel, ModelKind] = {
    "paper2008": ModelKind("asymptote"),
    "paper2008-printed": ModelKind("asymptote"),
    "film-sealed": ModelKind("held"),
    "film-open": ModelKind("held"),
    "film-plateau": ModelKind("held"),
    "film-smooth": ModelKind("held"),
    "partial-levitation": ModelKind("shared"),
    "partial-levitation-one-gap": ModelKind("shared", "one-gap"),
    "partial-levitation-shear": ModelKind("shared", friction="shear"),
    "levitation": ModelKind("shared", friction="lift"),
}


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class FrictionLimits:
    """µ′/µ (dimensionless) at amplitudes (m) in the two limits of the skin; how far they are apart
    belongs in the uncertainty of µ′/µ.

    `own`: each ridge at its own balance (a skin compliant at rest, the default); `one_gap`: all
    ridges tied to one mean gap.
    """

    amplitude: si.MetreArray
    own: si.DimensionlessArray
    one_gap: si.DimensionlessArray
