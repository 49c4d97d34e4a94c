"""Tables of directions and verdicts: what is shown of a claim, and what each verdict says."""

from __future__ import annotations

from squeezefilm.design.analysis.published_claims import MEANINGS, Claim, Verdict
from squeezefilm.validation.command import ClaimResult
from squeezefilm.validation.frozen import MODELS
from squeezefilm.validation.report.page import (
    directions,
    missed_lists,
    model_sentences,
    plain_claims,
    show_printed,
    show_values,
    verdict_table,
)
from squeezefilm.validation.values import ClaimValue


def result(
    number: int, model: str = "", printed: tuple[float, ...] = (2.0,), verdict: Verdict = "holds"
) -> ClaimResult:
    claim = Claim(
        f"claim-{number}",
        "here",
        "so",
        "1",
        "holds",
        "why",
        printed,
        relation="at_most",
        model=model,
    )
    return ClaimResult(claim, ClaimValue((1.0,)), verdict)


def test_values_are_shown_with_their_unit() -> None:
    assert show_values(None, "m") == "–"
    assert show_values((1.5e-6, 2e-3), "m") == "1.5 µm / 2 mm"
    assert show_values((28.181e-4, 1.0), "m2") == "28.18 cm² / 1e+04 cm²"
    assert show_values((0.123456,), "1") == "0.1235"


def test_what_was_not_compared_says_so() -> None:
    assert show_printed(result(1)) == "≤ 2"
    assert show_printed(result(1, printed=())) == "not compared"


def test_directions_are_kept_together() -> None:
    mixed = (result(1), result(2, "a"), result(3, "a"), result(2, "b"), result(4))
    assert [item.claim.id for item in plain_claims(mixed)] == ["claim-1", "claim-4"]
    together = [[item.claim.name for item in items] for items in directions(mixed)]
    assert together == [["claim-2, a", "claim-2, b"], ["claim-3, a"]]


def test_verdicts_are_counted_and_explained() -> None:
    head, rows = verdict_table((result(1), result(2), result(3, verdict="sign only")))
    assert head == ("verdict", "claims", "what it says")
    assert list(rows) == [
        ("holds", "2", MEANINGS["holds"]), ("sign only", "1", MEANINGS["sign only"]),
    ]  # fmt: skip


def test_every_model_is_explained_and_has_what_it_misses() -> None:
    assert [text.partition(":")[0] for text in model_sentences()] == list(MODELS)
    for model, missed in missed_lists():
        assert model in MODELS
        assert missed
        assert all(" In the model: " in text for text in missed)
