"""Two intervals, and same or different, of the same simulated people: the Weber fraction of the
spatial period that they were made with comes out of both."""

from __future__ import annotations

import dataclasses

import pytest

from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.study.design.study_design import StudyDesign, load_design
from squeezefilm.study.simulated.answers import simulate_participants

PEOPLE, SEED = 24, 7
OBSERVER = load_observer()
# Noise is 1.3 times as large at first, and falls by a factor e in 20 trials of some 130.
LEARNT = 1.045


def with_everybody(name: str) -> StudyDesign:
    """A preset that marks people and leaves out nobody. A rule that asks for answers which follow
    the surfaces leaves out, of honest people, those who hardly tell them apart, and the others'
    Weber fraction is smaller: here 0.077 of 22 people for 0.083 of 24."""
    design = load_design(name)
    assert design.exclusion is not None
    return dataclasses.replace(
        design, exclusion=dataclasses.replace(design.exclusion, action="mark")
    )


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["period-jnd", "period-same-different"])
def test_the_weber_fraction_of_a_period_comes_out(name: str) -> None:
    study = simulate_participants(with_everybody(name), OBSERVER, PEOPLE, SEED)
    (found,) = study.analyses.values()
    true = OBSERVER.period_weber_fraction * LEARNT
    assert found.pooled.low < true < found.pooled.high
    # Where a grating was not felt it was guessed, and two intervals said 14 %.
    assert found.pooled.value == pytest.approx(true, rel=0.2)
    assert not any("at random" in note for note in found.notes)


@pytest.mark.nightly
def test_answers_at_random_are_told_where_they_flatten_the_slope() -> None:
    blind = dataclasses.replace(OBSERVER, name="blind", lapse_rate=0.15)
    study = simulate_participants(with_everybody("period-jnd"), blind, 8, SEED)
    (found,) = study.analyses.values()
    assert any("answers at random may be more than the 8 %" in note for note in found.notes)
