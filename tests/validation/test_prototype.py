"""What could explain the paper's prototype: explanations are solved, not asserted."""

import dataclasses

import pytest

from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.validation import explanations as prototype
from squeezefilm.validation.command import Reproduction
from squeezefilm.validation.explanations import (
    MEASURED_AMPLITUDE,
    MEASURED_FREQUENCY,
    MEASUREMENTS,
    Explanation,
    PrototypeStudy,
    paper_plate,
    paper_points,
    prototype_study,
)
from squeezefilm.validation.report.page import validation_markdown
from squeezefilm.validation.report.prototype import identifiability, sentences, separation_table
from squeezefilm.validation.values import paper_design


def _case(name: str) -> Explanation:
    found = next(case for case in prototype._CASES if case[0] == name)
    name, free, unit, low, high, make = found
    return prototype._explained(paper_plate(), name, free, unit, (low, high), make)


@pytest.fixture(scope="module")
def study() -> PrototypeStudy:
    """Two of the explanations: enough to tell apart."""
    both = (_case("50 µm of glue"), _case("a heavier plate"))
    return PrototypeStudy(*paper_points(), both, (prototype._apart(*both),))


@pytest.mark.nightly
def test_each_explanation_gives_the_measured_frequency(study: PrototypeStudy) -> None:
    for one in study.explanations:
        assert one.frequency == pytest.approx(MEASURED_FREQUENCY, rel=2e-4)
        # Linear in Q: with the Q it names, each gives the measured amplitude.
        assert one.amplitude * one.quality_factor_for_measured / one.quality_factor == (
            pytest.approx(MEASURED_AMPLITUDE)
        )
    glue = study.explanations[0]
    # The specification: 50 µm of 1 GPa is plausible.
    assert glue.value.endswith("Pa")
    assert (
        0.8e9
        < float(glue.value.split()[0]) * {"MPa": 1e6, "GPa": 1e9}[glue.value.split()[1]]
        < 1.2e9
    )


@pytest.mark.nightly
def test_what_tells_glue_from_mass(study: PrototypeStudy) -> None:
    glue, mass = study.explanations
    # Mass added to the substrate leaves the coupling; a soft bond takes most of the ceramic's.
    perfect = study.from_d31.open_frequency / study.from_d31.frequency - 1
    assert mass.open_shift == pytest.approx(perfect, abs=5e-4)
    assert glue.open_shift < 0.5 * perfect
    (pair,) = study.separations
    apart = dict(zip(MEASUREMENTS, pair.apart, strict=True))
    assert apart["open-circuit shift"] > 5
    assert apart["f(9,0) / f(8,0)"] < 2


@pytest.mark.nightly
def test_a_pair_alike_in_everything_is_told_apart_by_nothing(study: PrototypeStudy) -> None:
    glue = study.explanations[0]
    twin = dataclasses.replace(glue, name="its twin")
    alike = dataclasses.replace(
        study, explanations=(glue, twin), separations=(prototype._apart(glue, twin),)
    )
    assert separation_table(alike)[1][0][-1] == "none of these"
    assert any("1 by none of these: 50 µm of glue / its twin" in s for s in sentences(alike))
    assert not any("its twin" in s for s in sentences(study))


@pytest.mark.slow
def test_a_parameter_that_cannot_explain_is_refused() -> None:
    _, free, unit, _, _, make = prototype._CASES[0]
    with pytest.raises(SqueezefilmError, match="does not bring"):
        prototype._explained(paper_plate(), "stiff glue", free, unit, (5e9, 6e9), make)


@pytest.mark.nightly
def test_the_study_is_shown(study: PrototypeStudy) -> None:
    text = validation_markdown(Reproduction((), (), paper_design(), study))
    assert "30.5 kHz" in text
    assert "35.6 kHz" in text
    assert "a heavier plate" in text
    assert "| Explanation" in text or "| explanation" in text
    assert identifiability(study).get_suptitle().startswith("2 explanations")


@pytest.mark.nightly
def test_the_whole_study() -> None:
    whole = prototype_study()
    assert len(whole.explanations) == len(prototype._CASES)
    for one in whole.explanations:
        assert one.frequency == pytest.approx(MEASURED_FREQUENCY, rel=2e-4)
    # Two thicknesses of glue, each with its modulus, are the pair that nothing here tells apart.
    never = [s for s in whole.separations if max(s.apart) < 2]
    assert [(s.first, s.second) for s in never] == [("50 µm of glue", "20 µm of glue")]
