"""What recordings are made of is recovered by the fits, and intervals hold it as often as said.

The tests of the campaign are those of the requirement: 2 000 runs, 93.5 to 96.5 %. They print the
coverage and the median length of every interval, which the campaign keeps.
"""

from __future__ import annotations

import math

import pytest

from .measured_designs import DESIGNS, coverage


@pytest.mark.parametrize(
    "design",
    [
        pytest.param(name, marks=[pytest.mark.slow] * name.startswith("voltage sweeps"))
        for name in DESIGNS
        if name.endswith(", noise")
    ],
)
def test_intervals_hold_the_truth(design: str) -> None:
    runs = 12
    for name, found in coverage(design, runs).items():
        assert found.share >= 0.95 - 5 * math.sqrt(0.95 * 0.05 / runs), name


@pytest.mark.nightly
@pytest.mark.parametrize("design", sorted(DESIGNS))
def test_intervals_hold_the_truth_whatever_is_wrong(design: str) -> None:
    runs = 100
    for name, found in coverage(design, runs, first=100_000).items():
        assert found.share == pytest.approx(0.95, abs=4 * math.sqrt(0.95 * 0.05 / runs)), name


@pytest.mark.campaign
@pytest.mark.parametrize("design", sorted(DESIGNS))
def test_intervals_of_2000_runs_cover_as_often_as_they_say(design: str) -> None:
    for name, found in coverage(design, 2000).items():
        print(f"{design}: {name}: {found.share:.4f}, median length {found.length:.3g} of it")
        assert 0.935 <= found.share <= 0.965, name
