"""What the command line prints of an analysis: one screen, and the rest where it is asked for."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import pytest

from squeezefilm.core.kit.numbers import printable
from squeezefilm.design.analysis.analysis import Analysis
from squeezefilm.design.analysis.report import page
from squeezefilm.design.analysis.report.first_screen import (
    MOST_DOUBTS,
    first_screen,
    first_statement,
)
from squeezefilm.design.analysis.report.folds import folds
from squeezefilm.design.analysis.report.rows import sensitivity_rows

LINES, WORDS, NUMBERS = 30, 120, 6


@pytest.mark.parametrize(
    "name",
    [
        "biet2008-plate",
        *(
            pytest.param(name, marks=pytest.mark.slow)
            for name in ("biet2008-stator", "not-driven", "no-voltage")
        ),
    ],
)
def test_what_one_decides_from_is_one_screen(
    name: str, analysis_of: Callable[[str], Analysis], printed: Callable[[], str]
) -> None:
    analysis = analysis_of(name)
    screen = first_screen(analysis)
    said = [screen.sentence, *screen.doubts, screen.next_step]
    cells = [cell for row in screen.numbers for cell in row]
    assert 0 < len(" ".join([*said, *cells]).split()) <= WORDS
    assert len(screen.numbers) <= NUMBERS
    assert len(screen.doubts) <= MOST_DOUBTS
    page.show_analysis(analysis)
    text = printed()
    assert len(text.splitlines()) < LINES
    words = " ".join(text.split())
    places = [words.index(printable(one)) for one in said]
    assert places == sorted(places)
    assert all(" ".join(" ".join(row).split()) in words for row in screen.numbers)
    assert ("as Biet (2008) asks" in words) == analysis.display.name.startswith("biet2008")
    assert "timoshenko" not in words


def test_no_number_of_the_first_screen_is_said_again(plate_analysis: Analysis) -> None:
    first = {row[0] for row in first_screen(plate_analysis).numbers}
    assert len(first) == NUMBERS
    behind = [
        row[0] for fold in folds(plate_analysis) for table in fold.tables for row in table.rows
    ]
    assert not first & set(behind)


@pytest.mark.slow
def test_all_of_it_is_printed_where_it_is_asked_for(
    analysis_of: Callable[[str], Analysis], printed: Callable[[], str]
) -> None:
    analysis = dataclasses.replace(analysis_of("biet2008-plate"), whole=True)
    page.show_analysis(analysis)
    words = " ".join(printed().split())
    for finding in analysis.findings:
        assert " ".join(printable(finding.text).split()) in words
    for part in ("piezoelectric_solid_3d (used)", "timoshenko_beam_plane_strain", "Squeeze number",
                 "Thermal resistance", "Slew rate", "Rival models give"):  # fmt: skip
        assert part in words


def test_what_each_value_does_is_printed_where_only_that_is_asked_for(
    plate_analysis: Analysis, printed: Callable[[], str]
) -> None:
    page.show_analysis(dataclasses.replace(plate_analysis, effort="quick"))
    words = " ".join(printed().split())
    table = words[words.index("What each value does") :]
    shifts = plate_analysis.sensitivities
    assert shifts is not None
    for row in sensitivity_rows(shifts):
        assert row[0] in table
    assert f"--json has all {len(shifts.rows)} values." in table


def test_a_statement_ends_where_the_next_begins() -> None:
    assert first_statement("short") == "short."
    assert first_statement("One is 2.5 mm. Two follows.") == "One is 2.5 mm."
    assert first_statement("one; two") == first_statement("one: two") == "one."
    assert first_statement("one (by hand) is so.") == "one."
    assert first_statement("Mode (7,0) is not driven: so.") == "Mode (7,0) is not driven."


def test_hostile_names_are_printed_and_not_obeyed(
    hostile_analysis: Analysis, printed: Callable[[], str]
) -> None:
    page.show_analysis(hostile_analysis)
    text = printed()
    assert "[bold]" in text
    assert "\u202e" not in text


def test_a_display_without_texture(analysis_of: Any, printed: Callable[[], str]) -> None:
    page.show_analysis(dataclasses.replace(analysis_of("no-voltage"), whole=True))
    text = printed()
    assert "Finest grating" not in text
    assert "Sound" not in text
