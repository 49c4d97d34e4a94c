"""Noise and decisions of simulated participants, on chains written down by hand."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from scipy.special import ndtr

from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.observer import Observer, load_observer
from squeezefilm.physics.perception.percepts import Apparatus
from squeezefilm.physics.perception.senses import D_PRIME_OF_75, Candidates
from squeezefilm.study.design.study_design import StudyDesign, load_design
from squeezefilm.study.simulated.answers import simulate_participants
from squeezefilm.study.simulated.chain_tables import ChainTables, chain_tables
from squeezefilm.study.simulated.participants import (
    match_counts,
    right_answers,
)

PERIODS = np.array([0.4e-3, 2e-3, 4e-3, 8e-3, 10e-3])
DESIGN = dataclasses.replace(load_design("biet2008-gratings"), displays=("biet2008-stator",))
EXACT = dataclasses.replace(
    load_observer(),
    finger_classes=1,
    candidates=1,
    period_spread=0.0,
    lapse_rate=0.0,
    learning_excess=0.0,
)


def tables(d_prime: float, observer: Observer = EXACT, design: StudyDesign = DESIGN) -> ChainTables:
    """One display, one finger: each period alone, as evident as said; gratings beyond doubt."""
    period = PERIODS[None, :, None]
    return ChainTables(
        design=design,
        observer=observer,
        fingers=observer.fingers(),
        apparatus=(Apparatus(),),
        virtual=Candidates(period[None, ..., None], np.full((1, 1, 5, 1, 1), d_prime)),
        real=Candidates(period, np.full((1, 5, 1), 1e6)),
    )


def run(d_prime: float, people: int = 600, seed: int = 3, observer: Observer = EXACT):  # type: ignore[no-untyped-def]
    return simulate_participants(DESIGN, observer, people, seed, tables(d_prime, observer))


def test_8_against_10_mm_as_three_independent_percepts_have_it() -> None:
    # v, a, b of equal variance: v − (a + b)/2 and b − a are independent.
    sigma = math.log1p(EXACT.period_weber_fraction) / D_PRIME_OF_75
    apart = math.log(10 / 8)
    near, order = ndtr(apart / 2 / (sigma * math.sqrt(1.5))), ndtr(apart / (sigma * math.sqrt(2)))
    expected = near * order + (1 - near) * (1 - order)
    found = run(1e6).confusion().proportions
    error = math.sqrt(expected * (1 - expected) / 6000)
    assert found[4, 4] == pytest.approx(expected, abs=4 * error)
    assert found[3, 3] == pytest.approx(expected, abs=4 * error)
    assert found[0, 0] == 1.0


def test_lapses_and_nothing_felt_are_guesses() -> None:
    nothing = run(-np.inf)
    blind = run(1e6, observer=dataclasses.replace(EXACT, lapse_rate=1.0, lapse_spread=0.0))
    for study in (nothing, blind):
        error = math.sqrt(0.16 / study.answers.trials)
        assert study.proportion_correct() == pytest.approx(0.2, abs=4 * error)


def test_the_seed_gives_the_same_answers_and_people_do_not_depend_on_their_number() -> None:
    few, many, other = run(2.0, 12), run(2.0, 150), run(2.0, 12, seed=4)
    first = many.answers.take(many.answers.participant < 12)
    for name in ("display", "presented", "choice", "number", "response_time"):
        assert np.array_equal(getattr(few.answers, name), getattr(first, name))
    assert not np.array_equal(few.answers.choice, other.answers.choice)


def test_every_stimulus_comes_as_often_as_designed() -> None:
    counts = match_counts(run(2.0, 30).answers)
    assert np.all(counts.sum(axis=1) == DESIGN.blocks * DESIGN.repetitions)


def test_people_learn_and_doubt_takes_time() -> None:
    slow = dataclasses.replace(EXACT, learning_excess=3.0, learning_trials=5.0)
    answers = run(1e6, observer=slow).answers
    right = answers.correct.reshape(len(answers.people), -1)
    assert right[:, :10].mean() < right[:, -10:].mean() - 0.02
    times, stimulus = answers.response_time, answers.presented[0]
    assert times[stimulus == 4].mean() > times[stimulus == 1].mean()


def test_right_answers_are_the_designs() -> None:
    assert right_answers(DESIGN).tolist() == [0, 1, 2, 3, 4]


def test_what_cannot_be_simulated_is_refused() -> None:
    with pytest.raises(InputError, match="participants"):
        run(2.0, 0)
    with pytest.raises(InputError, match="another design"):
        simulate_participants(DESIGN, load_observer(), 2, 0, tables(1.0))
    with pytest.raises(InputError, match="1 displays"):
        chain_tables(DESIGN, EXACT, displays=())
