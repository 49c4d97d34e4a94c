"""Limits of one value of a display while the others stay: read from its type, or tried.

A field's own bounds stand in its annotation. Some limits depend on other values (a patch ends where
its plate does): where the display does not fit at a bound, building it anew finds what it accepts.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.config.schema import leaves
from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.core.hard_limits import HardLimit
from squeezefilm.lab.designing.form import choices, display_of, stated
from squeezefilm.physics.display import Display

_FAR = 1e9
"""Times the value up to which a limit is looked for."""
_STEPS = 80
_NOTHING = 2e-5


def allowed(text: str, path: str) -> str:
    """Values allowed at a dotted path, in words with units; "" for what is no number.

    The range is the one around the value that is there, with the others as they are.
    Raises `ConfigError` for a text that is no display, `InputError` for a path that is not there.
    """
    display = display_of(text)
    described = next(
        (leaf for leaf in leaves(display) if ".".join(map(str, leaf[0])) == path),
        None,
    )
    if described is None:
        raise InputError(f"the display has no value at '{path[:200]}'; open it again")
    place, value, annotation, _ = described
    unit = si.unit_of(stated(annotation))
    whole = isinstance(value, int) and not isinstance(value, bool)
    if (unit is None and not whole) or choices(stated(annotation)):
        return ""

    def fits(candidate: float) -> bool:
        try:
            _with(display, place, round(candidate) if whole else candidate)
        except (SqueezefilmError, ValueError, ArithmeticError):
            return False
        return True

    least, most = _stated_ends(annotation)
    size = max(abs(value), 1.0) if whole else abs(value) or _size_of(display, place)
    below = _stated_end(fits, value, least) or _limit(fits, value, -size, whole=whole)
    above = _stated_end(fits, value, most) or _limit(fits, value, size, whole=whole)
    return _words(below, above, unit)


_End = tuple[float, bool]  # the last value, and whether it fits itself


def _stated_ends(annotation: Any) -> tuple[_End | None, _End | None]:
    """The least and the most that an annotation allows."""
    bounds, limits = si.bounds_of(annotation)
    hard = [limit for limit in limits if isinstance(limit, HardLimit)]
    low = [(bounds[name], name == "at_least") for name in ("above", "at_least") if name in bounds]
    high = [(bounds[name], name == "at_most") for name in ("below", "at_most") if name in bounds]
    low += [(limit.least, True) for limit in hard]
    high += [(limit.most, True) for limit in hard]
    # Of two alike the open one is the narrower.
    return (
        max(low, default=None, key=lambda end: (end[0], not end[1])),
        min(high, default=None),
    )


def _stated_end(fits: Callable[[float], bool], value: float, end: _End | None) -> _End | None:
    """The end that the type states, if the display fits there, or just before an open one."""
    if end is None:
        return None
    number, itself = end
    return end if fits(number if itself else number + 1e-9 * (value - number)) else None


def _with(node: Any, place: tuple[str | int, ...], value: float) -> Any:
    """The same part with one value changed; it refuses as it does when it is loaded."""
    head, *rest = place
    old = node[head] if isinstance(head, int) else getattr(node, head)
    new = _with(old, tuple(rest), value) if rest else value
    if isinstance(head, int):
        return (*node[:head], new, *node[head + 1 :])
    return dataclasses.replace(node, **{head: new})


def _size_of(display: Display, place: tuple[str | int, ...]) -> float:
    """A step from a value that is zero: a thousandth of the greatest of its kind beside it."""
    owner: Any = display
    for part in place[:-1]:
        owner = owner[part] if isinstance(part, int) else getattr(owner, part)
    beside = [
        abs(value)
        for value in (getattr(owner, field.name) for field in dataclasses.fields(owner))
        if isinstance(value, float) and value
    ]
    return 1e-3 * max(beside, default=1.0)


def _limit(fits: Callable[[float], bool], value: float, step: float, *, whole: bool) -> _End | None:
    """The last value that fits in one direction, and whether it fits itself; None if far away."""
    zero = value and (value > 0) != (step > 0)
    if zero and not fits(0.0):
        good, bad = value, 0.0
    else:
        good, distance = (0.0 if zero else value), abs(step)
        sign = 1.0 if step > 0 else -1.0
        while fits(bad := good + sign * distance):
            good, distance = bad, 2 * distance
            if distance > _FAR * abs(step):
                return None
    for _ in range(_STEPS):
        middle = round(0.5 * (good + bad)) if whole else 0.5 * (good + bad)
        if middle in (good, bad):
            break
        good, bad = (middle, bad) if fits(middle) else (good, middle)
    if whole:
        return good, True
    # Parts that must fit into each other may do so with a nanometre between them.
    if abs(bad) < _NOTHING * abs(step):
        return 0.0, fits(0.0)
    # The number somebody wrote is the round one between the last that fits and the first that
    # does not.
    round_one = float(f"{bad:.6g}")
    if abs(round_one - bad) > 1e-9 * abs(value or step):
        # No round one: six digits of the last that fits, on its side.
        digit = 10.0 ** (math.floor(math.log10(abs(good))) - 5)
        to = math.floor if step > 0 else math.ceil
        return float(f"{to(good / digit) * digit:.6g}"), True
    return round_one, fits(round_one)


def _words(below: _End | None, above: _End | None, unit: si.Unit | None) -> str:
    def text(number: float) -> str:
        if unit is None or unit.symbol == "1":
            return f"{number:.6g}"
        return si.format_quantity(number, unit, digits=6)

    if below is None and above is None:
        return "any number"
    if below == above and below is not None:
        return f"only {text(below[0])}"
    parts = []
    if below is not None:
        parts.append(f"{'from' if below[1] else 'above'} {text(below[0])}")
    if above is not None:
        parts.append(f"{'up to' if above[1] else 'below'} {text(above[0])}")
    return " ".join(parts)
