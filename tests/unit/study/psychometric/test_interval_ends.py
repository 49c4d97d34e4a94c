"""An interval is opened to its estimate, and an end that is not known stays so."""

from __future__ import annotations

import math

import numpy as np

from squeezefilm.study.psychometric.estimate import holding


def test_an_interval_is_opened_only_where_the_estimate_lies_outside() -> None:
    low, high = holding(np.array([0.5, 2.0, 4.0]), 1.0, 3.0)
    assert low.tolist() == [0.5, 1.0, 1.0]
    assert high.tolist() == [3.0, 3.0, 4.0]


def test_an_end_that_is_not_known_stays_so() -> None:
    low, high = holding(1.0, math.nan, 0.5)
    assert math.isnan(low)
    assert high == 1.0
    low, high = holding(math.nan, 0.0, 0.5)
    assert (low, high) == (0.0, 0.5)
