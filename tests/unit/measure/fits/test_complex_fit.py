"""The least squares under every fit of an admittance."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.complex_fit import (
    Model,
    Prior,
    correlation_time,
    fit_complex,
    noise_floor,
    sweep_adequacy,
)

X = np.linspace(0, 1, 200)
RANDOM = np.random.default_rng(3)


def white(size: int) -> si.ComplexArray:
    return RANDOM.standard_normal(size) + 1j * RANDOM.standard_normal(size)


def line(p: si.FloatArray) -> tuple[si.ComplexArray, si.ComplexArray]:
    """p0 + i p1 x."""
    return p[0] + 1j * p[1] * X, np.array([np.ones(X.size), 1j * X])


MODEL: Model = line


def test_a_line_is_found_with_the_standard_errors_of_a_line() -> None:
    noise = 0.01
    exact = line(np.array([1.0, 1.0]))[0]
    size = np.abs(exact)
    fit = fit_complex(line, np.array([0.5, 0.2]), exact + noise * size * white(X.size))
    assert fit.parameters == pytest.approx([1.0, 1.0], abs=4e-3)
    expected = noise / np.sqrt([np.sum(size**-2), np.sum((X / size) ** 2)])
    assert np.sqrt(np.diag(fit.covariance)) == pytest.approx(expected, rel=0.15)
    assert fit.spread == pytest.approx(noise, rel=0.15)
    estimate = fit.estimate(lambda p: float(p[0] ** 2), "1")
    assert estimate.standard_error == pytest.approx(2 * expected[0], rel=0.15)


def test_relative_noise_does_not_pull_the_fit_down() -> None:
    """Weights of the noisy data would: by the square of the noise, here 0.01."""
    errors = []
    for _ in range(40):
        data = line(np.array([1.0, 1.0]))[0] * (1 + 0.1 * white(X.size))
        errors.append(fit_complex(line, np.array([1.0, 1.0]), data).parameters[0] - 1)
    assert np.mean(errors) == pytest.approx(0, abs=4 * np.std(errors) / math.sqrt(40))


def test_a_prior_holds_what_the_data_do_not_tell() -> None:
    def blind(p: si.FloatArray) -> tuple[si.ComplexArray, si.ComplexArray]:
        curve, slopes = line(p[:2])
        return curve, np.vstack([slopes, np.zeros(X.size)])

    data = line(np.array([1.0, 1.0]))[0] * (1 + 0.01 * white(X.size))
    prior = Prior(np.array([0.0, 0.0, 7.0]), np.array([np.inf, np.inf, 0.5]))
    fit = fit_complex(blind, np.array([1.0, 1.0, 6.0]), data, prior=prior)
    assert fit.parameters[2] == pytest.approx(7.0)
    assert math.sqrt(fit.covariance[2, 2]) == pytest.approx(0.5)
    assert fit.parameters[0] == pytest.approx(1.0, abs=0.01)


def test_neighbours_that_err_alike_are_told_from_noise() -> None:
    smooth = 0.1 * np.exp(6j * X)
    assert correlation_time(smooth + 1e-3 * white(X.size)) > 20
    assert correlation_time(white(400)) == 1.0
    assert correlation_time(np.zeros(20, dtype=complex)) == 1.0


def test_a_floor_of_noise_is_told_and_none_is_invented() -> None:
    size = np.exp(4 * X)  # from 1 to 55
    smooth = 3.0 * np.exp(6j * X)
    found = [noise_floor(smooth + 0.01 * np.hypot(size, 5.0) * white(200), size) for _ in range(40)]
    assert 3.0 < np.median(found) < 8.0
    relative = [noise_floor(smooth + 0.01 * size * white(200), size) for _ in range(200)]
    assert np.mean(np.array(relative) > 0) < 0.02
    assert noise_floor(np.zeros(200, dtype=complex), size) == 0.0
    assert noise_floor(white(4), size[:4]) == 0.0


def test_the_same_noise_everywhere_does_not_drown_what_is_small() -> None:
    """A resonance's foot, a thousandth of its top: with relative noise alone its intervals would
    be those of the foot's noise."""

    def two(p: si.FloatArray) -> tuple[si.ComplexArray, si.ComplexArray]:
        rows = np.array([np.exp(-7 * X), np.ones(X.size)]).astype(complex)
        return p @ rows, rows

    hits, fits = 0, []
    for _ in range(100):
        data = two(np.array([1.0, 1e-3]))[0] + 2e-3 * white(X.size)
        fits.append(fit_complex(two, np.array([1.0, 2e-3]), data))
        low, high = fits[-1].estimate(lambda p: float(p[0]), "1").interval
        hits += low < 1 < high
    assert all(fit.floor > 0 for fit in fits)
    assert 88 <= hits <= 100
    assert all(sweep_adequacy(fit, 1e3 * X, "It").adequate for fit in fits[:20])


def test_a_misfit_widens_intervals_and_is_said_with_its_place() -> None:
    good = line(np.array([1.0, 1.0]))[0] * (1 + 1e-3 * white(X.size))
    bad = good * (1 + 0.2 * np.exp(-(((X - 0.7) / 0.05) ** 2)))
    fits = [fit_complex(line, np.array([1.0, 1.0]), data) for data in (good, bad)]
    fine, missed = (sweep_adequacy(fit, 1e3 * X, "The line") for fit in fits)
    assert fine.adequate
    assert "as noise would" in fine.sentence
    assert not missed.adequate
    assert abs(float(missed.where.split()[1]) - 700) < 20
    assert "does not describe" in missed.sentence
    assert missed.residual > 5 * missed.noise
    widths = [fit.covariance[0, 0] / fit.spread**2 for fit in fits]
    assert widths[1] > 3 * widths[0]


def test_a_small_misfit_is_adequate_and_said() -> None:
    data = line(np.array([1.0, 1.0]))[0] * (1 + 0.008 * np.sin(6 * X))
    found = sweep_adequacy(fit_complex(line, np.array([1.0, 1.0]), data), 1e3 * X, "The line")
    assert found.adequate
    assert "widened" in found.sentence


def test_too_few_points_are_refused() -> None:
    with pytest.raises(InputError, match="points are too few"):
        fit_complex(line, np.array([1.0, 1.0]), np.ones(4, dtype=complex))
