"""What is said of somebody's answers: habits, mixed up, at chance, catch trials, unfinished."""

from __future__ import annotations

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.recovery.task_people import D_PRIME, DESIGNS, Person, answered, somebody

from squeezefilm.study.design.rules import ExclusionRule
from squeezefilm.study.design.study_design import load_design
from squeezefilm.study.identification import screening
from squeezefilm.study.identification.screening import _changed, _habits, _models, judged_people


def habits(**given: Any) -> list[str]:
    choice = np.array(given.get("choice", [0, 1, 1, 0, 0, 1] * 2))
    mine: Any = {
        "design": SimpleNamespace(
            answers=("first", "second"), exclusion=ExclusionRule(fastest=0.2, fast=0.25)
        ),
        "trials": choice.size,
        "choice": choice,
        "right": np.resize([0, 1], choice.size),
        "estimate": np.arange(choice.size) + 1.0,
        "response_time": np.ones(choice.size),
    }
    return _habits(SimpleNamespace(**{**mine, **given, "choice": choice}))  # type: ignore[arg-type]


NUMBERS = SimpleNamespace(answers=(), exclusion=None)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({}, []),
        ({"choice": [0] * 11 + [1]}, ["answers “first” in 92 %"]),
        ({"choice": [1] * 11 + [0]}, ["answers “second” in 92 %"]),
        ({"choice": [0] * 10 + [1] * 2}, []),
        # Where that answer is mostly right, it is no habit.
        ({"choice": [0] * 12, "right": np.zeros(12)}, []),
        ({"choice": [0, 1] * 6}, ["alternates the answers in 100 %"]),
        ({"choice": [0, 1] * 5}, []),
        ({"choice": [0] * 11}, []),
        ({"response_time": np.r_[np.full(4, 0.19), np.ones(8)]}, ["33 % of the answers within"]),
        ({"response_time": np.r_[np.full(3, 0.19), np.ones(9)]}, []),
        ({"response_time": np.r_[np.full(3, 0.19), np.ones(8), np.nan]}, ["27 % of the answers"]),
        ({"response_time": np.full(12, np.nan)}, []),
        ({"design": NUMBERS}, []),
        ({"design": NUMBERS, "estimate": np.full(12, 7.5)}, ["gives the number 7.5 to everything"]),
        ({"design": NUMBERS, "choice": [0] * 3, "estimate": np.full(3, 2.0)}, ["gives the number"]),
        ({"design": NUMBERS, "choice": [0] * 2, "estimate": np.full(2, 2.0)}, []),
    ],
)
def test_habits_are_named_and_nothing_else(given: dict[str, Any], said: list[str]) -> None:
    found = habits(**given)
    assert len(found) == len(said)
    for reason, begin in zip(found, said, strict=True):
        assert reason.startswith(begin)


def judged(
    monkeypatch: pytest.MonkeyPatch, follows: list[float], *, lost: int = 0, catch: Any = ()
) -> tuple[list[tuple[tuple[str, ...], tuple[str, ...]]], str]:
    """Reasons and doubts of people who follow the surfaces as told; the first answered `lost`
    trials less than the others."""
    random = np.random.default_rng(5)
    answers = answered(DESIGNS["constant"], [somebody(random) for _ in follows], random)
    if lost:
        mine = np.flatnonzero(answers.participant == 0)
        answers = answers.take(np.delete(np.arange(answers.trials), mine[:lost]))
    given = iter(follows)
    monkeypatch.setattr(screening, "_follows", lambda mine, model: next(given))
    monkeypatch.setattr(screening, "_habits", lambda mine: [])
    monkeypatch.setattr(screening, "_changed", lambda mine, model: [])
    monkeypatch.setattr(screening, "attention", lambda caught: catch)
    people, said = judged_people(answers, 0)
    assert [person.person for person in people] == [f"p{k}" for k in range(len(follows))]
    return [(person.reasons, person.doubts) for person in people], said


def test_at_chance_is_below_the_rule_or_half_of_the_median(monkeypatch: pytest.MonkeyPatch) -> None:
    found, said = judged(monkeypatch, [3.2, 3.0, -3.2, 8.0, 9.0])
    assert said == ""
    assert found[0] == found[3] == found[4] == ((), ())
    # A third of the median of 3.2 is asked, so nobody but who mixes up the answers is told.
    assert found[1] == ((), ())
    assert found[2] == (("answers are mixed up (z = -3.2)",), ())
    found, _ = judged(monkeypatch, [8.1, 2.6, 7.9, 9.0])
    assert found[1] == (("answers do not follow the surfaces (z = 2.6; 2.7 is asked)",), ())
    found, _ = judged(monkeypatch, [9.0, 3.0, 9.5, 9.6, -3.0])
    assert found[1] == ((), ())
    found, _ = judged(monkeypatch, [12.0, 3.0, 11.0, 12.0, -3.0])
    assert found[1] == (("answers do not follow the surfaces (z = 3.0; 3.1 is asked)",), ())
    assert found[4] == (("answers do not follow the surfaces (z = -3.0; 3.1 is asked)",), ())


def test_where_most_are_at_chance_it_is_only_doubted(monkeypatch: pytest.MonkeyPatch) -> None:
    found, said = judged(monkeypatch, [1.0, 1.5, 8.0])
    assert said.startswith("most people are not above chance")
    doubt = "answers do not follow the surfaces (z = 1.0; 3.1 is asked)"
    assert found == [((), (doubt,)), ((), (doubt.replace("1.0", "1.5"),)), ((), ())]
    found, said = judged(monkeypatch, [1.0, 8.0])
    assert (found[0], said) == (((), (doubt,)), "")
    found, said = judged(monkeypatch, [-6.0, -7.0, -8.0])
    assert said.startswith("most people's answers are mixed up")
    assert [reasons[0][:20] for reasons, _ in found] == ["answers are mixed up"] * 3


def test_catch_trials_and_trials_not_answered_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    def catch(p_value: float) -> tuple[Any, ...]:
        return (SimpleNamespace(person="p1", right=2, asked=6, p_value=p_value),)

    found, _ = judged(monkeypatch, [8.0] * 3, catch=catch(0.009))
    assert found == [((), ()), (("2 of 6 catch trials right",), ()), ((), ())]
    found, _ = judged(monkeypatch, [8.0] * 3, catch=catch(0.01))
    assert found[1] == ((), ())
    random = np.random.default_rng(5)
    whole = answered(DESIGNS["constant"], [somebody(random)], random).main(0).trials
    few = int(0.25 * whole) + 1
    found, _ = judged(monkeypatch, [8.0] * 3, lost=few)
    assert found[0] == ((f"{whole - few} of {whole} trials answered",), ())
    found, _ = judged(monkeypatch, [8.0] * 3, lost=few - 1)
    assert found[0] == ((), ())
    found, _ = judged(monkeypatch, [0.0, 8.0, 8.0], lost=whole - 11)
    assert found[0][1] == ("11 trials are too few to tell guessing from doing the task",)
    assert found[0][0] == (f"11 of {whole} trials answered",)


def test_a_rule_is_the_designs_own_or_one_that_marks() -> None:
    strict = ExclusionRule("exclude", complete=0.5)
    design = dataclasses.replace(DESIGNS["constant"], exclusion=strict)
    assert screening.rule_of(design) is strict
    assert screening.rule_of(dataclasses.replace(design, exclusion=None)).action == "mark"


def test_catch_trials_tell_little_sense_from_guessing() -> None:
    """Who feels hardly any difference but what everybody tells does the task."""
    design = dataclasses.replace(load_design("friction-jnd"), practice=0)
    dull = Person(0.7, 0.9, 0.0)
    named = {"dull": 0, "dull, no catch": 0, "guesses": 0}
    seeds = 20
    for seed in range(seeds):
        random = np.random.default_rng(seed)
        people = [dull, *(somebody(random) for _ in range(6)), somebody(random)]
        answers = answered(design, people, random)
        guesser = answers.participant == 7
        guess = random.integers(0, 2, answers.trials)
        answers = dataclasses.replace(answers, choice=np.where(guesser, guess, answers.choice))
        judged = judged_people(answers, 0)[0]
        named["dull"] += bool(judged[0].reasons)
        named["guesses"] += bool(judged[7].reasons)
        named["dull, no catch"] += bool(judged_people(answers.main(0), 0)[0][0].reasons)
    assert named["guesses"] >= seeds - 1
    assert named["dull"] <= named["dull, no catch"] / 2


@pytest.mark.parametrize("guesses", [False, True])
def test_a_criterion_that_shifts_is_no_guess_as_a_part_that_was_guessed_is(guesses: bool) -> None:
    """Of 20 people each, who shift in the middle, or guess before it."""
    design = dataclasses.replace(load_design("period-same-different"), practice=0)
    named = 0
    for seed in range(20):
        random = np.random.default_rng([11, seed])
        answers = answered(design, [Person(0.15, 0.9, 0.0)], random)
        mine = answers.main(0)
        late = np.arange(mine.trials) >= mine.trials // 2
        if guesses:
            choice = np.where(late, mine.choice, random.integers(0, 2, mine.trials))
        else:
            apart = mine.differences * D_PRIME / math.log1p(0.15)
            apart += math.sqrt(2) * random.standard_normal(mine.trials)
            choice = (np.abs(apart) > np.where(late, 3.2, 1.0)).astype(np.int64)
        mine = dataclasses.replace(mine, choice=choice)
        named += any("follow" in said or "mixed" in said for said in _changed(mine, _models(mine)))
    # Eighty answers seldom tell a guess of same or different surely.
    assert 3 <= named <= 12 if guesses else named <= 1
