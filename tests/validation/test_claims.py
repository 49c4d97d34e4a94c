"""Published claims: the numbers that must come out, and that a changed verdict is noticed."""

import dataclasses
from pathlib import Path

import pytest

from squeezefilm.core.errors import ConfigError
from squeezefilm.design.analysis.published_claims import Claim, read_claims
from squeezefilm.validation.command import ClaimResult, judge, reproduce
from squeezefilm.validation.frozen import DIRECTION_VALUES
from squeezefilm.validation.values import CLAIM_VALUES, ClaimValue


@pytest.fixture(scope="module")
def found() -> dict[str, ClaimResult]:
    return {item.claim.name: item for item in reproduce().results}


@pytest.mark.slow
def test_every_verdict_is_the_one_on_record(found: dict[str, ClaimResult]) -> None:
    assert {key: item.verdict for key, item in found.items()} == {
        key: item.claim.verdict for key, item in found.items()
    }


def test_every_claim_is_computed_and_every_computation_is_a_claim() -> None:
    assert {claim.id for claim in read_claims().claims} == set(CLAIM_VALUES)
    assert {one.id for one in read_claims().directions} == set(DIRECTION_VALUES)


@pytest.mark.parametrize(
    ("claim", "values", "digits"),
    [
        ("squeeze-number-stator", [20.418], 5e-4),
        ("squeeze-number-plate", [15.886], 5e-4),
        ("two-micrometres-are-felt", [0.702], 5e-4),
        ("levitation-amplitude", [7.63e-6], 5e-9),
        ("friction-criterion", [2.33e-6, 1.89e-6, 1.54e-6, 1.35e-6], 5e-9),
        ("mean-pressure-above-one", [1.0149], 5e-5),
        ("prototype-is-enough", [0.82], 5e-3),
        ("half-wavelength-limit", [14.94e-3], 5e-6),
    ],
)
def test_recomputed_values_of_the_specification(
    found: dict[str, ClaimResult], claim: str, values: list[float], digits: float
) -> None:
    assert found[claim].found.value == pytest.approx(values, abs=digits)


def test_other_readings(found: dict[str, ClaimResult]) -> None:
    assert found["frequency-criterion"].found.value == pytest.approx([21.37e3], abs=5)
    assert found["frequency-criterion"].found.alternative == pytest.approx([20597], abs=0.5)
    assert found["levitation-amplitude"].found.alternative == pytest.approx([5.46e-6], abs=5e-9)
    assert found["two-micrometres-are-felt"].found.alternative == pytest.approx([0.532], abs=5e-4)


def _claim(**changes: object) -> Claim:
    claim = Claim("x", "here", "one", "1", "reproduces", "so", (1.0,), tolerance=0.01)
    return dataclasses.replace(claim, **changes)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("claim", "value", "verdict"),
    [
        (_claim(), ClaimValue((1.009,)), "reproduces"),
        (_claim(), ClaimValue((1.02,)), "does not reproduce"),
        (_claim(), ClaimValue((2.0,), alternative=(1.0,)), "misprint"),
        (_claim(), ClaimValue((2.0,), printed_formula_value=(1.0,)), "does not reproduce"),
        (_claim(), ClaimValue((float("nan"),)), "does not reproduce"),
        (_claim(relation="above"), ClaimValue((1.0,)), "does not hold"),
        (_claim(relation="at_least"), ClaimValue((1.0,)), "holds"),
        (_claim(relation="at_most"), ClaimValue((1.1,)), "does not hold"),
        (_claim(relation="within", printed=(0.8, 0.6)), ClaimValue((0.6, 0.7, 0.8)), "holds"),
        (_claim(relation="within", printed=(0.8, 0.6)), ClaimValue((0.7, 0.81)), "does not hold"),
        (_claim(relation="above", grounds="sign"), ClaimValue((1.1,)), "sign only"),
        (_claim(relation="above", grounds="sign"), ClaimValue((0.9,)), "does not hold"),
        (_claim(grounds="construction"), ClaimValue((1.0,)), "true by construction"),
        (_claim(grounds="construction"), ClaimValue((1.1,)), "does not reproduce"),
        (
            _claim(relation="at_least", grounds="our parameters"),
            ClaimValue((1.0,)),
            "reachable with parameters of our choice",
        ),
    ],
)
def test_verdicts_are_computed(claim: Claim, value: ClaimValue, verdict: str) -> None:
    assert judge(claim, value).verdict == verdict


def test_a_changed_verdict_is_reported() -> None:
    claim = next(c for c in read_claims().claims if c.id == "plate-area")
    tampered = reproduce((dataclasses.replace(claim, printed=(41e-4,)),))
    assert [item.claim.id for item in tampered.changed] == ["plate-area"]
    with pytest.raises(ConfigError, match="Did you mean 'plate-area'"):
        reproduce((dataclasses.replace(claim, id="plate-areas"),))
    with pytest.raises(ConfigError, match="Did you mean 'speed'"):
        reproduce((dataclasses.replace(claim, id="speeds", model="partial-levitation"),))


def test_a_claim_that_was_found_before_a_kill_is_not_computed_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SQUEEZEFILM_CACHE", str(tmp_path))
    claims = tuple(one for one in read_claims().claims if one.id == "plate-area")
    found = reproduce(claims).results
    monkeypatch.setitem(CLAIM_VALUES, "plate-area", lambda: ClaimValue((0.0,)))
    assert reproduce(claims).results == found
    monkeypatch.setenv("SQUEEZEFILM_CACHE", "off")
    assert reproduce(claims).results != found


def test_the_solved_plate_stands_beside_the_papers_numbers(found: dict[str, ClaimResult]) -> None:
    """Converged references of the specification, for both data sets."""
    for claim in ("modal-frequency", "harmonic-frequency", "measured-frequency"):
        assert found[claim].found.value == pytest.approx([33574], rel=1e-3)
        assert found[claim].found.alternative == pytest.approx([33422], rel=1e-3)
    for claim in ("harmonic-amplitude", "measured-amplitude"):
        assert found[claim].found.value == pytest.approx([2.44e-6], rel=0.01)
        assert found[claim].found.alternative == pytest.approx([0.55e-6], rel=0.01)
