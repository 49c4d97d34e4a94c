"""Metal on metal without a film: the fit, its predictions, and an independent march."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import i0

from squeezefilm.analysis.claims import metal
from squeezefilm.analysis.claims.metal import dry_friction, fitted_ratio, metal_prediction

KINDS = ("constant", "following")


def marched(a: float, decay: float, speed: float, ratio: float, kind: str) -> float:
    """µ′/µ by small steps of the rate equations, in units of the pressure at rest: heights from
    the balance without gas, ⟨exp(−(u − a cos T)/λ)⟩ = 1."""
    mean, _ = quad(lambda t: math.exp(a * math.cos(t) / decay) / math.pi, 0.0, math.pi)
    u = decay * math.log(mean)
    steps = 40_000
    turn = np.linspace(-math.pi, math.pi, steps + 1)
    limit = np.exp(-(u - a * np.cos(turn)) / decay)
    rate = ratio * speed / (2 * math.pi * metal.FREQUENCY * decay) * 2 * math.pi / steps
    q, last, total = float(limit[0]), -1.0, 0.0
    while abs(q - last) > 1e-11 * limit[0]:
        last, total = q, 0.0
        for before, after in itertools.pairwise(limit.tolist()):
            if kind == "constant":
                q += rate
            elif after >= before:
                q += rate * 0.5 * (before + after)
            else:
                q = (q / before + rate) * after
            q = min(q, after)
            total += q
    return total / steps


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("a", "speed"), [(0.6e-6, 0.0203), (2e-6, 0.0203), (2e-6, 0.087)])
def test_against_small_steps(a: float, speed: float, kind: str) -> None:
    found = dry_friction(a, 0.4e-6, speed, 1.3, kind)  # type: ignore[arg-type]
    assert found == pytest.approx(marched(a, 0.4e-6, speed, 1.3, kind), rel=3e-4)


@pytest.mark.parametrize("kind", KINDS)
def test_limits(kind: str) -> None:
    # What slides at once, and what does not vibrate, keeps all friction.
    assert dry_friction(2e-6, 0.4e-6, 0.02, 1e4, kind) == pytest.approx(1.0)  # type: ignore[arg-type]
    assert dry_friction(0.0, 0.4e-6, 0.02, 1.0, kind) == pytest.approx(1.0)  # type: ignore[arg-type]
    # Toward no speed a constant stiffness keeps the least pressure of the period, p e^(−A)/I0(A).
    slow = dry_friction(0.4e-6, 0.4e-6, 1e-6, 1.0, kind)  # type: ignore[arg-type]
    least = math.exp(-1) / i0(1) if kind == "constant" else 0.0
    assert slow == pytest.approx(least, abs=2e-3)


@pytest.mark.parametrize("kind", KINDS)
def test_only_the_two_groups_count(kind: str) -> None:
    """Amplitude and decay length scaled alike, and the stiffness with them, change nothing."""
    one = dry_friction(1e-6, 0.2e-6, 0.03, 0.7, kind)  # type: ignore[arg-type]
    assert dry_friction(3e-6, 0.6e-6, 0.03, 2.1, kind) == pytest.approx(one, rel=1e-9)  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", KINDS)
def test_the_pressure_drops_out(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    one = dry_friction(1e-6, 0.2e-6, 0.03, 0.7, kind)  # type: ignore[arg-type]
    for pressure in (1e6, 4e6):
        monkeypatch.setattr(metal, "PRESSURE", pressure)
        assert dry_friction(1e-6, 0.2e-6, 0.03, 0.7, kind) == pytest.approx(one, rel=1e-9)  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", KINDS)
def test_the_fit_is_reached_or_refused(kind: str) -> None:
    ratio = fitted_ratio(2e-6, 0.4e-6, 0.38, kind)  # type: ignore[arg-type]
    assert ratio is not None
    assert dry_friction(2e-6, 0.4e-6, metal.FITTED_SPEED, ratio, kind) == pytest.approx(0.38)  # type: ignore[arg-type]
    # With half a decay length a constant stiffness cannot: e^(−½)/I0(½) = 0.57 is left at rest.
    small = fitted_ratio(0.2e-6, 0.4e-6, 0.38, kind)  # type: ignore[arg-type]
    assert (small is None) == (kind == "constant")


@pytest.mark.parametrize("kind", KINDS)
def test_the_prediction_lies_in_its_interval_and_rises_with_the_speed(kind: str) -> None:
    found = metal_prediction(kind)  # type: ignore[arg-type]
    assert found.speeds == (40.6e-3, 87e-3)
    assert found.fitted_friction == pytest.approx(0.38, abs=1e-6)
    for low, middle, high in zip(found.low, found.relative_friction, found.high, strict=True):
        assert 0.38 < low < middle < high < 1
    assert found.relative_friction[0] < found.relative_friction[1]
    middle, low, high = found.stiffness_over_friction
    assert 0 < low < middle < high
    assert 0 <= found.refused < 0.05
