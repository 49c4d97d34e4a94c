"""Quantity text: exact, dimension-checked, and refused with a message that helps."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from squeezefilm.core.errors import InputError, QuantityError
from squeezefilm.core.quantities import (
    CLOSED_FORMS,
    Metre,
    Unit,
    checked_numbers,
    closed_form,
    format_quantity,
    parse_quantity,
    require,
    require_alike,
    unit_of,
)

M = Unit("m")


@pytest.mark.parametrize(
    ("text", "symbol", "value"),
    [
        ("50 um", "m", 5e-05),
        ("0.1 µm", "m", 1e-07),
        ("3 mm", "m", 0.003),
        ("40.5 kHz", "Hz", 40500.0),
        ("-247 pm/V", "m/V", -2.47e-10),
        ("7700 kg/m^3", "kg/m3", 7700.0),
        ("7.7 g/cm3", "kg/m3", 7700.0),
        ("16.4e-12 m2/N", "m2/N", 1.64e-11),
        ("1.85e-5 Pa*s", "Pa*s", 1.85e-05),
        ("1.85e-5 Pa·s", "Pa*s", 1.85e-05),
        ("200 mm/s", "m/s", 0.2),
        ("40.67 cm2", "m2", 0.004067),
        ("2 N/mm", "N/m", 2000.0),
        ("60", "1", 60.0),
        ("30 %", "1", 0.3),
        ("180 deg", "rad", math.pi),
        ("1 atm", "Pa", 101325.0),
    ],
)
def test_text_becomes_the_nearest_float_in_si(text: str, symbol: str, value: float) -> None:
    assert parse_quantity(text, Unit(symbol)) == value


@pytest.mark.parametrize(
    ("text", "symbol", "says"),
    [
        ("2", "m", 'like "2 mm"'),
        ("2 V", "m", "wrong dimension"),
        ("2 um", "1", "dimensionless"),
        ("100 rad/s", "Hz", "wrong dimension"),
        ("nan um", "m", "finite"),
        ("inf m", "m", "finite"),
        ("5 umm", "m", "unknown unit 'umm'"),
        ("2 kmin", "s", "unknown unit 'kmin'"),
        ("", "m", "no quantity"),
        ("two um", "m", "no quantity"),
        ("1e400 m", "m", "too large"),
        ("2 m/", "m", "no unit"),
    ],
)
def test_bad_text_is_refused_with_what_is_allowed(text: str, symbol: str, says: str) -> None:
    with pytest.raises(QuantityError, match=says.replace("/", "/")) as caught:
        parse_quantity(text, Unit(symbol))
    assert text in str(caught.value)


@given(st.floats(min_value=-1e12, max_value=1e12).filter(lambda x: x == 0 or abs(x) > 1e-12))
def test_formatting_with_all_digits_reads_back_exactly(value: float) -> None:
    assert parse_quantity(format_quantity(value, M, digits=17), M) == value


@given(st.integers(-(10**9), 10**9), st.integers(-12, 9))
def test_prefixes_scale_exactly(number: int, power: int) -> None:
    decimal = parse_quantity(f"{number}e{power} m", M)
    assert parse_quantity(f"{number}e{power + 6} um", M) == decimal
    assert parse_quantity(f"{number}e{power + 3} mm", M) == decimal


def test_unit_is_found_in_annotations() -> None:
    assert unit_of(Metre) == M
    assert unit_of(Metre | None) == M
    assert unit_of(float) is None
    assert Unit("N/m").suffix == "_N_per_m"
    assert Unit("1").suffix == ""


def test_require_names_quantity_value_and_bound() -> None:
    with pytest.raises(InputError, match=r"gap = -2 µm cannot be used: .* above 0 m") as caught:
        require("gap", -2e-6, M, above=0)
    assert caught.value.quantity == "gap"
    with pytest.raises(InputError, match="nan"):
        require("gap", [1e-6, float("nan")], M)


def test_a_share_in_percent_is_refused_with_what_to_write() -> None:
    with pytest.raises(InputError, match=r'if 80 % is meant, write "80 %" or 0\.8$'):
        require("least_yield", 80, above=0, at_most=1)
    for value, most in ((150, 1), (0.7, 0.5), (-2, 1), (20, 9)):
        with pytest.raises(InputError) as caught:
            require("share", value, above=0, at_most=most)
        assert "%" not in str(caught.value)


def test_series_are_of_one_length() -> None:
    require_alike(x=np.zeros(3), y=[1, 2, 3], z=None)
    for y in (np.zeros(2), 0.5, np.zeros((3, 1)), [[1.0], [1.0, 2.0]]):
        with pytest.raises(InputError, match=r"x, y|x .* y"):
            require_alike(x=np.zeros(3), y=y)


def test_closed_form_checks_its_arguments() -> None:
    @closed_form(positive="length")
    def doubled(length: Metre) -> Metre:
        return 2 * length

    name = next(key for key in CLOSED_FORMS if key.endswith("doubled"))
    del CLOSED_FORMS[name]  # the registry is for the package's own
    assert doubled(1.0) == 2.0
    with pytest.raises(InputError, match="length = 0 m"):
        doubled(0.0)
    with pytest.raises(TypeError, match="no argument"):
        closed_form(positive="width")(doubled)


@pytest.mark.parametrize(
    "text",
    [
        "1e99999999999999999999 N", "1e-99999999999999999999 N", "1e999999 GN", "1 N99", "1 N" * 99,
        "1 N" + " " * 100_000 + "x", "1 N^" + "9" * 5000, "9" * 5000 + " N", "1 kN99*kN99",
    ],
)  # fmt: skip
def test_texts_that_no_number_can_hold_are_refused_at_once(text: str) -> None:
    with pytest.raises(QuantityError):
        parse_quantity(text, Unit("N"))


@checked_numbers
def _angles(rows: tuple[tuple[float, float], ...] = ()) -> tuple[tuple[float, float], ...]:
    return rows


def test_rows_of_numbers_are_taken_and_made_tuples() -> None:
    rows = ((0.0, 1.0), (1.0, 2.0))
    assert _angles() == ()
    assert _angles(rows) == _angles(np.array(rows)) == rows


@pytest.mark.parametrize(
    ("rows", "says"),
    [
        (((0.0, 1.0), (1.0,)), "rows of 1, 2 numbers"),
        (((0.0, 1.0, 2.0),), "rows of 3 numbers; give 2"),
        ((0.0, 1.0), "an array of 2 axes"),
        (1.0, "an array of 2 axes"),
        ("ab", "real number"),
        (((0.0, math.nan),), "finite"),
    ],
)
def test_what_is_no_rows_of_numbers_is_refused(rows: object, says: str) -> None:
    with pytest.raises(InputError, match=says):
        _angles(rows)  # type: ignore[arg-type]
