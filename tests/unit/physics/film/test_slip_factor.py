"""The slip factors: published values, limits, and slopes consistent with values."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.film.gas import SLIP_LAWS, slip_law
from squeezefilm.physics.film.mobility import slip_factor


def flow_factor(knudsen, slip="first"):
    """φ at local Knudsen numbers, each of them asked by itself."""
    given = np.asarray(knudsen, dtype=float)
    flat = [slip_factor(SLIP_LAWS[slip], float(k))[0] for k in given.ravel()]
    return np.array(flat).reshape(given.shape)


def test_values():
    assert flow_factor(0.1) == pytest.approx(1.6)
    assert flow_factor(0.1, "second") == pytest.approx(1.66)
    assert flow_factor(0.1, "veijola") == pytest.approx(1.0 + 9.638 * 0.1**1.159)


@pytest.mark.parametrize("slip", SLIP_LAWS)
def test_no_slip_without_free_path(slip):
    assert flow_factor(0.0, slip) == 1.0
    tiny = {"first": 6e-6, "second": 6e-6, "fukui-kaneko": 7e-6, "veijola": 2e-6}
    assert flow_factor(1e-6, slip) == pytest.approx(1.0 + tiny[slip], abs=1.5e-6)


def test_fukui_kaneko_is_first_order_with_slip_coefficient_1_15_at_small_kn():
    # 1.0162 · 6/D with D = √π/(2 Kn): the slip coefficient of the linearised Boltzmann equation.
    kn = 1e-3
    assert flow_factor(kn, "fukui-kaneko") - 1.0 == pytest.approx(
        6.0972 * 2.0 / np.sqrt(np.pi) * kn, rel=2e-3
    )


def test_fukui_kaneko_has_the_knudsen_minimum_of_the_flow_rate():
    D = np.geomspace(0.05, 20.0, 200)
    Q = D / 6.0 * flow_factor(0.5 * np.sqrt(np.pi) / D, "fukui-kaneko")
    least = D[np.argmin(Q)]
    assert 0.7 < least < 2.0
    assert Q.min() == pytest.approx(1.53, abs=0.03)


@pytest.mark.parametrize("slip", SLIP_LAWS)
def test_factor_is_continuous_rising_and_its_slope_is_right(slip):
    kn = np.geomspace(1e-3, 20.0, 4001)
    values = flow_factor(kn, slip)
    assert np.all(np.diff(values) > 0.0)
    assert np.all(np.diff(np.log(values)) < 0.01)
    for k in (0.003, 0.05, 0.17, 0.18, 0.2, 1.0, 5.0, 6.0, 8.0):
        slope = slip_factor(SLIP_LAWS[slip], k)[1]
        step = 1e-5 * k
        above, below = flow_factor(k + step, slip), flow_factor(k - step, slip)
        assert slope == pytest.approx((above - below) / (2.0 * step), rel=1e-5)


def test_bad_input():
    with pytest.raises(InputError, match="slip = 'none'"):
        slip_law("none", 1.0)
    with pytest.raises(InputError, match="knudsen_number = -1"):
        slip_law("first", -1.0)
