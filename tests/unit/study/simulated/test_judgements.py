"""Simulated answers to two intervals, same or different and magnitudes, on percepts by hand."""

from __future__ import annotations

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.special import ndtr

from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.perception.percepts import Apparatus, Perceived
from squeezefilm.physics.perception.senses import D_PRIME_OF_75, Candidates
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.adaptive.series import adaptive_method
from squeezefilm.study.design.rules import AdaptiveCondition
from squeezefilm.study.design.study_design import StudyDesign, load_design
from squeezefilm.study.design.tasks.every_task import TASKS
from squeezefilm.study.simulated.answers import (
    simulate_participants,
)
from squeezefilm.study.simulated.chain_tables import ChainTables
from squeezefilm.study.simulated.judgements import _alike_in_plane, simulate_judgements

EXACT = dataclasses.replace(
    load_observer(),
    finger_classes=1,
    candidates=1,
    period_spread=0.0,
    lapse_rate=0.0,
    learning_excess=0.0,
)
SIGMA = math.log1p(EXACT.period_weber_fraction) / D_PRIME_OF_75
PERIODS = dataclasses.replace(
    load_design("period-same-different"), task="two-interval", practice=0, repetitions=10, catch=()
)
ALIKE = dataclasses.replace(
    load_design("period-same-different"), practice=0, catch=(), repetitions=10
)
DEPTHS = dataclasses.replace(load_design("friction-jnd"), practice=0, catch=())
NUMBERS = dataclasses.replace(load_design("coarseness-magnitude"), familiarisation=0)


def tables(design: StudyDesign, d_prime: list[float] | float = 1e6) -> ChainTables:
    """One display, one finger: each period alone, as evident as said."""
    period = np.array([one.period for one in design.stimuli])[None, None, :, None, None]
    evidence = np.broadcast_to(np.asarray(d_prime, dtype=float), len(design.stimuli))
    return ChainTables(
        design=design,
        observer=EXACT,
        fingers=EXACT.fingers(),
        apparatus=(Apparatus(),),
        virtual=Candidates(period, evidence[None, None, :, None, None].copy()),
        real=Candidates(np.empty((1, 0, 1)), np.empty((1, 0, 1))),
    )


@pytest.mark.slow
def test_the_coarser_is_found_as_often_as_two_percepts_have_it() -> None:
    main = simulate_judgements(tables(PERIODS), 200, 1).main(0)
    for one in PERIODS.stimuli[1:]:
        pair = np.array(
            [main.surfaces[k].name for k in np.maximum(main.presented[0], main.presented[1])]
        )
        here = pair == one.name
        expected = ndtr(math.log(one.period / 4e-3) / (math.sqrt(2) * SIGMA))
        error = math.sqrt(expected * (1 - expected) / here.sum())
        assert main.correct[here].mean() == pytest.approx(expected, abs=4.5 * error + 1e-3)


def test_the_deeper_is_found_by_its_evidence() -> None:
    strengths = [2.0 + 2.0 * (one.friction_depth - 0.3) / 0.12 for one in DEPTHS.stimuli]
    main = simulate_judgements(tables(DEPTHS, strengths), 300, 1).main(0)
    names = np.array([one.name for one in main.surfaces])
    deepest = (names[main.presented[0]] == "42 %") | (names[main.presented[1]] == "42 %")
    expected = ndtr(2.0 / math.sqrt(2))
    assert main.correct[deepest].mean() == pytest.approx(expected, abs=0.02)


@pytest.mark.slow
def test_the_same_are_called_different_as_the_criterion_has_it() -> None:
    main = simulate_judgements(tables(ALIKE), 100, 1).main(0)
    same = main.presented[0] == main.presented[1]
    expected = 2 * ndtr(-EXACT.detection_criterion)
    assert (main.choice[same] == 1).mean() == pytest.approx(expected, abs=0.02)


def test_numbers_are_in_proportion_to_clear_periods() -> None:
    answers = simulate_judgements(tables(NUMBERS), 400, 1)
    main = answers.main(0)
    for k, one in enumerate(NUMBERS.stimuli):
        mean = math.exp(np.log(main.estimate[main.presented[0] == k]).mean())
        assert mean == pytest.approx(10 * one.period / 4e-3, rel=0.03)
    digits = [f"{value:.1e}" for value in main.estimate[:50]]
    assert [float(one) for one in digits] == pytest.approx(main.estimate[:50].tolist())


@pytest.mark.slow
def test_nobody_feels_anything_and_answers_are_guesses() -> None:
    main = simulate_judgements(tables(PERIODS, -np.inf), 100, 1).main(0)
    assert main.correct.mean() == pytest.approx(0.5, abs=0.03)


@pytest.mark.parametrize(
    "design",
    [*(pytest.param(design, marks=pytest.mark.slow) for design in (PERIODS, ALIKE)), NUMBERS],
    ids=lambda one: one.task,
)
def test_people_do_not_depend_on_how_many_there_are(design: StudyDesign) -> None:
    few = simulate_judgements(tables(design, 1.5), 3, 4)
    many = simulate_judgements(tables(design, 1.5), 70, 4)
    mine = many.participant < 3
    for key in ("choice", "estimate", "presented", "response_time"):
        assert np.array_equal(getattr(few, key), getattr(many, key)[..., mine], equal_nan=True)
    again = simulate_judgements(tables(design, 1.5), 3, 5)
    assert not np.array_equal(few.response_time, again.response_time)


def test_results_say_that_they_are_simulated_and_what_they_assume() -> None:
    found = simulate_participants(ALIKE, EXACT, 4, 0, tables(ALIKE, 3.0))
    data = found.summary()
    assert data["origin"] == "simulated"
    (one,) = found.analyses.values()
    assert next(iter(data["displays"].values()))["assumed"] == list(TASKS["same-different"].assumed)
    assert one.origin == "simulated"
    assert len(found.rows()) == found.answers.trials
    assert found.participants == 4


def test_a_simulated_match_has_its_answers_too() -> None:
    design = load_design("biet2008-gratings")
    alone = dataclasses.replace(design, displays=("biet2008-plate",))
    period = np.array([one.period for one in alone.stimuli])[None, None, :, None]
    table = dataclasses.replace(tables(alone), real=Candidates(period[0], np.full((1, 5, 1), 1e6)))
    study = simulate_participants(alone, EXACT, 3, 0, table)
    answers = study.answers
    assert study.is_matching
    assert answers.trials == 3 * alone.most_main_trials
    assert [row["trial"] for row in study.rows()] == answers.number.tolist()
    assert np.nanmean(answers.correct) == pytest.approx(study.proportion_correct())


def test_what_cannot_be_judged_is_refused() -> None:
    odd = dataclasses.replace(NUMBERS, judged="orientation")
    with pytest.raises(InputError, match="judged = 'orientation'"):
        simulate_judgements(tables(odd), 1, 0)
    with pytest.raises(InputError, match="another design"):
        simulate_participants(ALIKE, EXACT, 2, 0, tables(NUMBERS))


def test_alike_in_the_plane_is_within_the_criterion_of_noise_alone() -> None:
    """Strengths along both ways, and periods where both are felt; blind people guess."""
    random = np.random.default_rng(8)
    count = 6
    one, other = (
        Perceived(
            random.normal(size=(count, 2)),
            random.normal(1.5, 1.0, (count, 2)),
            random.random((count, 2)) < 0.6,
        )
        for _ in range(2)
    )
    people: Any = SimpleNamespace(
        spread=np.full(count, 0.3),
        blind=np.array([[9.0] * 6, [0.9, 0.9, 0.9, 0.9, 0.01, 0.01]]),
        lapse=np.full(count, 0.05),
        guess=np.array([[0.0] * 6, [0.0, 0.0, 0.0, 0.0, 0.4, 0.6]]),
    )
    room: Any = SimpleNamespace(observer=SimpleNamespace(detection_criterion=0.8))
    given = _alike_in_plane(room, people, [one, other], 1.2, 1)
    for k in range(count):
        terms, square = 2, 0.0
        for way in range(2):
            square += (max(one.strength[k, way], 0) - max(other.strength[k, way], 0)) ** 2
            if one.felt[k, way] and other.felt[k, way]:
                terms += 1
                square += ((one.log_period[k, way] - other.log_period[k, way]) / 0.3) ** 2
        apart = math.sqrt(square / (2 * 1.2**2) / terms)
        blind = k in (4, 5)
        assert given.choice[k] == ((k == 4) if blind else (apart > 0.8))
        assert given.doubt[k] == pytest.approx(1.0 if blind else math.exp(-abs(apart - 0.8)))
    assert np.isnan(given.estimate).all()


class Varied(ChainTables):
    """Tables that feel what an adaptive series chooses, too: each period alone, as evident."""

    def felt(self, display: int, finger: int, stimulus: Stimulus) -> Candidates:
        """The period that the stimulus has."""
        assert (display, finger) == (0, 0)
        return Candidates(np.array([[stimulus.period]]), np.array([[1e6]]))


def varied(design: StudyDesign) -> ChainTables:
    one = tables(design)
    return Varied(**{field.name: getattr(one, field.name) for field in dataclasses.fields(one)})


SERIES = dataclasses.replace(
    load_design("period-jnd"), practice=0, catch=(),
    adaptive=(AdaptiveCondition("stairs", "staircase", start=0.4, step=0.08, count=30),),
)  # fmt: skip
PAIRS = dataclasses.replace(
    load_design("period-same-different"), practice=0, catch=(), repetitions=1,
    adaptive=(AdaptiveCondition("pairs", "bayesian", count=6),),
)  # fmt: skip


@pytest.mark.parametrize(("design", "people"), [(SERIES, 2), (PAIRS, 1)])
def test_a_series_asks_next_what_its_answers_make_it_ask(design: StudyDesign, people: int) -> None:
    """Each person's answers, told to the method again, choose the differences that were asked."""
    found = simulate_judgements(varied(design), people, 3)
    for person in range(people):
        mine = found.take((found.participant == person) & (found.series == 0))
        assert len(mine.intensity) == design.adaptive[0].count
        method = adaptive_method(design.adaptive[0], task=design.task)
        trials_asked = zip(mine.intensity, *mine.presented, mine.choice, mine.right, strict=True)
        for intensity, first, second, choice, right in trials_asked:
            shown = [mine.surfaces[place] for place in (first, second)]
            if design.task == "same-different" and design.answers[right] == "same":
                assert intensity == 0.0
                assert [one.name for one in shown] == [design.reference] * 2
            else:
                assert intensity == method.next_stimulus()
                here = design.stimulus(design.reference).period
                periods = sorted(one.period for one in shown)
                assert periods == pytest.approx([here, here * (1 + intensity)])
            if design.task == "two-interval":
                finer = shown[0].period > shown[1].period
                assert design.answers[right] == ("first" if finer else "second")
            method.update(float(intensity), bool(choice == right))
    # People differ, so that one's series is not the other's.
    series = {tuple(found.intensity[found.participant == person]) for person in range(people)}
    assert len(series) == people


def test_progress_is_told_of_people() -> None:
    told: list[str] = []
    simulate_judgements(tables(NUMBERS), 3, 1, told.append)
    assert told == ["3 of 3 simulated participants"]


def test_the_noise_of_a_percept_of_nothing_is_a_guess() -> None:
    """Depths are judged though nothing is felt: half of the answers are right."""
    main = simulate_judgements(tables(DEPTHS, -np.inf), 12, 1).main(0)
    error = 0.5 / math.sqrt(main.trials)
    assert main.correct.mean() == pytest.approx(0.5, abs=4 * error)


def test_a_depth_is_a_number_in_proportion_to_what_is_felt_of_it() -> None:
    """Twice the reference's strength is given more, half of it less, the reference its modulus."""
    design = dataclasses.replace(
        DEPTHS, task="magnitude-estimation", reference="30 %", modulus=10.0, repetitions=3
    )
    levels = {one.name: one.friction_depth / 0.3 for one in design.stimuli}
    strengths = [40.0 * levels[one.name] for one in design.stimuli]
    answers = simulate_judgements(tables(design, strengths), 20, 1).main(0)
    middle = {
        one.name: float(np.median(answers.estimate[answers.presented[0] == k]))
        for k, one in enumerate(design.stimuli)
    }
    assert middle["30 %"] == pytest.approx(10.0, rel=0.1)
    order = sorted(levels, key=lambda name: levels[name])
    assert sorted(middle, key=lambda name: middle[name]) == order
