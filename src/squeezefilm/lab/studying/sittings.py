"""Data that a sitting needs beside its study's file: conditions as they are typed, surfaces that
somebody puts before a participant by hand, and what the experimenter's page is told.

A sitting without a device waits before each surface until it is said to be in place, on the
experimenter's page or the participant's. Only then the trial counts as presented and the question
comes, so that no response time includes the swap.
"""

from __future__ import annotations

import dataclasses
import hashlib
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import values_of
from squeezefilm.study.conduct.sessions import SessionConditions
from squeezefilm.study.design.study_design import StudyDesign


class SurfacesByHand:
    """The surfaces of the trials that are presented by hand now, by their sittings."""

    def __init__(self) -> None:
        self._names: dict[str, tuple[str, ...]] = {}
        self._waits: dict[str, tuple[str, int]] = {}

    def comes_next(self, sitting: str, names: tuple[str, ...]) -> None:
        """The surfaces of a sitting's next trial, in their order; none is waited for yet."""
        self._names[sitting] = names
        self._waits.pop(sitting, None)

    def wait(self, sitting: str, token: str, place: int) -> None:
        """Surface number `place` (from 0) of the trial with this token is waited for.

        Raises `InputError` for a place that the trial has not.
        """
        count = len(self._names.get(sitting, ()))
        if not 0 <= place < count:
            raise InputError(f"the trial has {count} surfaces; asked: {place}")
        self._waits[sitting] = token, place

    def in_place(self, sitting: str) -> tuple[str, int]:
        """The token and place of the surface that was waited for, and is in place now.

        Raises `InputError` where none is waited for.
        """
        if sitting not in self._waits:
            raise InputError(
                "no surface is waited for at this sitting; it is once the participant's page asks "
                "for it"
            )
        return self._waits.pop(sitting)

    def over(self, sitting: str) -> None:
        """The trial was answered, or the sitting ended."""
        self._names.pop(sitting, None)
        self._waits.pop(sitting, None)

    def status(self, sitting: str) -> dict[str, Any]:
        """Message for the experimenter: the surfaces, and the place of the one waited for."""
        _, waited = self._waits.get(sitting, ("", None))
        return {"by_hand": list(self._names.get(sitting, ())), "waits_for": waited}


def conditions_of(
    given: dict[str, Any], consent_text: str, *, consented: bool
) -> SessionConditions:
    """The conditions from a form's fields: numbers in SI, or texts with their units.

    Raises `InputError` for a field that there is not, and for a value outside its range, in the
    unit that was typed.
    """
    known = {field.name for field in dataclasses.fields(SessionConditions)}
    odd = set(given) - (known - {"consent", "consent_form"})
    if odd:
        raise InputError(f"conditions have no field '{sorted(odd)[0][:60]}'")
    hints = si.hints_of(SessionConditions)
    values = {name: _si(name, value, hints[name]) for name, value in given.items()}
    form = "text sha256 " + hashlib.sha256(consent_text.encode()).hexdigest()[:16]
    return SessionConditions(consent=consented, consent_form=form, **values)


def _si(name: str, value: Any, hint: Any) -> Any:
    unit = si.unit_of(hint)
    if unit is None or not isinstance(value, str):
        return value
    si.require_typed(name, value, hint)
    return si.parse_quantity(value, unit)


def described(design: StudyDesign) -> dict[str, Any]:
    """A design, as the page lists it."""
    return {
        **values_of(design, "title task displays answers note"),
        "stimuli": [stimulus.name for stimulus in design.stimuli],
        "question": design.spoken_question,
        "design": design.name,
    }
