"""One style for numbers: units, signs and shares."""

from __future__ import annotations

import pytest

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import (
    HZ,
    M,
    changed,
    printable,
    shown,
    signed,
    span,
    unit_stays,
)


@pytest.mark.parametrize(
    ("value", "unit", "said"),
    [
        (2e-6, M, "2 µm"), (600e-9, M, "0.6 µm"), (0.058, HZ, "0.058 Hz"), (0.0, HZ, "0 Hz"),
        (33.58e3, HZ, "33.58 kHz"), (-0.058, HZ, "-0.058 Hz"), (0.5, si.Unit("N"), "0.5 N"),
    ],
)  # fmt: skip
def test_a_quantity_is_said_in_the_unit_of_the_field(
    value: float, unit: si.Unit, said: str
) -> None:
    assert shown(value, unit) == said


def test_changes_have_their_sign_and_shares_their_space() -> None:
    assert [signed(one, HZ) for one in (-248.0, 12.0)] == ["−248 Hz", "+12 Hz"]
    assert [changed(one) for one in (-0.041, 0.02)] == ["−4.1 %", "+2.0 %"]
    assert [si.percent(0.614), si.percent(0.614, 1)] == ["61 %", "61.4 %"]
    assert span(0.04, 0.786) == "0.04–0.79"


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ("a gap of 2.29 um at 3 us", "a gap of 2.29 µm at 3 µs"),
        ("drifts by -248 Hz (-0.5)", "drifts by −248 Hz (−0.5)"),
        ("R1 164 ohm, 22.06 kohm", "R1 164 Ω, 22.06 kΩ"),
        ("7743 kg/m3 on 10 mm2 and 1.3e-11 m2/N", "7743 kg/m³ on 10 mm² and 1.3e-11 m²/N"),
        # What is no unit and no sign stays.
        ("model m2, out/m3, 5 m2x", "model m2, out/m3, 5 m2x"),
        ("P1-91, 2026-11-23, 1e-05, --all", "P1-91, 2026-11-23, 1e-05, --all"),
        ("5 umbrellas, -x", "5 umbrellas, -x"),
        ("10.1063/1.13-2 1/-3", "10.1063/1.13-2 1/-3"),
    ],
)  # fmt: skip
def test_messages_are_printed_in_the_same_style(written: str, said: str) -> None:
    assert printable(written) == said


def test_no_line_ends_between_a_number_and_its_unit() -> None:
    kept = unit_stays("at 24.5 mm of 3 parts, 0.23 % and 8.04 VA; µ′/µ = 0.31 in 5 models")
    assert kept.split(" ") == [
        "at", "24.5\u00a0mm", "of", "3", "parts,", "0.23\u00a0%", "and", "8.04\u00a0VA;",
        "µ′/µ\u00a0=\u00a00.31", "in", "5", "models",
    ]  # fmt: skip
