"""Refusing a quantity's text in the unit that somebody typed: degC, deg or %, where K, rad or a
number would be another person's words."""

from __future__ import annotations

import re
from typing import Any

from squeezefilm.core.errors import InputError
from squeezefilm.core.quantities.bounds import bounds_of
from squeezefilm.core.quantities.require import HOLDS
from squeezefilm.core.quantities.units import parse_quantity, unit_of

__all__ = ["require_typed"]

_TYPED = re.compile(r"\s*(?P<number>[-+\d.eE]+)\s*(?P<unit>\S.*?)\s*")


def require_typed(name: str, text: str, hint: Any) -> None:
    """Refuse a quantity text that is not within the bounds of an annotation, in the text's unit.

    Nothing is refused where that is the annotation's own unit or a multiple of it with a prefix,
    which `require` says as well. Raises `InputError` that names the quantity, what was typed and
    the bounds, and `QuantityError` for a text that is no such quantity.
    """
    unit, (bounds, _) = unit_of(hint), bounds_of(hint)
    match = _TYPED.fullmatch(text)
    if unit is None or match is None or match["unit"].endswith(unit.symbol):
        return
    value, symbol = parse_quantity(text, unit), match["unit"]
    if all(HOLDS[word](value, bound) for word, bound in bounds.items()):
        return
    # A unit may have a zero of its own, as degC has.
    place = parse_quantity(f"100 {symbol}", unit)
    step = (parse_quantity(f"200 {symbol}", unit) - place) / 100
    wanted = " and ".join(
        f"{word.replace('_', ' ')} {100 + (bound - place) / step:.4g} {symbol}"
        for word, bound in bounds.items()
    )
    raise InputError(f"{name} = {text} cannot be used: it must be {wanted}", quantity=name)
