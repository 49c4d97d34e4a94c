"""Sensitivities and tracks as drawn: bars as long as their shifts, lines where the modes are."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex

from squeezefilm.analysis.plate.sensitivity import Sensitivity, SensitivityTable, WorkingPoint
from squeezefilm.analysis.plate.tracking import ModeTrack, ModeTracks
from squeezefilm.report.kit.style import BLUE, LINES, MUTED, ORANGE
from squeezefilm.report.plate.sensitivity_figures import tornado, tracks

POINT = WorkingPoint((8, 0), 33e3, 10.0, 1e-7, 60.0, 34e3)


def row(name: str, shift: float, amplitude: float | None) -> Sensitivity:
    return Sensitivity(name, "changed", 33e3, shift, None, amplitude, 1.0)


def words(text: str) -> str:
    return text.replace("\u00a0", " ").replace("\n", " ")


def bars(axes: Any) -> list[tuple[float, float, str]]:
    """Height and signed length of every bar, from below, and its colour."""
    return sorted(
        (one.get_y() + one.get_height() / 2, one.get_width(), to_hex(one.get_facecolor()))
        for one in axes.patches
    )


def test_bars_are_sorted_and_as_long_as_their_shifts() -> None:
    rows = (
        row("low", -0.02, 0.5), row("high", 0.025, -0.25), row("open", 0.01, None),
        row("damping", 0.0, 0.3), row("still", 4.9e-5, 0.0), row("moves", 5e-5, 0.0),
    )  # fmt: skip
    figure = tornado(SensitivityTable(POINT, rows))
    assert words(figure.get_suptitle()) == (
        "Mode (8,0) at 33.00 kHz: high, changed, shifts it most: +2.5 %"
    )
    left, right = figure.axes
    names = [one.get_text() for one in left.get_yticklabels()]
    assert names == [f"{one}: changed" for one in ("high", "low", "open", "moves", "damping")]
    assert list(left.get_yticks()) == [4, 3, 2, 1, 0]
    assert bars(left) == [
        (pytest.approx(0), pytest.approx(0), ORANGE),
        (pytest.approx(1), pytest.approx(0.005), ORANGE),
        (pytest.approx(2), pytest.approx(1), ORANGE),
        (pytest.approx(3), pytest.approx(-2), BLUE),
        (pytest.approx(4), pytest.approx(2.5), ORANGE),
    ]
    assert [one[1] for one in bars(right)] == pytest.approx([30, 0, 0, 50, -25])
    assert [one.get_text() for one in left.texts] == [
        "+2.5 %",
        "−2.0 %",
        "+1.0 %",
        "+0.005 %",
        "0 %",
    ]
    assert [one.get_text() for one in right.texts] == ["−25 %", "+50 %", "no drive", "0 %", "+30 %"]
    # At the end of its bar, on the side where there is room.
    assert [one.xy[0] for one in left.texts] == pytest.approx([2.5, -2, 1, 0.005, 0])
    assert [one.get_ha() for one in left.texts] == ["left", "right", "left", "left", "left"]
    assert left.get_xlim() == pytest.approx((-4, 4))
    assert (left.get_xlabel(), right.get_xlabel()) == (
        "shift of frequency (%)", "amplitude per volt (%)",
    )  # fmt: skip
    low, high = left.get_ylim()
    assert low < -0.3
    assert high > 4.3


def test_a_bar_of_more_than_two_and_a_half_of_the_third_is_cut() -> None:
    rows = [row("a", 0.5, None), row("b", 0.04, 0.01), row("c", -0.02, 0.02)]
    left, right = tornado(SensitivityTable(POINT, tuple(rows))).axes
    # 2.6 times 2 %.
    assert [one[1] for one in bars(left)] == pytest.approx([-2, 4, 5.2])
    assert left.texts[0].get_text() == "+50 % (cut)"
    assert left.get_xlim() == pytest.approx((-8.32, 8.32))
    # Of two that are known none is the third.
    assert right.get_xlim() == pytest.approx((-3.2, 3.2))


def test_tracks_are_drawn_in_the_units_of_their_values() -> None:
    x = np.array([0.5e-3, 1e-3, 1.5e-3])
    whole = ModeTrack("(8,0)", np.array([30e3, 33e3, 36e3]), np.ones(3), True)
    other = ModeTrack("(0,5)", np.array([30.1e3, 33.1e3, 36.01e3]), np.ones(3), False)
    third = ModeTrack("(1,5)", np.array([31e3, 32e3, 33e3]), np.ones(3), False)
    figure = tracks(
        ModeTracks("ceramic_thickness", "m", x, 0.9e-3, 0.5e-3, (whole, other, third), 0.876)
    )
    assert words(figure.get_suptitle()) == (
        "3 modes followed by their shapes over the ceramic thickness"
    )
    assert "labels read at 500 um; least likeness from one value to the next 0.88" in words(
        figure.get_supxlabel()
    )
    (axes,) = figure.axes
    lines = axes.get_lines()
    for line, track in zip(lines, (other, third, whole), strict=False):
        assert np.asarray(line.get_xdata()) == pytest.approx([0.5, 1, 1.5])
        assert np.asarray(line.get_ydata()) == pytest.approx(track.frequency / 1e3)
    assert [to_hex(line.get_color()) for line in lines[:3]] == [MUTED, MUTED, LINES[0][0]]
    assert np.asarray(lines[3].get_xdata()) == pytest.approx([0.9, 0.9])
    assert [one.get_text() for one in axes.get_legend().get_texts()] == [
        "not driven (symmetry)", "(8,0), driven", "this plate",
    ]  # fmt: skip
    # Each line is named at its end, the names apart.
    assert [(one.get_text(), one.xy) for one in axes.texts] == [
        ("(1,5)", pytest.approx((1.5, 33))), ("(8,0)", pytest.approx((1.5, 36))),
        ("(0,5)", pytest.approx((1.5, 36.01))),
    ]  # fmt: skip
    heights = [one.xyann[1] for one in axes.texts]
    low, high = axes.get_ylim()
    assert heights[:2] == pytest.approx([33, 36])
    assert heights[2] - heights[1] == pytest.approx(0.034 * (high - low), rel=0.2)
    assert all(one.xyann[0] > 1.5 for one in axes.texts)
    assert axes.get_xlim() == pytest.approx((0.5, 1.5))
    assert axes.get_ylabel() == "frequency (kHz)"


def test_a_ratio_has_no_unit_and_each_driven_mode_its_line() -> None:
    x = np.array([0.25, 0.35])
    several = tuple(
        ModeTrack(f"({n},0)", np.array([30e3, 31e3]) + 1e3 * n, np.ones(2), True) for n in range(5)
    )
    figure = tracks(ModeTracks("poisson_ratio", "1", x, 0.3, 0.3, several, 1.0))
    (axes,) = figure.axes
    assert axes.get_xlabel() == "poisson ratio"
    assert axes.get_xlim() == pytest.approx((0.25, 0.35))
    assert "labels read at 0.3;" in words(figure.get_supxlabel())
    colors = [to_hex(line.get_color()) for line in axes.get_lines()[:5]]
    assert colors == [LINES[n % 4][0] for n in range(5)]
