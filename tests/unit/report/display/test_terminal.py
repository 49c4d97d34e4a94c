"""What the command line prints of an analysis: one screen, and the rest where it is asked for."""

from __future__ import annotations

from typing import Any

import pytest

from squeezefilm.analysis.analyze import Analysis
from squeezefilm.report.display import terminal
from squeezefilm.report.display.rows import decision_rows, unsaid_warnings
from squeezefilm.report.kit.numbers import printable

LINES, COLUMNS = 66, 80


@pytest.fixture(autouse=True)
def plain_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("FORCE_COLOR", "COLUMNS", "TTY_COMPATIBLE", "TTY_INTERACTIVE"):
        monkeypatch.delenv(name, raising=False)


def printed(capsys: pytest.CaptureFixture[str]) -> str:
    captured = capsys.readouterr()
    assert captured.err == ""
    assert "\x1b" not in captured.out
    assert all(len(line) <= COLUMNS for line in captured.out.splitlines())
    return captured.out


def test_what_one_decides_from_is_one_screen(
    plate_analysis: Analysis, capsys: pytest.CaptureFixture[str]
) -> None:
    terminal.show_analysis(plate_analysis)
    text = printed(capsys)
    assert len(text.splitlines()) < LINES
    words = " ".join(text.split())
    places = [words.index(f"{one.kind} {one.text[:40]}") for one in plate_analysis.verdict]
    warned = [words.index(printable(one)[:40]) for one in unsaid_warnings(plate_analysis)]
    numbers = words.index("Key numbers")
    assert places + warned == sorted(places + warned)
    assert max(warned) < numbers
    for group in decision_rows(plate_analysis):
        for label, value, _ in group.rows:
            said = label.startswith(("Place", "µ′/µ over", "Sound"))
            assert (f"{label} {value}" in words[numbers:]) is not said
    assert "timoshenko" not in words
    assert "--all prints the warnings in full" in words


def test_all_of_it_is_printed_where_it_is_asked_for(
    plate_analysis: Analysis, capsys: pytest.CaptureFixture[str]
) -> None:
    terminal.show_analysis(plate_analysis, whole=True)
    words = " ".join(printed(capsys).split())
    for text in unsaid_warnings(plate_analysis):
        assert " ".join(printable(text).split()) in words
    for part in ("piezoelectric_solid_3d (used)", "timoshenko_beam_plane_strain", "shear_plate",
                 "paper2008", "film-open", "Squeeze number", "Thermal resistance"):  # fmt: skip
        assert part in words
    assert words.count("carries the finger at a mean gap") == 1


def test_a_long_warning_is_cut_between_words() -> None:
    assert terminal.shortened("short") == "short"
    cut = terminal.shortened("a word, " * 40)
    assert cut.endswith(("word …", "a …"))
    assert len(cut) <= 142


def test_hostile_names_are_printed_and_not_obeyed(
    hostile_analysis: Analysis, capsys: pytest.CaptureFixture[str]
) -> None:
    terminal.show_analysis(hostile_analysis)
    text = printed(capsys)
    assert "[bold]" in text
    assert "\u202e" not in text


def test_a_display_without_texture(analysis_of: Any, capsys: pytest.CaptureFixture[str]) -> None:
    terminal.show_analysis(analysis_of("no-voltage"), whole=True)
    text = printed(capsys)
    assert "Finest grating" not in text
    assert "Sound" not in text
