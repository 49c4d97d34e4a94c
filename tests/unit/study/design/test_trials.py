"""Orders: what balance is promised is counted."""

from __future__ import annotations

import dataclasses
from collections import Counter
from itertools import pairwise

import pytest

from squeezefilm.core import config
from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.rules import AdaptiveCondition, CatchTrial
from squeezefilm.study.design.study_design import StudyDesign, load_design
from squeezefilm.study.design.trials import (
    expected_duration,
    latin_square,
    orders,
    trial_count,
    trials,
    williams_square,
)

PAIRS = StudyDesign(
    name="pairs",
    title="",
    displays=("biet2008-plate",),
    task="same-different",
    stimuli=tuple(Stimulus(f"{mm} mm", mm * 1e-3, "period") for mm in (4, 5, 6)),
    reference="4 mm",
    practice=5,
    blocks=3,
    repetitions=2,
    catch=(CatchTrial(Stimulus("20 mm", 20e-3, "period"), "different", 4),),
)


def _neighbours(rows: tuple[tuple[int, ...], ...]) -> Counter[tuple[int, int]]:
    return Counter(pair for row in rows for pair in pairwise(row))


def _places(rows: tuple[tuple[int, ...], ...]) -> Counter[tuple[int, int]]:
    return Counter((place, one) for row in rows for place, one in enumerate(row))


@pytest.mark.parametrize("size", [1, 2, 3, 4, 5, 6, 7, 8, 11, 12])
def test_squares_are_balanced(size: int) -> None:
    for square in (williams_square(size), latin_square(size)):
        assert {tuple(sorted(row)) for row in square} == {tuple(range(size))}
        assert set(_places(square).values()) == {len(square) // size}
        assert len(_places(square)) == size * size
    square = williams_square(size)
    assert len(square) == (size if size % 2 == 0 or size == 1 else 2 * size)
    if size > 1:
        found = _neighbours(square)
        assert len(found) == size * (size - 1)
        assert set(found.values()) == {1 if size % 2 == 0 else 2}


@pytest.mark.parametrize("size", [4, 5])
@pytest.mark.parametrize("seed", [0, 1, 7])
def test_balance_holds_over_participants_and_over_repetitions(size: int, seed: int) -> None:
    rows = len(williams_square(size))
    by_participant = tuple(orders(size, 1, p, seed)[0] for p in range(rows))
    by_repetition = orders(size, rows, 3, seed)
    for found in (by_participant, by_repetition):
        assert len(set(_places(found).values())) == 1
        assert len(set(_neighbours(found).values())) == 1
        assert len(_neighbours(found)) == size * (size - 1)


def test_the_seed_changes_the_order_and_nothing_else_does() -> None:
    design = load_design("biet2008-gratings")
    assert trials(design, 2, 7) == trials(design, 2, 7)
    assert trials(design, 2, 7) != trials(design, 2, 8)
    assert trials(design, 2, 7) != trials(design, 3, 7)


def test_the_papers_study_is_balanced_per_participant() -> None:
    design = load_design("biet2008-gratings")
    for participant in range(4):
        planned = trials(design, participant, 7)
        assert [one.number for one in planned] == list(range(1, len(planned) + 1))
        for display in design.displays:
            main = [one for one in planned if one.display == display and one.phase == "main"]
            names = [one.stimuli[0] for one in main]
            assert set(Counter(names).values()) == {10}
            rows = [names[i : i + 5] for i in range(0, 50, 5)]
            found = Counter(pair for row in rows for pair in pairwise(row))
            assert set(found.values()) == {2}
            assert len(found) == 20
            assert all(sorted(one.alternatives) == sorted(design.answers) for one in main)
            felt = [one for one in planned if one.display == display and not one.asks]
            assert Counter(one.stimuli[0] for one in felt) == dict.fromkeys(design.answers, 2)
    first = Counter(trials(design, p, 7)[0].display for p in range(12))
    assert set(first.values()) == {6}
    assert trial_count(design) == 100
    # 120 trials of 20 s; a break between blocks of both displays, and one between the displays.
    assert expected_duration(design) == 120 * 20 + 3 * 120


def test_pairs_have_same_and_different_equally_often_and_the_reference_in_both_places() -> None:
    every = PAIRS.conditions
    answers = [PAIRS.answer_to(*(PAIRS.stimulus(one) for one in pair)) for pair in every]
    assert Counter(answers) == {"same": 4, "different": 4}
    planned = trials(PAIRS, 0, 1)
    assert Counter(one.phase for one in planned) == {"practice": 5, "main": 48, "catch": 4}
    main = Counter(one.stimuli for one in planned if one.phase == "main")
    # (the reference, itself) stands once for each of the two it is compared with.
    assert main == {pair: 6 * every.count(pair) for pair in set(every)}
    assert all(one.answer == "different" for one in planned if one.phase == "catch")
    assert [one.block for one in planned if one.pause] == [2, 3]
    for block in (1, 2, 3):
        assert next(one for one in planned if one.block == block).phase == "main"


def test_adaptive_series_are_interleaved_and_choose_no_stimulus_beforehand() -> None:
    design = dataclasses.replace(
        PAIRS,
        task="two-interval",
        practice=3,
        catch=(dataclasses.replace(PAIRS.catch[0], answer="first"),),
        adaptive=(
            AdaptiveCondition("easy", "staircase", count=20),
            AdaptiveCondition("hard", "staircase", count=20),
        ),
    )
    planned = trials(design, 0, 1)
    assert Counter(one.adaptive for one in planned) == {"easy": 20, "hard": 20, "": 7}
    assert Counter(one.phase for one in planned) == {"practice": 3, "main": 40, "catch": 4}
    assert {one.stimuli for one in planned if one.phase == "catch"} == {("20 mm", "4 mm")}
    for name in ("easy", "hard"):
        mine = [one for one in planned if one.adaptive == name]
        assert sum(one.reference_first for one in mine) == 10
        assert all(one.answer == ("second" if one.reference_first else "first") for one in mine)
        assert all(one.stimuli == () for one in mine)
    order = [one.adaptive for one in planned if one.adaptive]
    assert order[:20] != ["easy"] * 20


def test_half_of_a_same_different_series_presents_the_reference_twice() -> None:
    series = AdaptiveCondition("bayes", "bayesian", count=40)
    planned = trials(dataclasses.replace(PAIRS, catch=(), practice=0, adaptive=(series,)), 0, 1)
    assert Counter(one.answer for one in planned) == {"same": 20, "different": 20}
    for answer in ("same", "different"):
        assert sum(one.reference_first for one in planned if one.answer == answer) == 10
    assert [one.answer for one in planned] != [one.answer for one in trials(PAIRS, 1, 1)][:40]
    assert all(one.stimuli == () for one in planned)


def test_seeds_of_trials_differ_and_survive_a_float() -> None:
    seeds = [one.seed for p in range(12) for one in trials(PAIRS, p, 1)]
    assert len(set(seeds)) == len(seeds)
    assert all(int(float(one)) == one for one in seeds)


def test_numbers_below_zero_are_refused() -> None:
    for call in ((-1, 0), (0, -1)):
        with pytest.raises(InputError, match="must be"):
            trials(PAIRS, *call)


def test_a_design_is_written_and_read_back() -> None:
    from squeezefilm.core.config.schema import text_of

    assert config.load_text(StudyDesign, text_of(PAIRS)) == PAIRS
