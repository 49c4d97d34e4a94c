"""Measured thresholds beside the rival senses: what the table, the words and the figure say."""

from __future__ import annotations

import numpy as np
import pytest
from tests.unit.drawn import words

from squeezefilm.measure.recordings.kinds import DetectionThresholds, Told
from squeezefilm.validation.populations import RIVALS, DetectionComparison
from squeezefilm.validation.report.published import (
    DETECTION_HEAD,
    detection_figure,
    detection_rows,
    detection_words,
)

pytestmark = pytest.mark.usefixtures("figures_as_described")

MEASURED = DetectionThresholds(
    np.array([4e-3, 1e-3, 0.5e-3]), np.array([0.04, 0.005, 0.002]), 0.7, 0.05, 12,
    Told(name="thresholds"),
)  # fmt: skip
COMPARED = DetectionComparison(
    MEASURED, tuple((rival, np.array([0.05, 0.005, 0.004])) for rival in RIVALS)
)


def test_a_row_has_the_median_and_every_rival() -> None:
    rows = detection_rows(COMPARED)
    assert rows[0] == ("4 mm", "12.5 Hz", "0.0400", "0.0500", "0.0500", "0.0500", "1.25")
    assert [row[-1] for row in rows] == ["1.25", "1.00", "2.00"]
    assert all(len(row) == len(DETECTION_HEAD) for row in rows)


def test_what_is_assumed_is_said() -> None:
    measured, near, assumed = detection_words(COMPARED)
    assert "12 people, 50 mm/s, 0.7 N" in measured
    assert near.startswith("2 of 3 medians within a factor of 1.5, the farthest by 2.000")
    assert "0.5 is assumed" in assumed


def test_the_figure_has_the_medians_and_every_rival_at_both_speeds() -> None:
    figure = detection_figure(COMPARED)
    here, twice = figure.axes
    assert (here.get_title(loc="left") or here.get_title()).endswith("50 mm/s")
    assert "100 mm/s: predicted" in (twice.get_title(loc="left") or twice.get_title())
    points = here.get_lines()[-1]
    assert points.get_xdata() == pytest.approx([4.0, 1.0, 0.5])
    assert points.get_ydata() == pytest.approx(MEASURED.amplitude)
    lines = here.get_lines()[:3]
    assert all(line.get_ydata() == pytest.approx(lines[0].get_ydata()) for line in lines)
    legend = twice.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == [*RIVALS, "measured"]
    assert "detected" in words(figure.get_suptitle())
