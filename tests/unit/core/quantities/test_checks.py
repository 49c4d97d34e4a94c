"""What a checked call takes of numbers, what it refuses, and in which words."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import pint
import pytest

from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.core.hard_limits import SIDE
from squeezefilm.core.quantities import (
    ComplexArray,
    Dimensionless,
    FloatArray,
    Metre,
    MetreArray,
    MetreLike,
    Unit,
)
from squeezefilm.core.quantities.checks import CLOSED_FORMS, checked_numbers, closed_form
from squeezefilm.core.quantities.require import (
    Above,
    AtLeast,
    AtMost,
    Below,
    bounds_of,
    real_numbers,
    require,
    require_one_of,
)

M = Unit("m")


@checked_numbers
def one(value: Metre) -> Any:
    return value


@checked_numbers
def perhaps(value: Metre | None = None) -> Any:
    return value


@checked_numbers
def many(value: MetreArray) -> Any:
    return value


@checked_numbers
def either(value: MetreLike, other: MetreLike = 0.0, third: MetreArray | None = None) -> Any:
    return np.asarray(value + other) if isinstance(value, np.ndarray) else value


@checked_numbers
class Row(NamedTuple):
    width: Metre
    places: FloatArray
    is_held: bool = False


@checked_numbers
def count(value: int) -> Any:
    return value


@checked_numbers
def phasor(value: complex | ComplexArray) -> Any:
    return value


@checked_numbers
def waves(value: ComplexArray) -> Any:
    return value


@checked_numbers
def row(value: tuple[float, ...]) -> Any:
    return value


@checked_numbers
def pair(value: tuple[float, float]) -> Any:
    return value


@checked_numbers
def table(value: tuple[tuple[float, float], ...]) -> Any:
    return value


@checked_numbers
def free_table(value: tuple[list[float], ...]) -> Any:
    return value


@checked_numbers
def container(value: Annotated[dict[str, float] | list[Any] | float, M]) -> Any:
    return value


@checked_numbers
def unchecked(text: str, call: Callable[[float], float] | float, flag: bool) -> Any:
    return (text, call, flag)


def refusal(call: Callable[[], object]) -> str:
    with pytest.raises(InputError) as caught:
        call()
    return str(caught.value)


def test_real_numbers_become_floats() -> None:
    for value in (2, 2.0, np.float32(2), np.int8(2), np.uint16(2), [2], np.array([[2]])):
        found = real_numbers("x", value)
        assert found.dtype == float
        assert np.all(found == 2.0)
    assert real_numbers("x", 2**70) == 2.0**70
    assert real_numbers("x", pint.Quantity(2, "mm")) == 2.0


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (True, "True"),
        ("2", "'2'"),
        (2j, "2j"),
        (None, "None"),
        ([[1.0], [1.0, 2.0]], "[[1.0], [1.0, 2.0]]"),
        ([2**70], f"[{2**70}]"),
        (10**400, "a whole number of 1329 bits"),
        ("y" * 58, f"'{'y' * 58}'"),
        ("y" * 59, f"'{'y' * 56}..."),
    ],
)
def test_what_is_no_real_number_is_shown_and_refused(value: object, shown: str) -> None:
    with pytest.raises(InputError) as caught:
        real_numbers("x", value)
    assert caught.value.quantity == "x"
    assert str(caught.value) == (
        f"x = {shown} cannot be used: it must be a real number, or an array of real numbers, that "
        "a float can hold"
    )


@pytest.mark.parametrize(
    ("bounds", "good", "bad", "words"),
    [
        ({"above": 1.0}, 1.5, 1.0, "above 1 m"),
        ({"at_least": 1.0}, 1.0, 0.5, "at least 1 m"),
        ({"below": 1.0}, 0.5, 1.0, "below 1 m"),
        ({"at_most": 1.0}, 1.0, 1.5, "at most 1 m"),
        ({"above": 0.0, "at_most": 1.0}, 1.0, 2.0, "above 0 m and at most 1 m"),
    ],
)
def test_each_bound_holds_on_its_own_side(
    bounds: dict[str, float], good: float, bad: float, words: str
) -> None:
    require("gap", good, M, **bounds)  # type: ignore[arg-type]
    require("gap", [good, good], M, **bounds)  # type: ignore[arg-type]
    shown = {0.5: "500 mm", 1.0: "1 m", 1.5: "1.5 m", 2.0: "2 m"}[bad]
    says = refusal(lambda: require("gap", [good, bad, 9 * bad], M, **bounds))  # type: ignore[arg-type]
    assert says == f"gap = {shown} cannot be used: it must be finite and {words}"


def test_nothing_but_finite_numbers_is_required_without_bounds() -> None:
    require("ratio", [-1e300, 0.0])
    says = refusal(lambda: require("ratio", [1.0, math.inf]))
    assert says == "ratio = inf cannot be used: it must be finite"


def test_the_number_of_axes_is_required() -> None:
    require("x", [[1.0]], axes=2)
    assert refusal(lambda: require("x", [1.0, 2.0], axes=2)) == (
        "x has the shape (2,); an array of 2 axes is wanted"
    )


def test_a_number_is_one_finite_float() -> None:
    for value in (2, 2.0, np.float64(2), np.array(2)):
        assert type(one(value)) is float
        assert one(value) == 2.0
    assert "cannot be used: it must be finite" in refusal(lambda: one(math.nan))
    assert refusal(lambda: one(np.ones(1))) == "value has the shape (1,); one number is wanted"
    assert "NoneType" not in refusal(lambda: one(None))
    assert perhaps(None) is None
    assert perhaps() is None
    assert perhaps(3) == 3.0
    length = pint.Quantity(2.0, "mm")
    assert one(length) is length


def test_an_array_has_a_sample_at_least() -> None:
    assert many([1, 2]).dtype == float
    assert many([1, 2]).tolist() == [1.0, 2.0]
    assert refusal(lambda: many(1.0)) == (
        "value is one number; an array of at least one sample is wanted"
    )
    assert refusal(lambda: many([])) == "value is empty; at least one sample is wanted"
    assert refusal(lambda: either([])) == "value is empty; at least one sample is wanted"


def test_what_may_be_either_must_broadcast() -> None:
    assert type(either(2)) is float
    assert either([1.0, 2.0], [[1.0], [2.0]]).shape == (2, 2)
    assert refusal(lambda: either([1.0, 2.0], [1.0, 2.0, 3.0])) == (
        "the shapes of value (2,), other (3,) do not broadcast"
    )
    # An array is not broadcast, so its shape is its own business.
    assert either([1.0, 2.0], 1.0, np.ones(3)).tolist() == [2.0, 3.0]
    assert "do not broadcast" in refusal(lambda: either(value=[1.0, 2.0], other=[1.0, 2.0, 3.0]))


@checked_numbers
@dataclass(frozen=True)
class Ramp:
    rise: Metre


@checked_numbers
def ramp_or_number(value: MetreLike | Ramp) -> Any:
    return value


def test_a_record_may_stand_in_a_numbers_place() -> None:
    ramp = Ramp(1.0)
    assert ramp_or_number(ramp) is ramp
    # What is no such record is a number, and refused as one.
    assert type(ramp_or_number(2)) is float
    for wrong in (math.nan, "steep", None, Ramp, []):
        refusal(lambda wrong=wrong: ramp_or_number(wrong))


def test_a_count_is_a_whole_number_of_64_bits() -> None:
    assert count(2**64 - 1) == 2**64 - 1
    assert count(np.int32(3)) == 3
    for bad, shown in ((2**64, "a whole number of 65 bits"), (1.0, "1.0"), (True, "True")):
        assert refusal(lambda bad=bad: count(bad)) == (  # type: ignore[misc]
            f"value = {shown} cannot be used: it must be a whole number of at most 64 bits"
        )


def test_complex_numbers_are_finite() -> None:
    for call in (phasor, waves):
        assert call(1 + 2j) == 1 + 2j
        assert call(3) == 3
        for bad in (complex(0, math.inf), "1j", [1.0, math.nan], True):
            assert refusal(lambda bad=bad, call=call: call(bad)).endswith(  # type: ignore[misc]
                "it must be a finite number, real or complex, or an array of such numbers"
            )


def test_rows_keep_their_length_and_tables_their_width() -> None:
    assert row((1.0, 2.0, 3.0)) == (1.0, 2.0, 3.0)
    assert row(np.array([1.0, 2.0])) == (1.0, 2.0)
    assert row(()) == ()
    assert pair([1.0, 2.0]) == [1.0, 2.0]
    assert refusal(lambda: pair((1.0,))) == "value holds 1 numbers; give 2"
    assert "an array of 1 axes is wanted" in refusal(lambda: row(1.0))
    assert "an array of 1 axes is wanted" in refusal(lambda: row(((1.0,),)))
    assert table(()) == ()
    assert table(((1.0, 2.0),)) == ((1.0, 2.0),)
    assert table(np.array([[1.0, 2.0]])) == ((1.0, 2.0),)
    assert refusal(lambda: table(((1.0, 2.0, 3.0),))) == (
        "value has rows of 3 numbers; give 2 in each"
    )
    assert refusal(lambda: table(((1.0, 2.0), (1.0,)))) == (
        "value has rows of 1, 2 numbers; give rows of one length"
    )
    assert free_table(([1.0, 2.0, 3.0],)) == ([1.0, 2.0, 3.0],)


def test_numbers_in_a_container_are_left_in_it() -> None:
    given = [1, 2]
    assert container(given) is given
    assert refusal(lambda: container(1.0)).startswith("value is one number; an array")
    assert refusal(lambda: container([5e3, -math.inf])) == (
        "value = -inf m cannot be used: it must be finite"
    )


def test_what_stands_for_no_number_is_not_looked_at() -> None:
    assert unchecked("a", math.sin, True) == ("a", math.sin, True)
    assert unchecked(None, "x", "y") == (None, "x", "y")  # type: ignore[arg-type]


def test_a_closed_form_bounds_its_arguments_and_is_registered() -> None:
    @closed_form(positive="length width", nonnegative="shift")
    def area(length: Metre, width: MetreLike, shift: Metre = 0.0) -> Any:
        return length * width + shift

    assert CLOSED_FORMS.pop(f"{area.__module__}.{area.__qualname__}") is area
    assert area(2.0, 3.0) == 6.0
    assert area(2.0, 3.0, shift=0.0) == 6.0
    for call, says in (
        (lambda: area(0.0, 1.0), "length = 0 m cannot be used: it must be finite and above 0 m"),
        (lambda: area(1.0, [1.0, -2.0]), "width = -2 m cannot be used: it must be finite and abov"),
        (lambda: area(1.0, 1.0, -1.0), "shift = -1 m cannot be used: it must be finite and at lea"),
    ):
        assert refusal(call).startswith(says)
    with pytest.raises(TypeError, match=re.escape("area has no argument ['depth', 'height']")):
        closed_form(positive="length", nonnegative="height depth")(area)
    with pytest.raises(TypeError, match="positional argument"):
        area(1.0, 2.0, 3.0, 4.0)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="unexpected keyword"):
        area(1.0, 2.0, hight=2.0)  # type: ignore[call-arg]


@checked_numbers
def share(part: Dimensionless, whole: float = 1.0) -> Any:
    return np.float64(part) / np.float64(whole)


@checked_numbers
def parts(value: Dimensionless) -> tuple[float, tuple[FloatArray, int]]:
    return value, (np.array([1.0, value, math.nan if value == 7.0 else 1.0]), 3)


def test_a_result_that_no_float_holds_is_an_error_of_ours() -> None:
    for call, why in (
        (lambda: share(1.0, 0.0), "divide by zero encountered in scalar divide"),
        (lambda: share(1e308, 1e-308), "overflow encountered in scalar divide"),
        (lambda: share(0.0, whole=0.0), "invalid value encountered in scalar divide"),
    ):
        with pytest.raises(OutOfRangeError) as caught:
            call()
        assert str(caught.value).startswith(f"share leaves the range of a float ({why}) at part = ")
        assert ", whole = " in str(caught.value)
    assert parts(2.0)[0] == 2.0
    with pytest.raises(OutOfRangeError) as caught:
        parts(7)
    assert str(caught.value) == (
        "parts leaves the range of a float (the result is not finite) at value = 7 in SI units; "
        "take values of a size that occurs"
    )


def test_results_that_are_no_floats_are_given_as_they_are() -> None:
    @checked_numbers
    def given(what: str) -> Any:
        return {"int": np.array([1]), "text": "nan", "nan": math.nan, "j": complex(math.nan, 0),
                "pint": pint.Quantity(math.inf, "m")}[what]  # fmt: skip

    assert given("int") == np.array([1])
    assert given("text") == "nan"
    for bad in ("nan", "j", "pint"):
        with pytest.raises(OutOfRangeError, match=r"given leaves the .*finite\); take values"):
            given(bad)


def test_a_dataclass_is_checked_as_it_is_made() -> None:
    @checked_numbers
    @dataclass
    class Box:
        side: Metre
        name: str = ""

        def __post_init__(self) -> None:
            if self.name == "singular":
                raise ZeroDivisionError("none")

    assert type(Box(2).side) is float
    assert refusal(lambda: Box("2")).startswith("side = '2' cannot be used")  # type: ignore[arg-type]
    with pytest.raises(OutOfRangeError, match=r"Box leaves the range of a float \(none\) at side"):
        Box(1.0, "singular")


@checked_numbers
@dataclass
class Bounded:
    """Every kind of number with bounds in its type."""

    share: Annotated[Dimensionless, Above(0), Below(1)] = 0.5
    way: Annotated[Metre, AtLeast(0), AtMost(2)] | None = None
    side: Annotated[Metre, SIDE] = 0.1
    times: Annotated[int, AtLeast(1), AtMost(10_000)] = 1
    places: tuple[Annotated[Metre, AtLeast(-1)], ...] = ()
    levels: Annotated[MetreArray, Above(0)] | None = None
    waveform: Literal["square", "sine"] = "square"


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"share": 0.0}, "share = 0 cannot be used: it must be finite and above 0 and below 1"),
        ({"share": 1}, "share = 1 cannot be used: it must be finite and above 0 and below 1"),
        ({"share": math.nan}, "share = nan cannot be used: .* and above 0 and below 1"),
        ({"way": -1e-9}, "way = -1 nm cannot be used: .*at least 0 m and at most 2 m"),
        ({"way": 2.5}, "way = 2.5 m cannot be used"),
        ({"side": 1e-7}, "side = 100 nm cannot be used: it must be at least 1 µm and at most 10 m"),
        ({"side": 11}, r"side = 11 m cannot be used: .* \(a side or a diameter: "),
        ({"times": 0}, "times = 0 .* a whole number at least 1 and at most 10000$"),
        ({"times": 10_001}, "times = 10001 cannot be used"),
        ({"times": 2.0}, "times = 2.0 cannot be used"),
        ({"places": (0.0, -2.0)}, "places = -2 m cannot be used: .*at least -1 m"),
        ({"levels": [1.0, 0.0]}, "levels = 0 m cannot be used: it must be finite and above 0 m"),
        ({"waveform": "sinus"}, "'sinus' is not known. Did you mean 'sine'. Allowed: square, sine"),
        ({"waveform": ["sine"]}, r"waveform = \['sine'\] is not known. Allowed: square, sine"),
    ],
)
def test_bounds_stand_in_the_type(given: dict[str, Any], says: str) -> None:
    assert re.search(says, refusal(lambda: Bounded(**given)))


def test_what_is_on_its_side_of_the_bounds_is_taken() -> None:
    found = Bounded(1e-9, 2.0, 1e-6, 10_000, (-1.0, 5), [1e-9, 3], "sine")  # type: ignore[arg-type]
    assert (found.way, found.side, found.times) == (2.0, 1e-6, 10_000)
    assert Bounded(way=0).way == 0.0
    assert Bounded(levels=None).levels is None


@checked_numbers
def _within(
    inner: Annotated[Metre, Below("outer"), AtMost("limits.real")],
    outer: Metre | None = 2.0,
    limits: complex = 1.5 + 0j,
) -> None: ...


def test_another_argument_may_be_the_bound() -> None:
    _within(1.5)
    _within(outer=None, inner=1.0)
    with pytest.raises(InputError, match=r"^inner = 2 m .* below 2 m, which is outer$") as caught:
        _within(2.0)
    assert caught.value.quantity == "inner"
    with pytest.raises(InputError, match=r"at most 1\.5 m, which is limits\.real$"):
        _within(1.6, None)


def test_the_bounds_of_a_type_can_be_read() -> None:
    own = {"at_least": 1, "below": 2}
    assert bounds_of(Annotated[Metre, AtLeast(1), Below(2)]) == (own, (), ())
    assert bounds_of(Annotated[Metre, SIDE] | None) == ({}, (), (SIDE,))
    assert bounds_of(Annotated[Metre, AtLeast(1), Below("x")])[1] == (("below", "x"),)
    assert bounds_of(Metre) == bounds_of(str) == ({}, (), ())


def test_bounds_beside_what_is_no_number_are_a_slip_of_the_writer() -> None:
    @checked_numbers
    def call(name: Annotated[str, Above(0)]) -> None:
        pass

    with pytest.raises(TypeError, match="name is bounded and is no number"):
        call("x")


def test_a_word_is_one_of_those_allowed() -> None:
    require_one_of("axis", "log", ("linear", "log"))
    require_one_of("polarity", -1, (1, -1))
    for bad in ("logs", 2, None, ["log"], np.zeros(2)):
        says = refusal(lambda bad=bad: require_one_of("axis", bad, ("linear", "log")))  # type: ignore[misc]
        assert says.endswith(" Allowed: linear, log")


ENDS = (Above(1.0), AtLeast(1.0), Below(1.0), AtMost(1.0))


@pytest.mark.parametrize("end", ENDS)
@pytest.mark.parametrize(
    "value",
    [
        *(1.0, np.nextafter(1.0, 0.0), np.nextafter(1.0, 2.0), -math.inf, math.inf, math.nan),
        *(0.0, -0.0, 5e-324, 1.7976931348623157e308, -1.7976931348623157e308),
    ],
)
def test_what_is_taken_at_a_glance_is_what_the_full_look_takes(end: Any, value: float) -> None:
    """Alone and in an array, to the last bit of a bound."""

    def bounded(kind: Any) -> Callable[[Any], Any]:
        def taken(value: Any) -> Any:
            return value

        taken.__annotations__ = {"value": Annotated[kind, end]}
        return checked_numbers(taken)

    alone, many = bounded(Metre), bounded(MetreArray)
    words = bounds_of(Annotated[Metre, end])[0]
    value, good = float(value), 2.0 if isinstance(end, Above | AtLeast) else 0.0
    try:
        require("value", value, M, **words)
        refused = ""
    except InputError as error:
        refused = str(error)
    given = np.array([good, value])
    if refused:
        assert refusal(lambda: alone(value)) == refused
        assert refusal(lambda: many(given)) == refused
    else:
        assert alone(value) == value
        assert many(given) is given


def test_a_named_tuple_is_checked_where_it_is_made() -> None:
    places = np.array([[1.0, 2.0]])
    made = Row(2, places)  # type: ignore[arg-type]
    assert (type(made.width), made.places is places, made.is_held) == (float, True, False)
    assert "width = inf" in refusal(lambda: Row(math.inf, places))
    assert "places = nan" in refusal(lambda: Row(2.0, np.array([1.0, math.nan]), is_held=True))
    with pytest.raises(TypeError):
        Row(2.0)  # type: ignore[call-arg]
