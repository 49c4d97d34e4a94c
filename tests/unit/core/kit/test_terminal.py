"""What the command line prints: readable at 80 columns, plain where nobody looks."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

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


def test_progress_at_a_terminal_is_a_line_that_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[str] = []

    @contextlib.contextmanager
    def status(_: object, begins: str) -> Iterator[Any]:
        said.append(begins)
        yield SimpleNamespace(update=lambda text: said.append(str(text)))
        said.append("gone")

    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setattr("rich.console.Console.status", status)
    with terminal.progress(enabled=True) as step:
        step("plate 3 of 7")
        # Brackets are no markup, and what would move the cursor is not sent.
        step("[red]\x1b[2J")
    assert said[:2] == ["starting", "plate 3 of 7 …"]
    assert said[2].startswith("[red]")
    assert "\x1b" not in said[2]
    assert said[3] == "gone"
