"""The models of friction that one can ask for by name, and what each makes of film and skin."""

from __future__ import annotations

from typing import Literal, NamedTuple

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
    with the speed, or the constants published in 2016.
    """

    friction: Literal["asymptote", "load", "lift"]
    fitted: bool = False

    @property
    def shares_load(self) -> bool:
        """True where film and asperities share the load, at a gap that yields."""
        return self.friction != "asymptote"


MODEL_KINDS: dict[FrictionModel, ModelKind] = {
    "paper2008": ModelKind("asymptote"),
    "paper2008-printed": ModelKind("asymptote"),
    "levitation-2016": ModelKind("lift"),
    "levitation-ridges": ModelKind("lift", fitted=True),
    "partial-levitation": ModelKind("load"),
    "levitation": ModelKind("lift", fitted=True),
}
