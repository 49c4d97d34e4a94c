"""What the command line prints: readable at 80 columns, plain where nobody looks."""

from __future__ import annotations

import pytest

from squeezefilm.core.kit import terminal
from squeezefilm.core.kit.numbers import printable, shown
from squeezefilm.core.quantities import Unit


def test_progress_is_plain_lines_where_no_terminal_is(capsys: pytest.CaptureFixture[str]) -> None:
    with terminal.progress(enabled=True) as step:
        step("film\x1b[2J")
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err == "  film [2J …\n"


def test_progress_can_be_silent(capsys: pytest.CaptureFixture[str]) -> None:
    with terminal.progress(enabled=False) as step:
        step("film")
    captured = capsys.readouterr()
    assert captured.out == captured.err == ""


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.6e-6, "m", "0.6 µm"),
        (2e-6, "m", "2 µm"),
        (67e-9, "m", "67 nm"),
        (0.083, "m", "83 mm"),
        (0.5, "N", "0.5 N"),
        (5.51085e-4, "s", "0.5511 ms"),
        (34656.3, "Hz", "34.66 kHz"),
        (1.0302e-7, "m/V", "103 nm/V"),
        (0.0, "m", "0 m"),
        (1900, "1", "1900"),
    ],
)
def test_quantities_read_as_the_field_says_them(value: float, unit: str, text: str) -> None:
    assert shown(value, Unit(unit)) == text


def test_printable() -> None:
    assert printable("a\x1b[31m\n b\u202e") == "a [31m b"
