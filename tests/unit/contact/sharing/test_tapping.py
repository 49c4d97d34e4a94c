"""Intermittent contact without gas: against two other solutions of the same slider."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from squeezefilm.contact.asperities import MINDLIN_RATIO, AsperityLaw
from squeezefilm.contact.sharing.tapping import Tapping, tapping_friction

REST = AsperityLaw().decay_length


def envelope(half: float, rate: float, phases: int = 2**18) -> float:
    """Mean shear over µ k_n a by the slider's own formula: the shear is the least that any limit
    passed so far allows, q(θ) = min over θ' ≤ θ of limit(θ') + rate (θ − θ')."""
    theta, step = np.linspace(-half, half, phases + 1, retstep=True)
    limit = np.cos(theta) - np.cos(half)
    shear = np.minimum.accumulate(limit - rate * theta) + rate * theta
    return float(np.sum(shear) * step) / (2 * np.pi)


def closed_form(half: float, rate: float) -> float:
    """The same: it sticks from the beginning of the tap or, where the limit rises more slowly than
    the shear at first, from sin|θ| = rate on; then it slips once."""
    held = (math.sin(half) - half * math.cos(half)) / math.pi
    start = -half
    if math.sin(half) <= rate:
        if half <= math.pi / 2 or rate >= 1:
            return held
        start = -(math.pi - math.asin(rate))

    def deficit(theta: float) -> float:
        return math.cos(theta) - math.cos(start) - rate * (theta - start)

    end = brentq(deficit, -math.asin(rate), half, xtol=1e-15) if deficit(half) < 0 else half
    lost = math.sin(end) - math.sin(start) - math.cos(start) * (end - start)
    return float(held - (lost - rate * (end - start) ** 2 / 2) / (2 * math.pi))


def cases() -> list[tuple[float, Tapping]]:
    """Amplitudes from where contact is just lost to 30 depths, at 1 mm/s to 3 m/s."""
    rng = np.random.default_rng(1)
    swings = REST * np.exp(rng.uniform(math.log(1.002), math.log(30), 200))
    speeds = np.exp(rng.uniform(math.log(1e-3), math.log(3), 200))
    return [
        (a, tapping_friction(a, 40.5e3, v, 5e3))
        for a, v in zip(swings.tolist(), speeds.tolist(), strict=True)
    ]


def test_the_element_is_the_slider() -> None:
    for a, tap in cases():
        half, rate = tap.contact_fraction * math.pi, MINDLIN_RATIO / tap.tapping_number
        exact = min(closed_form(half, rate) * a / REST, 1.0)
        assert tap.relative_friction == pytest.approx(exact, abs=1e-10)


def test_the_element_is_the_slider_on_a_fine_grid() -> None:
    for a, tap in cases()[::10]:
        half, rate = tap.contact_fraction * math.pi, MINDLIN_RATIO / tap.tapping_number
        marched = min(envelope(half, rate) * a / REST, 1.0)
        assert tap.relative_friction == pytest.approx(marched, abs=1e-9)


def test_contact_that_is_never_lost_is_left_as_it_is() -> None:
    tap = tapping_friction(0.99 * REST, 40.5e3, 0.01, 5e3)
    assert not tap.intermittent
    assert (tap.relative_friction, tap.contact_fraction) == (1.0, 1.0)
    assert tap.penetration == pytest.approx(1.99 * REST)
