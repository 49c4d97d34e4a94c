"""How probable a friction is over the active area: by draws at its best, median and worst place."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.design.analysis import area_odds as room
from squeezefilm.design.analysis.area_odds import judged_area
from squeezefilm.physics.chain.area_map import active_area
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import load_display
from squeezefilm.physics.uncertainty.draws import Outcome
from squeezefilm.physics.uncertainty.uncertainty import uncertain_friction

STATOR = load_display("biet2008-stator")


def test_odds_fall_from_the_best_place_to_the_worst() -> None:
    p = predict(STATOR)
    judged = judged_area(STATOR, p, samples=16)
    assert judged is not None
    area, odds = judged
    assert odds is not None
    best, median, worst = odds.probabilities_below(0.7)
    # The places are those of the model as described: a draw by another may order them otherwise.
    assert 1 >= best >= median - 1 / 64
    assert median >= worst >= 0
    low, high = odds.worst_interval
    assert area.worst is not None
    assert 0 <= low < area.worst < high <= 1
    assert odds.summary()["probability_below_0.70"]["worst"] == worst


@pytest.mark.parametrize("name", ["biet2008-stator", "winfield2007-tpad"])
def test_a_draw_that_is_as_described_has_the_friction_of_the_area(name: str) -> None:
    display = load_display(name)
    p = predict(display)
    area = active_area(display, p.mode, p.law, p.drive)
    assert area is not None
    found = Outcome(p.relative_friction, p.vibration_amplitude, None)
    over = room._elsewhere(display, p, area)
    # A stator's shape is not solved: its prediction is on an even wave, at none of the places.
    assert [one is None for one in over] == [p.law.place is not None, False, False]
    # In the median there is one of the nearest places.
    assert room._met(p.law, found, over) == pytest.approx(
        [area.best, area.median, area.worst], abs=2e-3
    )


@pytest.mark.slow
def test_no_draw_is_asked_for_more_amplitude_than_the_face_has() -> None:
    # A pad as wide as waves are long: its friction is that of no even wave on an antinode.
    display = load_display("winfield2007-tpad")
    p = predict(display)
    judged = judged_area(display, p, samples=16)
    assert judged is not None
    area, odds = judged
    assert odds is not None
    assert not np.isnan(odds.samples).any()
    middle = np.median(odds.samples, axis=0)
    assert middle == pytest.approx([area.best, area.median, area.worst], abs=0.1)


@pytest.mark.slow
def test_at_the_place_of_the_prediction_the_odds_are_those_of_its_interval() -> None:
    """One set of draws, one number."""
    display = load_display("winfield2007-tpad")
    p = predict(display)
    sure = uncertain_friction(display, p, samples=8, seed=3)
    judged = judged_area(display, p, samples=8, seed=3)
    assert judged is not None
    assert judged.odds is not None
    assert judged.odds.samples[:, 0] == pytest.approx(sure.samples, abs=1e-12)
    for criterion in (0.05, 0.1, 0.3, 0.7):
        assert judged.odds.probabilities_below(criterion)[0] == sure.probability_below(criterion)
    unasked = judged_area(display, p, samples=0)
    assert unasked is not None
    assert unasked.odds is None
