"""Units in the type, and quantity text.

Inside the package every number is an SI float; its unit stands in its annotation
(`Metre = Annotated[float, Unit("m")]`). Outside, in TOML and on the command line, a quantity is
text with its unit: `"2 um"`. This module reads and writes that text with exact decimals, so that
`"50 um"` is the float 5e-05 and not 4.9999999999999996e-05.

The units' names in annotations (`Metre`, `Newton`) are in `squeezefilm.core.quantities.vocabulary`.
"""

from __future__ import annotations

import functools
import re
import typing
from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal, DecimalException, localcontext
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core.errors import QuantityError
from squeezefilm.core.quantities.slips import probably_meant

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
IntArray = NDArray[np.int64]
Array = NDArray[Any]
FloatLike = float | FloatArray

# kg, m, s, A, K, rad. The radian is counted, so that "100 rad/s" is not taken for 100 Hz.
Dimension = tuple[int, int, int, int, int, int]
_NONE: Dimension = (0, 0, 0, 0, 0, 0)

_UNITS: dict[str, tuple[Decimal, Dimension, bool]] = {}


def _unit(symbols: str, scale: str, dimension: Dimension, prefixed: bool = True) -> None:
    for symbol in symbols.split():
        _UNITS[symbol] = (Decimal(scale), dimension, prefixed)


_unit("m", "1", (0, 1, 0, 0, 0, 0))
_unit("g", "1e-3", (1, 0, 0, 0, 0, 0))
_unit("s", "1", (0, 0, 1, 0, 0, 0))
_unit("min", "60", (0, 0, 1, 0, 0, 0), False)
_unit("h", "3600", (0, 0, 1, 0, 0, 0), False)
_unit("A", "1", (0, 0, 0, 1, 0, 0))
_unit("K", "1", (0, 0, 0, 0, 1, 0))
_unit("degC °C", "1", (0, 0, 0, 0, 1, 0), False)
_unit("rad", "1", (0, 0, 0, 0, 0, 1))
_unit("deg °", "0.01745329251994329576923690768488612713", (0, 0, 0, 0, 0, 1), False)
_unit("Hz", "1", (0, 0, -1, 0, 0, 0))
_unit("N", "1", (1, 1, -2, 0, 0, 0))
_unit("Pa", "1", (1, -1, -2, 0, 0, 0))
_unit("bar", "1e5", (1, -1, -2, 0, 0, 0))
_unit("atm", "101325", (1, -1, -2, 0, 0, 0), False)
_unit("J", "1", (1, 2, -2, 0, 0, 0))
_unit("W", "1", (1, 2, -3, 0, 0, 0))
_unit("V", "1", (1, 2, -3, -1, 0, 0))
_unit("C", "1", (0, 0, 1, 1, 0, 0))
_unit("F", "1", (-1, -2, 4, 2, 0, 0))
_unit("H", "1", (1, 2, -2, -2, 0, 0))
_unit("VA", "1", (1, 2, -3, 0, 0, 0), False)
_unit("ohm Ohm Ω", "1", (1, 2, -3, -2, 0, 0))
_unit("S", "1", (-1, -2, 3, 2, 0, 0))
_unit("1", "1", _NONE, False)
_unit("%", "1e-2", _NONE, False)

_PREFIXES = {
    "p": "1e-12", "n": "1e-9", "u": "1e-6", "µ": "1e-6", "μ": "1e-6", "m": "1e-3",
    "c": "1e-2", "d": "1e-1", "k": "1e3", "M": "1e6", "G": "1e9",
}  # fmt: skip

# A level is no power product: it is read where one is wanted, and what it is re is said there.
_LEVEL = "dB"
_CELSIUS = ("degC", "°C")
_CELSIUS_ZERO = Decimal("273.15")

# What a keyboard has no key for: "kg/m³" is kg/m3, "Pa·s" is Pa*s.
_TYPED = str.maketrans("·⋅×²³⁴⁻¹", "***234-1")

# A text past it is no quantity, and would be searched for one in vain for minutes.
_LONGEST_TEXT = 200
_FACTOR = re.compile(r"([^\s*/^·\d]+?|1)\s*(?:\^|\*\*)?\s*(-?\d{1,2})?")
_QUANTITY = re.compile(
    r"\s*(?P<number>[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?|[+-]?(?:nan|inf(?:inity)?))"
    r"\s*(?P<unit>\S.*?)?\s*",
    re.IGNORECASE,
)


def _factor(symbol: str) -> tuple[Decimal, Dimension]:
    if symbol in _UNITS:
        scale, dimension, _ = _UNITS[symbol]
        return scale, dimension
    prefix, rest = symbol[:1], symbol[1:]
    if prefix in _PREFIXES and rest in _UNITS and _UNITS[rest][2]:
        scale, dimension, _ = _UNITS[rest]
        return scale * Decimal(_PREFIXES[prefix]), dimension
    raise QuantityError(f"unknown unit '{symbol}'")


@functools.lru_cache(maxsize=512)
def parse_unit(text: str) -> tuple[Decimal, Dimension]:
    """The scale to SI and the dimension of a unit text such as ``"kg/m3"`` or ``"N*m"``.

    Raises `QuantityError` for a unit that is unknown or not well formed.
    """
    scale, total = Decimal(1), list(_NONE)
    for position, part in enumerate(text.translate(_TYPED).split("/")):
        sign = 1 if position == 0 else -1
        for piece in re.split(r"(?<!\*)\*(?!\*)|\s+", part.strip()):
            match = _FACTOR.fullmatch(piece.strip())
            if match is None:
                raise QuantityError(f"'{text}' is no unit; write one like m, mm, kHz, N/m or kg/m3")
            power = sign * int(match.group(2) or 1)
            factor, dimension = _factor(match.group(1))
            with localcontext() as context:
                context.prec = 40
                scale *= factor**power
            total = [t + power * d for t, d in zip(total, dimension, strict=True)]
    a, b, c, d, e, f = total
    return scale, (a, b, c, d, e, f)


@dataclass(frozen=True)
class Unit:
    """The SI unit of a number, carried in its annotation: ``Annotated[float, Unit("m")]``.

    A temperature is `absolute`, "20 degC" is then 293.15 K; of a difference it is 20 K.
    """

    symbol: str
    absolute: bool = False

    @property
    def dimension(self) -> Dimension:
        """The exponents of kg, m, s, A, K and rad."""
        return parse_unit(self.symbol)[1]

    @property
    def suffix(self) -> str:
        """The end of a JSON key or a CSV column, e.g. ``_N_per_m``; empty if dimensionless."""
        if self.symbol == "1":
            return ""
        return "_" + self.symbol.replace("*", "_").replace("/", "_per_").replace("^", "")

    @property
    def label(self) -> str:
        """The symbol as an axis or a table shows it."""
        return "" if self.symbol == "1" else self.symbol


# What to offer a person who wrote no unit, or the wrong one.
_EXAMPLES = {
    "m": "m, mm, µm, nm",
    "Hz": "Hz, kHz",
    "s": "s, ms",
    "N": "N, mN",
    "Pa": "Pa, kPa, MPa, GPa",
    "V": "V, mV",
    "Pa*s": "Pa*s",
    "kg/m3": "kg/m3",
    "m/s": "m/s, mm/s",
    "m2": "m2, cm2, mm2",
    "m/V": "m/V, pm/V",
    "C/m2": "C/m2",
    "m2/N": "m2/N",
    "F/m": "F/m, nF/m",
    "rad": "rad, deg",
    "ohm": "ohm, kohm, Mohm",
    "S": "S, mS, µS",
    "Pa/m": "Pa/m, MPa/m, N/m3",
    "K": "K, degC",
    "kg": "kg, g, mg",
    "A": "A, mA",
    "W": "W, mW",
}


def allowed_units(unit: Unit) -> str:
    """The units a person may write for `unit`, as a short list for messages."""
    return _EXAMPLES.get(unit.symbol, unit.symbol)


# What a bare number is most often meant in; the first of the units offered where none is named.
_USUAL = {"m": "mm", "Hz": "kHz", "Pa": "kPa", "m/s": "mm/s", "m/V": "pm/V", "rad": "deg"}

_DIMENSIONS = {
    "m": "a length", "Hz": "a frequency", "s": "a time", "N": "a force", "V": "a voltage",
    "Pa": "a pressure or a modulus", "Pa*s": "a viscosity", "kg/m3": "a density",
    "kg": "a mass", "m/s": "a speed", "m2": "an area", "m/V": "a charge coefficient",
    "C/m2": "a stress coefficient", "m2/N": "a compliance", "rad": "an angle",
    "ohm": "a resistance", "S": "an admittance", "A": "a current", "W": "a power", "J": "an "
    "energy", "F": "a capacitance",
    "K": "a temperature", "J/kg/K": "a specific heat", "N/m": "a stiffness",
    "V/s": "a rate of voltage", "1": "a number without dimension (dimensionless)",
}  # fmt: skip


def _dimension_in_words(dimension: Dimension) -> str | None:
    known = {parse_unit(symbol)[1]: words for symbol, words in reversed(_DIMENSIONS.items())}
    return known.get(dimension)


def parse_quantity(text: str, unit: Unit) -> float:
    """The SI value of a quantity text such as ``"2 um"``, correctly rounded to the nearest float.

    Raises `QuantityError` for a text without a number, without a unit (unless the quantity is
    dimensionless), of another dimension, not finite, or too large for a float; the message says
    what to write where it can be guessed.
    """
    try:
        return _parsed(text, unit)
    except QuantityError as error:
        if len(text) > _LONGEST_TEXT or (meant := _meant(text, unit)) is None:
            raise
        raise QuantityError(f"'{text}' cannot be read: {meant}") from error


def _meant(text: str, unit: Unit) -> str | None:
    """The reason why it was refused and what to write, the first that can be read; None where none
    can."""
    units = allowed_units(unit)
    for why, candidates in probably_meant(text, unit.symbol, tuple(units.split(", "))):
        try:
            for candidate in candidates:
                _parsed(candidate, unit)
        except QuantityError:
            continue
        where = f" (units allowed here: {units})" if unit.label else ""
        return f"{why}; write " + " or ".join(f'"{symbol}"' for symbol in candidates) + where
    return None


def _parsed(text: str, unit: Unit) -> float:
    if len(text) > _LONGEST_TEXT:
        raise QuantityError(
            f"'{text[:40]}…' is no quantity: it has {len(text)} characters, and at most "
            f'{_LONGEST_TEXT} are read; write a number and a unit, like "{_example(unit)}"'
        )
    match = _QUANTITY.fullmatch(text)
    if match is None:
        raise QuantityError(
            f"'{text}' is no quantity; write a number and a unit, like \"{_example(unit)}\""
        )
    try:
        number = Decimal(match.group("number"))
    except DecimalException as error:
        raise QuantityError(f"'{text}' is too large or too small to be represented") from error
    if not number.is_finite():
        raise QuantityError(f"'{text}' is not a finite number; a quantity must be finite")
    scale = _scale(text, match, unit)
    if unit.absolute and match["unit"] in _CELSIUS:
        number += _CELSIUS_ZERO
    try:
        with localcontext() as context:
            context.prec = 60
            value = float(number * scale)
    except DecimalException:
        value = float("inf")
    if not np.isfinite(value):
        raise QuantityError(f"'{text}' is too large to be represented")
    if unit.absolute and value < 0:
        raise QuantityError(f"'{text}' is below absolute zero, 0 K or -273.15 degC")
    return value


def _scale(text: str, match: re.Match[str], unit: Unit) -> Decimal:
    """The scale to SI of the unit that was written, or of none where none is needed.

    Raises `QuantityError` for a unit that is missing, unknown or of another dimension.
    """
    symbol = match.group("unit")
    if symbol is None and unit.symbol != "1":
        raise QuantityError(
            f"'{text}' has no unit; write it with one of {allowed_units(unit)}, "
            f'like "{match.group("number")} {_usual(unit)}"'
        )
    if unit.symbol == _LEVEL:
        if symbol != _LEVEL:
            raise QuantityError(f"'{text}' is no level in {_LEVEL}, like \"{_example(unit)}\"")
        return Decimal(1)
    try:
        scale, dimension = parse_unit(symbol or "1")
    except QuantityError as error:
        where = f"allowed here: {allowed_units(unit)}" if unit.label else "no unit stands here"
        raise QuantityError(f"'{text}': {error}; {where}") from error
    if dimension != unit.dimension:
        is_, wanted = _dimension_in_words(dimension), _dimension_in_words(unit.dimension)
        raise QuantityError(
            f"'{text}' has the wrong dimension"
            + (f": it is {is_}" if is_ else "")
            + f", and {wanted or f'a quantity in {unit.label}'} is wanted"
            + ("" if unit.symbol == "1" else f", in one of {allowed_units(unit)}")
        )
    return scale


def _usual(unit: Unit) -> str:
    return _USUAL.get(unit.symbol, allowed_units(unit).split(", ")[0])


def _example(unit: Unit) -> str:
    return "0.5" if unit.symbol == "1" else f"2 {_usual(unit)}"


_READABLE = [("G", 9), ("M", 6), ("k", 3), ("", 0), ("m", -3), ("µ", -6), ("n", -9), ("p", -12)]
_SCALED = {"m", "Hz", "s", "N", "Pa", "V", "A", "W", "J", "F", "C", "S", "m/V", "m/s", "N/m", "H"}


def format_quantity(value: float, unit: Unit, digits: int = 4) -> str:
    """A readable quantity text, e.g. ``"2 µm"``, which `parse_quantity` reads back.

    `digits` significant digits are kept (17 keep every float).
    """
    if unit.symbol == "1":
        return f"{value:.{digits}g}"
    if unit.symbol not in _SCALED or value == 0 or not np.isfinite(value):
        return f"{value:.{digits}g} {unit.symbol}"
    with localcontext() as context:
        context.prec = 60
        exact = Decimal(repr(float(value)))
        rounded = Decimal(f"{exact:.{digits - 1}e}")
        exponent = rounded.adjusted()
        prefix, power = next((item for item in _READABLE if exponent >= item[1]), _READABLE[-1])
        number = rounded.scaleb(-power).normalize()
    text = f"{number:f}" if -4 < number.adjusted() < 7 else f"{number:e}"
    return f"{text} {prefix}{unit.symbol}"


def typed_quantity(value: float, unit: Unit, digits: int = 4) -> str:
    """The text of `format_quantity` as any keyboard has it, for a file or a form: ``"2 um"``."""
    return format_quantity(value, unit, digits).replace("µ", "u")


def percent(share: float, decimals: int = 0) -> str:
    """A share as a person reads it, e.g. ``"61 %"``."""
    return f"{100 * share:.{decimals}f} %"


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """A hint such as ``" Did you mean 'thickness'?"``, or an empty text if nothing is near."""
    import difflib

    near = difflib.get_close_matches(word, list(known), n=1, cutoff=0.6)
    return f" Did you mean '{near[0]}'?" if near else ""


def unit_of(annotation: Any) -> Unit | None:
    """The `Unit` in an annotation (also below ``X | None``), or None where it carries none."""
    if typing.get_origin(annotation) is Annotated:
        for item in annotation.__metadata__:
            if isinstance(item, Unit):
                return item
    for part in typing.get_args(annotation):
        if typing.get_origin(part) is Annotated and (unit := unit_of(part)) is not None:
            return unit
    return None


_HINTS: dict[type[Any], dict[str, Any]] = {}


def hints_of(cls: type[Any]) -> dict[str, Any]:
    """The annotations of a class by name, with their units; read once, so leave them unchanged."""
    if cls not in _HINTS:
        _HINTS[cls] = typing.get_type_hints(cls, include_extras=True)
    return _HINTS[cls]
