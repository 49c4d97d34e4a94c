"""Whose mode the chain goes on with, and what is objected to a beam in the place of a solid."""

from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.core.errors import InputError, OutOfTimeError
from squeezefilm.core.progress import NO_HURRY, Pace
from squeezefilm.physics.chain import touch as module
from squeezefilm.physics.chain.touch import chosen_mode
from squeezefilm.physics.display import load_display

PLATE = load_display("biet2008-plate").actuator
STATOR = load_display("biet2008-stator").actuator
BEAM = SimpleNamespace(solid=None)


def solving(
    monkeypatch: pytest.MonkeyPatch, error: Exception | None, coarseness: str = ""
) -> list[tuple[Any, ...]]:
    """A stand-in for `working_mode`: the solid fails with an error, or is left coarse."""
    asked: list[tuple[Any, ...]] = []

    def working_mode(actuator: Any, theory: str, *, pace: Pace = NO_HURRY) -> Any:
        asked.append((actuator, theory, pace))
        if theory != "solid":
            return BEAM
        if error is not None:
            raise error
        return SimpleNamespace(solid=SimpleNamespace(coarseness=coarseness))

    monkeypatch.setattr(module, "working_mode", working_mode)
    return asked


def test_the_solid_is_taken_where_it_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = solving(monkeypatch, None)
    pace = Pace(5.0)
    mode, objections = chosen_mode(PLATE, pace=pace)
    assert mode.solid is not None
    assert objections == ()
    assert asked == [(PLATE, "solid", pace)]


def test_a_coarse_one_is_objected_to(monkeypatch: pytest.MonkeyPatch) -> None:
    solving(monkeypatch, None, "it is coarse")
    assert chosen_mode(PLATE)[1] == chosen_mode(PLATE, "solid")[1] == ("it is coarse",)


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (InputError("no such mode"), "does not give the working mode (no such mode); a beam's"),
        (OutOfTimeError("it takes long"), "it takes long; the numbers are those of a beam"),
    ],
)
def test_a_beam_stands_in_with_the_reason(
    error: Exception, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    solving(monkeypatch, error)
    mode, (objection,) = chosen_mode(PLATE)
    assert mode is BEAM
    assert said in objection
    for strictly in ({"strict": True}, {"theory": "solid"}):
        with pytest.raises(type(error), match=str(error)):
            chosen_mode(PLATE, **strictly)  # type: ignore[arg-type]


def test_what_is_no_plate_has_no_beam_to_be_taken_for(monkeypatch: pytest.MonkeyPatch) -> None:
    solving(monkeypatch, InputError("no such mode"))
    with pytest.raises(InputError, match="no such mode"):
        chosen_mode(STATOR)


def test_a_theory_that_is_asked_for_is_no_fallback(monkeypatch: pytest.MonkeyPatch) -> None:
    solving(monkeypatch, InputError("no such mode"))
    assert chosen_mode(PLATE, "timoshenko") == (BEAM, ())
