from __future__ import annotations

import pytest

from squeezefilm.chain.prediction import predict
from squeezefilm.search.design.reference import reference_of
from squeezefilm.search.design.requirements import load_requirements


def test_the_papers_plate_is_judged_by_the_questions_of_the_search() -> None:
    wanted = load_requirements("biet2008-plate")
    found = reference_of(wanted)
    p = predict("biet2008-plate", voltage="15 V", speed="200 mm/s", surface="adhesive")
    assert found.numbers["relative_friction"] == pytest.approx(p.relative_friction)
    assert found.numbers["resonance_frequency"] == pytest.approx(p.mode.resonance_frequency)
    assert "cost" not in found.numbers
    # It keeps every limit that was set by it, so that what beats it beats it at equal ones.
    assert found.broken == ()
