"""An interval is opened to its estimate, and an end that is not known stays so."""

from __future__ import annotations

import math

import pytest

from squeezefilm.study.psychometric.estimate import holding


@pytest.mark.parametrize(
    ("estimate", "low", "high"), [(0.5, 0.5, 3.0), (2.0, 1.0, 3.0), (4.0, 1.0, 4.0)]
)
def test_an_interval_is_opened_only_where_the_estimate_lies_outside(
    estimate: float, low: float, high: float
) -> None:
    found = holding(estimate, 1.0, 3.0, 0.95, "by hand")
    assert (found.value, found.low, found.high) == (estimate, low, high)


def test_an_end_that_is_not_known_stays_so() -> None:
    found = holding(1.0, math.nan, 0.5, 0.95, "by hand")
    assert math.isnan(found.low)
    assert found.high == 1.0
    found = holding(math.nan, 0.0, 0.5, 0.95, "by hand")
    assert (found.low, found.high) == (0.0, 0.5)
