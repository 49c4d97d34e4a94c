"""The compiled core of fits and grids against sums written out, SciPy and NumPy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from squeezefilm.study.psychometric import kernel

SHAPES = (kernel.LOGISTIC, kernel.GAUSSIAN, kernel.GUMBEL)
# No two numbers alike, so that none can be taken for another.
X = np.array([0.4, 1.1, 1.9, 2.6, 3.7])
K = np.array([3.0, 0.0, 9.0, 17.0, 13.0])
N = np.array([11.0, 7.0, 16.0, 19.0, 13.0])
THETA = np.array([2.1, math.log(1.7), 0.04, 0.23])
BETA = np.array([1.5, 9.0, 2.5, 6.0])


def shape_at(code: int, z: float) -> float:
    """S, from its definition: ½ at 0, 0.05 and 0.95 one width apart."""
    if code == kernel.LOGISTIC:
        return float(stats.logistic.cdf(2 * math.log(19) * z))
    if code == kernel.GAUSSIAN:
        return float(stats.norm.cdf(2 * stats.norm.ppf(0.95) * z))
    reach = math.log(math.log(0.05) / math.log(0.95))
    return 1 - 0.5 ** math.exp(reach * z)


def density(theta: np.ndarray, code: int, k: np.ndarray = K, n: np.ndarray = N) -> float:
    """ln likelihood and ln prior, summed one by one."""
    total = 0.0
    for x, yes, trials in zip(X, k, n, strict=True):
        s = shape_at(code, (x - theta[0]) / math.exp(theta[1]))
        psi = theta[3] + (1 - theta[2] - theta[3]) * s
        total += yes * math.log(psi) + (trials - yes) * math.log(1 - psi)
    for rate, (a, b) in zip(theta[2:], BETA.reshape(2, 2), strict=True):
        total += (a - 1) * math.log(rate) + (b - 1) * math.log(1 - rate)
    return total


@pytest.mark.parametrize("code", SHAPES)
def test_a_shape_and_its_rest(code: int) -> None:
    for z in (-1.2, -0.3, 0.0, 0.2, 0.9):
        s, rest = kernel.sigmoid(code, z)
        assert s == pytest.approx(shape_at(code, z), abs=1e-13)
        assert rest == pytest.approx(1 - shape_at(code, z), abs=1e-13)
    for far, end in ((-1e6, 0.0), (1e6, 1.0)):
        assert kernel.sigmoid(code, far) == pytest.approx((end, 1 - end), abs=1e-12)


@pytest.mark.parametrize("code", SHAPES)
def test_the_density_is_the_sum_written_out(code: int) -> None:
    found = kernel.log_density(code, THETA, BETA, X, K, N)
    assert found == pytest.approx(density(THETA, code), rel=1e-12)
    p = kernel.probabilities(code, THETA, X)
    s = np.array([shape_at(code, (x - THETA[0]) / 1.7) for x in X])
    assert p == pytest.approx(0.23 + 0.73 * s, abs=1e-13)


def test_a_grid_holds_the_likelihood_of_each_cell() -> None:
    thresholds, widths = np.array([1.5, 2.2, 2.9]), np.log([0.8, 1.9])
    lapses, guesses = np.array([0.01, 0.06, 0.5]), np.array([0.1, 0.3, 0.5, 0.6])
    found = kernel.grid_log_likelihood(
        kernel.GUMBEL, thresholds, widths, lapses, guesses, X, K, N
    )  # fmt: skip
    assert found.shape == (3, 2, 3, 4)
    flat = np.ones(4)
    for (i, j, a, b), value in np.ndenumerate(found):
        if lapses[a] + guesses[b] >= 1:
            assert value == -math.inf
            continue
        theta = np.array([thresholds[i], widths[j], lapses[a], guesses[b]])
        expected = kernel.log_density(kernel.GUMBEL, theta, flat, X, K, N)
        assert value == pytest.approx(expected, rel=1e-12)
