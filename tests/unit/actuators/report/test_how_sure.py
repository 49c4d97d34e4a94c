"""Intervals in words."""

from __future__ import annotations

from squeezefilm.actuators.analysis.drawn import DrawnAnswers, with_interval
from squeezefilm.actuators.report.page import drawn_words, how_sure
from squeezefilm.core import quantities as si
from squeezefilm.core.distributions import Uniform
from squeezefilm.physics.uncertainty.parameters import Parameter

GIVEN = Parameter("motor.preload", 2.0, si.Unit("N"), Uniform(1, 3), "given", "a balance")
GUESSED = Parameter("motor.friction", 0.3, si.Unit("1"), Uniform(0.2, 0.4), "assumed", "a guess")


def drawn(
    *parameters: Parameter,
    refused: int = 0,
    intervals: dict[str, tuple[float, float, float]] | None = None,
) -> DrawnAnswers:
    found = {"force": (1.0, 2.0, 3.04)} if intervals is None else intervals
    shares = {name: (0.5,) * len(parameters) for name in found}
    return DrawnAnswers(found, shares, 64, refused, "preload", 1, parameters)


def test_a_value_has_its_interval_behind_it() -> None:
    assert with_interval(drawn(GIVEN), 2.2, "force", si.Unit("N")) == "2.2 N (1 N to 3 N)"
    assert with_interval(drawn(GIVEN), 2.2, "speed", si.Unit("N")) == "2.2 N"


def test_ranges_that_are_assumed_are_called_so() -> None:
    assert "2 uncertain values together, 1 of them from ranges that are themselves" in drawn_words(
        drawn(GIVEN, GUESSED)
    )
    assert "together, all from ranges that are themselves assumed" in drawn_words(drawn(GUESSED))
    assert "together, from ranges of the file" in drawn_words(drawn(GIVEN))


def test_draws_that_do_not_work_are_said() -> None:
    assert "In 5 of the draws the actuator does not work (most often: preload)" in drawn_words(
        drawn(GIVEN, refused=5)
    )
    assert "no interval is given" in drawn_words(drawn(GIVEN, refused=40, intervals={}))


def test_the_section_lists_what_was_drawn() -> None:
    said = how_sure(drawn(GIVEN, GUESSED), {"force": "stall force", "unknown": "nothing"})
    assert "1 N to 3 N" in said.replace("\N{NO-BREAK SPACE}", " ")
    assert "assumed: a guess" in said
    assert "of the stall force" in said
    assert "nothing" not in said
