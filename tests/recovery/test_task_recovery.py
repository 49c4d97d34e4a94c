"""Weber fractions and exponents of made-up people are recovered, and intervals hold them as often
as they say: of each person, of the population and of its spread.

The campaign's tests are those of the requirement; they print what they found.
"""

from __future__ import annotations

import math

import pytest

from .task_people import EVERY, coverage


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["constant", "magnitude", "ranking", "adjustment", "pairs"])
def test_intervals_hold_the_truth(name: str) -> None:
    """Of designs that are quick to fit; the campaign has the others."""
    runs = 40
    found = coverage(name, runs)
    print(name, found)
    for what, count in (("persons", 8 * runs), ("population", runs), ("spread", runs)):
        # Too wide is no fault that so few runs could show; some tasks tell no spread.
        least = 0.95 - 4 * math.sqrt(0.95 * 0.05 / count)
        assert found[what] >= least or math.isnan(found[what]), what


@pytest.mark.campaign
@pytest.mark.parametrize("name", EVERY)
def test_intervals_of_many_studies_hold_the_truth(name: str) -> None:
    # Lines and settings are cheap; the others integrate a grid for each of 8 people.
    cheap = name in ("magnitude", "ranking", "adjustment")
    found = coverage(name, 2000 if cheap else 500)
    print(name, found)
    # Of 500 studies chance alone leaves 0.93 to 0.97; each person's interval of ranks holds 0.92.
    for what in ("persons", "population", "spread"):
        assert 0.91 <= found[what] <= 0.985 or math.isnan(found[what]), what
    # Of a few dozen answers each: same-different without catch trials errs most, by -5 %.
    assert abs(found["error"]) < 0.06
    assert found["named"] < 0.03
