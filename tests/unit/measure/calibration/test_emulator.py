"""An emulator is as good as it says, also where the answer is not a line."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import qmc

from squeezefilm.core.errors import InputError
from squeezefilm.measure.calibration.emulator import (
    _fitted,
    _matern,
    emulator_of,
    least_points,
)


def truth(x: np.ndarray) -> np.ndarray:
    """A line, a saturating answer and a constant."""
    return np.stack([x @ [0.1, 0.02, -0.05], np.tanh(2 * x[:, 0]) * 0.1, 0 * x[:, 0] + 3.0], axis=1)


def test_the_stated_error_is_the_real_one() -> None:
    x = 2 * qmc.Sobol(3, rng=1).random(64) - 1
    emulator = emulator_of(x, truth(x))
    fresh = np.random.default_rng(2).uniform(-0.95, 0.95, (500, 3))
    off = np.sqrt(np.mean((emulator(fresh) - truth(fresh)) ** 2, axis=0))
    assert off[0] < 1e-6
    assert off[1] < 2e-3
    assert off[2] < 1e-9
    assert np.all(off < 4 * emulator.errors + 1e-9)


def test_more_points_are_better() -> None:
    errors = []
    fresh = np.random.default_rng(3).uniform(-0.95, 0.95, (400, 3))
    for count in (32, 128):
        x = 2 * qmc.Sobol(3, rng=1).random(count) - 1
        off = emulator_of(x, truth(x))(fresh)[:, 1] - truth(fresh)[:, 1]
        errors.append(np.sqrt(np.mean(off**2)))
    assert errors[1] < errors[0] / 3


def test_too_few_points_are_refused() -> None:
    with pytest.raises(InputError, match=str(least_points(3))):
        emulator_of(np.zeros((10, 3)), np.zeros((10, 1)))


def test_what_the_trend_leaves_is_carried_by_the_weights() -> None:
    """y = line + covariance · weights but for the nugget, and the weights know no line."""
    x = 2 * qmc.Sobol(2, rng=2).random(32) - 1
    y = np.tanh(2 * x[:, 0]) * 0.1 + 0.3 * x[:, 1]
    line, lengths, weights = _fitted(x, y)
    trend = np.column_stack([np.ones(32), x])
    left = y - trend @ line - _matern(x / lengths, x / lengths) @ weights
    nugget = float(left @ weights / (weights @ weights))
    assert 0 < nugget < 1e-3
    assert left == pytest.approx(nugget * weights, abs=1e-9)
    assert trend.T @ weights == pytest.approx(np.zeros(3), abs=1e-7 * np.abs(weights).sum())
    # Of two points a unit apart, in Matérn's form of order 5/2.
    apart = 1 + np.sqrt(5) + 5 / 3
    assert _matern(np.zeros((1, 2)), np.array([[0.6, 0.8]]))[0, 0] == pytest.approx(
        apart * np.exp(-np.sqrt(5))
    )
