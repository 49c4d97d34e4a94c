"""Conditions of a sitting as they are typed: read in their units, refused in them."""

from __future__ import annotations

import math

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.lab.studying.sittings import conditions_of


def test_typed_conditions_are_read_in_their_units_and_numbers_are_si() -> None:
    typed = {"temperature": "22.5 degC", "relative_humidity": "45 %", "normal_force_asked": 0.5}
    found = conditions_of({**typed, "finger_orientation": "90 deg"}, "text", consented=True)
    assert found.temperature == pytest.approx(295.65)
    assert found.relative_humidity == pytest.approx(0.45)
    assert found.finger_orientation == pytest.approx(math.pi / 2)
    assert (found.normal_force_asked, found.consent) == (0.5, True)
    assert conditions_of({"temperature": 295.0}, "text", consented=False).temperature == 295.0


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        ("temperature", "-300 degC", "'-300 degC' is below absolute zero"),
        (
            "temperature", "95 degC",
            "95 degC cannot be used: it must be at least -20.15 degC and at most 59.85 degC",
        ),
        ("shoe_size", "43", "no field 'shoe_size'"),
    ],
)  # fmt: skip
def test_a_condition_is_refused_in_the_unit_that_was_typed(name: str, text: str, says: str) -> None:
    with pytest.raises(InputError, match=says):
        conditions_of({name: text}, "text", consented=False)
