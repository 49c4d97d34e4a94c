"""Sensitivities as drawn: bars as long as their shifts."""

from __future__ import annotations

from typing import Any

import pytest
from matplotlib.colors import to_hex
from tests.unit.drawn import words

from squeezefilm.core.kit.style import BLUE, ORANGE
from squeezefilm.design.plate.report.sensitivity_figures import tornado
from squeezefilm.design.plate.sensitivity import Sensitivity, SensitivityTable, WorkingPoint

pytestmark = pytest.mark.usefixtures("figures_as_described")

POINT = WorkingPoint((8, 0), 33e3, 10.0, 1e-7, 60.0, 34e3)


def row(name: str, shift: float, amplitude: float | None) -> Sensitivity:
    return Sensitivity(name, "changed", 33e3, shift, None, amplitude, 1.0)


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
