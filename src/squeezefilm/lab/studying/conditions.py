"""The conditions of a sitting as an experimenter types them."""

from __future__ import annotations

import dataclasses
import hashlib
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.study.conduct.sessions import SessionConditions


def conditions_of(
    given: dict[str, Any], consent_text: str, *, consented: bool
) -> SessionConditions:
    """The conditions from a form's fields: numbers in SI, or texts with their units.

    Raises `InputError` for a field that there is not, and for a value outside its range, in the
    unit that was typed.
    """
    known = {one.name for one in dataclasses.fields(SessionConditions)}
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
