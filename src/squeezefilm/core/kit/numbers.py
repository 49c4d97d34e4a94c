"""Numbers in words and units: the one style of all pages, figures and terminals."""

from __future__ import annotations

import math
import re
import unicodedata

from squeezefilm.core import quantities as si

Row = tuple[str, str, str]
NUMBERS = ("Quantity", "Value", "Remark")
"""Heads of the columns of such rows on a page."""

M, HZ, S, N, V = si.Unit("m"), si.Unit("Hz"), si.Unit("s"), si.Unit("N"), si.Unit("V")
_TYPED_MICRO = re.compile(r"(?<=\d )u(?=[msNVAFWH]\b)")
_TYPED_OHM = re.compile(r"(?<=\d )([kMmµG]?)ohm\b")
_TYPED_POWER = re.compile(r"(?:(?<=\d )|(?<=\d kg/)|(?<=\d N/)|(?<=\d C/))([kcmµn]?m)([23])(?!\w)")
_RAISED = {"2": "²", "3": "³"}
_MINUS = re.compile(r"(?<![\w.\-−–/])-(?=\d)")
A, W, SPEED, PER_VOLT = si.Unit("A"), si.Unit("W"), si.Unit("m/s"), si.Unit("m/V")
KELVIN, OHM, HENRY, FARAD = si.Unit("K"), si.Unit("ohm"), si.Unit("H"), si.Unit("F")


def shown(value: float | None, unit: si.Unit, digits: int = 4, none: str = "–") -> str:
    """A quantity as a person reads it, e.g. ``"2 µm"``; `none` where it is not known."""
    if value is None:
        return none
    if unit.symbol == "Hz" and 0 < abs(value) < 1:
        return f"{value:.{digits}g} Hz"  # nobody reads millihertz
    text = si.format_quantity(value, unit, digits)
    number, _, symbol = text.partition(" ")
    # 0.6 µm and 0.5 N are what the field says, not 600 nm and 500 mN.
    larger = {"n": "µ", "µ": "m"} | ({"m": ""} if unit.symbol in ("N", "V") else {})
    base = unit.symbol
    known = base in ("m", "s", "N", "V") and symbol != base and symbol[:1] in larger
    if known and abs(float(number)) >= 100:
        return f"{float(number) / 1000:.{digits}g} {larger[symbol[0]]}{base}"
    return text


def decimals(value: float | None, count: int) -> str:
    """A number with so many decimals; a dash for none, or one that is not finite."""
    return "–" if value is None or not math.isfinite(value) else f"{value:.{count}f}"


def signed(value: float, unit: si.Unit, digits: int = 3) -> str:
    """A change as a person reads it, always with its sign, e.g. ``"−248 Hz"``."""
    return f"{'−' if value < 0 else '+'}{shown(abs(value), unit, digits)}"


def changed(share: float, decimals: int = 1) -> str:
    """A relative change as a person reads it, always with its sign, e.g. ``"−4.1 %"``."""
    return f"{'−' if share < 0 else '+'}{si.percent(abs(share), decimals)}"


def span(low: float, high: float) -> str:
    """Two relative frictions with what lies between, e.g. ``"0.04–0.79"``."""
    return f"{low:.2f}–{high:.2f}"


def printable(text: str) -> str:
    """A text in one line without control characters (a terminal would obey them), its units and
    signs as everywhere: "2 um" is 2 µm, "5 ohm" 5 Ω, "1 kg/m3" 1 kg/m³, -3 is −3."""
    line = " ".join(
        "".join(" " if unicodedata.category(c) in ("Cc", "Cf", "Cs") else c for c in text).split()
    )
    line = _TYPED_OHM.sub(r"\1Ω", _TYPED_MICRO.sub("µ", line))
    line = _TYPED_POWER.sub(lambda match: match[1] + _RAISED[match[2]], line)
    return _MINUS.sub("−", line)


def unit_stays(text: str) -> str:
    """A text of which no line may end between a number and its unit, nor after an equals sign."""
    text = re.sub(r"(?<=\d) (?=%|[µnmkM]?(?:m|Hz|s|N|V|W|A|K|VA|dB|F|H)\b)", "\u00a0", text)
    return re.sub(r" = (?=\d)", "\u00a0=\u00a0", text)


def dotted(path: tuple[str | int, ...]) -> str:
    """A path as people read it: list members counted from 1."""
    return ".".join(str(part + 1) if isinstance(part, int) else part for part in path)
