"""`implausibilities`: what of a display cannot be right, and what is doubtful, before any solve."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.config.lines import locate
from squeezefilm.core.errors import ConfigError
from squeezefilm.physics.display import Display
from squeezefilm.physics.plausibility.bounds import Bound, bounds, shown
from squeezefilm.physics.plausibility.ratios import Path, Ratio, ratios

# Slips that people make: milli and kilo, micro and mega, a digit or millimetres for centimetres,
# metres for centimetres, nano and giga; in the order in which they are offered.
_SLIPS = (1e3, 1e-3, 1e6, 1e-6, 10.0, 0.1, 1e-2, 1e2, 1e9, 1e-9)

_CHECKED: ContextVar[bool] = ContextVar("checked_before", default=False)


@dataclass(frozen=True)
class Implausible:
    """A value of a description that is not usual: its dotted `key`, and what is said of it.

    `refused` where it cannot be right; else it is computed with a warning.
    """

    key: str
    path: Path
    text: str
    refused: bool

    @property
    def sentence(self) -> str:
        """The key and what is said of it."""
        return f"{self.key}: {self.text}"


@si.checked_numbers
def implausibilities(display: Display, voltage: si.Volt | None = None) -> tuple[Implausible, ...]:
    """Every value of a display, driven with a voltage (V, zero-to-peak; None: its own), that is
    not usual, those that cannot be right first.

    What is usual stands in ``usual.toml`` with its reasons. Only closed forms are computed, in a
    few milliseconds. One key is told of once, and where single values cannot be right their ratios,
    which follow from them, are not told.
    """
    known = bounds()
    single = [
        Ratio(of, path, value)
        for owner, path, value in described_numbers(display)
        if (of := f"{owner}.{path[-1]}") in known
    ]
    found = _outside(display, single)
    if not any(one.refused for one in found.values()):
        for key, one in _outside(display, ratios(display, voltage)).items():
            if key not in found or (one.refused and not found[key].refused):
                found[key] = one
    return tuple(sorted(found.values(), key=lambda one: not one.refused))


def _outside(display: Display, values: Iterable[Ratio]) -> dict[str, Implausible]:
    """Of these values what is not usual, by key."""
    found: dict[str, Implausible] = {}
    for value in values:
        bound = bounds()[value.of]
        if bound.is_usual(value.value):
            continue
        one = _said(display, bound, value)
        if one.key not in found or (one.refused and not found[one.key].refused):
            found[one.key] = one
    return found


@contextmanager
def checked_before() -> Iterator[None]:
    """While displays are computed that differ by tolerances from one that was checked: none of
    them is checked again, which would take a quarter of their time."""
    before = _CHECKED.set(True)
    try:
        yield
    finally:
        _CHECKED.reset(before)


@si.checked_numbers
def require_plausible(
    display: Display, voltage: si.Volt | None = None, *, text: str = "", file: str | None = None
) -> tuple[str, ...]:
    """Refuse a display with values that cannot be right; what is only doubtful, as sentences.

    `text` is the TOML that the display was read from and `file` its name, for the lines in
    messages. Raises `ConfigError` with each key, its value, what is usual and what may be meant.
    """
    if _CHECKED.get():
        return ()
    found = implausibilities(display, voltage)
    wrong = [one for one in found if one.refused]
    if len(wrong) == 1:
        line = locate(text, wrong[0].path) if text else None
        raise ConfigError(wrong[0].text, file=file, line=line, key=wrong[0].key)
    if wrong:
        lines = [f"  {one.sentence}{_line(text, one)}" for one in wrong]
        raise ConfigError(f"{len(wrong)} values cannot be right:\n" + "\n".join(lines), file=file)
    return tuple(one.sentence for one in found)


def _line(text: str, one: Implausible) -> str:
    line = locate(text, one.path) if text else None
    return "" if line is None else f" (line {line})"


def described_numbers(owner: Any, path: Path = ()) -> Iterator[tuple[str, Path, float]]:
    """Every number of a description or a part of one, with the class that holds it and its path."""
    if isinstance(owner, tuple):
        for number, item in enumerate(owner):
            yield from described_numbers(item, (*path, number))
        return
    if not dataclasses.is_dataclass(owner):
        return
    for field in dataclasses.fields(owner):
        value = getattr(owner, field.name)
        if isinstance(value, float | int) and not isinstance(value, bool):
            yield type(owner).__name__, (*path, field.name), float(value)
        else:
            yield from described_numbers(value, (*path, field.name))


def _said(display: Display, bound: Bound, value: Ratio) -> Implausible:
    path = value.path
    key = ".".join(str(part + 1) if isinstance(part, int) else part for part in path)
    told = shown(value.value if value.told is None else value.told, bound.unit)
    own = bound.of.rpartition(".")[2] == path[-1]
    refused = not bound.is_possible(value.value)
    verb = "cannot be right" if refused else "is doubtful"
    said = f"{told} {verb}" if own else f"the {bound.of} is {told}, which {verb}"
    said += f": usual is {bound.usual_text} ({bound.reason})."
    meant = _meant(bound, value.value) if own else _meant_of_part(display, path)
    if meant:
        said += f" Did you mean {meant}?"
    elif refused:
        said += " Mend what is wrong."
    return Implausible(key, path, said, refused)


def _meant(bound: Bound, value: float) -> str:
    """The value in another unit that would be usual, in words; empty where there is none."""
    for factor in _SLIPS:
        if bound.is_usual(value * factor) and value != 0:
            # As a decimal: 70 MPa a thousandfold is 70 GPa and no 69.99999.
            return si.format_quantity(float(f"{value * factor:.12g}"), bound.unit)
    return ""


def _meant_of_part(display: Display, path: Path) -> str:
    """What the value behind a ratio may mean, where it is not usual by itself."""
    owner: Any = display
    for part in path[:-1]:
        owner = owner[part] if isinstance(part, int) else getattr(owner, part)
    bound = bounds().get(f"{type(owner).__name__}.{path[-1]}")
    value = getattr(owner, str(path[-1]), None)
    if bound is None or not isinstance(value, float) or bound.is_usual(value):
        return ""
    return _meant(bound, value)
