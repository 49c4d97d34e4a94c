"""The table of what is usual: complete, ordered, and wider at each step."""

import dataclasses
import math
import re
import typing

import pytest

from squeezefilm.core import hard_limits
from squeezefilm.core import quantities as si
from squeezefilm.core.materials import ElasticMaterial, Gas, Piezoceramic, PiezoConstants
from squeezefilm.physics import display
from squeezefilm.physics.contact.finger import fingertip
from squeezefilm.physics.plate import layout
from squeezefilm.physics.plate.round_layout import DiscPlate
from squeezefilm.physics.plausibility import expected
from squeezefilm.physics.plausibility.checks import Bound, bounds, shown

_M, _KG3 = si.Unit("m"), si.Unit("kg/m3")


def test_a_range_lies_in_the_wider_one_and_has_a_reason() -> None:
    for name, bound in bounds().items():
        for low, high in (bound.usual, bound.possible):
            assert low < high, name
        assert bound.possible[0] <= bound.usual[0], name
        assert bound.usual[1] <= bound.possible[1], name
        assert bound.reason, name
        assert bound.usual_text, name


def test_a_bound_of_a_field_is_of_one_that_is_there_in_its_unit_and_within_its_hard_limit() -> None:
    modules = (display, fingertip, layout, hard_limits)
    classes = {
        name: one
        for module in modules
        for name, one in vars(module).items()
        if dataclasses.is_dataclass(one)
    }
    for cls in (ElasticMaterial, Gas, PiezoConstants, Piezoceramic, DiscPlate):
        classes[cls.__name__] = cls
    for law in typing.get_args(fingertip.ContactLaw):
        classes[law.__name__] = law
    for of, bound in bounds().items():
        owner, dot, name = of.partition(".")
        if not dot:
            continue
        hint = typing.get_type_hints(classes[owner], include_extras=True)[name]
        unit = si.unit_of(hint)
        assert unit is not None, of
        assert unit.dimension == bound.unit.dimension, of
        for limit in getattr(hint, "__metadata__", ()):
            if isinstance(limit, hard_limits.HardLimit) and not bound.size:
                assert bound.possible[0] == -math.inf or bound.usual[0] >= limit.least, of
                assert bound.usual[1] == math.inf or bound.usual[1] <= limit.most, of


def test_every_ratio_has_its_bound_and_every_bound_that_is_no_field_its_ratio() -> None:
    text = typing.cast(str, expected.__loader__.get_source(expected.__name__))  # type: ignore[union-attr]
    named = set(re.findall(r'"([a-zA-Z][^".]* [^".]*|[ds]\d\d over [ds]\d\d)"', text)) & set(
        bounds()
    )
    assert named == {of for of in bounds() if "." not in of}


def test_the_ends_count_and_signs_and_nothings_where_it_says_so() -> None:
    bound = Bound("a", _M, (1.0, 2.0), (0.1, 20.0), "because")
    assert [bound.is_usual(x) for x in (0.99, 1.0, 2.0, 2.01, -1.5, 0.0)] == [
        False, True, True, False, False, False,
    ]  # fmt: skip
    assert [bound.is_possible(x) for x in (0.09, 0.1, 20.0, 21.0)] == [False, True, True, False]
    signed = dataclasses.replace(bound, size=True)
    assert signed.is_usual(-1.5)
    assert not signed.is_usual(-0.5)
    none = dataclasses.replace(bound, or_none=True)
    assert none.is_usual(0.0)
    assert not none.is_usual(0.5)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (2e-6, _M, "2 µm"),
        (20e3, _KG3, "20 000 kg/m³"),
        (2.7, _KG3, "2.7 kg/m³"),
        (400.0, si.Unit("W/kg"), "0.4 W/g"),
        (1e6, si.Unit("V/m"), "1 kV/mm"),
        (1.5e-12, si.Unit("m2/N"), "1.5e-12 m²/N"),
        (0.2, si.Unit("1"), "0.2"),
        (60e3, si.Unit("1"), "60 000"),
    ],
)
def test_values_are_shown_as_people_write_them(value: float, unit: si.Unit, text: str) -> None:
    assert shown(value, unit) == text


def test_ranges_open_at_one_end() -> None:
    assert Bound("a", _M, (1e-3, math.inf), (0, math.inf), "").usual_text == "1 mm or more"
    assert Bound("a", _M, (0, 1e-3), (0, math.inf), "").usual_text == "1 mm or less"
