"""Stick and slip within a period, against marching it step by step and against known limits."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.contact.asperities import AsperityLaw
from squeezefilm.contact.asperity_kernel import asperity_mean
from squeezefilm.contact.rough_contact import RoughContact
from squeezefilm.contact.sharing.shear_kernel import (
    CONSTANT,
    FOLLOWING,
    RIGID,
    CompiledShear,
    friction_limit,
    shear_mean,
)

LAW = AsperityLaw()
DECAY, LOAD = LAW.decay_length, 5e3
GAP = {0.1e-6: 2.0e-6, 0.5e-6: 2.4e-6, 2e-6: 3.8e-6}


def shear(kind: int, speed: float, full: float = 0.0) -> CompiledShear:
    """At 40.5 kHz under a coefficient of 0.9."""
    return CompiledShear(kind, 2 / 3 * speed / (0.9 * 2 * math.pi * 40.5e3), LOAD / DECAY, full)


def marched(u: float, a: float, element: CompiledShear, steps: int = 20_000) -> float:
    """The same by small steps of the rate equations, until the period repeats."""
    turn = np.linspace(-math.pi, math.pi, steps + 1)
    p = np.asarray(LAW.pressure(u - a * np.cos(turn)))
    rate = element.advance * 2 * math.pi / steps
    q, last = float(p[0]), -1.0
    while abs(q - last) > 1e-10 * p[0]:
        last, total = q, 0.0
        for before, after in zip(p[:-1].tolist(), p[1:].tolist(), strict=True):
            if element.kind == CONSTANT:
                q += rate * element.stiffness
            elif after >= before:
                q += rate * 0.5 * (before + after) / DECAY
            else:
                q = (q / before + rate / DECAY) * after
            q = min(q, after)
            total += q
    return total / steps


@pytest.mark.parametrize("kind", [CONSTANT, FOLLOWING])
@pytest.mark.parametrize("speed", [0.003, 0.02, 0.08, 0.3])
@pytest.mark.parametrize("a", list(GAP))
def test_against_small_steps(kind: int, speed: float, a: float) -> None:
    element = shear(kind, speed)
    exact = marched(GAP[a], a, element)
    assert shear_mean(LAW.compiled(), GAP[a], a, element) == pytest.approx(exact, rel=2e-4)


@pytest.mark.parametrize("a", list(GAP))
def test_what_slides_throughout_is_rigid(a: float) -> None:
    """Stiffness that follows the load sticks nowhere once κ U ≥ µ ω a."""
    law, u = LAW.compiled(), GAP[a]
    mean = asperity_mean(law, u, a)[0]
    assert shear_mean(law, u, a, shear(RIGID, 0.1)) == mean
    least = 0.9 * 2 * math.pi * 40.5e3 * a / (2 / 3)
    assert shear_mean(law, u, a, shear(FOLLOWING, 1.001 * least)) == pytest.approx(mean, rel=1e-12)
    assert shear_mean(law, u, a, shear(FOLLOWING, 0.9 * least)) < mean * (1 - 1e-6)


def test_at_rest() -> None:
    """A constant stiffness keeps the least pressure of the period, one that follows loses all."""
    law, u, a = LAW.compiled(), 3.8e-6, 2e-6
    least = float(LAW.pressure(u + a))
    assert shear_mean(law, u, a, shear(CONSTANT, 1e-9)) == pytest.approx(least, rel=1e-3)
    assert shear_mean(law, u, a, shear(FOLLOWING, 1e-6)) < 1e-3 * asperity_mean(law, u, a)[0]


@pytest.mark.parametrize("kind", [CONSTANT, FOLLOWING])
def test_faster_is_never_less(kind: int) -> None:
    law = LAW.compiled()
    found = [shear_mean(law, 3.0e-6, 1.5e-6, shear(kind, u)) for u in np.geomspace(1e-4, 3, 40)]
    assert np.all(np.diff(found) >= -1e-9 * found[-1])


def test_friction_of_the_real_area() -> None:
    contact = RoughContact()
    full = contact.modulus * contact.rms_slope
    for pressure in (1.0, 1e4, 3e5):
        ratio = contact.contact_ratio(pressure) / contact.contact_ratio(1e-3) * 1e-3
        assert friction_limit(pressure, full) == pytest.approx(float(ratio), rel=1e-6)
    assert friction_limit(77.0, 0.0) == 77.0
    law, u, a = contact.compiled(), 3.2e-6, 2e-6
    turn = np.cos(2 * np.pi * np.arange(4096) / 4096)
    held = [friction_limit(float(p), full) for p in np.asarray(contact.pressure(u - a * turn))]
    assert shear_mean(law, u, a, shear(RIGID, 1.0, full)) == pytest.approx(np.mean(held), rel=1e-6)
    assert shear_mean(law, u, a, shear(FOLLOWING, 9.0, full)) == pytest.approx(
        np.mean(held), rel=1e-6
    )
