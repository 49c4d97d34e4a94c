"""The figure of a psychometric function: the curve, the answers and the threshold's interval."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from tests.unit.drawn import words

from squeezefilm.core.kit.style import BLUE, ORANGE
from squeezefilm.study.psychometric.function import PsychometricFunction
from squeezefilm.study.report.figures import psychometric_function

pytestmark = pytest.mark.usefixtures("figures_as_described")

PLACES = np.array([1.0, 2.0, 4.0, 11.0])


def fit(axis: Any) -> Any:
    return SimpleNamespace(
        function=PsychometricFunction("logistic", 3.0, 2.5, 0.5, 0.02, axis),
        intensity=PLACES, positive=np.array([5.0, 6.0, 36.0, 20.0]),
        trials=np.array([10.0, 10.0, 40.0, 20.0]), level=0.9,
        posterior_interval={"threshold": (2.25, 4.125), "width": (1.0, 9.0)}, falls=False, notes=(),
    )  # fmt: skip


@pytest.mark.parametrize("axis", ["linear", "log"])
def test_the_curve_reaches_over_all_intensities(axis: str) -> None:
    axes = psychometric_function(fit(axis)).axes[0]
    curve = axes.get_lines()[0]
    x = curve.get_xdata()
    if axis == "linear":
        # A little room on both sides, evenly spaced.
        assert x[[0, -1]] == pytest.approx([0.6, 11.4])
        assert np.diff(x) == pytest.approx(10.8 / 200)
    else:
        assert x[[0, -1]] == pytest.approx([1, 11])
        assert np.diff(np.log(x)) == pytest.approx(np.log(11) / 200)
        assert axes.xaxis.get_major_formatter()(2.5) == "2.5"
    assert axes.get_xscale() == axis
    assert to_hex(curve.get_color()) == BLUE
    # From guessing to what lapses leave; half way at the threshold.
    assert np.all(np.diff(curve.get_ydata()) > 0)
    assert 50 < curve.get_ydata()[0] < 55
    assert 95 < curve.get_ydata()[-1] < 98
    assert np.interp(3.0, x, curve.get_ydata()) == pytest.approx(74, abs=0.1)
    assert axes.get_ylim() == (-2, 103)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("intensity", "positive answers (%)")


def test_answers_are_points_as_large_as_they_are_many() -> None:
    axes = psychometric_function(fit("linear")).axes[0]
    (points,) = axes.collections
    assert np.asarray(points.get_offsets()).tolist() == [[1, 50], [2, 60], [4, 90], [11, 100]]
    assert points.get_sizes() == pytest.approx([65, 65, 200, 110])


def test_the_threshold_stands_on_its_interval_half_way_up() -> None:
    figure = psychometric_function(fit("linear"))
    _, interval, threshold = figure.axes[0].get_lines()
    assert list(interval.get_xdata()) == [2.25, 4.125]
    # Half of what lies between guessing (50 %) and lapses (98 %).
    assert interval.get_ydata() == pytest.approx([74, 74])
    assert threshold.get_xydata() == pytest.approx(np.array([[3, 74]]))
    assert {to_hex(one.get_color()) for one in (interval, threshold)} == {ORANGE}
    assert words(figure.get_suptitle()) == "The threshold is 3, with 90 % between 2.25 and 4.12"
    assert words(figure.get_supxlabel()) == (
        "Model: logistic function, guess rate 0.5, lapse rate 0.02; 80 trials; credible interval"
    )
