"""Two amplitudes with a wanted friction between them, of frictions that are a formula."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.design.analysis.wanted import _LEAST, _STEP, _bracket
from squeezefilm.physics.contact.sharing.levitation import HIGHEST_AMPLITUDE


def friction(half: float, closed: float = math.inf) -> Callable[[float], float]:
    """Half at an amplitude, less above; refused from another on, where the gap closes."""

    def at(amplitude: float) -> float:
        if amplitude >= closed:
            raise OutOfRangeError("the gap closes")
        return 1.0 / (1.0 + amplitude / half)

    return at


@pytest.mark.parametrize("first", [0.1e-6, 0.9e-6, 1e-6, 1.1e-6, 20e-6])
def test_what_is_wanted_lies_between_two_that_are_a_step_apart(first: float) -> None:
    low, high = _bracket(friction(1e-6), 0.5, first)
    assert low <= 1e-6 <= high
    assert high / low == pytest.approx(_STEP)


def test_nothing_below_what_can_be_looked_at_is_looked_for() -> None:
    """It is reached by the least amplitude already: it lies between nothing and that."""
    low, high = _bracket(friction(1e-9), 0.5, 1e-6)
    assert low == 0.0
    assert _LEAST / _STEP < high <= _LEAST


def test_what_no_amplitude_reaches_ends_at_the_highest() -> None:
    low, high = _bracket(friction(1.0), 0.5, 1e-6)
    assert (low, high) == (HIGHEST_AMPLITUDE, math.inf)


@pytest.mark.parametrize("first", [1e-6, 5e-6, 40e-6])
def test_where_the_gap_closes_before_it_is_never_reached(first: float) -> None:
    """It is looked for in ever smaller steps up to there."""
    low, high = _bracket(friction(10e-6, closed=4e-6), 0.5, first)
    assert high == math.inf
    assert 4e-6 / 1.05 < low < 4e-6


def test_what_lies_just_below_where_the_gap_closes_is_found() -> None:
    low, high = _bracket(friction(3.6e-6, closed=4e-6), 0.5, 1e-6)
    assert low <= 3.6e-6 <= high < 4e-6


def test_a_gap_that_is_closed_at_any_amplitude_is_refused() -> None:
    with pytest.raises(OutOfRangeError, match="the gap closes"):
        _bracket(friction(1e-6, closed=1e-8), 0.5, 1e-6)
