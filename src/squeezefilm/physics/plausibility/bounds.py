"""The ranges of `usual.toml`: what of a display is usual, and what cannot be right."""

from __future__ import annotations

import functools
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from pathlib import Path
from types import MappingProxyType

from squeezefilm.core import quantities as si

Range = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Bound:
    """Of one value or ratio `of`: the `usual` range and the `possible` one (SI, in `unit`).

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
        """Whether a value (SI) is one that is built."""
        return self._within(self.usual, value)

    def is_possible(self, value: float) -> bool:
        """Whether a value (SI) may be right at all."""
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
_MARKS = {" um": " µm", "kg/m3": "kg/m³", "m2/N": "m²/N", "C/m2": "C/m²", "s2/m2": "s²/m²"}


def shown(value: float, unit: si.Unit) -> str:
    """A value (SI) for people: ``"20 000 kg/m³"``, ``"30 µm"``, ``"0.4 W/g"``."""
    if unit.symbol in _READ_AS:
        scale, name = _READ_AS[unit.symbol]
        return f"{_plain(value * scale)} {name}"
    text = si.format_quantity(value, unit, 3)
    if "e" in text.partition(" ")[0]:
        text = " ".join([_plain(value), *([unit.symbol] if unit.symbol != "1" else [])])
    for ascii_text, mark in _MARKS.items():
        text = text.replace(ascii_text, mark)
    return text


def _plain(value: float) -> str:
    """Three digits, with no power of ten where a few zeros will do."""
    if 1e3 <= abs(value) < 1e7:
        return f"{float(f'{value:.3g}'):,.0f}".replace(",", " ")
    return f"{value:.3g}"


@functools.cache
def bounds() -> Mapping[str, Bound]:
    """Every bound of `usual.toml` by what it is of."""
    text = Path(__file__).with_name("usual.toml").read_text(encoding="utf-8")
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
    """From ``"1 mm to 2 mm"``, ``"from 1 mm"``, ``"up to 2 mm"`` or ``"any"``."""
    if text == "any":
        return -inf, inf
    if text.startswith("from "):
        return si.parse_quantity(text.removeprefix("from "), unit), inf
    if text.startswith("up to "):
        return 0.0, si.parse_quantity(text.removeprefix("up to "), unit)
    low, high = text.split(" to ")
    return si.parse_quantity(low, unit), si.parse_quantity(high, unit)
