"""Laws of asperities: heights against their integral, a gap found again, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import iv
from tests.plateau import mean_pressure

from squeezefilm.core.errors import InputError
from squeezefilm.physics.contact.asperities import (
    AsperityLaw,
    exponential_pressure,
    gaussian_overlap,
)

EXPONENTIAL = AsperityLaw(4e3, 1.8e-6, 0.5e-6)
GAUSSIAN = AsperityLaw(4e3, 1.8e-6, 0.5e-6, "gaussian")


def overlap(t: float) -> float:
    """∫ (z − t)^{3/2} φ(z) dz from t on."""
    density = 1 / math.sqrt(2 * math.pi)
    part = lambda z: (z - t) ** 1.5 * density * math.exp(-(z**2) / 2)  # noqa: E731
    return float(quad(part, t, t + 14, epsabs=0, epsrel=1e-10, limit=200)[0])


@pytest.mark.parametrize("t", [-8.0, -2.5, 0.0, 1.0, 4.0])
def test_the_overlap_is_its_integral(t: float) -> None:
    assert gaussian_overlap(t) == pytest.approx(overlap(t), rel=1e-7)


def test_the_overlap_is_known_in_its_range_only() -> None:
    assert gaussian_overlap(np.array([-8.0, 20.0])).shape == (2,)
    for t in (-8.01, 20.01):
        with pytest.raises(InputError, match="separation"):
            gaussian_overlap(t)


def test_pressures_fall_from_the_reference() -> None:
    for law in (EXPONENTIAL, GAUSSIAN):
        assert law.pressure(1.8e-6) == pytest.approx(4e3)
    assert EXPONENTIAL.pressure(2.3e-6) == pytest.approx(4e3 / math.e)
    assert exponential_pressure(0.8e-6, 4e3, 1.8e-6, 0.5e-6) == pytest.approx(4e3 * math.exp(2))
    assert GAUSSIAN.pressure(0.5e-6) == pytest.approx(4e3 * overlap(1.0) / overlap(3.6), rel=1e-6)
    both = np.asarray(GAUSSIAN.pressure(np.array([9.9e-6, 10.1e-6])))
    assert both[0] > 0
    assert both[1] == 0.0


def test_the_mean_over_a_period() -> None:
    expected = 4e3 * math.exp(-(3e-6 - 1.8e-6) / 0.5e-6) * iv(0, 2.4)
    assert mean_pressure(EXPONENTIAL, 3e-6, 1.2e-6) == pytest.approx(expected)
    turn = 2 * np.pi * (np.arange(1000) + 0.25) / 1000
    found = np.asarray(mean_pressure(GAUSSIAN, np.array([3e-6, 2e-6]), np.array([1.2e-6, 0.0])))
    assert found[0] == pytest.approx(
        np.mean(np.asarray(GAUSSIAN.pressure(3e-6 - 1.2e-6 * np.cos(turn)))), rel=1e-9
    )
    assert found[1] == pytest.approx(GAUSSIAN.pressure(2e-6))


@pytest.mark.parametrize("law", [EXPONENTIAL, GAUSSIAN])
def test_a_scaled_interface_carries_the_same_at_the_scaled_gap(law: AsperityLaw) -> None:
    assert law.scaled(3.0).pressure(6e-6) == pytest.approx(law.pressure(2e-6))
    assert law.scaled(3.0).heights == law.heights
    with pytest.raises(InputError, match="factor"):
        law.scaled(0.0)
