"""Weights of draws of finger and laws by what was observed of µ′/µ."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.measure.calibration.discrepancy import (
    BELIEVED,
    GRID,
    FrictionLikelihood,
    Touching,
    touching,
)
from squeezefilm.measure.calibration.friction_posterior import weighted
from squeezefilm.measure.fits.estimate import Observation

NO_MIXTURE = cast(Any, SimpleNamespace(inputs=()))


def seen(value: float, amplitude: float, error: float = 0.02) -> Observation:
    return Observation("relative_friction", value, error, {"vibration_amplitude": amplitude})


def test_the_likelihood_is_that_of_a_multivariate_normal() -> None:
    likelihood = FrictionLikelihood((seen(0.8, 1e-6), seen(0.5, 2e-6)))
    curves = np.array([[0.75, 0.55], [0.2, np.nan]])
    found = likelihood.logarithms(curves)
    scale = GRID[-1] * BELIEVED["relative_friction"]
    alike = np.exp(-np.log(2) / 0.7)
    covariance = scale**2 * np.array([[1, alike], [alike, 1]]) + 0.02**2 * np.eye(2)
    expected = multivariate_normal(cov=covariance).logpdf([0.05, -0.05])
    assert found[0, -1] == pytest.approx(expected)
    assert np.all(np.isneginf(found[1]))


def test_draws_that_agree_get_the_weight() -> None:
    curves = np.linspace(0, 1, 201)[:, None] * np.ones((1, 3))
    likelihood = FrictionLikelihood(tuple(seen(0.4, a) for a in (0.5e-6, 1e-6, 2e-6)))
    found = weighted(NO_MIXTURE, likelihood, np.zeros((201, 0)), curves)
    assert found.weights.sum() == pytest.approx(1)
    draws = found.resampled(500, seed=1)
    assert np.median(draws.curves) == pytest.approx(0.4, abs=0.02)
    assert 1 < found.effective < 100
    there = draws.with_error(draws.curves[:, :1], (Touching(1e-6),), seed=1)
    assert np.quantile(there, [0.05, 0.95]) == pytest.approx([0.38, 0.42], abs=0.025)


def test_a_law_that_cannot_is_a_misfit_and_its_error_is_learned() -> None:
    flat = np.linspace(0, 1, 101)[:, None] * np.ones((1, 2))
    steep = (seen(0.9, 0.5e-6), seen(0.3, 2e-6))
    found = weighted(NO_MIXTURE, FrictionLikelihood(steep), np.zeros((101, 0)), flat)
    assert found.misfit.judgement == "misfit"
    draws = found.resampled(800, seed=2)
    again = draws.with_error(draws.curves[:, 1:], (Touching(2e-6),), seed=3)
    assert np.median(again) == pytest.approx(0.3, abs=0.05)
    # Elsewhere the wrong law is not trusted.
    far = draws.with_error(draws.curves[:, 1:], (Touching(8e-6),), seed=3)
    assert far.std() > 3 * again.std()


def test_what_is_refused() -> None:
    with pytest.raises(InputError, match="vibration_amplitude"):
        touching(Observation("relative_friction", 0.5, 0.1))
    with pytest.raises(InputError, match="standard error"):
        touching(seen(0.5, 1e-6, 0.0))
    with pytest.raises(InputError, match="normal_force"):
        touching(
            Observation(
                "relative_friction", 0.5, 0.1, {"vibration_amplitude": 1e-6, "normal_force": 0.0}
            )
        )
    with pytest.raises(OutOfRangeError, match="no draw"):
        weighted(
            NO_MIXTURE,
            FrictionLikelihood((seen(0.5, 1e-6),)),
            np.zeros((2, 0)),
            np.full((2, 1), np.nan),
        )
