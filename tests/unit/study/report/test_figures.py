"""Figures of an identification study: every number in its cell, every interval at its place."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.unit.drawn import words

from squeezefilm.study.report.figures import (
    confusion,
    data_of,
    sensitivity,
)

pytestmark = pytest.mark.usefixtures("figures_as_described")

NAMES = ("fine", "middle", "coarse")
COUNTS = np.array([[6, 1, 0], [2, 5, 3], [0, 4, 7]])  # rows answers, columns stimuli


def interval(low: float, high: float, **more: Any) -> Any:
    return SimpleNamespace(low=low, high=high, level=0.95, method="bootstrap", **more)


def matrix(counts: np.ndarray = COUNTS, **changes: Any) -> Any:
    with np.errstate(invalid="ignore"):
        percent = 100 * counts / counts.sum(axis=0)
    values: dict[str, Any] = {
        "answers": NAMES, "stimuli": NAMES, "counts": counts, "percent": percent,
        "is_square": True, "trials": int(counts.sum()), "chance": 1 / 3,
    }  # fmt: skip
    return SimpleNamespace(**{**values, **changes})


THURSTONE = SimpleNamespace(
    total=3.0, d_prime=np.array([2.0, 1.0]), positions=np.array([0.0, 2.0, 3.0]),
    criteria=np.array([1.0, 2.5]), low=np.array([1.5, 0.5]), high=np.array([2.5, 1.75]),
    level=0.95, interval_method="a-method", corrected=False, deviance=4.25, degrees_of_freedom=3,
    p_value=0.234,
)  # fmt: skip


def analysis(**changes: Any) -> Any:
    values: dict[str, Any] = {
        "origin": "made-up", "name": "a study", "participants": 4, "matrix": matrix(),
        "trials": 28,
        "proportion_correct": 18 / 28, "main_number": interval(0.5, 0.75), "permutation_p": 0.0004,
        "by_stimulus": [
            SimpleNamespace(stimulus=name, low=p - 0.125, high=p + 0.125, proportion_correct=p)
            for name, p in zip(NAMES, (0.75, 0.5, 0.625), strict=True)
        ],
        "participant_correct": np.array([0.5, 0.75, 0.75, 1.0]),
        "counts": np.array([COUNTS, COUNTS // 2]),
        "intervals": [interval(0.5, 0.75), interval(0.4, 0.8)],
        "sensitivity": THURSTONE, "notes": (),
    }  # fmt: skip
    return SimpleNamespace(**{**values, **changes})


def data(line: Any) -> list[list[float]]:
    return [[float(v) for v in line.get_xdata()], [float(v) for v in line.get_ydata()]]


def upright(axes: Any) -> list[tuple[float, float, float]]:
    """Place, bottom and top of the intervals that stand upright."""
    seen = [data(line) for line in axes.get_lines()]
    return [(x[0], *y) for x, y in seen if len(x) == 2 and x[0] == x[1]]


def test_the_small_print_counts_people_and_trials() -> None:
    assert data_of(analysis()) == "made-up answers, a study; 4 participants, 28 trials"
    assert "; 1 participant, " in data_of(analysis(participants=1))


def test_a_confusion_stands_in_its_cell() -> None:
    figure = confusion(analysis())
    # 18 of 28; of eight fine ones two, of ten middle ones four, of ten coarse ones three.
    assert words(figure.get_suptitle()) == (
        "64.3 % of the answers are right; middle is most often taken for coarse (40 %)"
    )
    (axes,) = figure.axes
    (image,) = axes.images
    shares = 100 * COUNTS / np.array([8, 10, 10])
    assert np.asarray(image.get_array()) == pytest.approx(shares)
    assert image.get_clim() == (0, 100)
    cells = {one.get_position(): one for one in axes.texts}
    assert {at: one.get_text() for at, one in cells.items()} == {
        (j, i): f"{shares[i, j]:.0f} %\n({COUNTS[i, j]})" if COUNTS[i, j] else "·"
        for i in range(3)
        for j in range(3)
    }
    # What is right is bold and framed.
    assert {at for at, one in cells.items() if one.get_weight() == "bold"} == {
        (0, 0), (1, 1), (2, 2),
    }  # fmt: skip
    assert [(*one.get_xy(), one.get_width(), one.get_height()) for one in axes.patches] == [
        (n - 0.5, n - 0.5, 1, 1) for n in range(3)
    ]
    for labels in (axes.get_xticklabels(), axes.get_yticklabels()):
        assert [one.get_text() for one in labels] == list(NAMES)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("simulated", "answered")


def test_a_stimulus_that_was_not_shown_has_no_shares() -> None:
    right = np.diag([3, 0, 5])
    figure = confusion(analysis(matrix=matrix(right, is_square=False)))
    assert "nothing is confused" in figure.get_suptitle()
    (axes,) = figure.axes
    assert [one.get_text() for one in axes.texts if one.get_position()[0] == 1] == ["–"] * 3
    assert not axes.patches
    assert {one.get_weight() for one in axes.texts} == {"normal"}


def test_stimuli_and_criteria_lie_on_the_decision_axis() -> None:
    figure = sensitivity(analysis())
    assert words(figure.get_suptitle()) == (
        "Δ′ = 3.00 from fine to coarse; middle and coarse lie closest, d′ = 1.00"
    )
    assert "G² = 4.2 with 3 degrees of freedom (p = 0.23)" in words(figure.get_supxlabel())
    top, below = figure.axes
    curves = [one for one in top.get_lines() if len(one.get_xdata()) > 2]
    for curve, place in zip(curves, (0, 2, 3), strict=True):
        x, y = np.asarray(curve.get_xdata()), np.asarray(curve.get_ydata())
        assert y == pytest.approx(np.exp(-((x - place) ** 2) / 2))
        # All that is more than a thirtieth of a peak is seen.
        assert x[0] < -2.5
        assert x[-1] > 3 + 2.5
    assert [(one.get_text(), one.get_position()[0]) for one in top.texts] == [
        ("fine", 0), ("middle", 2), ("coarse", 3),
    ]  # fmt: skip
    criteria = [data(one)[0][0] for one in top.get_lines() if len(one.get_xdata()) == 2]
    assert criteria == [1.0, 2.5]
    assert [one.get_text() for one in top.get_legend().get_texts()] == ["criteria"]
    assert upright(below) == [(0, 1.5, 2.5), (1, 0.5, 1.75)]
    assert [data(one) for one in below.get_lines() if one.get_marker() == "o"] == [
        [[0], [2]],
        [[1], [1]],
    ]
    assert [one.get_text() for one in below.get_xticklabels()] == [
        "fine – middle", "middle – coarse",
    ]  # fmt: skip
    assert below.get_xlim() == (-0.5, 1.5)
    assert below.get_title(loc="left") == "95 % intervals: a-method"
    corrected = SimpleNamespace(**{**vars(THURSTONE), "corrected": True})
    said = words(sensitivity(analysis(sensitivity=corrected)).get_supxlabel())
    assert "one trial per stimulus added (some never confused): d′ too low" in said


def test_what_was_not_computed_says_why() -> None:
    figure = sensitivity(analysis(notes=("times: none", "d′: too many"), sensitivity=None))
    assert figure.get_suptitle() == "No d′"
    assert figure.axes[0].texts[0].get_text() == "d′: too many"
    figure = sensitivity(analysis(sensitivity=None))
    assert figure.axes[0].texts[0].get_text() == "It was not computed."
