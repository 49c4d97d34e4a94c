"""`reproduce`: every published claim recomputed, with a verdict that is computed, not recited."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import stamp, to_json
from squeezefilm.design.analysis.paper_procedure import PaperDesign
from squeezefilm.design.analysis.published_claims import (
    VERDICT_OF_GROUNDS,
    Claim,
    Erratum,
    Verdict,
    read_claims,
)
from squeezefilm.validation import actuators  # noqa: F401 # each enters what it computes
from squeezefilm.validation.frozen import DIRECTION_VALUES
from squeezefilm.validation.values import CLAIM_VALUES, ClaimValue, paper_design

_VALUES: Kept[ClaimValue] = Kept("claims", ClaimValue)


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
    its prototype (`validation.explanations.PrototypeStudy`; None where none was made)."""

    results: tuple[ClaimResult, ...]
    errata: tuple[Erratum, ...]
    design: PaperDesign
    prototype: Any = None

    @property
    def changed(self) -> tuple[ClaimResult, ...]:
        """The claims whose verdict differs from the one on record."""
        return tuple(item for item in self.results if item.verdict != item.claim.verdict)

    def summary(self) -> dict[str, Any]:
        """Values as plain JSON: ``claims`` (values in the SI ``unit`` each names),
        ``errata``."""
        return {
            "claims": [
                {
                    "id": item.claim.id,
                    "model": item.claim.model or None,
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
                    "grounds": item.claim.grounds,
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


def reproduce(
    claims: tuple[Claim, ...] | None = None,
    *,
    prototype: Callable[[SayProgress | None], Any] | None = None,
    progress: SayProgress | None = None,
) -> Reproduction:
    """Recompute every claim (those on record, or those given); with `prototype`, what studies the
    paper's prototype (`validation.explanations.prototype_study`), also that. What was
    found until it was stopped is kept on disk.

    Raises `ConfigError` for a claim that nothing computes.
    """
    tell = progress or (lambda _: None)
    file = read_claims()
    results = []
    for claim in file.all_claims if claims is None else claims:
        tell(f"claim {claim.name}")
        results.append(judge(claim, _found(claim)))
    tell("the paper's design procedure")
    study = None if prototype is None else prototype(progress)
    return Reproduction(tuple(results), file.errata, paper_design(), study)


def _found(claim: Claim) -> ClaimValue:
    known = DIRECTION_VALUES if claim.model else CLAIM_VALUES
    if claim.id not in known:
        raise ConfigError(
            f"nothing computes the claim '{claim.id}'.{si.did_you_mean(claim.id, known)}",
            file=presets.claims_path(),
        )
    of_model = functools.partial(DIRECTION_VALUES[claim.id], claim.model) if claim.model else None
    return _VALUES.found(f"{claim.id} {claim.model}", of_model or CLAIM_VALUES[claim.id])


def judge(claim: Claim, value: ClaimValue) -> ClaimResult:
    """The verdict on a claim, from what was computed for it."""
    return ClaimResult(claim=claim, verdict=_verdict(claim, value), **vars(value))


def _verdict(claim: Claim, found: ClaimValue) -> Verdict:
    passed = VERDICT_OF_GROUNDS.get(claim.grounds)
    if claim.relation == "equals":
        if _near(found.value, claim):
            return passed or "reproduces"
        if found.alternative is not None and _near(found.alternative, claim):
            return "misprint"
        return "does not reproduce"
    if claim.relation == "within":
        least, most = min(claim.printed), max(claim.printed)
        holds = all(least <= value <= most for value in found.value)
        return (passed or "holds") if holds else "does not hold"
    compare: dict[str, Callable[[float, float], bool]] = {
        "above": lambda value, bound: value > bound,
        "at_least": lambda value, bound: value >= bound,
        "at_most": lambda value, bound: value <= bound,
    }
    holds = all(
        compare[claim.relation](value, bound)
        for value, bound in zip(found.value, claim.printed, strict=True)
    )
    return (passed or "holds") if holds else "does not hold"


def _near(values: tuple[float, ...], claim: Claim) -> bool:
    return all(
        math.isclose(value, printed, rel_tol=claim.tolerance)
        for value, printed in zip(values, claim.printed, strict=True)
    )
