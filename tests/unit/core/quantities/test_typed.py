"""Values outside their bounds, refused in the unit that was typed."""

from __future__ import annotations

from typing import Annotated

import pytest

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

SHARE = Annotated[si.Dimensionless, si.AtLeast(0), si.Below(1)]
ROOM = Annotated[si.AbsoluteKelvin, si.AtLeast(273.15), si.AtMost(373.15)]
TURN = Annotated[si.Radian, si.Above(-3.2), si.AtMost(3.2)]


@pytest.mark.parametrize(
    ("text", "hint", "says"),
    [
        ("150 %", SHARE, "x = 150 % cannot be used: it must be at least 0 % and below 100 %"),
        (
            "101 degC",
            ROOM,
            "x = 101 degC cannot be used: it must be at least 0 degC and at most 100 degC",
        ),
        (
            "400 deg",
            TURN,
            "x = 400 deg cannot be used: it must be above -183.3 deg and at most 183.3 deg",
        ),
    ],
)
def test_bounds_are_said_in_the_unit_that_was_typed(text: str, hint: object, says: str) -> None:
    with pytest.raises(InputError) as refused:
        si.require_typed("x", text, hint)
    assert str(refused.value) == says
    assert refused.value.quantity == "x"


def test_what_is_within_its_bounds_or_in_the_units_own_words_is_left_to_others() -> None:
    for text, hint in (
        ("99 %", SHARE),
        ("20 degC", ROOM),
        ("500 K", ROOM),
        ("9 rad", TURN),
        ("7", SHARE),
    ):
        si.require_typed("x", text, hint)
    si.require_typed("x", "9000 mm", si.Metre)
