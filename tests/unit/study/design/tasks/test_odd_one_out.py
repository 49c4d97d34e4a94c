"""Odd one out of three: its orders, its model against brute force, people of a known fraction."""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from scipy import integrate, stats
from scipy.special import ndtr

from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.senses import percept_deviation
from squeezefilm.study.design.plan import plan_study
from squeezefilm.study.design.special_trials import AdaptiveCondition
from squeezefilm.study.design.study_design import StudyDesign, load_design
from squeezefilm.study.design.tasks.odd_one_out import (
    ODD_ONE_OUT,
    correct_of_three,
    d_prime_of_three,
)
from squeezefilm.study.design.tasks.task import Percepts
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.report.page import write_study
from squeezefilm.study.tasks.analyze import analyze_answers

DESIGN = load_design("period-odd-one-out")
PLACES = {name: k for k, name in enumerate(DESIGN.answers)}


def test_each_of_six_orders_comes_and_the_odd_one_is_right() -> None:
    every = DESIGN.conditions
    assert len(every) == len(set(every)) == 6 * 4
    assert Counter(len(set(one)) for one in every) == {2: 24}
    for one in every:
        answer = DESIGN.answer_to(*map(DESIGN.stimulus, one))
        assert one.count(one[PLACES[answer]]) == 1
    main = [t for t in plan_study(DESIGN, 1).schedules[0] if t.phase == "main"]
    assert set(Counter(t.answer for t in main).values()) == {len(main) // 3}
    caught = [t for t in plan_study(DESIGN, 1).schedules[0] if t.phase == "catch"]
    assert {(t.stimuli, t.answer) for t in caught} == {(("12 mm", "12 mm", "4 mm"), "third")}


@pytest.mark.parametrize("d_prime", [0.0, 0.5, 1.0, 2.5, 5.0])
def test_the_share_right_is_that_of_a_brute_force_simulation(d_prime: float) -> None:
    """200 000 triangles of normal percepts; the one furthest from the others' nearest pair."""
    random, runs = np.random.default_rng(7), 200_000
    level = random.standard_normal((3, runs)) + np.array([[0.0], [0.0], [d_prime]])
    felt, one = np.ones((3, runs), dtype=bool), np.ones(runs)
    found = ODD_ONE_OUT.decides
    assert found is not None
    share = float(np.mean(found(Percepts(level, felt, one, 1.0)).choice == 2))
    assert correct_of_three(d_prime) == pytest.approx(share, abs=4e-3)
    if d_prime:
        assert d_prime_of_three(float(correct_of_three(d_prime))) == pytest.approx(d_prime)


def by_adaptive_quadrature(d_prime: float) -> float:
    """The triangular method's share of right answers, by SciPy's integrator."""
    apart = math.sqrt(2 / 3) * d_prime

    def integrand(z: float) -> float:
        inner = -math.sqrt(3) * z
        return float((ndtr(inner + apart) + ndtr(inner - apart)) * stats.norm.pdf(z))

    return 2 * float(integrate.quad(integrand, 0, math.inf, epsabs=1e-13)[0])


@pytest.mark.parametrize("d_prime", [0.0, 0.3, 1.0, 2.0, 3.5, 6.0])
def test_the_share_of_right_answers_is_that_of_two_independent_sums(d_prime: float) -> None:
    found = correct_of_three(d_prime)
    assert found == pytest.approx(by_adaptive_quadrature(d_prime), abs=1e-11)
    # The odd one is named where v² > 3 u², u and v the difference of the alike and the distance
    # from them, in standard deviations: a ratio of χ², the first not central.
    noncentral = float(stats.ncf.sf(3.0, 1, 1, 2 / 3 * d_prime**2)) if d_prime else 1 / 3
    assert found == pytest.approx(noncentral, abs=1e-8)


def test_guesses_are_a_third_and_the_published_table_is_met() -> None:
    assert correct_of_three(0.0) == pytest.approx(1 / 3, abs=1e-12)
    # Ennis 1993, table of the triangular method: d′ 1 and 2, which have four digits there.
    assert correct_of_three(np.array([1.0, 2.0])) == pytest.approx([0.4180, 0.6048], abs=1e-4)
    assert d_prime_of_three(0.2) == 0.0
    assert d_prime_of_three(1.0) == 20.0


def test_one_felt_alone_or_one_not_felt_is_the_odd_one() -> None:
    felt = np.array([[1, 1, 0, 0], [0, 1, 0, 1], [0, 0, 0, 1]], dtype=bool)
    given = Percepts(np.zeros((3, 4)), felt, np.ones(4), 1.0)
    assert ODD_ONE_OUT.decides is not None
    found = ODD_ONE_OUT.decides(given)
    assert found.choice[[0, 1, 3]].tolist() == [0, 2, 0]
    assert found.decided.tolist() == [True, True, False, True]


def made_up(design: StudyDesign, people: int, fraction: float, seed: int) -> Answers:
    """Answers of people who all have a Weber fraction, and lapse in 2 % of their trials."""
    random = np.random.default_rng(seed)
    plans = [[t for t in s if t.asks] for s in plan_study(design, people).schedules]
    surfaces = (*design.stimuli, *(one.stimulus for one in design.catch))
    number = {one.name: k for k, one in enumerate(surfaces)}
    rows = [t for plan in plans for t in plan]
    shown = np.array([[number[name] for name in t.stimuli] for t in rows]).T
    logs = np.log([design.judged_value(one) for one in surfaces])[shown]
    level = logs + percept_deviation(fraction) * random.standard_normal(shown.shape)
    apart = np.abs(level - level[[1, 2, 0]])
    choice = (np.argmin(apart, axis=0) + 2) % 3
    guessed = random.random(choice.size) < 0.02
    choice = np.where(guessed, random.integers(0, 3, choice.size), choice)
    nothing, none = np.full(choice.size, np.nan), np.full(choice.size, -1)
    return Answers(
        design=design,
        origin="made up",
        people=tuple(f"p{k}" for k in range(people)),
        surfaces=surfaces,
        participant=np.repeat(np.arange(people), len(plans[0])),
        number=np.array([t.number for t in rows]),
        phase=np.array([t.phase for t in rows]),
        display=np.zeros(choice.size, dtype=np.int64),
        series=none,
        presented=shown,
        intensity=nothing,
        choice=choice,
        right=np.array([PLACES[t.answer] for t in rows]),
        estimate=nothing,
        response_time=nothing,
    )


@pytest.mark.slow
def test_a_weber_fraction_comes_back_from_answers_to_its_page(tmp_path: Path) -> None:
    (found,) = analyze_answers(made_up(DESIGN, 10, 0.12, 3), "odd").values()
    pooled = found.main_number
    assert pooled is not None
    assert pooled.low < 0.12 < pooled.high
    assert pooled.high - pooled.low < 0.05
    assert found.screening is not None
    assert not found.screening.named
    page = write_study(found, tmp_path / "page").read_text()
    assert "Which of the three surfaces was different?" in page
    assert "triangular method" in page
    assert "Right" in page


def test_somebody_who_guesses_is_named() -> None:
    answers = made_up(DESIGN, 6, 0.12, 4)
    random = np.random.default_rng(5)
    choice = np.where(
        answers.participant == 2, random.integers(0, 3, answers.trials), answers.choice
    )
    (found,) = analyze_answers(dataclasses.replace(answers, choice=choice), "odd").values()
    assert found.screening is not None
    assert [one.person for one in found.screening.named] == ["p2"]


def test_no_series_chooses_its_comparisons() -> None:
    with pytest.raises(InputError, match="adaptive"):
        dataclasses.replace(DESIGN, adaptive=(AdaptiveCondition("s", "bayesian"),))
