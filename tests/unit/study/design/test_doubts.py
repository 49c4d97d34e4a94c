"""What a plan calls doubtful: ranges beside the threshold, catch trials, displays out of reach."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import pytest

from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.study.design.plan import doubts_of, plan_study, predicted_depth, predicted_fraction
from squeezefilm.study.design.study_design import load_design

OBSERVER = load_observer()
ODD = load_design("period-odd-one-out")


def test_a_range_beside_the_predicted_threshold_is_said() -> None:
    assert predicted_fraction(ODD, OBSERVER) == OBSERVER.period_weber_fraction == 0.09
    assert predicted_fraction(dataclasses.replace(ODD, judged="ridge_share"), OBSERVER) is None
    assert doubts_of(ODD, OBSERVER) == ()
    coarse = dataclasses.replace(ODD, stimuli=(ODD.stimuli[0], *ODD.stimuli[2:]))
    (said,) = doubts_of(coarse, OBSERVER)
    assert said.startswith("the least difference from the reference, 25.0 %, is above")
    near = dataclasses.replace(ODD.stimuli[1], name="4.1 mm", spatial_period=4.1e-3)
    (said,) = doubts_of(dataclasses.replace(ODD, stimuli=(ODD.stimuli[0], near)), OBSERVER)
    assert "the greatest difference from the reference, 2.5 %, is below" in said


def test_a_series_and_a_task_without_differences_are_judged_as_they_are() -> None:
    assert doubts_of(load_design("period-jnd"), OBSERVER) == ()
    # Of a number nobody can say that it is wrong.
    assert doubts_of(load_design("coarseness-magnitude"), OBSERVER) == ()


def test_a_task_with_right_answers_wants_catch_trials() -> None:
    design = load_design("friction-jnd")
    assert not [doubt for doubt in doubts_of(design, OBSERVER) if "catch" in doubt]
    doubts = doubts_of(dataclasses.replace(design, catch=()), OBSERVER)
    assert len([doubt for doubt in doubts if "no catch trials" in doubt]) == 1


def test_a_display_that_does_not_reach_a_stimulus_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    made = SimpleNamespace(relative_friction=0.72)
    monkeypatch.setattr("squeezefilm.physics.chain.prediction.predict", lambda _: made)
    plan = plan_study("friction-jnd", reach=True)
    (reached,) = [one for one in plan.doubts if "reaches" in one]
    assert reached.startswith("'biet2008-plate' reaches a relative friction of 0.72")
    assert "'42 %' for 0.58" in reached
    assert "'26 %'" not in reached
    assert plan.summary()["doubts"] == list(plan.doubts)
    assert not [one for one in plan_study("friction-jnd").doubts if "reaches" in one]


@pytest.mark.parametrize("name", ["friction-detection", "friction-yes-no", "friction-limits"])
def test_a_range_beside_the_depth_that_is_told_from_flat_is_said(name: str) -> None:
    design = load_design(name)
    depth = predicted_depth(design, OBSERVER)
    assert depth is not None
    # The observer's channels are fitted to published thresholds of a few per cent.
    assert 0.01 < depth < 0.05
    assert doubts_of(design, OBSERVER) == ()
    if not design.adaptive:
        deep = dataclasses.replace(design, stimuli=(design.stimuli[0], *design.stimuli[-2:]))
        (said,) = doubts_of(deep, OBSERVER)
        assert said.startswith("the least difference from the reference, 6.0 %, is above")


def test_a_period_of_which_no_depth_is_felt_is_said() -> None:
    design = load_design("friction-detection")
    flat, *others = design.stimuli
    fine = [dataclasses.replace(stimulus, spatial_period=1e-5) for stimulus in others]
    (said,) = doubts_of(dataclasses.replace(design, stimuli=(flat, *fine)), OBSERVER)
    assert said.startswith("no depth of the first stimulus' period is felt")
