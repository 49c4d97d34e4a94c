"""Same or different without a scale: what people's d′ was made of is found again."""

from __future__ import annotations

import numpy as np
import pytest
from tests.task_models import differencing_rate
from tests.unit.study.design.test_matching import shapes

from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.simulated.planned_precision import person_values
from squeezefilm.study.tasks.analyze import analyze_answers
from squeezefilm.study.tasks.measures import MEASURE, condition_findings

TRUE = {"bars": 1.0, "checks": 3.0}
CRITERION = 1.4


def _design() -> StudyDesign:
    return shapes(
        task="same-different", matched_with="real gratings", reference="disc", repetitions=10
    )


def answers(people: int, repetitions: int, seed: int) -> Answers:
    """People who answer by the differencing model, each pair with a d′ of its own."""
    design, random = _design(), np.random.default_rng(seed)
    names = [one.name for one in design.stimuli]
    pairs = [pair for pair in design.conditions for _ in range(repetitions)]
    shown = np.array([[names.index(one) for one in pair] for pair in pairs] * people)
    different = shown[:, 0] != shown[:, 1]
    other = np.where(shown[:, 0] != 0, shown[:, 0], shown[:, 1])
    rates = {name: differencing_rate(d, CRITERION) for name, d in TRUE.items()}
    alarm = differencing_rate(0.0, CRITERION)
    p = np.array(
        [rates[names[k]] if apart else alarm for k, apart in zip(other, different, strict=True)]
    )
    size = shown.shape[0]
    nothing = np.full(size, np.nan)
    return Answers(
        design=design,
        origin="made up",
        people=tuple(f"p{k}" for k in range(people)),
        surfaces=design.stimuli,
        participant=np.repeat(np.arange(people), len(pairs)),
        number=np.tile(np.arange(len(pairs)) + 1, people),
        phase=np.full(size, "main"),
        display=np.zeros(size, dtype=np.int64),
        series=np.full(size, -1),
        presented=shown.T,
        intensity=nothing,
        choice=(random.random(size) < p).astype(np.int64),
        right=different.astype(np.int64),
        estimate=nothing,
        response_time=nothing,
    )


def test_the_d_prime_of_each_pair_is_found_again() -> None:
    made = answers(40, 60, 3)
    assert not made.design.on_a_scale
    same, *pairs = condition_findings(made, 0.95, 0)
    assert same.name == "the same"
    assert same.d_prime is None
    for one in pairs:
        assert one.d_prime is not None
        assert one.d_prime.value == pytest.approx(TRUE[one.name], abs=0.12)
        assert one.d_prime.low < one.d_prime.value < one.d_prime.high


def test_the_analysis_says_that_there_is_no_weber_fraction() -> None:
    found = analyze_answers(answers(3, 10, 5), "shapes")["biet2008-plate"]
    assert found.measure == MEASURE
    assert found.pooled is not None
    assert found.spread is None
    assert [one.person for one in found.persons] == [f"p{k}" for k in range(3)]
    assert any("no Weber fraction" in one for one in found.notes)
    assert "no amount in common" in found.methods
    assert "false alarms (same called different)" in found.more
    assert found.summary()["conditions"][1]["value"] is None


def test_one_person_has_the_interval_of_their_trials() -> None:
    found = analyze_answers(answers(1, 20, 8), "shapes")["biet2008-plate"]
    assert found.pooled is not None
    assert found.pooled.method == "Jeffreys, over trials"


@pytest.mark.slow
def test_a_study_of_shapes_is_planned_by_its_sensitivity() -> None:
    """Surfaces without a scale have no Weber fraction, and its precision is that of d′."""
    measure, value = person_values(answers(4, 20, 5))
    assert measure == MEASURE
    assert value.shape == (4,)
    assert np.isfinite(value).all()
