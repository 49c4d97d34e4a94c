from __future__ import annotations

from dataclasses import replace

import pytest
from tests.unit.design.search.made_up import requirements
from tests.unit.design.search.report.made_search import made_search

from squeezefilm.core.errors import GeometryError
from squeezefilm.design.search import candidate
from squeezefilm.design.search.candidate import reference_of
from squeezefilm.design.search.requirements import load_requirements
from squeezefilm.physics.chain.prediction import Prediction, predict


def test_the_papers_plate_is_judged_by_the_questions_of_the_search() -> None:
    wanted = load_requirements("biet2008-plate")
    found = reference_of(wanted)
    p = predict("biet2008-plate", voltage="15 V", speed="200 mm/s", surface="adhesive")
    assert found.numbers["relative_friction"] == pytest.approx(p.relative_friction)
    assert found.numbers["resonance_frequency"] == pytest.approx(p.mode.resonance_frequency)
    assert "cost" not in found.numbers
    # It keeps every limit that was set by it, so that what beats it beats it at equal ones.
    assert found.broken == ()


@pytest.mark.slow
def test_a_disc_is_judged_too() -> None:
    wanted = requirements(**{'compare_with = ""': 'compare_with = "winfield2007-tpad"'})
    found = reference_of(wanted)
    p = predict("winfield2007-tpad")
    assert found.reason == ""
    assert found.numbers["resonance_frequency"] == pytest.approx(p.mode.resonance_frequency)


def test_a_reference_that_cannot_be_judged_says_why_and_nothing_beats_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    wanted = requirements(**{'compare_with = ""': 'compare_with = "biet2008-plate"'})

    def refused(*_: object, **__: object) -> Prediction:
        raise GeometryError("too thin to be solved")

    monkeypatch.setattr(candidate, "predict", refused)
    found = reference_of(wanted)
    assert (found.reason, found.numbers) == ("too thin to be solved", {})
    monkeypatch.undo()
    screened = predict("biet2008-plate", theory="timoshenko")
    screened = replace(screened, objections=("not solved: too large",))
    monkeypatch.setattr(candidate, "predict", lambda *_, **__: screened)
    assert reference_of(wanted).reason == "not solved: too large"
    plates = made_search()
    assert plates.beats_reference
    assert replace(plates, reference=found).beats_reference == ()
