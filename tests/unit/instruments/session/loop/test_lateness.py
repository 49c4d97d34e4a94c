"""Lateness as it is read off a loop's rows."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.loop.lateness import Lateness, lateness_of

PERIOD = 1e-3


def rows_of(ticks: list[int], late: list[float]) -> np.ndarray:
    rows = np.zeros((len(ticks), len(column.COLUMNS)))
    rows[:, column.TICK], rows[:, column.LATENESS] = ticks, late
    return rows


def test_ticks_that_are_missing_were_lost_and_cost_the_longest_lateness() -> None:
    found = lateness_of(rows_of([1, 2, 6], [1e-5, 3e-5, 2e-5]), PERIOD)
    assert (found.made, found.lost) == (3, 4)
    assert found.share_made == 3 / 7
    # Three ticks were lost before the last.
    assert found.longest == pytest.approx(3 * PERIOD + 2e-5)
    assert found.p50 == 2e-5
    assert 2e-5 < found.p99 < found.p99_9 <= 3e-5


def test_before_the_first_tick_nothing_is_a_number() -> None:
    nothing = lateness_of(rows_of([], []), PERIOD)
    assert (nothing.made, nothing.lost) == (0, 0)
    assert all(map(math.isnan, (nothing.share_made, nothing.p50, nothing.longest)))
    assert Lateness(0, 0).made == 0
