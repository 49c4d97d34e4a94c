"""`reproduce`: every published claim recomputed, with a verdict that is computed, not recited."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from squeezefilm import presets
from squeezefilm import quantities as si
from squeezefilm.analysis.claims import contact as contact_claims
from squeezefilm.analysis.claims.procedure import Design
from squeezefilm.analysis.claims.prototype import PrototypeStudy, prototype_study
from squeezefilm.analysis.claims.values import CLAIM_VALUES, ClaimValue, paper_design
from squeezefilm.config import load
from squeezefilm.errors import ConfigError
from squeezefilm.results import stamp, to_json

# Registers what it computes; named so that the import is no accident.
FROZEN_CONTACT = contact_claims.FROZEN

Verdict = Literal["reproduces", "misprint", "does not reproduce", "holds", "does not hold"]
Relation = Literal["equals", "above", "at_least", "at_most"]


@dataclass(frozen=True)
class Claim:
    """One published claim: what stands where, how near counts as the same, the verdict on record.

    `printed` and the values computed for it are in the SI unit `unit`; `tolerance` is relative and
    used for the relation "equals".
    """

    id: str
    where: str
    statement: str
    printed: tuple[float, ...]
    unit: str
    verdict: Verdict
    why: str
    relation: Relation = "equals"
    tolerance: float = 0.01


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
    errata: tuple[Erratum, ...]


@dataclass(frozen=True)
class ClaimResult:
    """A claim and what was found: the corrected value, what the printed formula or the printed
    input gives (None where it does not differ), an alternative reading, and the verdict."""

    claim: Claim
    value: tuple[float, ...]
    printed_formula_value: tuple[float, ...] | None
    alternative: tuple[float, ...] | None
    verdict: Verdict
    note: str


@dataclass(frozen=True)
class Reproduction:
    """All claims recomputed, the errata, where the paper's design procedure leads, and the study of
    its prototype (None where it was not asked for)."""

    results: tuple[ClaimResult, ...]
    errata: tuple[Erratum, ...]
    design: Design
    prototype: PrototypeStudy | None = None

    @property
    def changed(self) -> tuple[ClaimResult, ...]:
        """The claims whose verdict differs from the one on record."""
        return tuple(item for item in self.results if item.verdict != item.claim.verdict)

    def summary(self) -> dict[str, Any]:
        """What ``--json`` prints: ``claims`` (values in the SI ``unit`` each names), ``errata``."""
        return {
            "claims": [
                {
                    "id": item.claim.id,
                    "where": item.claim.where,
                    "statement": item.claim.statement,
                    "unit": item.claim.unit,
                    "printed": list(item.claim.printed),
                    "relation": item.claim.relation,
                    "printed_formula_value": to_json(item.printed_formula_value),
                    "value": to_json(item.value),
                    "alternative": to_json(item.alternative),
                    "verdict": item.verdict,
                    "verdict_on_record": item.claim.verdict,
                    "why": item.claim.why,
                    "note": item.note,
                }
                for item in self.results
            ],
            "errata": to_json(self.errata),
            "design_procedure": to_json(self.design),
            "prototype": to_json(self.prototype),
            "changed": [item.claim.id for item in self.changed],
            "provenance": stamp([item.claim for item in self.results]),
        }


def read_claims() -> ClaimFile:
    """The claims on record. Raises `ConfigError` where the file is not right."""
    return load(ClaimFile, presets.claims_path())


def reproduce(
    claims: tuple[Claim, ...] | None = None,
    *,
    prototype: bool = False,
    progress: Callable[[str], None] | None = None,
) -> Reproduction:
    """Recompute every claim (those on record, or those given); with `prototype` also what could
    explain the paper's prototype, which takes a minute or two.

    Raises `ConfigError` for a claim that nothing computes.
    """
    tell = progress or (lambda _: None)
    file = read_claims()
    results = []
    for claim in file.claims if claims is None else claims:
        tell(f"claim {claim.id}")
        if claim.id not in CLAIM_VALUES:
            raise ConfigError(
                "nothing computes the claim "
                f"'{claim.id}'.{si.did_you_mean(claim.id, CLAIM_VALUES)}",
                file=presets.claims_path(),
            )
        results.append(judge(claim, CLAIM_VALUES[claim.id]()))
    tell("the paper's design procedure")
    study = prototype_study(progress) if prototype else None
    return Reproduction(tuple(results), file.errata, paper_design(), study)


def judge(claim: Claim, found: ClaimValue) -> ClaimResult:
    """The verdict on a claim, from what was computed for it."""
    return ClaimResult(claim=claim, verdict=_verdict(claim, found), **vars(found))


def _verdict(claim: Claim, found: ClaimValue) -> Verdict:
    if claim.relation == "equals":
        if _near(found.value, claim):
            return "reproduces"
        if found.alternative is not None and _near(found.alternative, claim):
            return "misprint"
        return "does not reproduce"
    compare: dict[str, Callable[[float, float], bool]] = {
        "above": lambda value, bound: value > bound,
        "at_least": lambda value, bound: value >= bound,
        "at_most": lambda value, bound: value <= bound,
    }
    holds = all(
        compare[claim.relation](value, bound)
        for value, bound in zip(found.value, claim.printed, strict=True)
    )
    return "holds" if holds else "does not hold"


def _near(values: tuple[float, ...], claim: Claim) -> bool:
    return all(
        math.isclose(value, printed, rel_tol=claim.tolerance)
        for value, printed in zip(values, claim.printed, strict=True)
    )
