"""Claims at a terminal: each with what was printed, what was found, why, and the verdicts."""

from __future__ import annotations

from typing import Any

from tests.unit.printed import printed

from squeezefilm.design.analysis.published_claims import Claim, Verdict
from squeezefilm.validation.command import ClaimResult
from squeezefilm.validation.report.page import show_claims
from squeezefilm.validation.values import ClaimValue


def result(verdict: Verdict, **changes: Any) -> ClaimResult:
    given: dict[str, Any] = {
        "id": "two-micrometres", "where": "section 2.3.1", "statement": "2 µm [give] 0.7",
        "printed": (1.4e-6, 1.55e-6), "unit": "m", "verdict": verdict, "why": "because " * 30,
        "relation": "at_least",
    }  # fmt: skip
    claim = Claim(**{**given, **changes})
    return ClaimResult(claim, ClaimValue((2e-6, 3e-6), note="a note"), verdict)


class Found:
    results = (
        result("does not hold"),
        result("sign only", id="speed", model="a-model"),
        result("does not hold", id="speed", model="another"),
    )
    errata = ()


def said(columns: int) -> str:
    return "\n".join(printed(lambda: show_claims(Found()), columns))  # type: ignore[arg-type]


def test_claims_at_80_columns() -> None:
    text = said(80)
    for part in ("two-micrometres", "≥ 1.4 µm", "3 µm", "2 µm [give] 0.7", "why: because"):
        assert part in text
    assert "3 claims, and what their verdicts say" in text


def test_directions_stand_by_model() -> None:
    lines = said(200).splitlines()
    at = lines.index("direction model bound found verdict")
    assert lines[at + 1].startswith("speed a-model ≥ 1.4 µm")
    assert lines[at + 1].endswith("sign only")
    # Named once.
    assert lines[at + 2].startswith("another ≥ 1.4 µm")
    assert "a-model: sign only" in lines
    assert "another: does not hold" in lines
    counted = [line for line in lines if line.startswith("does not hold 2 ")]
    assert len(counted) == 1
