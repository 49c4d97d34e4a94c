"""Odd one out of three: its orders, its model against brute force, people of a known fraction."""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from scipy import integrate, stats
from scipy.linalg import helmert
from scipy.special import ndtr

from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.senses import percept_deviation
from squeezefilm.study.design.plan import plan_study
from squeezefilm.study.design.rules import AdaptiveCondition
from squeezefilm.study.design.study_design import StudyDesign, load_design
from squeezefilm.study.design.tasks.every_task import TASKS
from squeezefilm.study.design.tasks.same_different import (
    ODD_ONE_OUT,
    d_prime_of_share,
    share_right,
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
    assert share_right(d_prime) == pytest.approx(share, abs=4e-3)
    if d_prime:
        assert d_prime_of_share(float(share_right(d_prime))) == pytest.approx(d_prime)


def by_adaptive_quadrature(d_prime: float) -> float:
    """The triangular method's share of right answers, by SciPy's integrator."""
    apart = math.sqrt(2 / 3) * d_prime

    def integrand(z: float) -> float:
        inner = -math.sqrt(3) * z
        return float((ndtr(inner + apart) + ndtr(inner - apart)) * stats.norm.pdf(z))

    return 2 * float(integrate.quad(integrand, 0, math.inf, epsabs=1e-13)[0])


@pytest.mark.parametrize("d_prime", [0.0, 0.3, 1.0, 2.0, 3.5, 6.0])
def test_the_share_of_right_answers_is_that_of_two_independent_sums(d_prime: float) -> None:
    found = share_right(d_prime)
    assert found == pytest.approx(by_adaptive_quadrature(d_prime), abs=1e-11)
    # The odd one is named where v² > 3 u², u and v the difference of the alike and the distance
    # from them, in standard deviations: a ratio of χ², the first not central.
    noncentral = float(stats.ncf.sf(3.0, 1, 1, 2 / 3 * d_prime**2)) if d_prime else 1 / 3
    assert found == pytest.approx(noncentral, abs=1e-8)


def test_guesses_are_a_third_and_the_published_table_is_met() -> None:
    assert share_right(0.0) == pytest.approx(1 / 3, abs=1e-12)
    # Ennis 1993, table of the triangular method: d′ 1 and 2, which have four digits there.
    assert share_right(np.array([1.0, 2.0])) == pytest.approx([0.4180, 0.6048], abs=1e-4)
    assert d_prime_of_share(0.2) == 0.0
    assert d_prime_of_share(1.0) == 20.0


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
    choice = np.argmax(np.abs(level - level.mean(axis=0)), axis=0)
    guessed = random.random(choice.size) < 0.02
    choice = np.where(guessed, random.integers(0, len(shown), choice.size), choice)
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
        right=np.array([design.answers.index(t.answer) for t in rows]),
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


NUMBERS = {"odd-one-out": 3, "odd-one-out-of-four": 4, "odd-one-out-of-five": 5}


@pytest.mark.parametrize(("task", "surfaces"), NUMBERS.items())
def test_shares_of_any_number_are_those_of_brute_force(task: str, surfaces: int) -> None:
    """400 000 trials of normal percepts, the first of them the odd one."""
    random, runs = np.random.default_rng(11), 400_000
    decides = TASKS[task].decides
    assert decides is not None
    for d_prime in (0.0, 1.0, 2.5):
        level = random.standard_normal((surfaces, runs))
        level[0] += d_prime
        felt, ones = np.ones(level.shape, dtype=bool), np.ones(runs)
        share = float(np.mean(decides(Percepts(level, felt, ones, 1.0)).choice == 0))
        made = share_right(d_prime, surfaces)
        assert made == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / runs))
    assert share_right(0.0, surfaces) == pytest.approx(1 / surfaces, abs=2e-5)
    assert d_prime_of_share(1 / surfaces, surfaces) == pytest.approx(0.0, abs=0.02)
    back = d_prime_of_share(float(share_right(1.7, surfaces)), surfaces)
    assert back == pytest.approx(1.7, abs=1e-9)


def test_shares_of_four_are_those_of_a_sum_over_the_plane() -> None:
    """Two dimensions remain of four percepts: angles and radii in place of a Sobol sequence."""
    angle = 2 * math.pi * (np.arange(2000) + 0.5) / 2000
    nodes, weights = np.polynomial.legendre.leggauss(120)
    radius = 4.5 * (nodes + 1)
    around = np.stack([np.cos(angle), np.sin(angle)], axis=-1) @ helmert(3)
    farthest = np.maximum(around.max(axis=1), -2 * around.min(axis=1))
    u = np.outer(farthest, radius).ravel()
    weight = np.outer(np.full(2000, 1 / 2000), 4.5 * weights * radius * np.exp(-(radius**2) / 2))
    weight = weight.ravel()
    for d_prime in (0.0, 0.954, 2.0, 4.0):
        s = math.sqrt(4 / 3)
        share = float(weight @ (ndtr((d_prime - u) / s) + ndtr((-d_prime - u) / s)))
        assert share_right(d_prime, 4) == pytest.approx(share, abs=5e-5)


@pytest.mark.parametrize("task", list(NUMBERS)[1:])
def test_four_and_five_go_from_plan_to_result(task: str) -> None:
    design = dataclasses.replace(DESIGN, task=task, catch=(), practice=0)
    surfaces = NUMBERS[task]
    assert len(design.conditions) == 2 * surfaces * 4
    for condition in design.conditions:
        answer = design.answer_to(*map(design.stimulus, condition))
        assert condition.count(condition[design.answers.index(answer)]) == 1
    (found,) = analyze_answers(made_up(design, 6, 0.12, 3), "odd").values()
    assert found.main_number is not None
    assert found.main_number.low < 0.12 < found.main_number.high


def test_an_unfelt_half_is_guessed() -> None:
    felt = np.array([[1, 1, 1], [1, 0, 1], [0, 0, 1], [0, 0, 0]], dtype=bool)
    decides = TASKS["odd-one-out-of-four"].decides
    assert decides is not None
    found = decides(Percepts(np.zeros((4, 3)), felt, np.ones(3), 1.0))
    assert found.decided.tolist() == [False, True, True]
    assert found.choice[1:].tolist() == [0, 3]


def test_a_series_presents_the_comparison_alone_or_all_but_once() -> None:
    series = AdaptiveCondition("s", "bayesian", lowest=0.02, highest=1.0, count=12)
    design = dataclasses.replace(DESIGN, adaptive=(series,), catch=())
    kinds = [ODD_ONE_OUT.series(k, "bayesian") for k in range(series.count)]
    assert Counter(kinds) == {(first, place): 2 for first in (True, False) for place in PLACES}
    for first, answer in kinds:
        shown = ODD_ONE_OUT.arranges("reference", "other", first, answer)
        assert shown.count(shown[PLACES[answer]]) == 1
        assert shown.count("reference") == (2 if first else 1)
    assert {t.adaptive for t in plan_study(design, 1).schedules[0] if t.phase == "main"} == {"s"}
    with pytest.raises(InputError, match="method"):
        dataclasses.replace(DESIGN, adaptive=(dataclasses.replace(series, method="staircase"),))
