"""Leads, drift and both kinds of noise: 90 % intervals hold the truth, or the fit is inadequate.

The campaign (``pytest -m campaign -s tests/recovery/test_fixture_recovery.py``) has 200 sweeps of
each kind and prints what they hold.
"""

from __future__ import annotations

import pytest

from .fixture_sweeps import ASKED, MAKERS, coverage_of


@pytest.mark.slow
@pytest.mark.parametrize("name", MAKERS)
def test_a_few_sweeps_of_each_kind_hold_the_truth(name: str) -> None:
    found = coverage_of(MAKERS[name], 12, seed=3)
    assert (found.false_modes, found.refused) == (0, 0)
    for quantity in ASKED:
        assert found.share(quantity) >= 0.6, quantity


@pytest.mark.campaign
@pytest.mark.parametrize("name", MAKERS)
def test_200_sweeps_of_each_kind_hold_the_truth(name: str) -> None:
    found = coverage_of(MAKERS[name], 200, seed=48)
    shares = {quantity: f"{found.share(quantity):.3f}" for quantity in ASKED}
    print(f"{name}: {found.fits} adequate, {found.inadequate} inadequate, {found.refused} refused, "
          f"{found.false_modes} with a mode too many; {shares}")  # fmt: skip
    assert found.false_modes <= 1
    for quantity in ASKED:
        assert found.share(quantity) >= 0.85, quantity
