"""Quantity texts with a slip: what is offered reads as what was probably meant."""

from __future__ import annotations

import math
import re

import pytest

from squeezefilm.core.errors import QuantityError
from squeezefilm.core.quantities import Unit, parse_quantity
from squeezefilm.core.quantities.slips import probably_meant


@pytest.mark.parametrize(
    ("text", "symbol", "meant"),
    [
        ("82,5 mm", "m", [82.5e-3]),
        ("8,250 kg/m3", "kg/m3", [8.25, 8250.0]),
        ("1,000,000 Hz", "Hz", [1e6]),
        ("8.250,5 kg/m3", "kg/m3", [8250.5]),
        ("8 250 kg/m3", "kg/m3", [8250.0]),
        ("8'250 kg/m3", "kg/m3", [8250.0]),
        ("20 Vpp", "V", [10.0]),
        ("20 V p-p", "V", [10.0]),
        ("20 V (peak-to-peak)", "V", [10.0]),
        ("3 um pp", "m", [1.5e-6]),
        ("10 Vrms", "V", [10 * math.sqrt(2)]),
        ("20 Vp", "V", [20.0]),
        ("0.6 micron", "m", [0.6e-6]),
        ("0.6 µ", "m", [0.6e-6]),
        ("2 inch", "m", [50.8e-3]),
        ("5 mil", "m", [127e-6]),
        ("10 Mpsi", "Pa", [6.894757e10]),
        ("83 MM", "m", [83e-3]),
        ("70 gpa", "Pa", [70e9]),
        ("34 KHZ", "Hz", [34e3]),
        ("20 C", "K", [20.0]),
        ("20 gram", "N", [0.1961330]),
        ("20 grams", "kg", [0.02]),
        ("125 db", "dB", [125.0]),
        ("125 dB(SPL)", "dB", [125.0]),
        ("100 g", "N", [0.980665]),
        ("100 gf", "N", [0.980665]),
        ("2.7 g/cc", "kg/m3", [2700.0]),
        ("8250 kg per m3", "kg/m3", [8250.0]),
        ("5×10⁻⁶ m", "m", [5e-6]),
        ("5 x 10^-6 m", "m", [5e-6]),
        ("−247 pm/V", "m/V", [-247e-12]),
        ("83 mm ± 0.1 mm", "m", [83e-3]),
        ("83±0.1 mm", "m", [83e-3]),
        ("~83 mm", "m", [83e-3]),
        ("83/2 mm", "m", [41.5e-3]),
        ("50 percent", "1", [0.5]),
    ],
)
def test_what_is_offered_is_what_was_meant(text: str, symbol: str, meant: list[float]) -> None:
    with pytest.raises(QuantityError, match="cannot be read: ") as caught:
        parse_quantity(text, Unit(symbol))
    message = str(caught.value)
    assert message.startswith(f"'{text}'")
    offered = re.findall(r'"([^"]+)"', message[message.index("; write ") :])
    # Five digits are shown, which is what a person would write.
    assert [parse_quantity(one, Unit(symbol)) for one in offered] == pytest.approx(meant, rel=5e-5)


@pytest.mark.parametrize("text", ["2 q", "2 V", "eighty mm", "", "mm 2", "80-85 mm", "1,2,3 mm"])
def test_nothing_is_offered_where_nothing_can_be_guessed(text: str) -> None:
    with pytest.raises(QuantityError) as caught:
        parse_quantity(text, Unit("m"))
    assert "cannot be read" not in str(caught.value)


def test_only_readings_of_the_wanted_dimension_are_offered() -> None:
    assert any("mm" in one for _, texts in probably_meant("2 inch", "V", ("V",)) for one in texts)
    with pytest.raises(QuantityError, match="unknown unit 'inch'; allowed here: V, mV"):
        parse_quantity("2 inch", Unit("V"))
