"""The published claims on record: what stands where, how it is compared, the verdict."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import Literal

from squeezefilm.core import presets
from squeezefilm.core.config import load
from squeezefilm.physics.display import preset_display

Verdict = Literal[
    "reproduces",
    "misprint",
    "does not reproduce",
    "holds",
    "does not hold",
    "sign only",
    "true by construction",
    "reachable with parameters of our choice",
]
Relation = Literal["equals", "above", "at_least", "at_most", "within"]
"""Relation of a computed value to the printed one; "within" the range of several measured."""
Grounds = Literal["compared", "sign", "construction", "our parameters"]
"""Grounds on which a claim passes: see `VERDICT_OF_GROUNDS`."""

VERDICT_OF_GROUNDS: dict[Grounds, Verdict] = {
    "sign": "sign only",
    "construction": "true by construction",
    "our parameters": "reachable with parameters of our choice",
}
"""The verdict on a claim that passes, where it is less than "reproduces" or "holds"."""

MEANINGS: dict[Verdict, str] = {
    "reproduces": "the printed number comes out, within the tolerance of the claim",
    "misprint": "the printed number comes out with a stated correction of the print",
    "does not reproduce": "the printed number does not come out",
    "holds": "a published comparison or bound, with a number of its own, comes out",
    "does not hold": "a published comparison, bound or direction does not come out",
    "sign only": "only a direction or a word such as 'markedly' was published, and only that, or "
    "our reading of it, is compared",
    "true by construction": "what was put in makes it so, whatever the values: no test of a model",
    "reachable with parameters of our choice": "it comes out with values that we chose or fitted, "
    "since those of the measurement could not be read",
}
"""Meaning of each verdict, in words."""


@dataclass(frozen=True)
class Claim:
    """A published claim: what stands where, how near counts as the same, the verdict on record.

    `printed` and the values computed for it are in the SI unit `unit`; `tolerance` is relative and
    used for the relation "equals". A number that a preset carries as measured is not written again:
    `measured_of` is the preset and the name of the number. `grounds` says what it is worth where it
    passes. A published direction of friction is asked of one `model`, and `says` has it in words
    where it was measured; of other claims both are empty.
    """

    id: str
    where: str
    statement: str
    unit: str
    verdict: Verdict
    why: str
    printed: tuple[float, ...] = ()
    measured_of: tuple[str, ...] = ()
    relation: Relation = "equals"
    tolerance: float = 0.01
    grounds: Grounds = "compared"
    model: str = ""
    says: str = ""

    @property
    def name(self) -> str:
        """The claim's id, with the model that it is asked of."""
        return f"{self.id}, {self.model}" if self.model else self.id


@dataclass(frozen=True)
class AskedDirection:
    """Published direction in one model: verdict on record, its grounds, why."""

    model: str
    verdict: Verdict
    why: str
    grounds: Grounds = "sign"


@dataclass(frozen=True)
class Direction:
    """A published direction of friction under vibration, and the models that it is asked of.

    `says` is the direction in the words that are shown beside a model that misses it; one that was
    only computed, and not `measured`, is not shown there.
    """

    id: str
    where: str
    says: str
    statement: str
    printed: tuple[float, ...]
    unit: str
    relation: Relation
    by: tuple[AskedDirection, ...]
    measured: bool = True


@dataclass(frozen=True)
class Erratum:
    """An equation of the paper as printed and as it must be."""

    equation: str
    printed: str
    corrected: str
    why: str


@dataclass(frozen=True)
class ClaimFile:
    """The content of claims.toml."""

    claims: tuple[Claim, ...]
    directions: tuple[Direction, ...]
    errata: tuple[Erratum, ...]

    @property
    def all_claims(self) -> tuple[Claim, ...]:
        """The claims, then every direction asked of every model, as a claim each."""
        return (
            *self.claims,
            *(
                Claim(
                    id=direction.id,
                    where=direction.where,
                    statement=direction.statement,
                    printed=direction.printed,
                    unit=direction.unit,
                    relation=direction.relation,
                    says=direction.says if direction.measured else "",
                    **vars(asked),
                )
                for direction in self.directions
                for asked in direction.by
            ),
        )


@functools.cache
def read_claims() -> ClaimFile:
    """The claims on record. Raises `ConfigError` where the file is not right."""
    file = load(ClaimFile, presets.claims_path())
    return replace(
        file,
        claims=tuple(
            replace(claim, printed=(measured_of_preset(*claim.measured_of),))
            if claim.measured_of
            else claim
            for claim in file.claims
        ),
    )


def measured_of_preset(preset: str, quantity: str) -> float:
    """Value measured of a preset's real device (SI): `quantity` is a field of `Measured`."""
    return float(getattr(preset_display(preset).measured, quantity))


def missed_by(model: str) -> tuple[Claim, ...] | None:
    """The measured directions that a friction model misses, by the verdicts on record; None for a
    model that they were not asked of."""
    asked = [claim for claim in read_claims().all_claims if claim.model and claim.model == model]
    if not asked:
        return None
    return tuple(claim for claim in asked if claim.says and claim.verdict == "does not hold")
