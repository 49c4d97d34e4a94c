"""Points in, answers out: refusals and faults are answers, and so is that a process died."""

from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.design.sweep.answers import VERBS
from squeezefilm.design.sweep.points import Point, answer_of
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
