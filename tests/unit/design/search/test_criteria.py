from __future__ import annotations

import math

import numpy as np
import pytest
from tests.unit.design.search.made_up import requirements

from squeezefilm.design.analysis.felt import felt_gratings
from squeezefilm.design.search.criteria import (
    CRITERIA,
    breaches,
    excess_of,
    finest_period_felt,
    numbers_of_prediction,
)
from squeezefilm.design.search.limits import LimitReason, limit_in_words
from squeezefilm.design.search.requirements import Limits
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import load_display

LIMITS = Limits(most_relative_friction=0.5, least_frequency=20e3, most_power=2.0)


def test_every_limit_of_the_file_bounds_a_criterion() -> None:
    bounded = {one.limit for one in CRITERIA.values() if one.limit}
    fields = {name for name in Limits.__dataclass_fields__ if name.startswith(("most_", "least_"))}
    assert fields - bounded == {"least_yield"}


def test_breaches_are_told_the_worst_first_with_what_is_wanted() -> None:
    numbers = {"relative_friction": 0.6, "resonance_frequency": 10e3, "power": 1.0}
    found = breaches(numbers, LIMITS)
    assert [one.key for one in found] == ["resonance_frequency", "relative_friction"]
    assert found[0].sentence == "resonance is 10 kHz, at least 20 kHz is wanted"
    assert found[0].excess == pytest.approx(0.5)


def test_a_share_of_the_area_is_told_in_percent_as_is_its_limit() -> None:
    (one,) = breaches({"area": 0.25}, Limits(least_area=0.6))
    assert one.sentence.endswith("is 25 %, at least 60 % is wanted")


def test_an_objective_of_thickness_is_told_of_what_is_gained() -> None:
    reason = LimitReason("power", 2.0, 9, 4, {"thickness": 2e-3, "relative_friction": 0.5})
    said = limit_in_words(reason, 20)
    assert "power at most 2 W: broken by 9 of 20 screened designs" in said
    assert "thickness with ceramics of 2 mm and µ′/µ at the best place of 0.5 would be" in said


def test_nothing_is_said_of_what_is_not_known() -> None:
    assert breaches({"relative_friction": math.nan}, LIMITS) == ()


def test_what_is_never_felt_breaks_any_limit_of_what_is_felt() -> None:
    one = CRITERIA["finest_period"]
    assert excess_of(one, math.inf, 1e-3) == math.inf
    assert excess_of(CRITERIA["neighbour"], math.inf, 3.0) == -1.0


def test_the_finest_period_is_that_of_the_analysis_between_its_steps() -> None:
    display = load_display("biet2008-plate")
    for speed in (0.1, 0.2, 0.4):
        p = predict(display, theory="timoshenko", speed=speed)
        found = finest_period_felt(display, p)
        told = felt_gratings(display, p, draws=0)
        assert told is not None
        assert told.here.felt is not None
        # Theirs is the next of periods 5.6 % apart.
        assert told.here.felt / 1.06 <= found <= told.here.felt * 1.01


def test_the_criteria_of_the_papers_plate() -> None:
    display = load_display("biet2008-plate")
    p = predict(display, theory="timoshenko")
    numbers = numbers_of_prediction(requirements(), display, p)
    sheet, strips = 0.083 * 0.049 * 2e-3 * 8250, 7 * 0.011 * 0.049 * 1e-3 * 7700
    assert numbers["mass"] == pytest.approx(sheet + strips)
    assert numbers["field"] == pytest.approx(15e3)
    assert numbers["total_thickness"] == pytest.approx(3e-3)
    # From 46 to 117 nF at 15 V and 34 kHz, and what its losses take.
    assert 0.15 < numbers["current"] < 3
    assert 1e6 < numbers["stress"] < 100e6
    assert 1e-7 < numbers["deflection"] < 1e-4
    assert np.isfinite(list(numbers.values())).all()
