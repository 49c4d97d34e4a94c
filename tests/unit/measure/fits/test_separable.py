"""Curves that are linear in most of their numbers: exact without noise, honest with it."""

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import (
    Estimate,
    interval_around,
    inverse_of,
    propagated,
)
from squeezefilm.measure.fits.least_squares import (
    SeparableFit,
    fit_nonlinear,
    fit_separable,
    linear_fit,
)

T = np.linspace(0.0, 2.0, 60)


def decay(shape):
    fall = np.exp(-shape[0] * T)
    columns = np.stack([fall, np.ones(T.size)], axis=1)
    bent = np.stack([-T * fall, np.zeros(T.size)], axis=1)[None]
    return columns, bent


def test_a_curve_without_noise_is_found_exactly() -> None:
    data = 3.0 * np.exp(-1.7 * T) - 0.4
    fit = fit_separable(decay, data, np.array([0.5]))
    assert fit.shape[0] == pytest.approx(1.7, rel=1e-6)
    assert fit.weights == pytest.approx([3.0, -0.4], rel=1e-6)


def test_complex_data_get_complex_weights() -> None:
    data = (3.0 - 2.0j) * np.exp(-1.7 * T) + 0.4j
    fit = fit_separable(decay, data, np.array([1.0]))
    assert fit.weights == pytest.approx([3.0 - 2.0j, 0.4j], rel=1e-6)
    assert fit.freedom == 2 * T.size - 5


def test_standard_errors_are_those_of_many_repetitions() -> None:
    random = np.random.default_rng(1)
    exact = 3.0 * np.exp(-1.7 * T) - 0.4
    fits = [
        fit_separable(decay, exact + 0.02 * random.standard_normal(T.size), np.array([1.0]))
        for _ in range(300)
    ]
    rates = [fit.shape[0] for fit in fits]
    said = np.mean([np.sqrt(fit.covariance[0, 0]) for fit in fits])
    assert said == pytest.approx(np.std(rates), rel=0.15)


def test_the_shape_stays_within_reach_of_its_start() -> None:
    data = 3.0 * np.exp(-1.7 * T) - 0.4
    assert fit_separable(decay, data, np.array([1.0]), reach=0.3).shape[0] <= 1.3


def test_fewer_data_than_numbers_are_refused() -> None:
    with pytest.raises(InputError, match="record more points"):
        linear_fit(np.ones((2, 2)), np.ones(2))


def test_nonlinear_numbers_agree_with_the_separable_ones() -> None:
    random = np.random.default_rng(2)
    data = 3.0 * np.exp(-1.7 * T) - 0.4 + 0.02 * random.standard_normal(T.size)
    one = fit_separable(decay, data, np.array([1.0]))
    other = fit_nonlinear(
        lambda at: at[1] * np.exp(-at[0] * T) + at[2] - data,
        np.array([1.0, 2.0, 0.0]),
        np.full(3, 1e-6),
    )
    assert other.numbers == pytest.approx(one.numbers, rel=1e-4)
    assert other.covariance == pytest.approx(one.covariance, rel=0.01)


def test_an_interval_of_a_logarithm_never_reaches_zero_and_an_inverse_may_be_open() -> None:
    low, high = interval_around(0.0, 3.0, 5, "1", logarithmic=True).interval
    assert 0 < low < 1 < high
    loss = interval_around(0.02, 0.02, 50, "1")
    quality = inverse_of(loss)
    assert quality.value == pytest.approx(50)
    assert quality.interval == (1 / loss.interval[1], float("inf"))


def test_a_product_has_the_error_of_its_factors() -> None:
    covariance = np.diag([0.01**2, 0.02**2])
    found = propagated(lambda n: n[0] * n[1], np.array([2.0, 5.0]), covariance, 1000, "m")
    assert isinstance(found, Estimate)
    assert found.standard_error == pytest.approx(np.hypot(5 * 0.01, 2 * 0.02), rel=1e-4)


def test_numbers_in_one_row_are_split_as_they_were_put_together() -> None:
    shape = np.array([1.0, 2.0])
    for weights in (np.array([3.0, 4.0, 5.0]), np.array([3.0 + 6j, 4.0 + 7j, 5.0 + 8j])):
        count = 2 + weights.size * (2 if np.iscomplexobj(weights) else 1)
        fit = SeparableFit(shape, weights, np.eye(count), weights, weights, 4, 1.0)
        assert fit.numbers.tolist() == [float(number) for number in range(1, count + 1)]
        again = fit.split(fit.numbers)
        np.testing.assert_array_equal(again[0], shape)
        np.testing.assert_array_equal(again[1], weights)
        wider = fit.with_widening(3.0).with_widening(2.0)
        np.testing.assert_allclose(wider.covariance, 4.0 * np.eye(count))
        assert wider.widening == 2.0
