"""Catch trials and adaptive series: what they take, what they refuse, and in which words."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.rules import (
    AdaptiveCondition,
    CatchTrial,
    require_different,
    require_name,
)

PLAIN = Stimulus("plain", 4e-3, "period")


def refusal(call: Callable[[], object], quantity: str) -> str:
    with pytest.raises(InputError) as caught:
        call()
    assert caught.value.quantity == quantity
    return str(caught.value)


@pytest.mark.parametrize("name", ["a", "7", "A.b_c-9", "x" * 80])
def test_names_that_go_into_file_names_are_taken(name: str) -> None:
    require_name(name)


@pytest.mark.parametrize(
    "name", ["", ".a", "-a", "_a", "a b", "a/b", "é", "aé", "a\n", "x" * 81]
)  # fmt: skip
def test_other_names_are_refused(name: str) -> None:
    assert refusal(lambda: require_name(name), "name") == (
        f"name = {name!r} cannot be used: it goes into file names; write up to 80 of the letters "
        "A-Z a-z, digits, dot, dash and underscore, beginning with a letter or digit"
    )


def test_names_are_different() -> None:
    require_different("stimuli", ["a", "b", "A"])
    require_different("stimuli", [])
    twice = refusal(lambda: require_different("stimuli", ["b", "a", "b", "a", "c"]), "stimuli")
    assert twice == "stimuli have a name twice (a, b); name each differently"


def test_a_catch_trial_comes_up_to_a_thousand_times() -> None:
    assert CatchTrial(PLAIN, "4 mm").count == 1
    assert CatchTrial(PLAIN, "4 mm", 1000).count == 1000
    for bad in (0, 1001, 3.0, True, "3", None):
        says = refusal(lambda bad=bad: CatchTrial(PLAIN, "4 mm", bad), "count")  # type: ignore[misc]
        assert says.startswith(f"count = {bad!r} cannot be used")
        assert says.endswith("a whole number at least 1 and at most 1000")


def test_a_series_has_its_defaults() -> None:
    found = AdaptiveCondition("stairs", "staircase")
    assert (found.varied, found.down, found.count) == ("spatial_period", 2, 60)
    assert (found.start, found.lowest, found.highest, found.step) == (0.4, 0.005, 0.9, 0.1)


@pytest.mark.parametrize(
    "changes",
    [
        {"start": 0.005},
        {"start": 0.9},
        {"highest": 100.0},
        {"highest": 0.41, "step": 0.41},
        {"lowest": 1e-9},
        {"down": 1},
        {"down": 10},
        {"count": 1},
        {"count": 10_000},
        {"method": "bayesian"},
    ],
)
def test_a_series_reaches_to_its_bounds(changes: dict[str, Any]) -> None:
    made = AdaptiveCondition(**{"name": "s", "method": "staircase", **changes})
    for name, value in changes.items():
        assert getattr(made, name) == value


@pytest.mark.parametrize(
    ("changes", "quantity", "says"),
    [
        ({"name": "a b"}, "name", "it goes into file names"),
        ({"method": "ladder"}, "method", "staircase, bayesian"),
        ({"lowest": 0.0}, "lowest", "above 0"),
        ({"highest": 0.005}, "highest", "above 0.005, which is lowest"),
        ({"highest": 100.1}, "highest", "at most 100"),
        ({"start": 0.0049}, "start", "at least 0.005 and at most 0.9"),
        ({"start": 0.91}, "start", "at least 0.005 and at most 0.9"),
        ({"step": 0.0}, "step", "above 0 and at most 0.9"),
        ({"step": 0.91}, "step", "above 0 and at most 0.9"),
        ({"down": 0}, "down", "at least 1 and at most 10"),
        ({"down": 11}, "down", "at least 1 and at most 10"),
        ({"count": 0}, "count", "at least 1 and at most 10000"),
        ({"count": 10_001}, "count", "at least 1 and at most 10000"),
    ],
)
def test_a_series_beyond_its_bounds_is_refused(
    changes: dict[str, Any], quantity: str, says: str
) -> None:
    arguments: dict[str, Any] = {"name": "s", "method": "staircase", **changes}
    assert says in refusal(lambda: AdaptiveCondition(**arguments), quantity)
