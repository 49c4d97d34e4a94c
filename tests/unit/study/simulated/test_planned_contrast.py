"""Two displays told apart by a design: what is found, and what is refused."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy import stats

from squeezefilm.core.errors import InputError
from squeezefilm.core.kept.store import Kept
from squeezefilm.physics.perception.senses import Candidates
from squeezefilm.study.simulated import planned_power
from squeezefilm.study.simulated import planned_precision as module
from squeezefilm.study.simulated.chain_tables import ChainTables
from squeezefilm.study.simulated.planned_precision import otherwise_than_0, planned_contrast

from .test_judgements import ALIKE, EXACT, NUMBERS, tables

HERE, THERE = "biet2008-plate", "biet2008-stator"


@pytest.fixture(autouse=True)
def by_hand(monkeypatch: pytest.MonkeyPatch) -> None:
    """On the second display all periods are felt nearer to their mean."""

    def made(design: Any, _observer: Any, **_: Any) -> ChainTables:
        one = tables(design, 6.0)
        logs = np.log(one.virtual.period)
        narrow = np.exp(logs.mean() + 0.3 * (logs - logs.mean()))
        both = Candidates(
            np.concatenate([one.virtual.period, narrow]), np.repeat(one.virtual.d_prime, 2, axis=0)
        )
        return dataclasses.replace(one, virtual=both, apparatus=one.apparatus * 2)

    monkeypatch.setattr(module, "chain_tables", made)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("design", "measure", "sign"), [(ALIKE, "ln Weber fraction", -1), (NUMBERS, "exponent", 1)]
)
def test_a_display_that_squeezes_differences_is_found(design: Any, measure: str, sign: int) -> None:
    found = planned_contrast(
        design, EXACT, HERE, THERE, participants=(2, 12), studies=30, people=24, seed=2
    )
    assert found.measure == measure
    assert np.sign(found.difference) == sign
    assert found.curve.power[1] == 1.0
    assert (found.first, found.second, found.display) == (HERE, THERE, "")
    assert found.summary()["measure"] == measure


def test_the_test_is_two_sided_and_knows_people_who_are_all_alike() -> None:
    scores = np.array([1.0, 2.0, 3.0])
    # t = 2 √3 with 2 degrees of freedom.
    assert otherwise_than_0(scores) == pytest.approx(2 * 0.0371, abs=2e-3)
    assert otherwise_than_0(-scores) == otherwise_than_0(scores)
    assert otherwise_than_0(np.zeros(3)) == 1.0
    assert otherwise_than_0(np.full(3, -0.5)) == 0.0


def test_what_cannot_be_contrasted_is_refused() -> None:
    with pytest.raises(InputError, match="differ from itself"):
        planned_contrast(ALIKE, EXACT, HERE, HERE)
    with pytest.raises(InputError, match="neither a file nor a preset"):
        planned_contrast(ALIKE, EXACT, HERE, "nowhere")
    with pytest.raises(InputError, match="people = 5"):
        planned_contrast(ALIKE, EXACT, HERE, THERE, people=5)


def test_the_p_is_students_and_of_people_on_both_displays(monkeypatch: pytest.MonkeyPatch) -> None:
    scores = np.array([0.3, -0.1, 0.4, 0.2, 0.25])
    assert otherwise_than_0(scores) == pytest.approx(stats.ttest_1samp(scores, 0.0).pvalue)
    assert otherwise_than_0(-scores) == pytest.approx(stats.ttest_1samp(scores, 0.0).pvalue)
    values = np.array([0.2, 0.5]), np.array([0.1, 0.8])
    answers: Any = SimpleNamespace(main=lambda number: number)
    for measure, said, expected in (
        ("Weber fraction", "ln Weber fraction", np.log([2.0, 0.625])),
        ("exponent", "exponent", [0.1, -0.3]),
    ):
        monkeypatch.setattr(module, "person_values", lambda n, m=measure: (m, values[n]))
        name, found = module.within_people(answers)
        assert name == said
        assert found == pytest.approx(expected)


def test_a_plan_has_what_people_do_otherwise_and_the_power_to_show_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Simulated once, kept by what it follows from, and tested as often as is asked."""
    apart = np.random.default_rng(2).normal(0.3, 0.1, 24)
    simulated: list[int] = []

    def answers(_tables: Any, people: int, *_: Any) -> str:
        simulated.append(people)
        return "answers"

    monkeypatch.setattr(planned_power, "simulated_answers", answers)
    monkeypatch.setattr(module, "within_people", lambda _: ("exponent", apart))
    monkeypatch.setattr(module, "_DIFFERENCES", Kept("differences-of-a-test", tuple[str, Any]))
    told: list[str] = []
    found = planned_contrast(
        NUMBERS, EXACT, HERE, THERE, participants=(3, 12), studies=40, people=24, seed=2,
        progress=told.append,
    )  # fmt: skip
    assert (found.measure, found.difference) == ("exponent", pytest.approx(apart.mean()))
    assert (found.first, found.second, found.display) == (HERE, THERE, "")
    assert (found.design, found.seed, found.origin) == (NUMBERS.name, 2, "simulated")
    # A mean of three standard deviations is shown by twelve people in every study.
    assert found.curve.power[1] == 1.0
    assert simulated == [24]
    assert "each person's fits" in told
    planned_contrast(
        NUMBERS, EXACT, HERE, THERE, participants=(3, 12), studies=10, people=24, seed=3
    )
    assert simulated == [24, 24]
