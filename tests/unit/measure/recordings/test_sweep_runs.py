"""Where sweeps at several voltages begin and end in one table."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.measure.recordings.assembled import _runs


@pytest.mark.parametrize(
    ("frequency", "voltage", "runs"),
    [
        ([1, 2, 3], [5, 5, 5], [(0, 3)]),
        ([3, 2, 1], [5, 5, 5], [(0, 3)]),
        # Turned around with the last frequency again, or without.
        ([1, 2, 3, 3, 2, 1], [5] * 6, [(0, 3), (3, 6)]),
        ([1, 2, 3, 2, 1], [5] * 5, [(0, 3), (3, 5)]),
        ([1, 2, 3, 1, 2, 3], [5] * 6, [(0, 3), (3, 6)]),
        # Another voltage begins a sweep, whichever way the frequency goes on.
        ([1, 2, 3, 4, 5, 6], [5, 5, 5, 9, 9, 9], [(0, 3), (3, 6)]),
        ([1, 2, 3, 3, 4, 5], [5, 5, 5, 9, 9, 9], [(0, 3), (3, 6)]),
        ([4, 3, 1, 2], [5, 9, 9, 9], [(0, 1), (1, 3), (3, 4)]),
        ([2, 1, 3], [5, 5, 5], [(0, 2), (2, 3)]),
        ([7], [5], [(0, 1)]),
    ],
)
def test_a_sweep_is_at_one_voltage_and_goes_one_way(
    frequency: list[float], voltage: list[float], runs: list[tuple[int, int]]
) -> None:
    assert _runs(np.array(frequency, dtype=float), np.array(voltage, dtype=float)) == runs
