"""Units by their scale and dimension, and quantity text in both directions, word for word."""

from __future__ import annotations

import math
from decimal import Decimal
from typing import Annotated

import pytest

from squeezefilm.core.errors import QuantityError
from squeezefilm.core.quantities.units import (
    Unit,
    allowed_units,
    did_you_mean,
    format_quantity,
    parse_quantity,
    parse_unit,
    typed_quantity,
    unit_of,
)
from squeezefilm.core.quantities.vocabulary import (
    AbsoluteKelvin,
    Decibel,
    Dimensionless,
    Kelvin,
    Metre,
    MetreLike,
)

M, S, ONE = Unit("m"), Unit("s"), Unit("1")


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("N", "kg*m/s2"),
        ("Pa", "N/m2"),
        ("J", "N*m"),
        ("W", "J/s"),
        ("V", "W/A"),
        ("C", "A*s"),
        ("F", "C/V"),
        ("ohm", "V/A"),
        ("Ohm", "Ω"),
        ("Hz", "1/s"),
        ("h", "60 min"),
        ("min", "60 s"),
        ("bar", "100 kPa"),
        ("atm", "101325 Pa"),
        ("km", "1e3 m"),
        ("Gm", "1e9 m"),
        ("Mm", "1e6 m"),
        ("dm", "0.1 m"),
        ("cm", "0.01 m"),
        ("mm", "1e-3 m"),
        ("um", "1e-6 m"),
        ("µm", "1e-6 m"),
        ("μm", "1e-6 m"),
        ("nm", "1e-9 m"),
        ("pm", "1e-12 m"),
        ("g", "1e-3 kg"),
        ("%", "0.01"),
        ("K", "1000 mK"),
        ("rad", "1000 mrad"),
        ("360 deg", f"{2 * math.pi!r} rad"),
        ("180 °", f"{math.pi!r} rad"),
        ("m^2", "m*m"),
        ("m**2", "m m"),
        ("m^-2", "1/m2"),
        ("m-2", "1/m2"),
        ("V·s", "V*s"),
        ("m/s/s", "m/s2"),
    ],
)
def test_units_are_what_others_are_together(left: str, right: str) -> None:
    number, _, unit = right.partition(" ")
    try:
        float(number)
    except ValueError:
        number, unit = "1", right
    amount, _, symbol = left.rpartition(" ")
    unit = unit or "1"
    scale, dimension = parse_unit(symbol)
    other, same = parse_unit(unit)
    assert dimension == same
    assert float(amount or 1) * float(scale) == pytest.approx(float(number) * float(other))


def test_a_unit_has_its_dimension_in_kg_m_s_a_k_and_rad() -> None:
    assert Unit("kg*m*s*A*K*rad").dimension == (1, 1, 1, 1, 1, 1)
    assert Unit("kg/m2/s3*A").dimension == (1, -2, -3, -1, 0, 0)
    assert ONE.dimension == parse_unit("%")[1] == (0,) * 6
    assert parse_unit("mm3")[0] == Decimal("1e-9")


def test_a_temperature_has_the_zero_of_its_scale_and_a_difference_has_none() -> None:
    for text in ("25 degC", "25 °C"):
        assert parse_quantity(text, unit_of(AbsoluteKelvin)) == 298.15
        assert parse_quantity(text, unit_of(Kelvin)) == 25.0
    for kind in (Kelvin, AbsoluteKelvin):
        assert parse_quantity("25 K", unit_of(kind)) == 25.0
    assert parse_quantity("2e-5 1/degC", Unit("1/K")) == 2e-5
    assert parse_quantity("-300 degC", unit_of(Kelvin)) == -300.0
    with pytest.raises(QuantityError, match=r"'-300 degC' is below absolute zero, 0 K or -273"):
        parse_quantity("-300 degC", unit_of(AbsoluteKelvin))


def test_a_negative_zero_stays_one() -> None:
    assert math.copysign(1, parse_quantity("-0 rad", Unit("rad"))) == -1


def test_a_level_is_read_in_decibels_where_a_level_is_wanted() -> None:
    assert parse_quantity("125 dB", unit_of(Decibel)) == 125.0
    assert parse_quantity(format_quantity(-3.25, Unit("dB")), Unit("dB")) == -3.25
    for text in ("50 %", "125 dBA", "2 Pa", "125 dB/m"):
        with pytest.raises(QuantityError, match="is no level in dB"):
            parse_quantity(text, Unit("dB"))
    with pytest.raises(QuantityError, match=r'has no unit.* like "125 dB"'):
        parse_quantity("125", Unit("dB"))
    with pytest.raises(QuantityError, match="unknown unit 'dB'"):
        parse_quantity("12 dB", ONE)


@pytest.mark.parametrize("text", ["kmin", "hh", "katm", "m%", "cdeg", "kkm", "xm", "q"])
def test_a_prefix_goes_before_units_that_take_one(text: str) -> None:
    with pytest.raises(QuantityError, match=f"^unknown unit '{text}'$"):
        parse_unit(text)


def test_what_is_no_unit_is_refused_with_examples() -> None:
    for text in ("m/", "*m", "m2.5", "m^123", "m***2"):
        with pytest.raises(QuantityError) as caught:
            parse_unit(text)
        assert str(caught.value) == f"'{text}' is no unit; write one like m, mm, kHz, N/m or kg/m3"


def test_names_of_keys_and_axes() -> None:
    assert Unit("kg*m/s2").suffix == "_kg_m_per_s2"
    assert Unit("m^2").suffix == "_m2"
    assert (ONE.suffix, ONE.label) == ("", "")
    assert Unit("N/m").label == "N/m"


@pytest.mark.parametrize(
    ("text", "unit", "says"),
    [
        ("2", M, "'2' has no unit; write it with one of m, mm, µm, nm, like \"2 mm\""),
        ("2", Unit("Pa*s"), "'2' has no unit; write it with one of Pa*s, like \"2 Pa*s\""),
        ("x", M, "'x' is no quantity; write a number and a unit, like \"2 mm\""),
        ("x", ONE, "'x' is no quantity; write a number and a unit, like \"0.5\""),
        ("nan m", M, "'nan m' is not a finite number; a quantity must be finite"),
        ("-Infinity m", M, "'-Infinity m' is not a finite number; a quantity must be finite"),
        ("1e400 m", M, "'1e400 m' is too large to be represented"),
        ("2 q", S, "'2 q': unknown unit 'q'; allowed here: s, ms"),
        (
            "2 V",
            M,
            "'2 V' has the wrong dimension: it is a voltage, and a length is wanted, in one of m, "
            "mm, µm, nm",
        ),
        (
            "2 m",
            ONE,
            "'2 m' has the wrong dimension: it is a length, and a number without dimension "
            "(dimensionless) is wanted",
        ),
        (
            "9" * 201,
            M,
            f"'{'9' * 40}…' is no quantity: it has 201 characters, and at most 200 are read; "
            'write a number and a unit, like "2 mm"',
        ),
    ],
)
def test_a_text_is_refused_in_these_words(text: str, unit: Unit, says: str) -> None:
    with pytest.raises(QuantityError) as caught:
        parse_quantity(text, unit)
    assert str(caught.value) == says


def test_texts_are_read_to_the_nearest_float() -> None:
    assert parse_quantity(f"{'1' * 198} m", M) == float("1" * 198)
    assert parse_quantity("  +.5e1mm ", M) == 5e-3
    assert parse_quantity("50 %", ONE) == 0.5
    assert parse_quantity("0.3", ONE) == 0.3
    # 3e-6 × 0.1 in floats would be 3.0000000000000004e-07.
    assert parse_quantity("0.3 um", M) == 3e-7
    # A tie between two floats of which the digits far behind decide.
    assert parse_quantity("9007199254740993.0000000000000000000001 m", M) == 9007199254740994.0


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (2e-6, M, "2 µm"),
        (1e-6, M, "1 µm"),
        (9.9999e-7, M, "1 µm"),
        (9.99e-7, M, "999 nm"),
        (1.0, M, "1 m"),
        (999.9, M, "999.9 m"),
        (1000.0, M, "1 km"),
        (1.5e6, Unit("Hz"), "1.5 MHz"),
        (1.5e9, Unit("Pa"), "1.5 GPa"),
        (1.5e13, Unit("Pa"), "15000 GPa"),
        (1.5e15, Unit("Pa"), "1500000 GPa"),
        (1.5e16, Unit("Pa"), "1.5e+7 GPa"),
        (2e-3, S, "2 ms"),
        (3e-12, M, "3 pm"),
        (3e-15, M, "0.003 pm"),
        (3e-16, M, "3e-4 pm"),
        (-2.47e-10, Unit("m/V"), "-247 pm/V"),
        (0.0, M, "0 m"),
        (math.inf, M, "inf m"),
        (1.23456789, M, "1.235 m"),
        (1.23456789e-5, Unit("Pa*s"), "1.235e-05 Pa*s"),
        (0.123456, ONE, "0.1235"),
    ],
)
def test_a_value_is_written_as_a_person_reads_it(value: float, unit: Unit, text: str) -> None:
    assert format_quantity(value, unit) == text


def test_what_is_written_into_a_file_can_be_typed() -> None:
    assert typed_quantity(2.5e-6, M) == "2.5 um"
    assert typed_quantity(2.345678e-6, M, 7) == "2.345678 um"
    assert parse_quantity(format_quantity(2.5e-6, M), M) == parse_quantity("2.5 um", M) == 2.5e-6


def test_the_digits_asked_for_are_kept() -> None:
    assert format_quantity(1.23456789e-3, M, digits=6) == "1.23457 mm"
    assert format_quantity(0.125, ONE, 2) == "0.12"
    assert format_quantity(1.24e-5, Unit("Pa*s"), 2) == "1.2e-05 Pa*s"


def test_units_to_write_are_named() -> None:
    assert allowed_units(M) == "m, mm, µm, nm"
    assert allowed_units(Unit("J")) == "J"


def test_a_near_word_is_offered() -> None:
    assert did_you_mean("thicknes", ["width", "thickness"]) == " Did you mean 'thickness'?"
    assert did_you_mean("abc", iter(["abd", "xyz"])) == " Did you mean 'abd'?"
    # Four letters of ten in common are 0.4: not near.
    assert did_you_mean("abxyz", ["abuvw"]) == ""
    assert did_you_mean("a", []) == ""


def test_the_unit_is_found_below_other_annotations() -> None:
    assert unit_of(MetreLike) == M
    assert unit_of(Annotated[float, "a note", S]) == S
    assert unit_of(str | Metre) == M
    assert unit_of(dict[str, Dimensionless]) == ONE
    assert unit_of(Annotated[float, "a note"]) is None
    assert unit_of(Annotated[Metre, "a note"]) == M
    assert unit_of(int | None) is None
