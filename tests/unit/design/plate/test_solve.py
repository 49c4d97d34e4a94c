"""Which solver a plate, a disc or a stator goes to, with which arguments."""

from __future__ import annotations

from typing import Any

import pytest

from squeezefilm.core.progress import Pace
from squeezefilm.design.plate import command as solve
from squeezefilm.design.plate.command import solve_plate
from squeezefilm.physics.display import load_display

# The solvers themselves take seconds and have tests of their own.
DEFAULTS = {"mode": None, "band": None, "points": 200, "progress": None}


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, str, dict[str, Any]]]:
    calls: list[tuple[str, str, dict[str, Any]]] = []

    def of_rectangle(request: Any, plate: Any, doubts: Any) -> str:
        assert (plate, doubts) == (request.display.actuator, ())
        arguments = dict(vars(request))
        calls.append(("a rectangle", arguments.pop("display").name, arguments))
        return "solved as a rectangle"

    def analyze_ring(display: Any, **arguments: Any) -> str:
        calls.append(("analyze_ring", display.name, arguments))
        return "solved by analyze_ring"

    monkeypatch.setattr(solve, "_of_rectangle", of_rectangle)
    monkeypatch.setattr(solve, "analyze_ring", analyze_ring)
    return calls


def test_a_rectangle_is_solved_with_all_that_is_asked(asked: list[Any]) -> None:
    assert solve_plate("biet2008-plate") == "solved as a rectangle"
    given: dict[str, Any] = {
        "mode": (7, 0), "band": (30e3, 40e3), "points": 50,
        "progress": print, "budget": 60.0,
    }  # fmt: skip
    solve_plate(load_display("biet2008-plate"), **given)
    assert asked == [
        ("a rectangle", "biet2008-plate", {**DEFAULTS, "budget": None}),
        ("a rectangle", "biet2008-plate", given),
    ]


@pytest.mark.parametrize("name", ["biet2008-stator", "winfield2007-tpad"])
def test_discs_and_stators_are_solved_as_rings(asked: list[Any], name: str) -> None:
    assert solve_plate(name) == "solved by analyze_ring"
    given: dict[str, Any] = {
        "mode": (0, 1), "band": (30e3, 40e3), "points": 50, "progress": print,
    }  # fmt: skip
    solve_plate(name, **given, budget=60.0)
    assert asked == [
        ("analyze_ring", name, {**DEFAULTS, "pace": Pace()}),
        ("analyze_ring", name, {**given, "pace": Pace(60.0)}),
    ]
