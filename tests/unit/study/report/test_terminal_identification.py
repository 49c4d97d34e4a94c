"""What the terminal says of an analysed study, and of how many people a study needs."""

from __future__ import annotations

import numpy as np
import pytest
from tests.unit.printed import printed

from squeezefilm.core.kit.numbers import printable
from squeezefilm.study.identification.analysis import (
    IdentificationAnalysis,
    analyze_identification,
)
from squeezefilm.study.identification.power import PowerCurve
from squeezefilm.study.report.terminal_analysis import show_analyses, show_power
from squeezefilm.study.report.words import key_rows, read_first
from squeezefilm.study.simulated.planned_power import PlannedPower


@pytest.fixture(scope="module")
def analysis() -> IdentificationAnalysis:
    """One person: 8 mm is named rightly three times of four."""
    stimulus, choice = [0] * 4 + [1] * 4, [0, 0, 0, 0, 1, 1, 1, 0]
    return analyze_identification(
        [0] * 8, stimulus, choice, ("4 mm", "8 mm"), origin="simulated", resamples=20
    )


def test_each_display_has_its_confusions_and_main_numbers(
    analysis: IdentificationAnalysis,
) -> None:
    lines = printed(lambda: show_analyses({"plate": analysis, "ring": analysis}))
    half = lines[: len(lines) // 2]
    assert lines[len(half) :] == ["ring: simulated answers", *half[1:]]
    first = [printable(" ".join(one.split())) for one in read_first(analysis)]
    assert half[: 1 + len(first)] == ["plate: simulated answers", *first]
    rest = half[1 + len(first) :]
    assert rest[:3] == [
        "Answered \\ presented 4 mm 8 mm",
        "4 mm 100 % (4) 25 % (1)",
        "8 mm 0 % (0) 75 % (3)",
    ]
    rows = [printable(" ".join(map(printable, row))) for row in key_rows(analysis)]
    notes = [printable(note) for note in analysis.notes]
    assert rest[3:] == [*rows, *notes]
    assert "Participants 1 8 main trials" in half
    assert any(note.startswith("intervals over people: there is one") for note in notes)


def test_names_are_not_broken_on_a_narrow_terminal(analysis: IdentificationAnalysis) -> None:
    lines = printed(lambda: show_analyses({"plate": analysis}), 60)
    assert any(line.startswith("p against unrelated answers") for line in lines)
    long = "an unusually long name of a grating that somebody gave"
    named = analyze_identification([0, 0], [0, 1], [0, 1], (long, "b"), resamples=20)
    assert any(
        line.startswith(long) for line in printed(lambda: show_analyses({"plate": named}), 80)
    )


def power(needed: int | None) -> PlannedPower:
    """Three sizes of study."""
    curve = PowerCurve(
        np.array([4, 6, 8]), np.array([0.125, 0.816, 0.95]), np.array([0.08, 0.76, 0.9]),
        np.array([0.2, 0.87, 0.98]), 400, 0.05, 0.8, needed, 8,
    )  # fmt: skip
    return PlannedPower(
        "small", "plate", "fingertip", 0, "mine", "simulated", "8 mm", "10 mm", curve, 0.3, "score"
    )


def test_power_is_said_by_size_with_how_many_are_needed() -> None:
    lines = printed(lambda: show_power(power(6)))
    assert lines == [
        "8 mm against 10 mm on plate, SIMULATED",
        "people studies that find it 95 % bounds of the simulation",
        "4 12 % 8 to 20 %",
        "6 82 % 76 to 87 %",
        "8 95 % 90 to 98 %",
        "6 people reach 80 % power.",
        "One-sided test over people at 0.05; the pool's own score is 0.3 (0 for nothing); 400 "
        "studies a size, of simulated participants 'fingertip': what they assume, this assumes. "
        "Finger: mine.",
    ]


def test_heads_of_power_are_not_broken_on_a_narrow_terminal() -> None:
    lines = printed(lambda: show_power(power(6)), 30)
    rows = [number for number, line in enumerate(lines) if line.startswith("4 ")]
    assert "people" in " ".join(lines[2 : rows[0]]).split()


def test_too_few_people_are_told() -> None:
    assert printed(lambda: show_power(power(None)))[5] == "8 people do not reach 80 % power."
