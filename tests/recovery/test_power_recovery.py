"""Errors of the first kind, and simulated power against studies done one by one, for every task.

A planned study is drawn from a pool of simulated people whose values were computed once. Here every
study has people of its own. What they get of each surface is written down by hand, so that it is
known where there is nothing to be found.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.perception.percepts import Apparatus
from squeezefilm.physics.perception.senses import Candidates
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.study_design import StudyDesign, load_design
from squeezefilm.study.identification.power import above_0, distinction_scores
from squeezefilm.study.simulated import planned_power, planned_precision
from squeezefilm.study.simulated.chain_tables import ChainTables
from squeezefilm.study.simulated.judgements import simulate_judgements
from squeezefilm.study.simulated.participants import match_counts, simulate_matches

PEOPLE = dataclasses.replace(load_observer(), finger_classes=1, candidates=1)
_ALIKE = dataclasses.replace(
    load_design("period-same-different"), practice=0, repetitions=3, catch=()
)
PAIRS: dict[str, tuple[StudyDesign, str, str]] = {
    "match-to-sample": (
        dataclasses.replace(load_design("biet2008-gratings"), displays=("biet2008-plate",)),
        "8 mm",
        "10 mm",
    ),
    "two-interval": (dataclasses.replace(_ALIKE, task="two-interval"), "4 mm", "5 mm"),
    "same-different": (_ALIKE, "4 mm", "5 mm"),
    "magnitude-estimation": (
        dataclasses.replace(load_design("coarseness-magnitude"), familiarisation=0),
        "4 mm",
        "6 mm",
    ),
}
CLOSER = {
    "match-to-sample": 0.2,
    "two-interval": 0.2,
    "same-different": 0.5,
    "magnitude-estimation": 0.25,
}
"""How far apart pairs are felt, over how far they are, so that power is neither 0 nor 1."""
SERIES = dataclasses.replace(load_design("period-jnd"), practice=0)
SIZE = 8


@dataclasses.dataclass(frozen=True, slots=True, eq=False)
class Tables(ChainTables):
    """What is felt of comparisons that series chose: a period as it is, or nearer to the
    reference's on each display by a power."""

    stretch: tuple[float, ...] = (1.0,)

    def felt(self, display: int, finger: int, stimulus: Stimulus) -> Candidates:
        here = self.design.stimulus(self.design.reference).period
        period = here * (stimulus.period / here) ** self.stretch[display]
        return Candidates(np.array([[period]]), np.array([[6.0]]))


def tables(
    design: StudyDesign,
    pair: tuple[str, ...] = (),
    closer: float = 1.0,
    stretch: tuple[float, ...] = (1.0,),
) -> Tables:
    """Two of the periods are felt `closer` together, about their mean."""
    logs = np.log([one.period for one in design.stimuli])
    here = np.isin([one.name for one in design.stimuli], pair)
    if pair:
        logs[here] = logs[here].mean() + closer * (logs[here] - logs[here].mean())
    periods = np.exp(logs)
    virtual = np.tile(periods[None, None, :, None, None], (len(stretch), 1, 1, 1, 1))
    real = np.array([one.period for one in design.alternatives])[None, :, None]
    return Tables(
        design=design,
        observer=PEOPLE,
        fingers=PEOPLE.fingers(),
        apparatus=(Apparatus(),) * len(stretch),
        virtual=Candidates(virtual, np.full(virtual.shape, 6.0)),
        real=Candidates(real, np.full(real.shape, 6.0)),
        stretch=stretch,
    )


def significant(task: str, closer: float, studies: int, seed: int) -> float:
    """Share of studies with people of their own that find the difference at 5 %."""
    design, first, second = PAIRS[task]
    felt = tables(design, (first, second), closer)
    people = studies * SIZE
    if task == "match-to-sample":
        counts = match_counts(simulate_matches(felt, people, seed))
        a, b = (design.stimuli.index(design.stimulus(name)) for name in (first, second))
        scores = distinction_scores(counts, a, b)
    else:
        answers = simulate_judgements(felt, people, seed)
        scores = planned_power.pair_scores(answers, first, second)
    return float(np.mean([above_0(one) < 0.05 for one in scores.reshape(studies, SIZE)]))


def planned(task: str, studies: int, pool: int, patch: pytest.MonkeyPatch) -> float:
    design, first, second = PAIRS[task]

    def made(one: StudyDesign, *_: Any, **__: Any) -> Tables:
        return tables(one, (first, second), CLOSER[task])

    patch.setattr(planned_power, "chain_tables", made)
    patch.setattr(planned_power, "POOL", pool)
    found = planned_power.planned_power(
        design, PEOPLE, first, second, participants=(SIZE,), studies=studies, seed=77
    )
    return float(found.curve.power[0])


@pytest.mark.campaign
@pytest.mark.parametrize("task", PAIRS)
def test_a_pair_that_is_felt_alike_is_found_in_5_percent_of_studies(task: str) -> None:
    share = significant(task, 0.0, 2000, 1)
    print(f"{task}: {share:.4f} of 2000 studies, seed 1")
    assert 0.04 <= share <= 0.06


@pytest.mark.campaign
@pytest.mark.parametrize("task", PAIRS)
def test_planned_power_is_that_of_studies_done_one_by_one(
    task: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = planned(task, 2000, 4000, monkeypatch)
    done = significant(task, CLOSER[task], 2000, 2)
    print(f"{task}: planned {asked:.4f}, done {done:.4f} of 2000 studies, seeds 77 and 2")
    assert asked == pytest.approx(done, abs=0.05)


@pytest.mark.nightly
@pytest.mark.parametrize("task", PAIRS)
def test_pairs_felt_alike_and_not_of_a_few_studies(
    task: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert significant(task, 0.0, 200, 1) <= 0.05 + 4 * math.sqrt(0.05 * 0.95 / 200)
    asked, done = planned(task, 200, 800, monkeypatch), significant(task, CLOSER[task], 200, 2)
    assert asked == pytest.approx(done, abs=4 * math.sqrt(0.5 / 200))


def contrasted(
    stretch: tuple[float, float], studies: int, seed: int, size: int = 3
) -> tuple[float, float]:
    """Share of studies of adaptive series that find that two displays differ, and the mean of the
    differences of ln Weber fractions."""
    both = dataclasses.replace(SERIES, displays=("biet2008-plate", "biet2008-stator"))
    felt = tables(both, stretch=stretch)
    answers = simulate_judgements(felt, studies * size, seed)
    scores = planned_precision.within_people(answers)[1].reshape(studies, size)
    share = np.mean([planned_precision.otherwise_than_0(one) < 0.05 for one in scores])
    return float(share), float(scores.mean())


@pytest.mark.campaign
def test_displays_that_are_alike_differ_in_5_percent_of_adaptive_studies() -> None:
    share, mean = contrasted((1.0, 1.0), 1000, 3)
    print(f"adaptive: {share:.4f} of 1000 studies of 3 people, seed 3; mean {mean:.4f}")
    assert 0.04 <= share <= 0.06


@pytest.mark.campaign
def test_planned_contrasts_are_those_of_adaptive_studies_done_one_by_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    stretch = (1.0, 0.4)
    done, mean = contrasted(stretch, 300, 4)
    asked = plan_contrast(stretch, 2000, 600, monkeypatch)
    print(
        f"adaptive: planned {asked:.4f} of 2000 studies, done {done:.4f} of 300 studies of 3 "
        f"people, seeds 77 and 4; mean {mean:.4f}"
    )
    assert asked == pytest.approx(done, abs=0.08)


def plan_contrast(
    stretch: tuple[float, float], studies: int, people: int, patch: pytest.MonkeyPatch
) -> float:
    def made(one: StudyDesign, *_: Any, **__: Any) -> Tables:
        return tables(one, stretch=stretch)

    patch.setattr(planned_precision, "chain_tables", made)
    found = planned_precision.planned_contrast(
        SERIES, PEOPLE, "biet2008-plate", "biet2008-stator", participants=(3,), studies=studies,
        people=people, seed=77,
    )  # fmt: skip
    assert found.measure == "ln Weber fraction"
    # A display on which differences are felt less has larger Weber fractions.
    assert found.difference < 0.0 or stretch[0] == stretch[1]
    return float(found.curve.power[0])


@pytest.mark.nightly
def test_a_few_adaptive_studies_find_a_worse_display(monkeypatch: pytest.MonkeyPatch) -> None:
    assert plan_contrast((1.0, 0.3), 100, 60, monkeypatch) > 0.4
