"""Adjustment and the method of limits: runs played by hand, known people found again, a session of
each to its page; and an adaptive series of detection."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.study.adaptive.series import adaptive_method
from squeezefilm.study.adaptive.staircase import Runs
from squeezefilm.study.conduct.run import Acknowledgement, Presentation
from squeezefilm.study.conduct.terminal_run import Desk, run_session
from squeezefilm.study.design.rules import AdaptiveCondition, ExclusionRule
from squeezefilm.study.design.study_design import StudyDesign, load_design
from squeezefilm.study.design.tasks.surfaces import ADJUSTMENT
from squeezefilm.study.design.tasks.task import Percepts
from squeezefilm.study.psychometric.estimate import Estimate
from squeezefilm.study.record.exports import export_study
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.report.page import write_study
from squeezefilm.study.report.words import read_first
from squeezefilm.study.tasks.analyze import analyze_study
from squeezefilm.study.tasks.findings import PersonEstimate, TaskAnalysis
from squeezefilm.study.tasks.thresholds import _own, of_settings

PERIODS, YES_NO = load_design("period-direction"), load_design("friction-yes-no")


# Nobody who is made up takes time.
UNTIMED = ExclusionRule(fastest=0.0)


def of_runs(design: StudyDesign, **change: Any) -> StudyDesign:
    series = AdaptiveCondition(
        "runs", change.pop("method"), design.judged,
        **{"lowest": 0.005, "highest": 0.3, "step": 0.03, "count": 60} | change.pop("series", {}),
    )  # fmt: skip
    return dataclasses.replace(
        design,
        adaptive=(series,),
        catch=(),
        practice=0,
        blocks=1,
        exclusion=UNTIMED,
        **change,
    )


ADJUSTED = of_runs(PERIODS, method="adjustment", task="adjustment")
LIMITS = of_runs(PERIODS, method="limits")
DETECTED = of_runs(YES_NO, method="limits", series={"highest": 0.1, "step": 0.008})


class Person:
    """Somebody whose point of equality, or threshold, lies at a level, with noise."""

    def __init__(self, level: float, noise: float, seed: int, flat: float = 0.0) -> None:
        self.level, self.noise, self.flat = level, noise, flat
        self.random = np.random.default_rng(seed)

    def rest(self, duration: float) -> None:
        assert duration >= 0

    def feel(self, presentation: Presentation, place: int) -> None:
        assert 0 <= place < len(presentation.surfaces)

    def ask(self, presentation: Presentation) -> str:
        answers, here = presentation.trial.alternatives, presentation.intensity
        assert here is not None
        apart = here - self.level + self.noise * self.random.standard_normal()
        if answers == ("more", "less", "equal"):
            return "equal" if abs(apart) < 0.03 else "less" if apart > 0 else "more"
        if answers == ("first", "second"):
            surface = presentation.surfaces[0]
            return "first" if (surface.friction_depth > 0) == (apart > 0) else "second"
        return answers[0] if apart > 0 else answers[1]

    def acknowledge(self, presentation: Presentation, told: Acknowledgement) -> None:
        assert not told.repeated


def held(design: StudyDesign, people: list[Person], file: Path) -> TaskAnalysis:
    """A study of people who sit down one after the other, analysed from its file."""
    with StudyStore.create(file, design, 1) as store:
        for person in people:
            run_session(store, None, Desk(tell=lambda _: None, consent=True), person)
        export_study(store, "csv")
        (found,) = analyze_study(store).values()
    assert isinstance(found, TaskAnalysis)
    return found


def test_runs_of_limits_played_by_hand() -> None:
    series = AdaptiveCondition(
        "a", "limits", "friction_depth", lowest=0.1, highest=0.5, step=0.1, count=40
    )
    runs = adaptive_method(series, task="yes-no")
    assert isinstance(runs, Runs)
    seen = []
    for _ in range(9):
        seen.append(runs.next_stimulus())
        runs.update(seen[-1], "yes" if seen[-1] > 0.25 else "no")
    assert seen == pytest.approx([0.5, 0.4, 0.3, 0.2, 0.1, 0.2, 0.3, 0.4, 0.3])
    assert [run.level for run in runs.endings] == pytest.approx([0.25, 0.25])
    assert [run.is_down for run in runs.endings] == [True, False]
    again = adaptive_method(series, ((x, "yes" if x > 0.25 else "no") for x in seen), "yes-no")
    assert again.next_stimulus() == runs.next_stimulus()
    # Somebody who always says yes ends no run, and the series goes on from the other end.
    always = adaptive_method(series, [(0.5, "yes")], "yes-no")
    assert isinstance(always, Runs)
    for _ in range(4):
        always.update(always.next_stimulus(), "yes")
    assert always.next_stimulus() == pytest.approx(0.1)
    assert always.endings == []


def test_an_adjustment_played_by_hand() -> None:
    runs = adaptive_method(ADJUSTED.adaptive[0], task="adjustment")
    assert isinstance(runs, Runs)
    down = [1.3 / 1.03**steps - 1 for steps in range(3)]
    # Steps of one ratio, and as far below the reference as above it.
    low = 1 / 1.3 - 1
    for said, then in (("less", down[1]), ("less", down[2]), ("more", down[1]), ("equal", low)):
        runs.update(runs.next_stimulus(), said)
        assert runs.next_stimulus() == pytest.approx(then)
    assert [run.level for run in runs.endings] == pytest.approx([down[1]])
    runs.update(low, "less")
    assert runs.next_stimulus() == pytest.approx(low)


def test_an_orientation_is_turned_by_steps_of_one_amount() -> None:
    series = dataclasses.replace(ADJUSTED.adaptive[0], varied="orientation")
    runs = adaptive_method(series, task="adjustment")
    assert isinstance(runs, Runs)
    for said, then in (("less", 0.27), ("less", 0.24), ("more", 0.27), ("equal", -0.3)):
        runs.update(runs.next_stimulus(), said)
        assert runs.next_stimulus() == pytest.approx(then)


@pytest.mark.parametrize(
    ("design", "level", "measure"),
    [(ADJUSTED, 0.05, "point of equality"), (LIMITS, -0.05, "point of equality"),
     (DETECTED, 0.04, "threshold")],
)  # fmt: skip
def test_people_sit_down_and_are_found_again(
    design: StudyDesign, level: float, measure: str, tmp_path: Path
) -> None:
    people = [Person(level, 0.02 if level < 0.045 else 0.03, seed) for seed in range(4)]
    found = held(design, people, tmp_path / "own.sqlite")
    assert found.measure == measure
    assert found.pooled is not None
    assert found.pooled.low < found.pooled.value < found.pooled.high
    assert found.pooled.value == pytest.approx(level, abs=0.015)
    assert len(found.persons) == 4
    assert [one.name for one in found.conditions] == ["from above", "from below"]
    assert found.screening is not None
    assert not found.screening.named
    assert found.more["difference just told, by the scatter"].value < 0.06
    assert measure in " ".join(read_first(found)) or "calls equal" in " ".join(read_first(found))
    assert "in runs of steps" in found.methods
    page = write_study(found, tmp_path / "page").read_text(encoding="utf-8")
    assert "from above" in page
    assert ">nan<" not in page


def test_an_adaptive_series_of_detection_is_run(tmp_path: Path) -> None:
    detection = load_design("friction-detection")
    series = AdaptiveCondition(
        "near", "bayesian", "friction_depth", lowest=0.002, highest=0.2, count=40
    )
    design = dataclasses.replace(detection, adaptive=(series,), catch=(), practice=0, blocks=1)
    people = [Person(0.0, 0.05, seed) for seed in range(4)]
    found = held(design, people, tmp_path / "own.sqlite")
    assert found.measure == "threshold"
    assert found.pooled is not None
    # Told in 75 %: the quartile of the noise.
    assert found.pooled.low < 0.6745 * 0.05 < found.pooled.high
    assert found.pooled.high < 6 * found.pooled.low
    depths = [one.value for one in found.conditions]
    assert 0.002 <= min(depths) < max(depths) <= 0.2


def test_who_ends_no_run_has_no_value(tmp_path: Path) -> None:
    found = held(LIMITS, [Person(9.0, 0.0, 1)], tmp_path / "own.sqlite")
    assert found.pooled is None
    assert any("fewer than two runs" in note for note in found.notes)
    write_study(found, tmp_path / "page")


def test_runs_from_either_side_weigh_alike() -> None:
    # Two from above at 0.2 and 0.3, four from below about −0.1: their means are 0.25 and −0.1.
    own, deviation = _own([np.array([0.2, 0.3]), np.array([-0.15, -0.05, -0.1, -0.1])], 0.95)
    variance = (2 * 0.05**2 + 2 * 0.05**2) / 4
    assert deviation == pytest.approx(math.sqrt(variance))
    assert own.value == pytest.approx(0.075)
    reach = 2.7764451 * math.sqrt(variance * (1 / 2 + 1 / 4)) / 2
    assert (own.low, own.high) == pytest.approx((0.075 - reach, 0.075 + reach))
    one, both = _own([np.array([0.1]), np.array([-0.1])], 0.95)
    assert one.value == pytest.approx(0.0)
    assert both == pytest.approx(math.sqrt(0.02))


def test_people_have_a_geometric_mean_of_thresholds_and_of_what_is_equal() -> None:
    people = [
        PersonEstimate(f"p{k}", Estimate(x, x, x, 0.95, "t, over runs"), 9, False)
        for k, x in enumerate((0.01, 0.04))
    ]
    typical = of_settings("threshold", True, people, 0.95)
    mean = of_settings("point of equality", False, people, 0.95)
    assert typical is not None
    assert mean is not None
    assert typical.value == pytest.approx(0.02)
    assert mean.value == pytest.approx(math.sqrt(1.01 * 1.04) - 1)
    # Differences of an orientation are of amounts, whose mean is a plain one.
    turned = of_settings("point of equality", True, people, 0.95)
    assert turned is not None
    assert turned.value == pytest.approx(0.025)
    assert of_settings("threshold", True, people[:1], 0.95) == people[0].estimate
    assert of_settings("threshold", True, [], 0.95) is None


def test_what_is_called_equal_differs_by_less_than_the_criterion() -> None:
    felt, one = np.ones((2, 3), dtype=bool), np.ones(3)
    level = np.array([[1.0, 1.0, 1.0], [4.0, -2.0, 1.5]])
    assert ADJUSTMENT.decides is not None
    given = ADJUSTMENT.decides(Percepts(level, felt, one, 1.0))
    assert [ADJUSTMENT.answers[k] for k in given.choice] == ["less", "more", "equal"]


@pytest.mark.parametrize(
    ("design", "change", "message"),
    [
        (PERIODS, {"method": "adjustment"}, "takes method = 'limits'"),
        (PERIODS, {"method": "limits", "series": {"step": 0.2}}, "fewer than three steps"),
        (PERIODS, {"method": "limits", "series": {"highest": 1.5}}, "highest = 1.5"),
        (PERIODS, {"method": "limits", "series": {"step": 0.0}}, "step = 0"),
    ],
)
def test_runs_that_cannot_be_are_refused(
    design: StudyDesign, change: dict[str, Any], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        of_runs(design, **change)


def test_an_adjustment_without_steps_is_refused() -> None:
    with pytest.raises(InputError, match="is a series of steps"):
        dataclasses.replace(PERIODS, task="adjustment", catch=())
    assert math.isfinite(ADJUSTED.reference_value)
