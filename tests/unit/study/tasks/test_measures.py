"""What a task measures, alone: the same numbers that the whole analysis has."""

from __future__ import annotations

import dataclasses

import numpy as np
from tests.unit.study.design.tasks.test_odd_one_out import DESIGN, made_up

from squeezefilm.study.tasks.analyze import analyze_answers
from squeezefilm.study.tasks.measures import measured


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
    # The preset excludes those named: what is quoted is without them.
    assert results["without those named"] == found.main_number != alone.pooled
