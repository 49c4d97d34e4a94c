"""Thresholds of adaptive series by simulated runs of them: who has one, and what it says."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from tests.recovery.task_people import DESIGNS, Person, answered

from squeezefilm.core.errors import InputError
from squeezefilm.study.adaptive.staircase import StaircaseRule
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.report.words import person_rows
from squeezefilm.study.tasks.analyze import analyze_answers
from squeezefilm.study.tasks.asked_again import _procedure
from squeezefilm.study.tasks.findings import TaskAnalysis

PEOPLE = [Person(0.1, 0.9, 0.0), Person(0.25, 0.9, 0.0)]


@pytest.fixture(scope="module")
def answers() -> Answers:
    """Two people on staircases alone, which are quickly run again."""
    design = DESIGNS["adaptive"]
    stairs = tuple(series for series in design.adaptive if series.method == "staircase")
    chosen = stairs or tuple(
        dataclasses.replace(series, method="staircase") for series in design.adaptive[:1]
    )
    return answered(dataclasses.replace(design, adaptive=chosen), PEOPLE, np.random.default_rng(2))


def analysed(answers: Answers, reruns: int, **more: object) -> TaskAnalysis:
    (found,) = analyze_answers(answers, "jnd", reruns=reruns, **more).values()  # type: ignore[arg-type]
    assert isinstance(found, TaskAnalysis)
    return found


@pytest.mark.slow
def test_each_person_has_a_threshold_that_tells_them_apart(answers: Answers) -> None:
    steps: list[str] = []
    found = analysed(answers, 99, seed=4, progress=steps.append)
    sharp, dull = (person.asked_again for person in found.persons)
    assert sharp is not None
    assert dull is not None
    for threshold, person in zip((sharp, dull), found.persons, strict=True):
        assert threshold.low <= threshold.value <= threshold.high
        assert threshold.method == "99 simulated reruns"
        # Two ways to the same person: neither estimate is outside of the other's interval.
        assert threshold.low < person.estimate.value < threshold.high
        assert person.estimate.low < threshold.value < person.estimate.high
    assert sharp.value < dull.value
    assert any(step.startswith("simulated reruns, person 2 of 2") for step in steps)
    said = person_rows(found)[0][-1]
    assert f"by simulated reruns: {100 * sharp.value:.3g} (" in said
    kept = found.summary()["persons"][0]["asked_again"]
    assert (kept["low"], kept["high"]) == (sharp.low, sharp.high)
    # The seed decides.
    assert analysed(answers, 99, seed=4).persons == found.persons
    assert analysed(answers, 99, seed=5).persons != found.persons
    assert all(person.asked_again is None for person in analysed(answers, 0).persons)


def test_a_series_that_was_left_early_is_run_again_for_as_long(answers: Answers) -> None:
    procedure = _procedure(answers, 0, 17)
    assert isinstance(procedure, StaircaseRule)
    assert procedure.most_trials == 17
    assert procedure.start == answers.design.adaptive[0].start


def test_what_cannot_be_run_again_is_refused_before_anything_is_computed(answers: Answers) -> None:
    with pytest.raises(InputError, match="reruns"):
        analysed(answers, 20)
    constant = dataclasses.replace(answers, design=DESIGNS["constant"])
    with pytest.raises(InputError, match="has no adaptive series in two intervals"):
        analysed(constant, 99, progress=lambda _: pytest.fail("it began"))
