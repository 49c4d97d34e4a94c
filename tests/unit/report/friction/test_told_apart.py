"""What is shown of telling laws apart: words of the terminal, and where the map has its cells."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from tests.unit.report.printed import printed

from squeezefilm.analysis.friction.tell_apart import (
    BestExperiment,
    Condition,
    Overall,
    ToldApart,
)
from squeezefilm.report.friction.told_apart import show_told_apart, told_apart

SLOW, FAST = Condition(0.3, 0.01, 1e-6), Condition(0.3, 0.1, 2e-6)
PAIRS = (("persson", "gaussian"), ("following", "rigid"))
D = np.zeros((2, 2, 3, 2))
D[1, 0, 2, 1] = 2.0
D[0, 1] = np.nan
FOUND = ToldApart(
    forces=np.array([0.3, 1.0]), speeds=np.array([0.01, 0.03, 0.1]),
    amplitudes=np.array([1e-6, 2e-6]), pairs=PAIRS, discriminability=D,
    best=(
        BestExperiment(
            PAIRS[0], "height_law", SLOW, (0.5, 0.5), 0.0, (SLOW, FAST), (1.2, 1.0), 1.0
        ),
        BestExperiment(
            PAIRS[1], "finger.tangential_stiffness", FAST, (0.2, 0.7), 2.0, (SLOW, FAST),
            (0.3, 1.0), 4.0,
        ),
    ),
    overall=(
        Overall("height_law", SLOW, 0.5), Overall("finger.tangential_stiffness", FAST, 0.84),
    ),
    noise=0.05, draws=16,
)  # fmt: skip


def test_the_best_experiments_are_said_pair_by_pair() -> None:
    lines = printed(lambda: show_told_apart(FOUND))
    assert lines == [
        "Which measurement would tell the laws apart",
        "pair one condition µ′/µ right",
        "heights: persson or gaussian 0.3 N, 10 mm/s, 1 µm 0.50 or 0.50 50 %",
        "shear: following or rigid 0.3 N, 100 mm/s, 2 µm 0.20 or 0.70 84 %",
        "Which ratio of two measurements with the same finger would",
        "pair two conditions ratio right",
        "heights: persson or gaussian 0.3 N, 10 mm/s, 1 µm "
        "over 0.3 N, 100 mm/s, 2 µm 1.20 or 1.00 69 %",
        "shear: following or rigid 0.3 N, 10 mm/s, 1 µm "
        "over 0.3 N, 100 mm/s, 2 µm 0.30 or 1.00 98 %",
        "One condition for all laws of the heights: 0.3 N, 10 mm/s, 1 µm; right in 50 % of the "
        "cases for the two told worst.",
        "One condition for all shear elements: 0.3 N, 100 mm/s, 2 µm; right in 84 % of the cases "
        "for the two told worst.",
        "“Right” is how often whoever measures would choose the right one of the two; 50 % is "
        "guessing. The rest of the finger is drawn (16 fingers); a measured µ′/µ is taken to "
        "scatter by 5 %, which is assumed.",
    ]


def test_a_map_has_force_up_and_the_speeds_within_each_amplitude() -> None:
    figure = told_apart(SimpleNamespace(apart=FOUND))
    first, second = figure.axes[:2]
    assert [one.get_title("left") for one in (first, second)] == [
        "heights: persson or gaussian",
        "shear: following or rigid",
    ]
    cells = second.images[0].get_array()
    assert cells.shape == (2, 6)
    # 0.3 N is the first row, 2 µm the second half, 100 mm/s the last of it.
    assert cells[0, 5] == pytest.approx(84.1, abs=0.1)
    assert cells[1, 0] == pytest.approx(50)
    assert np.isnan(np.ma.filled(first.images[0].get_array()[1], np.nan)).all()
    words = figure.get_suptitle().replace("\u00a0", " ").replace("\n", " ")
    assert words == (
        "One measurement tells shear elements best: following or rigid, at 0.3 N, 100 mm/s, 2 µm, "
        "right in 84 % of the cases"
    )
