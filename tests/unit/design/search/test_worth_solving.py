from __future__ import annotations

from dataclasses import replace

import numpy as np
from tests.unit.design.search.made_up import formula, random_designs, requirements

from squeezefilm.design.search.candidate import Design, Evaluated, Level
from squeezefilm.design.search.worth_solving import (
    _adding_most,
    learned,
    objectives_of,
    worth_solving,
)
from squeezefilm.design.sweep.tradeoffs import front_of

WANTED = requirements()
SCREENED = {one: formula(WANTED, one, "screened") for one in random_designs(WANTED, 300)}


def seen(solved: list[Design]) -> dict[Level, dict[Design, Evaluated]]:
    """What a search knows that has solved these."""
    return {
        "screened": SCREENED,
        "solved": {one: formula(WANTED, one, "solved") for one in solved},
    }


def test_the_screened_front_comes_first() -> None:
    """Of those that may keep the limits, a quarter beyond them included: a screening errs."""
    chosen = worth_solving(WANTED, seen([]), [None], 16)
    assert len(chosen) == len(set(chosen)) == 16
    feasible = [one for one in SCREENED.values() if one.is_feasible]
    front = {feasible[k].design for k in front_of(objectives_of(WANTED, feasible))}
    found = [SCREENED[one] for one in chosen]
    assert all(breach.excess <= 0.25 for one in found for breach in one.broken)
    assert any(breach.excess > 0.08 for one in found for breach in one.broken)
    # None of those chosen is beaten by a feasible one that was not.
    rest = [one for one in feasible if one.design not in set(chosen) and one.design not in front]
    rows = objectives_of(WANTED, found)
    for row in objectives_of(WANTED, rest):
        assert not np.any(np.all(row < rows, axis=1) & np.all(rows > 1.3 * row, axis=1))


def test_a_frequency_is_believed_more_than_what_depends_on_losses() -> None:
    """A window of five percent is not met by plates that the screening has a quarter beside it."""
    limits = replace(WANTED.limits, least_frequency=20.5e3, most_frequency=21.5e3)
    wanted = replace(WANTED, limits=limits)
    screened = {one: formula(wanted, one, "screened") for one in SCREENED}
    chosen = worth_solving(wanted, {"screened": screened, "solved": {}}, [None], 300)
    assert chosen
    found = {screened[one].numbers["resonance_frequency"] for one in chosen}
    assert found == {21e3}  # by the formula 18 and 24 kHz are the next


def test_a_corrected_frequency_is_believed_as_far_as_its_error() -> None:
    """Else plates just beyond the limit, which move more, would be solved for nothing."""
    solved = list(SCREENED)[:40]
    correction = learned(WANTED.spaces[0], SCREENED, list(seen(solved)["solved"].values()))
    assert correction is not None
    error = correction.errors["resonance_frequency"]
    assert error < 0.02
    chosen = worth_solving(WANTED, seen(solved), [correction], 300)
    expected = correction.of_all([SCREENED[design] for design in chosen])
    least = min(numbers["resonance_frequency"] for numbers in expected)
    assert 20e3 / (1 + 2 * error) <= least


def test_what_was_solved_is_not_chosen_again_and_in_the_end_nothing_is() -> None:
    solved: list[Design] = []
    for _ in range(60):
        correction = learned(WANTED.spaces[0], SCREENED, list(seen(solved)["solved"].values()))
        chosen = worth_solving(WANTED, seen(solved), [correction], 8)
        assert set(chosen).isdisjoint(solved)
        if not chosen:
            break
        solved += chosen
    assert not chosen
    assert len(solved) < len(SCREENED)
    # What was left unsolved beats nothing of the front that was found.
    front = [one for one in seen(solved)["solved"].values() if one.is_feasible]
    best = objectives_of(WANTED, front)
    left = [formula(WANTED, one, "solved") for one in SCREENED if one not in set(solved)]
    rows = objectives_of(WANTED, [one for one in left if one.is_feasible])
    better = [not np.any(np.all(best <= row * 1.001, axis=1)) for row in rows]
    assert sum(better) <= 0.02 * len(better)


def test_what_adds_most_beside_what_is_known_is_chosen_first() -> None:
    known = np.array([[0.5, 0.5]])
    # Behind the known one; a little before it; far along; a twin of that, which adds nothing more.
    rows = np.array([[0.6, 0.6], [0.48, 0.5], [0.1, 0.7], [0.1, 0.7]])
    plates, worst = np.arange(4), np.array([1.0, 1.0])
    assert _adding_most(rows, known, worst, 4, plates).tolist() == [2, 1]
    assert _adding_most(rows[:1], known, worst, 4, plates[:1]).size == 0
    assert _adding_most(rows[:0], known, worst, 4, plates[:0]).size == 0
    # Of one plate whatever it does at any voltage counts, and it is chosen once.
    assert _adding_most(rows, known, worst, 4, np.array([0, 1, 1, 0])).tolist() == [2]


def test_what_cannot_be_built_is_never_chosen() -> None:
    broken = {one: replace(SCREENED[one], reason="does not fit") for one in list(SCREENED)[:50]}
    known: dict[Level, dict[Design, Evaluated]] = {"screened": broken, "solved": {}}
    assert worth_solving(WANTED, known, [None], 5) == []
