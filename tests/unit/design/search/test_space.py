from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.design.search.space import Choice, Space, number, step

SPACE = Space(
    "strips",
    (
        Choice("substrate", ("steel", "glass", "brass")),
        step("thickness", {"steel": (2e-3, 1e-3), "glass": (5e-4,), "brass": (1e-3,) * 2}, "m",
             "substrate"),
        number("length", 0.05, 0.08, "m"),
        number("width", 0.04, 0.04, "m"),
    ),
)  # fmt: skip


def test_what_is_chosen_lies_in_its_range() -> None:
    draw = np.random.default_rng(3)
    for _ in range(200):
        values = SPACE.at({one.name: draw.random() for one in SPACE.free})
        assert 0.05 <= float(values["length"]) <= 0.08
        assert values["width"] == 0.04
        stock = {"steel": (1e-3, 2e-3), "glass": (5e-4,), "brass": (1e-3,)}
        assert values["thickness"] in stock[str(values["substrate"])]
        assert all(0 <= one <= 1 for one in SPACE.shares(values))


def test_places_lead_back_to_the_values() -> None:
    draw = np.random.default_rng(4)
    for _ in range(200):
        values = SPACE.at({one.name: draw.random() for one in SPACE.free})
        again = SPACE.at(SPACE.places(values))
        assert again.keys() == values.keys()
        for name, value in values.items():
            assert again[name] == (value if isinstance(value, str) else pytest.approx(value))


def test_what_is_fixed_is_not_free() -> None:
    assert [one.name for one in SPACE.free] == ["substrate", "thickness", "length"]


def test_ranges_that_are_none_are_refused() -> None:
    with pytest.raises(InputError, match="length may be from 80 mm to 50 mm"):
        number("length", 0.08, 0.05, "m")
    with pytest.raises(InputError, match="of glass is an empty list"):
        step("thickness", {"glass": ()}, "m", "substrate")


def test_what_lies_beside_differs_in_one_number_by_what_can_be_built() -> None:
    values = SPACE.at({"substrate": 0.0, "thickness": 0.9, "length": 0.5})
    beside = [SPACE.at(one) for one in SPACE.beside(SPACE.places(values))]
    apart = sorted(round((float(one["length"]) - 0.065) * 1e4) for one in beside)
    assert apart == [-10, -3, -1, 1, 3, 10]
    assert all({**one, "length": 0.065} == {**values, "length": 0.065} for one in beside)
