"""Guesses at what a text that is no quantity was meant to be, and how to write it.

Nothing here is taken in a person's place: a text with a slip is refused, and the message says what
to write. `core.quantities.units` asks for the rewritings and offers those that it can read itself.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from decimal import Decimal, localcontext

Meant = tuple[str, tuple[str, ...]]
"""Reason why a text was refused, and what to write in its place: one text, or a choice."""

_NUMBER = re.compile(
    r"\s*(?P<number>[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?)\s*(?P<rest>.*?)\s*"
)
_PEAK_TO_PEAK = re.compile(
    r"(?P<unit>[^\s\d(]+?)[\s_]*\(?(?:pp|p-p|p2p|pk-pk|pkpk|ptp|peak[- ]to[- ]peak)\)?",
    re.IGNORECASE,
)
_RMS = re.compile(r"(?P<unit>[^\s\d(]+?)[\s_]*\(?(?:rms|eff)\)?", re.IGNORECASE)
_PEAK = re.compile(
    r"(?P<unit>[^\s\d(]+?)[\s_]*\(?(?:0-?p|pk|peak|zero[- ]to[- ]peak|0-to-peak|p)\)?",
    re.IGNORECASE,
)
_SCIENTIFIC = re.compile(
    r"\s*([+-]?\d+(?:\.\d+)?)\s*[x×*·]\s*10\s*(?:\^|\*\*)?\s*([+-−]?\d+)\s*(.*?)\s*"
)
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")

# Words and foreign units: the unit to write, and what one of them is in it.
_WORDS: dict[str, tuple[str, str]] = {}
for _unit, _scale, _names in (
    ("µm", "1", "micron microns micrometer micrometers micrometre micrometres mu mum mym"),
    ("mm", "1", "millimeter millimeters millimetre millimetres"),
    ("m", "1", "meter meters metre metres"),
    ("cm", "1", "centimeter centimeters centimetre centimetres"),
    ("nm", "1", "nanometer nanometers nanometre nanometres"),
    ("mm", "25.4", 'inch inches in "'),
    ("µm", "25.4", "mil mils thou"),
    ("nm", "0.1", "angstrom Å"),
    ("Hz", "1", "hertz cps"),
    ("kHz", "1", "kilohertz"),
    ("V", "1", "volt volts"),
    ("N", "1", "newton newtons"),
    ("Pa", "1", "pascal pascals"),
    ("GPa", "1", "gigapascal gigapascals"),
    ("mN", "9.80665", "gf pond"),
    ("N", "9.80665", "kgf kp"),
    ("kPa", "6.894757", "psi"),
    ("MPa", "6.894757", "ksi"),
    ("GPa", "6.894757", "Mpsi Msi"),
    ("kPa", "0.1333224", "torr Torr mmHg"),
    ("s", "1", "sec secs second seconds"),
    ("%", "1", "percent pct"),
    ("ohm", "1", "ohms"),
    ("kohm", "1", "kOhms kohms k"),
    ("deg", "1", "degree degrees"),
    ("g", "1", "gram grams gramme grammes gr"),
    ("kg", "1", "kilogram kilograms kilogramme kilogrammes kilo kilos"),
    ("dB", "1", "decibel decibels dBSPL dB(SPL)"),
    ("degC", "1", "C celsius Celsius centigrade"),
    ("K", "1", "kelvin kelvins Kelvin"),
    ("kg/m3", "1", "kg/cbm kg/m^3."),
    ("kg/m3", "1000", "g/cc g/ccm g/ml"),
):  # fmt: skip
    for _name in _names.split():
        _WORDS[_name] = (_unit, _scale)


def _number(text: str, factor: str = "1") -> str:
    """A number times a factor, in at most five digits, as a person would write it."""
    with localcontext() as context:
        context.prec = 12
        value = Decimal(text) * Decimal(factor)
        rounded = Decimal(f"{value:.4e}").normalize()
    return f"{rounded:f}" if -5 < rounded.adjusted() < 7 else f"{rounded:e}"


def probably_meant(text: str, wanted: str, allowed: tuple[str, ...]) -> Iterator[Meant]:
    """Guesses at what was meant by `text` where a quantity in `wanted` (a unit's symbol) stands.

    `allowed` are the units that are offered there. The most probable comes first; whoever asks
    leaves out what is no quantity of the wanted dimension.
    """
    yield from _of_the_number(text)
    if (match := _NUMBER.fullmatch(text)) is None:
        return
    number, rest = match["number"], match["rest"]
    yield from _of_amplitudes(number, rest)
    yield from _of_the_unit(number, rest, wanted, allowed)


_GROUPS = re.compile(r"\s*([+-]?\d{1,3}(?:[ '’_\u00a0\u202f]\d{3})+(?:\.\d+)?)\s*(.*?)\s*")
_COMMAS = re.compile(r"\s*([+-]?\d+(?:[.,]\d{3})*)([.,])(\d+)\s*(.*?)\s*")
_ABOUT = re.compile(r"\s*(?:~|≈|ca\.?|approx\.?|about|=|<|>)\s*(.+?)\s*")
_MINUS = re.compile(r"\s*[−–]\s*(\d.*?)\s*")
_QUOTIENT = re.compile(r"\s*(\d+)\s*/\s*(\d*[1-9]\d*)\s*(\D.*?)\s*")
_GIVE_OR_TAKE = re.compile(r"\s*([\d.eE+-]*\d)\s*(\D*?)\s*(?:±|\+/-|\+-)\s*[\d.eE+-]+\s*(\D.*?)\s*")


def _of_the_number(text: str) -> Iterator[Meant]:
    """Commas, groups of digits, powers of ten, signs before the number."""
    plain = text.translate(_SUPERSCRIPTS)
    if match := _COMMAS.fullmatch(plain):
        yield from _of_commas(*match.groups())
    if match := _GROUPS.fullmatch(plain):
        joined = re.sub(r"[^\d.+-]", "", match[1])
        yield "digits stand together", (f"{joined} {match[2]}",)
    if match := _SCIENTIFIC.fullmatch(plain):
        power = match[2].replace("−", "-")
        yield "a power of ten is written with e", (f"{match[1]}e{power} {match[3]}",)
    if match := _ABOUT.fullmatch(plain):
        why = "how sure a value is stands beside it, as its uncertainty or range, not in it"
        yield why, (match[1],)
    if match := _MINUS.fullmatch(plain):
        yield "its minus sign is not the one of the keyboard", (f"-{match[1]}",)
    if match := _QUOTIENT.fullmatch(plain):
        with localcontext() as context:
            context.prec = 12
            quotient = str(Decimal(match[1]) / Decimal(match[2]))
        yield "nothing is computed in a file", (f"{_number(quotient)} {match[3]}",)
    if match := _GIVE_OR_TAKE.fullmatch(plain):
        why = "how sure a value is stands beside it, as its uncertainty, not in it"
        yield why, (f"{match[1]} {match[2] or match[3]}",)


def _of_commas(whole: str, sign: str, part: str, rest: str) -> Iterator[Meant]:
    """A comma for the decimal point, or between groups of three digits."""
    if "," not in whole + sign:
        return
    digits = re.sub(r"[.,]", "", whole)
    decimal, grouped = f"{digits}.{part} {rest}", f"{digits}{part} {rest}"
    if sign == "." or len(part) != 3 or "." in whole:
        why = "decimals stand after a point" if sign == "," else "digits stand together"
        yield why, (decimal,)
    elif "," in whole:
        yield "digits stand together", (grouped,)
    else:
        yield "a comma may be a decimal sign or group thousands", (decimal, grouped)


def _of_amplitudes(number: str, rest: str) -> Iterator[Meant]:
    """Peak-to-peak and root-mean-square values where amplitudes are zero-to-peak."""
    for pattern, factor, why in (
        (_PEAK_TO_PEAK, "0.5", "amplitudes are zero-to-peak, which is half of peak-to-peak"),
        (
            _RMS,
            "1.41421356237",
            "amplitudes are zero-to-peak, which is √2 times a sine's rms value",
        ),
        (_PEAK, "1", "amplitudes are zero-to-peak, and their unit has no addition"),
    ):
        if match := pattern.fullmatch(rest):
            yield why, (f"{_number(number, factor)} {match['unit']}",)
            return


def _of_the_unit(number: str, rest: str, wanted: str, allowed: tuple[str, ...]) -> Iterator[Meant]:
    """Units by name, of other systems, in other letters, or cut short."""
    name = next((word for word in (rest, rest.lower(), rest.rstrip(".")) if word in _WORDS), None)
    if name is not None:
        unit, scale = _WORDS[name]
        own = scale == "1"
        why = "a unit is written as its symbol" if own else f"'{rest}' is not among the units read"
        yield why, (f"{number if own else _number(number, scale)} {unit}",)
    mass = _WORDS.get(rest, (rest,))[0]
    if wanted == "N" and mass in ("g", "kg"):
        # "A touch of 20 grams" is what a scale under the finger shows: the weight of that mass.
        weight = _number(number, "9.80665" if mass == "kg" else "0.00980665")
        yield "it is a mass, and a force is wanted (here its weight)", (f"{weight} N",)
    same = [unit for unit in allowed if unit.casefold() == rest.replace(" ", "").casefold()]
    if same:
        yield "capital and small letters differ in units", (f"{number} {same[0]}",)
    if rest in tuple("µμukMGpn"):
        yield f"'{rest}' alone is no unit", (f"{number} {rest.replace('u', 'µ')}{wanted}",)
    if " per " in rest:
        yield "a quotient of units is written with /", (f"{number} {rest.replace(' per ', '/')}",)
