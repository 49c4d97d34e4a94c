"""What the command line prints of an analysis: one screen, and the rest where it is asked for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from squeezefilm.core.kit.numbers import printable
from squeezefilm.design.analysis.analyze import Analysis
from squeezefilm.design.analysis.report import terminal
from squeezefilm.design.analysis.report.decisions import sensitivity_rows
from squeezefilm.design.analysis.report.rows import decision_rows, unsaid_warnings

LINES = 66


def test_what_one_decides_from_is_one_screen(
    plate_analysis: Analysis, printed: Callable[[], str]
) -> None:
    terminal.show_analysis(plate_analysis)
    text = printed()
    assert len(text.splitlines()) < LINES
    words = " ".join(text.split())
    places = [words.index(f"{one.kind} {one.text[:40]}") for one in plate_analysis.verdict]
    warned = [words.index(printable(one)[:40]) for one in unsaid_warnings(plate_analysis)]
    numbers = words.index("Key numbers")
    assert places + warned == sorted(places + warned)
    assert max(warned) < numbers
    for group in decision_rows(plate_analysis):
        assert set(group.said) <= set(group.rows)
        for row in group.rows:
            assert (f"{row[0]} {row[1]}" in words[numbers:]) is (row not in group.said)
    said = {row[0] for group in decision_rows(plate_analysis) for row in group.said}
    assert said == {"Place of the finger", "µ′/µ over the active area", "Sound at 0.5 m"}
    assert "timoshenko" not in words
    assert "--all prints the warnings in full" in words


def test_all_of_it_is_printed_where_it_is_asked_for(
    plate_analysis: Analysis, printed: Callable[[], str]
) -> None:
    terminal.show_analysis(plate_analysis, whole=True)
    words = " ".join(printed().split())
    for text in unsaid_warnings(plate_analysis):
        assert " ".join(printable(text).split()) in words
    for part in ("piezoelectric_solid_3d (used)", "timoshenko_beam_plane_strain", "shear_plate",
                 "Squeeze number", "Thermal resistance", "Slew rate"):  # fmt: skip
        assert part in words


def test_what_each_value_does_is_printed_where_only_that_is_asked_for(
    plate_analysis: Analysis, printed: Callable[[], str]
) -> None:
    terminal.show_analysis(plate_analysis, sensitivities=True)
    words = " ".join(printed().split())
    table = words[words.index("What each value does") :]
    shifts = plate_analysis.sensitivities
    assert shifts is not None
    for row in sensitivity_rows(shifts):
        assert row[0] in table
    assert f"µ′/µ is {shifts.relative_friction:.2f} as described." in table
    assert f"--json has all {len(shifts.rows)} values." in table
    assert "timoshenko_beam_plane_strain" not in words[: words.index("What each value does")]


def test_a_long_warning_is_cut_between_statements() -> None:
    assert terminal.shortened("short") == "short"
    assert terminal.shortened("One is 2.5 mm. Two follows") == "One is 2.5 mm. Two follows"
    long = "a word, " * 40
    assert terminal.shortened(long) == long
    assert terminal.shortened(f"{long}ends. Another") == f"{long}ends."
    assert terminal.shortened(f"One. {long}") == f"One. {long}"
    assert terminal.shortened(f"One. A {long}") == "One."
    assert terminal.shortened(f"one; two; {long}") == "one; two"


def test_hostile_names_are_printed_and_not_obeyed(
    hostile_analysis: Analysis, printed: Callable[[], str]
) -> None:
    terminal.show_analysis(hostile_analysis)
    text = printed()
    assert "[bold]" in text
    assert "\u202e" not in text


def test_a_display_without_texture(analysis_of: Any, printed: Callable[[], str]) -> None:
    terminal.show_analysis(analysis_of("no-voltage"), whole=True)
    text = printed()
    assert "Finest grating" not in text
    assert "Sound" not in text
