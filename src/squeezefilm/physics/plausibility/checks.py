"""`implausibilities`: what of a display cannot be right, and what is doubtful, before any solve.

The ranges that are usual and possible are those of `usual.toml`.
"""

from __future__ import annotations

import dataclasses
import functools
import pathlib
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from math import inf
from types import MappingProxyType
from typing import Any

from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.config.syntax import locate
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.kit.numbers import dotted, printable
from squeezefilm.core.progress import about
from squeezefilm.core.regular_file import read_toml_text
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.forecast import SolveSize, solve_size
from squeezefilm.physics.plausibility.expected import Expectation, Path, Ratio, expectation, ratios

Range = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Bound:
    """The `usual` and the `possible` range of one value or ratio `of` (SI, in `unit`).

    `reason` is what people are told is usual. With `or_none` a value of 0 says that there is none;
    with `size` the sign does not count.
    """

    of: str
    unit: si.Unit
    usual: Range
    possible: Range
    reason: str
    or_none: bool = False
    size: bool = False

    def is_usual(self, value: float) -> bool:
        """True where a value (SI) is one that is built."""
        return self._within(self.usual, value)

    def is_possible(self, value: float) -> bool:
        """True where a value (SI) may be right at all."""
        return self._within(self.possible, value)

    @property
    def usual_text(self) -> str:
        """The usual range in words: ``"900 kg/m³ to 20 000 kg/m³"``."""
        low, high = (shown(end, self.unit) for end in self.usual)
        if self.usual[1] == inf:
            return f"{low} or more"
        return f"{high} or less" if self.usual[0] in (0, -inf) else f"{low} to {high}"

    def _within(self, span: Range, value: float) -> bool:
        if self.or_none and value == 0:
            return True
        size = abs(value) if self.size else value
        # A rounding of units is no slip.
        slack = 1e-9 * abs(size)
        return span[0] - slack <= size <= span[1] + slack


# Units that people do not think in, and what they do, with the scale.
_READ_AS = {"W/kg": (1e-3, "W/g"), "V/m": (1e-6, "kV/mm")}


def shown(value: float, unit: si.Unit) -> str:
    """A value (SI) for people: ``"20 000 kg/m³"``, ``"30 µm"``, ``"0.4 W/g"``."""
    if unit.symbol in _READ_AS:
        scale, name = _READ_AS[unit.symbol]
        return f"{_plain(value * scale)} {name}"
    text = si.format_quantity(value, unit, 3)
    if "e" in text.partition(" ")[0]:
        text = " ".join([_plain(value), *([unit.symbol] if unit.symbol != "1" else [])])
    return printable(text)


def _plain(value: float) -> str:
    """Three digits, with no power of ten where a few zeros will do."""
    if 1e3 <= abs(value) < 1e7:
        return f"{float(f'{value:.3g}'):,.0f}".replace(",", " ")
    return f"{value:.3g}"


@functools.cache
def bounds() -> Mapping[str, Bound]:
    """Every bound of `usual.toml` by what it is of."""
    text = pathlib.Path(__file__).with_name("usual.toml").read_text(encoding="utf-8")
    return MappingProxyType({of: _bound(of, row) for of, row in tomllib.loads(text).items()})


def _bound(of: str, row: dict[str, str | bool]) -> Bound:
    unit = si.Unit(str(row["unit"]))
    return Bound(
        of,
        unit,
        _range(str(row["usual"]), unit),
        _range(str(row["possible"]), unit),
        str(row["reason"]),
        bool(row.get("or_none", False)),
        bool(row.get("size", False)),
    )


def _range(text: str, unit: si.Unit) -> Range:
    """Range of ``"1 mm to 2 mm"``, ``"from 1 mm"``, ``"up to 2 mm"`` or ``"any"``."""
    if text == "any":
        return -inf, inf
    if text.startswith("from "):
        return si.parse_quantity(text.removeprefix("from "), unit), inf
    if text.startswith("up to "):
        return 0.0, si.parse_quantity(text.removeprefix("up to "), unit)
    low, high = text.split(" to ")
    return si.parse_quantity(low, unit), si.parse_quantity(high, unit)


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
    doubts = _outside(display, single)
    if not any(doubt.refused for doubt in doubts.values()):
        for key, doubt in _outside(display, ratios(display, voltage)).items():
            if key not in doubts or (doubt.refused and not doubts[key].refused):
                doubts[key] = doubt
    return tuple(sorted(doubts.values(), key=lambda doubt: not doubt.refused))


def _outside(display: Display, values: Iterable[Ratio]) -> dict[str, Implausible]:
    """Values that are not usual, by key."""
    doubts: dict[str, Implausible] = {}
    for value in values:
        bound = bounds()[value.of]
        if bound.is_usual(value.value):
            continue
        doubt = _said(display, bound, value)
        if doubt.key not in doubts or (doubt.refused and not doubts[doubt.key].refused):
            doubts[doubt.key] = doubt
    return doubts


@contextmanager
def checked_before() -> Iterator[None]:
    """Skip the check of displays that differ by tolerances from one that was checked: none of them
    is checked again, which would take a quarter of their time."""
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
    doubts = implausibilities(display, voltage)
    wrong = [doubt for doubt in doubts if doubt.refused]
    lines = [locate(text, doubt.path) if text else None for doubt in wrong]
    if len(wrong) == 1:
        raise ConfigError(wrong[0].text, file=file, line=lines[0], key=wrong[0].key)
    if wrong:
        said = [
            f"  {doubt.sentence}" + ("" if line is None else f" (line {line})")
            for doubt, line in zip(wrong, lines, strict=True)
        ]
        raise ConfigError(f"{len(wrong)} values cannot be right:\n" + "\n".join(said), file=file)
    return tuple(doubt.sentence for doubt in doubts)


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
    return Implausible(dotted(path), path, said, refused)


def _meant(bound: Bound, value: float) -> str:
    """The value in another unit that would be usual, in words; empty where there is none."""
    for factor in _SLIPS:
        if bound.is_usual(value * factor) and value != 0:
            # As a decimal: 70 MPa a thousandfold is 70 GPa and no 69.99999.
            return si.format_quantity(float(f"{value * factor:.12g}"), bound.unit)
    return ""


def _meant_of_part(display: Display, path: Path) -> str:
    """Guess at what the value behind a ratio may mean, where it is not usual by itself."""
    owner: Any = display
    for part in path[:-1]:
        owner = owner[part] if isinstance(part, int) else getattr(owner, part)
    bound = bounds().get(f"{type(owner).__name__}.{path[-1]}")
    value = getattr(owner, str(path[-1]), None)
    if bound is None or not isinstance(value, float) or bound.is_usual(value):
        return ""
    return _meant(bound, value)


@dataclass(frozen=True)
class Foreseen:
    """Forecast of a display that nothing speaks against: `doubts` in sentences, the closed estimate
    and the size of the solve, None where there is none."""

    display: Display
    doubts: tuple[str, ...]
    expected: Expectation | None
    size: SolveSize | None

    @property
    def sentence(self) -> str:
        """Sentence on what to expect and how long it takes; empty where nothing is known."""
        if self.expected is None:
            return ""
        said = f"expected {self.expected.sentence}"
        if self.size is None:
            return said
        return (
            f"{said}; solving it in three dimensions ({_thousands(self.size.unknowns)} unknowns) "
            f"takes {about(self.size.seconds)}"
        )


def _thousands(count: int) -> str:
    return f"{count:,}".replace(",", " ")


def foreseen(name_or_path: str | pathlib.Path, voltage: si.Volt | None = None) -> Foreseen:
    """A display of a preset's name or a file, checked before anything is solved.

    `voltage` (V, zero-to-peak) is what it will be driven with, its own without one. Raises
    `ConfigError` for a file that cannot be read or a display that cannot be right, with the lines.
    """
    display = load_display(name_or_path)
    file = presets.resolve(name_or_path)
    text = read_toml_text(file)
    doubts = require_plausible(display, voltage, text=text, file=str(file))
    expected = expectation(display.actuator)
    return Foreseen(display, doubts, expected, _size(display, expected))


def _size(display: Display, expected: Expectation | None) -> SolveSize | None:
    plate = display.actuator
    if expected is None or not isinstance(plate, RectangularPlate):
        return None
    try:
        return solve_size(plate, plate.working_label, expected.frequency)
    except InputError:
        # Too thin or too large for solid elements: the solve says so itself.
        return None
