"""The compiled core of fits and grids against sums written out, SciPy and NumPy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from squeezefilm.study.psychometric import kernel

SHAPES = (
    kernel.LOGISTIC,
    kernel.GAUSSIAN,
    kernel.GUMBEL,
    kernel.REVERSED_GUMBEL,
    kernel.HYPERBOLIC_SECANT,
)
# No two numbers alike, so that none can be taken for another.
X = np.array([0.4, 1.1, 1.9, 2.6, 3.7])
K = np.array([3.0, 0.0, 9.0, 17.0, 13.0])
N = np.array([11.0, 7.0, 16.0, 19.0, 13.0])
THETA = np.array([2.1, math.log(1.7), 0.04, 0.23])
BETA = np.array([1.5, 9.0, 2.5, 6.0])
LOW, HIGH = np.array([-1.0, -2.0, 0.0, 0.0]), np.array([6.0, 2.5, 0.5, 0.49])
ALL = np.ones(4, dtype=bool)


def shape_at(code: int, z: float) -> float:
    """S, from its definition: ½ at 0, 0.05 and 0.95 one width apart."""
    if code == kernel.LOGISTIC:
        return float(stats.logistic.cdf(2 * math.log(19) * z))
    if code == kernel.GAUSSIAN:
        return float(stats.norm.cdf(2 * stats.norm.ppf(0.95) * z))
    if code == kernel.GUMBEL:
        reach = math.log(math.log(0.05) / math.log(0.95))
        return 1 - 0.5 ** math.exp(reach * z)
    if code == kernel.REVERSED_GUMBEL:
        return 1 - shape_at(kernel.GUMBEL, -z)
    reach = 2 * math.log(math.tan(math.pi / 2 * 0.95))
    return float(stats.hypsecant.cdf(reach * z))


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
def test_a_shape_its_rest_and_its_slope(code: int) -> None:
    h = 1e-5
    for z in (-1.2, -0.3, 0.0, 0.2, 0.9):
        s, rest, slope = kernel.sigmoid(code, z)
        assert s == pytest.approx(shape_at(code, z), abs=1e-13)
        assert rest == pytest.approx(1 - shape_at(code, z), abs=1e-13)
        centred = (shape_at(code, z + h) - shape_at(code, z - h)) / (2 * h)
        assert slope == pytest.approx(centred, rel=1e-6)
    for far, end in ((-1e6, 0.0), (1e6, 1.0)):
        s, rest, slope = kernel.sigmoid(code, far)
        assert (s, rest, slope) == pytest.approx((end, 1 - end, 0.0), abs=1e-12)


@pytest.mark.parametrize("code", SHAPES)
def test_the_density_is_the_sum_written_out(code: int) -> None:
    found = kernel.log_density(code, THETA, BETA, X, K, N)
    assert found == pytest.approx(density(THETA, code), rel=1e-12)
    p = kernel.probabilities(code, THETA, X)
    s = np.array([shape_at(code, (x - THETA[0]) / 1.7) for x in X])
    assert p == pytest.approx(0.23 + 0.73 * s, abs=1e-13)


@pytest.mark.parametrize("code", SHAPES)
def test_the_climb_follows_the_derivatives_of_the_density(code: int) -> None:
    gradient, information = np.empty(4), np.empty((4, 4))
    kernel._derivatives(code, THETA, BETA, X, K, N, gradient, information)
    h = 1e-6
    for at in range(4):
        up, down = THETA.copy(), THETA.copy()
        up[at] += h
        down[at] -= h
        assert gradient[at] == pytest.approx((density(up, code) - density(down, code)) / (2 * h),
                                             rel=1e-6, abs=1e-6)  # fmt: skip
    # Fisher's: the expected products of scores of the binomial counts, and the priors' curvature.
    scores = np.empty((4, X.size))
    psi = kernel.probabilities(code, THETA, X)
    for at in range(4):
        up, down = THETA.copy(), THETA.copy()
        up[at] += h
        down[at] -= h
        scores[at] = (
            kernel.probabilities(code, up, X) - kernel.probabilities(code, down, X)
        ) / (2 * h)  # fmt: skip
    expected = (scores * N / (psi * (1 - psi))) @ scores.T
    for at, rate, (a, b) in zip((2, 3), THETA[2:], BETA.reshape(2, 2), strict=True):
        expected[at, at] += (a - 1) / rate**2 + (b - 1) / (1 - rate) ** 2
    lower = np.tril_indices(4)
    assert information[lower] == pytest.approx(expected[lower], rel=1e-6)


def test_equations_of_four_unknowns_are_solved() -> None:
    made = np.random.default_rng(3).standard_normal((4, 4))
    matrix, right = made @ made.T + np.diag([1.0, 2.0, 3.0, 4.0]), np.array([1.0, -2.0, 0.5, 3.0])
    for size in (1, 2, 3, 4):
        # Only the lower triangle is filled.
        lower = np.tril(matrix)
        lower[np.triu_indices(4, 1)] = np.nan
        found = right.copy()
        assert kernel._solve(lower, found, size)
        assert found[:size] == pytest.approx(np.linalg.solve(matrix[:size, :size], right[:size]))
        assert np.array_equal(found[size:], right[size:])
    assert not kernel._solve(np.array([[1.0, 0.0], [2.0, 1.0]]), np.ones(2), 2)
    assert not kernel._solve(np.zeros((1, 1)), np.ones(1), 1)


@pytest.mark.parametrize("held", [(), (3,), (0, 2), (0, 1, 2)])
def test_the_climb_ends_where_no_free_parameter_leads_higher(held: tuple[int, ...]) -> None:
    free = ALL.copy()
    free[list(held)] = False
    theta = THETA.copy()
    top = kernel.maximise(kernel.Model(kernel.LOGISTIC, free, LOW, HIGH, BETA), theta, X, K, N)
    assert top == pytest.approx(density(theta, kernel.LOGISTIC), rel=1e-12)
    for at in range(4):
        if at in held:
            assert theta[at] == THETA[at]
            continue
        assert LOW[at] <= theta[at] <= HIGH[at]
        for step in (-1e-3, 1e-3):
            other = theta.copy()
            other[at] = np.clip(other[at] + step, LOW[at] + 1e-12, HIGH[at])
            assert density(other, kernel.LOGISTIC) <= top + 1e-7


def test_what_leads_beyond_a_bound_is_held_at_it() -> None:
    # All right far out and half below: no lapse and a guess rate that would be ½.
    k, n = np.array([20.0, 21.0, 30.0, 40.0, 40.0]), np.array([40.0, 40.0, 40.0, 40.0, 40.0])
    flat = np.ones(4)
    for top, wanted in ((0.45, 0.45), (0.3, 0.3)):
        high = HIGH.copy()
        high[3] = top
        theta = THETA.copy()
        kernel.maximise(kernel.Model(kernel.LOGISTIC, ALL, LOW, high, flat), theta, X, k, n)
        assert theta[3] == pytest.approx(wanted, abs=1e-9)
        assert theta[2] == pytest.approx(0.0, abs=1e-6)


def test_the_saturated_model_has_a_share_for_each_place() -> None:
    # Places of none or all have probability 1 and add nothing.
    k, n = np.array([0.0, 3.0, 8.0, 5.0]), np.array([4.0, 7.0, 8.0, 9.0])
    expected = 3 * math.log(3 / 7) + 4 * math.log(4 / 7) + 5 * math.log(5 / 9) + 4 * math.log(4 / 9)
    assert kernel.saturated(k, n) == pytest.approx(expected, rel=1e-13)


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


def test_every_row_of_answers_is_fitted_by_itself() -> None:
    answers = np.array([[3.0, 1.0, 9.0, 17.0, 13.0], [1.0, 2.0, 12.0, 18.0, 13.0]])
    free = np.array([True, True, True, False])
    model = kernel.Model(kernel.LOGISTIC, free, LOW, HIGH, BETA)
    deviances = np.full(2, np.nan)
    kernel.refit(model, THETA, X, N, answers, deviances)
    for row, k in enumerate(answers):
        best = THETA.copy()
        kernel.maximise(model, best, X, k, N)
        # Twice what the saturated model is likelier, without the priors.
        p = kernel.probabilities(kernel.LOGISTIC, best, X)
        likelihood = float(stats.binom.logpmf(k, N, p).sum())
        most = float(stats.binom.logpmf(k, N, k / N).sum())
        assert deviances[row] == pytest.approx(2 * (most - likelihood), rel=1e-9)
