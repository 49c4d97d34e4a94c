"""Values along the lines of a figure, where its SVG draws them."""

from __future__ import annotations

import re

import numpy as np
import pytest
from matplotlib.figure import Figure

from squeezefilm.core.kit import style

SPOT = re.compile(
    r'<g class="read"><circle cx="([\d.]+)" cy="([\d.]+)" r="5.0"/>'
    r'<text x="\d+" y="\d+">f &lt;kHz&gt;: (\S+), w: (\S+)</text></g>'
)


def spots(draw: str) -> list[tuple[float, ...]]:
    """Place (pt) and values of each spot of a figure of one line from (1, 0) to (100, 2)."""
    figure = Figure(figsize=(4.0, 3.0))
    axes = figure.add_axes((0.25, 0.25, 0.5, 0.5))
    axes.set(xlim=(1, 100), ylim=(0, 2), xlabel="f <kHz>", ylabel="w", xscale="log")
    if draw == "line":
        axes.plot([1, 100], [0, 2])
    elif draw == "points":
        axes.plot([1, 10, np.nan, 1000], [0, 1, 1, 1], "o", linestyle="None")
    axes.axhline(1.0)
    axes.plot([], [])
    return [
        tuple(map(float, values)) for values in SPOT.findall(style.svg(figure, "a", "A figure"))
    ]


def test_spots_lie_along_a_line_with_the_values_that_are_drawn_there() -> None:
    found = spots("line")
    assert len(found) == 2 + int(np.hypot(144, 108) / 10)
    for across, down, x, y in found:
        share = (across - 72) / 144
        assert share == pytest.approx((162 - down) / 108, abs=1e-3)
        assert (x, y) == pytest.approx((10 ** (2 * share), 2 * share), rel=3e-3, abs=2e-3)


def test_points_without_a_line_have_a_spot_each_within_the_axes() -> None:
    assert [spot[2:] for spot in spots("points")] == [(1, 0), (10, 1)]


def test_a_mark_across_the_axes_has_none() -> None:
    assert spots("mark") == []


def test_axes_over_others_name_the_scale_that_they_share() -> None:
    figure = Figure(figsize=(4.0, 3.0))
    axes = figure.add_subplot()
    axes.set(xlabel="f <kHz>", ylabel="amplitude")
    axes.twinx().set_ylabel("w")
    figure.axes[1].plot([1, 2], [0, 1], "o", linestyle="None")
    found = SPOT.findall(style.svg(figure, "a", "A figure"))
    assert [spot[2:] for spot in found] == [("1", "0"), ("2", "1")]
