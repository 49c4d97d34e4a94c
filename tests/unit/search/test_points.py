"""Points in, answers out: refusals and faults are answers; a process that dies costs one point."""

import dataclasses
import os
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.display import load_display
from squeezefilm.search.points import Answer, Point, Shares, answer_of, answered, of_one_plate
from squeezefilm.search.verbs import VERBS

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


def test_one_process_answers_in_order() -> None:
    asked = [asks({"voltage": float(k)}) for k in range(5)]
    found = list(answered(asked, answer=volts))
    assert [number for number, _ in found] == list(range(5))
    assert list(answered([], answer=volts)) == []


def test_points_of_one_plate_follow_each_other() -> None:
    wide, narrow = (
        dataclasses.replace(STATOR, actuator=dataclasses.replace(STATOR.actuator, radial_width=w))
        for w in (9e-3, 8e-3)
    )
    asked = [
        Point(one, {"voltage": v}, "predict") for v in (1.0, 2.0, 3.0) for one in (wide, narrow)
    ]
    assert of_one_plate(asked) == [[0, 2, 4], [1, 3, 5]]
    found = list(answered(asked, answer=volts))
    assert [number for number, _ in found] == [0, 2, 4, 1, 3, 5]
    assert [answer.numbers["voltage_V"] for _, answer in found] == [1.0, 2.0, 3.0] * 2


def test_a_process_keeps_to_its_plate_and_helps_where_no_plate_is_left() -> None:
    shares = Shares([[0, 1, 2, 3, 4, 5], [6, 7]])
    assert [shares.next(0), shares.next(1), shares.next(1)] == [0, 6, 7]
    # The second has done its plate: it takes the later half of what the first has left.
    assert [shares.next(1) for _ in range(3)] == [3, 4, 5]
    assert [shares.next(0), shares.next(0)] == [1, 2]
    assert [shares.next(0), shares.next(1), shares.next(2)] == [None, None, None]


def test_every_point_is_taken_once_whoever_asks() -> None:
    groups = [[0, 1, 2], [3], [4, 5, 6, 7, 8, 9, 10]]
    for turn in ([0, 1, 2], [0, 0, 1], [2, 1, 1, 0]):
        shares = Shares(groups)
        taken = []
        for _ in range(11):
            taken += [n for process in turn if (n := shares.next(process)) is not None]
        assert sorted(taken) == list(range(11)), turn


@pytest.mark.slow
def test_processes_answer_all_and_one_that_dies_costs_its_own_point() -> None:
    asked = [asks({"voltage": float(k)}) for k in range(8, 20)]
    found = dict(answered(asked, jobs=2, answer=volts))
    assert sorted(found) == list(range(12))
    for number, answer in found.items():
        if number == 5:
            assert "ended without an answer" in answer.reason
            assert not answer.lasting
        else:
            assert answer.numbers["voltage_V"] == 8 + number


@pytest.mark.slow
def test_no_process_is_left_where_the_asking_is_stopped() -> None:
    import multiprocessing

    # Other tests of the same process may have children of their own.
    before = set(multiprocessing.active_children())
    asked = [asks({"voltage": float(k)}) for k in range(6)]
    coming = answered(asked, jobs=2, answer=volts)
    next(coming)
    begun = set(multiprocessing.active_children()) - before
    assert len(begun) == 2
    coming.close()
    for process in begun:
        process.join(20)
    assert not set(multiprocessing.active_children()) & begun
