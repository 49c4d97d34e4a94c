"""Where a friction is meant and its range over the active area, as rows of a table."""

from __future__ import annotations

from typing import Any

from tests.unit.drawn import labelled
from tests.unit.made_curves import AMPLITUDE, made

from squeezefilm.design.analysis.area_odds import judged_area
from squeezefilm.design.analysis.report.figures import deciding
from squeezefilm.design.analysis.report.rows import place_rows
from squeezefilm.physics.chain.active_area import percent
from squeezefilm.physics.chain.area_map import active_area
from squeezefilm.physics.chain.pad_place import place_words
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import load_display

STATOR = load_display("biet2008-stator")
POINT = predict(STATOR)
AREA = active_area(STATOR, POINT.mode, POINT.law, POINT.drive)


def test_rows_and_figure_say_the_range_and_its_places() -> None:
    assert AREA is not None
    assert AREA.best_place is not None
    assert AREA.worst_place is not None
    judged = judged_area(STATOR, POINT, samples=0)
    first, second = place_rows(POINT, judged)
    assert first[1] == place_words(POINT.place)
    assert first[2] == POINT.place_said.replace(f"{first[1]}, ", "")
    assert second[1] == f"{AREA.best:.2f} to {AREA.worst:.2f}"
    assert place_words(AREA.worst_place) in second[2]
    assert f"{percent(AREA.share_below(0.7))} below 0.70" in second[2]
    axes = deciding(_analysis(judged)).axes
    # The stator's area is a line: along it, what a pad gets, and beside it the friction curve.
    assert "finger's centre" in axes[0].get_xlabel()
    assert axes[1].get_xlabel() == AMPLITUDE


def test_without_an_area_nothing_is_known_and_the_figure_is_the_curve() -> None:
    assert place_rows(POINT, None)[1][1] == "not known"
    (axes,) = deciding(_analysis(None)).axes
    assert axes.get_xlabel() == AMPLITUDE


def test_a_model_without_ridges_of_their_own_says_why() -> None:
    p = predict(STATOR, model="paper2008")
    judged = judged_area(STATOR, p, samples=32)
    assert judged is not None
    assert judged.odds is None
    assert "paper2008" in place_rows(p, judged)[1][2]
    assert labelled(deciding(_analysis(judged)).axes[0]).keys() == {"amplitude of the face"}


def _analysis(judged: Any) -> Any:
    return made(display=STATOR, prediction=POINT, active_area=judged)
