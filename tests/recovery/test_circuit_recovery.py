"""Circuits are recovered from made sweeps, and intervals hold them as often as they say.

The tests of the campaign are those of the requirement: 2 000 runs a kind, 93.5 to 96.5 %. They
print coverage and the median half width, relative to the value, which the campaign keeps.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.measure.fits.circuit.impedance import fit_impedance

from .circuit_sweeps import KINDS, compared, coverage, made_sweep


def test_a_sweep_with_little_noise_gives_back_what_it_was_made_of() -> None:
    made = made_sweep(np.random.default_rng(5), 0.001, missing=0.2, gap=0.1)
    assert made.sweep.frequency.size < 301
    for name, (true, estimate) in compared(made, fit_impedance(made.sweep)).items():
        assert estimate.value == pytest.approx(true, rel=0.01), name


@pytest.mark.parametrize(
    "runs", [pytest.param(8, marks=pytest.mark.slow), pytest.param(40, marks=pytest.mark.nightly)]
)
@pytest.mark.parametrize("name", sorted(KINDS))
def test_intervals_hold_the_truth(name: str, runs: int) -> None:
    held, failed = coverage(KINDS[name], runs, seed=7)
    assert failed == 0
    for quantity, one in held.items():
        assert one.inside / runs >= 0.95 - 4 * math.sqrt(0.95 * 0.05 / runs), quantity


@pytest.mark.campaign
@pytest.mark.parametrize("name", sorted(KINDS))
def test_intervals_of_2000_circuits_cover_as_often_as_they_say(name: str) -> None:
    runs = 2000
    held, failed = coverage(KINDS[name], runs, seed=190 + sorted(KINDS).index(name))
    print(f"{name}: {failed} of {runs} gave another number of branches, or none")
    for quantity, one in held.items():
        share, width = one.inside / runs, float(np.median(one.half_widths))
        print(f"{name}: {quantity}: {share:.4f}, median half width {100 * width:.3g} %")
    for quantity, one in held.items():
        assert 0.935 <= one.inside / runs <= 0.965, quantity
