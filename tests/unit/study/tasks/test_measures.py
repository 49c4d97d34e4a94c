"""What a task measures, alone: the same numbers that the whole analysis has."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy import stats
from tests.unit.study.design.tasks.test_odd_one_out import DESIGN, made_up

from squeezefilm.study.tasks.analyze import analyze_answers
from squeezefilm.study.tasks.measures import _trimmed, measured


def test_everybodys_number_is_that_of_the_task_alone() -> None:
    answers = made_up(DESIGN, 6, 0.12, 8)
    random = np.random.default_rng(9)
    guessed = random.integers(0, 3, answers.trials)
    answers = dataclasses.replace(
        answers, choice=np.where(answers.participant == 1, guessed, answers.choice)
    )
    (found,) = analyze_answers(answers, "odd").values()
    assert found.screening is not None
    results = found.screening.results
    alone = measured(answers.main(0), 0.95, 0, lambda _: None)
    assert results["everybody"] == alone.pooled
    assert results["robust, everybody"] == alone.robust
    # The preset excludes those named: what is quoted is without them.
    assert results["without those named"] == found.main_number != alone.pooled


def test_a_trimmed_mean_has_yuens_interval() -> None:
    """Of eleven values two are cut at either end; their spread is that of values drawn in."""
    values = np.array([0.3, 9.0, 1.0, 1.4, -4.0, 0.7, 1.1, 0.9, 5.0, 0.2, 1.3])

    def persons(values: np.ndarray) -> Any:
        return [SimpleNamespace(estimate=SimpleNamespace(value=value)) for value in values]

    found = _trimmed(persons(values), 0.9)
    assert found is not None
    kept = np.sort(values)[2:-2]
    assert found.value == pytest.approx(kept.mean())
    drawn_in = np.clip(values, kept[0], kept[-1])
    error = np.sqrt(10 * drawn_in.var(ddof=1) / (7 * 6))
    reach = stats.t.ppf(0.95, 6) * error
    assert (found.low, found.high) == pytest.approx((found.value - reach, found.value + reach))
    assert found.level == 0.9
    assert _trimmed(persons(values[:4]), 0.9) is None
    five = _trimmed(persons(values[:5]), 0.9)
    assert five is not None
    assert five.value == pytest.approx(np.mean([0.3, 1.0, 1.4]))
