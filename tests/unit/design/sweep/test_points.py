"""Points in, answers out: refusals and faults are answers, and so is that a process died."""

import dataclasses
import os
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.design.sweep.answers import VERBS
from squeezefilm.design.sweep.points import Answer, Point, answer_of, answered
from squeezefilm.design.sweep.tasks import ThisProcess
from squeezefilm.design.sweep.workers import Processes
from squeezefilm.physics.display import load_display

STATOR = load_display("biet2008-stator")


def asks(options: dict[str, Any], verb: str = "predict") -> Point:
    return Point(STATOR, options, verb)


def test_an_answer_is_what_the_verb_says() -> None:
    found = answer_of(asks({"voltage": 100.0}))
    assert found.numbers["voltage_V"] == 100.0
    assert 0 < found.numbers["relative_friction"] < 1
    assert found.reason == ""
    assert found.lasting
    assert found.modes is None
    assert found.seconds > 0


def test_a_refusal_is_an_answer_that_lasts_and_a_fault_one_that_does_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert "change no friction" not in answer_of(asks({"voltage": 0.0})).reason
    refused = answer_of(asks({"surface": "none"}))
    assert "no surface 'none'" in refused.reason
    assert (dict(refused.numbers), refused.lasting) == ({}, True)

    def fails(*_: Any, **__: Any) -> None:
        raise ZeroDivisionError("by zero")

    broken = SimpleNamespace(display=lambda display, _: display, settings=dict, answer=fails)
    monkeypatch.setitem(VERBS, "predict", broken)
    failed = answer_of(asks({}))
    assert failed.reason == "not foreseen: ZeroDivisionError: by zero"
    assert not failed.lasting


def volts(point: Point) -> Answer:
    """Answers without physics, and dies of 13 V."""
    if point.options["voltage"] == 13:
        os._exit(1)
    return Answer({"voltage_V": point.options["voltage"]})


def test_points_of_one_plate_follow_each_other() -> None:
    wide, narrow = (
        dataclasses.replace(STATOR, actuator=dataclasses.replace(STATOR.actuator, radial_width=w))
        for w in (9e-3, 8e-3)
    )
    asked = [
        Point(one, {"voltage": v}, "predict") for v in (1.0, 2.0, 3.0) for one in (wide, narrow)
    ]
    found = list(answered(asked, ThisProcess(), answer=volts))
    assert [number for number, _ in found] == [0, 2, 4, 1, 3, 5]
    assert [answer.numbers["voltage_V"] for _, answer in found] == [1.0, 2.0, 3.0] * 2
    assert list(answered([], ThisProcess(), answer=volts)) == []


@pytest.mark.slow
def test_a_point_that_processes_die_of_is_an_answer_that_does_not_last() -> None:
    asked = [asks({"voltage": float(k)}) for k in range(8, 20)]
    with Processes(2) as pool:
        found = dict(answered(asked, pool, answer=volts))
    assert sorted(found) == list(range(12))
    for number, answer in found.items():
        if number == 5:
            assert "ended without an answer" in answer.reason
            assert not answer.lasting
        else:
            assert answer.numbers["voltage_V"] == 8 + number
