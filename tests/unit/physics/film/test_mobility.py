"""How easily gas moves: the law in numbers, and a slope that is its derivative."""

from __future__ import annotations

import itertools

import pytest

from squeezefilm.physics.film.gas import FIRST, NO_SLIP, SECOND, SLIP_LAWS
from squeezefilm.physics.film.mobility import mobility

H, P, KN = 0.7, 1.6, 0.08


@pytest.mark.parametrize("n", [1.0, 1.4])
def test_it_is_the_cube_of_the_gap_times_the_gas_times_the_slip(n: float) -> None:
    root = P ** (1 / n)
    assert mobility(H, P, n, 0.0, NO_SLIP)[0] == pytest.approx(0.343 * root)
    # Slip is by the local free path, which goes with 1/P, over the local gap.
    local = KN / (P * H)
    assert mobility(H, P, n, KN, FIRST)[0] == pytest.approx(0.343 * root * (1 + 6 * local))
    second = 1 + 6 * local + 6 * local**2
    assert mobility(H, P, n, KN, SECOND)[0] == pytest.approx(0.343 * root * second)


def test_no_slip_asks_for_no_free_path() -> None:
    assert mobility(H, P, 1.2, 0.5, NO_SLIP) == mobility(H, P, 1.2, 0.0, NO_SLIP)
    assert mobility(H, P, 1.0, 0.5, NO_SLIP) == pytest.approx((0.343 * P, 0.343))


@pytest.mark.parametrize("law", [NO_SLIP, *SLIP_LAWS.values()])
def test_the_slope_is_the_derivative_in_the_pressure(law: int) -> None:
    step = 1e-5
    for n, pressure in itertools.product((1.0, 1.4), (0.6, 1.0, 1.6)):
        above, below = (mobility(H, pressure + d, n, KN, law)[0] for d in (step, -step))
        slope = (above - below) / (2 * step)
        assert mobility(H, pressure, n, KN, law)[1] == pytest.approx(slope, rel=1e-8)
