"""The claims on record: their verdicts fit their grounds, and what a model misses is said once."""

from __future__ import annotations

from typing import get_args

from squeezefilm.design.analysis.published_claims import (
    MEANINGS,
    VERDICT_OF_GROUNDS,
    Grounds,
    Verdict,
    missed_by,
    read_claims,
)
from squeezefilm.physics.chain.pad_law import MODEL_KINDS
from squeezefilm.validation.frozen import MODELS

CLAIMS = read_claims().all_claims
FAILED = ("does not reproduce", "does not hold")


def test_every_verdict_has_a_meaning() -> None:
    assert set(MEANINGS) == set(get_args(Verdict))
    assert set(VERDICT_OF_GROUNDS) | {"compared"} == set(get_args(Grounds))


def test_a_verdict_is_no_more_than_its_grounds_allow() -> None:
    for claim in CLAIMS:
        passed = VERDICT_OF_GROUNDS.get(claim.grounds)
        allowed = ("reproduces", "misprint", "holds") if passed is None else (passed,)
        assert claim.verdict in (*allowed, *FAILED), claim.name


def test_a_claim_is_asked_once_of_a_model() -> None:
    assert len({one.name for one in CLAIMS}) == len(CLAIMS)
    assert {one.model for one in CLAIMS} == {"", *MODELS}
    assert {*MODELS} <= {*MODEL_KINDS}


def test_what_a_model_misses_is_what_was_measured_and_does_not_hold() -> None:
    for model in MODELS:
        missed = missed_by(model)
        assert missed is not None
        expected = {
            one.id for one in CLAIMS
            if one.model == model and one.verdict == "does not hold" and one.id != "roughness"
        }  # fmt: skip
        assert {one.id for one in missed} == expected
        assert all(one.says and one.where for one in missed)
    ids = {one.id for one in missed_by("partial-levitation") or ()}
    assert {"speed", "load", "orientation"} <= ids


def test_of_a_model_that_was_not_asked_nothing_is_known() -> None:
    assert missed_by("paper2008-printed") is None
    assert missed_by("") is None
