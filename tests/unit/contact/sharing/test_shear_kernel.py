"""Stick and slip within a period, against marching it step by step and against known limits."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from squeezefilm.contact.asperities import AsperityLaw
from squeezefilm.contact.asperity_kernel import asperity_mean, held_at
from squeezefilm.contact.rough_contact import ContactLaw, RoughContact
from squeezefilm.contact.sharing.shear_kernel import (
    CONSTANT,
    FOLLOWING,
    RIGID,
    CompiledShear,
    gap_at_rest,
    sheared_rows,
)

LAW = AsperityLaw()
DECAY, LOAD = LAW.decay_length, 5e3
GAP = {0.1e-6: 2.0e-6, 0.5e-6: 2.4e-6, 2e-6: 3.8e-6}


def advance(speed: float) -> float:
    """κ U/(µ ω) at 40.5 kHz under a coefficient of 0.9."""
    return 2 / 3 * speed / (0.9 * 2 * math.pi * 40.5e3)


def shear_mean(kind: int, u: float, a: float, speeds: Any, law: ContactLaw = LAW) -> Any:
    """The mean shear over µ (Pa) of one plateau, of the shape of the speeds."""
    compiled, found = law.compiled(), np.empty((np.size(speeds), 1))
    element = CompiledShear(kind, np.array([advance(one) for one in np.atleast_1d(speeds)]))
    sheared_rows(compiled, np.array([[u, a, LOAD]]), element, found)
    at_rest = held_at(compiled, gap_at_rest(compiled, LOAD))[0]
    return found.reshape(np.shape(speeds)) * at_rest


def marched(kind: int, u: float, a: float, speed: float, steps: int = 20_000) -> float:
    """The same by small steps of the rate equations, until the period repeats."""
    turn = np.linspace(-math.pi, math.pi, steps + 1)
    p = np.asarray(LAW.pressure(u - a * np.cos(turn)))
    rate = advance(speed) * 2 * math.pi / steps
    q, last = float(p[0]), -1.0
    while abs(q - last) > 1e-10 * p[0]:
        last, total = q, 0.0
        for before, after in zip(p[:-1].tolist(), p[1:].tolist(), strict=True):
            if kind == CONSTANT:
                q += rate * LOAD / DECAY
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
    exact = marched(kind, GAP[a], a, speed)
    assert shear_mean(kind, GAP[a], a, speed) == pytest.approx(exact, rel=2e-4)


@pytest.mark.parametrize("kind", [CONSTANT, FOLLOWING])
@pytest.mark.parametrize("law", [LAW, RoughContact(), AsperityLaw(heights="gaussian")])
def test_many_speeds_are_each_alone(kind: int, law: ContactLaw) -> None:
    speeds = np.geomspace(1e-3, 1.0, 7)
    alone = [float(shear_mean(kind, 3.1e-6, 2e-6, speed, law)) for speed in speeds]
    assert shear_mean(kind, 3.1e-6, 2e-6, speeds, law).tolist() == alone


@pytest.mark.parametrize("a", list(GAP))
def test_what_follows_the_load_slides_throughout_above_a_speed(a: float) -> None:
    """It sticks nowhere once κ U ≥ µ ω a; below, what is lost goes with the square of the lack."""
    u = GAP[a]
    mean = asperity_mean(LAW.compiled(), u, a)[0]
    assert shear_mean(RIGID, u, a, 0.1) == pytest.approx(mean, rel=1e-12)
    least = 0.9 * 2 * math.pi * 40.5e3 * a / (2 / 3)
    assert shear_mean(FOLLOWING, u, a, 1.001 * least) == pytest.approx(mean, rel=1e-12)
    lost = mean - shear_mean(FOLLOWING, u, a, least * (1 - np.array([0.01, 0.005])))
    assert lost[0] / lost[1] == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize("a", list(GAP))
def test_what_is_constantly_stiff_slides_throughout_above_a_speed(a: float) -> None:
    """It sticks nowhere once κ k U ≥ µ ω times the fastest rise of the pressure over the phase."""
    u = GAP[a]
    mean = asperity_mean(LAW.compiled(), u, a)[0]
    turn = np.linspace(0, math.pi, 200_001)
    fastest = np.max(np.asarray(LAW.pressure(u - a * np.cos(turn))) / DECAY * a * np.sin(turn))
    least = fastest / (LOAD / DECAY) / advance(1.0)
    assert shear_mean(CONSTANT, u, a, 1.001 * least) == pytest.approx(mean, rel=1e-12)
    lost = mean - shear_mean(CONSTANT, u, a, least * (1 - np.array([0.01, 0.005])))
    assert lost[0] / lost[1] == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize("law", [LAW, RoughContact(), AsperityLaw(heights="gaussian")])
def test_at_rest(law: ContactLaw) -> None:
    """A constant stiffness keeps the least limit of the period; one that follows keeps nothing,
    and what it has is in proportion to the speed."""
    u, a = 3.8e-6, 2e-6
    least = held_at(law.compiled(), u + a)[0]
    slow = shear_mean(CONSTANT, u, a, [2e-9, 1e-9], law) - least
    mean = asperity_mean(law.compiled(), u, a)[0]
    assert np.all(np.abs(slow) < 1e-6 * mean)
    following = shear_mean(FOLLOWING, u, a, [2e-6, 1e-6], law)
    assert following[0] == pytest.approx(2 * following[1], rel=3e-3)
    assert following[0] < 1e-3 * mean


@pytest.mark.parametrize("kind", [CONSTANT, FOLLOWING])
@pytest.mark.parametrize("law", [LAW, RoughContact(), AsperityLaw(heights="gaussian")])
def test_faster_is_never_less(kind: int, law: ContactLaw) -> None:
    for u, a in ((3.0e-6, 1.5e-6), (2.3e-6, 0.2e-6), (6.5e-6, 5e-6)):
        found = shear_mean(kind, u, a, np.geomspace(1e-4, 5, 200), law)
        assert np.all(np.diff(found) >= -2e-6 * found[-1])


def test_friction_of_the_real_area() -> None:
    contact = RoughContact()
    compiled = contact.compiled()
    full = contact.modulus * contact.rms_slope
    for gap in (9e-6, 2e-6, 0.4e-6):
        pressure = float(contact.pressure(gap))
        ratio = contact.contact_ratio(pressure) / contact.contact_ratio(1e-6 * full) * 1e-6 * full
        held, stiffness = held_at(compiled, gap)
        assert held == pytest.approx(float(ratio), rel=1e-6)
        step = 1e-5 * gap
        change = float(contact.pressure(gap - step) - contact.pressure(gap + step))
        assert stiffness == pytest.approx(change / (2 * step), rel=1e-5)
    u, a = 3.2e-6, 2e-6
    turn = np.cos(2 * np.pi * np.arange(4096) / 4096)
    held = np.mean([held_at(compiled, float(h))[0] for h in u - a * turn])
    assert shear_mean(RIGID, u, a, 1.0, contact) == pytest.approx(held, rel=1e-9)
    assert shear_mean(FOLLOWING, u, a, 9.0, contact) == pytest.approx(held, rel=1e-9)


def test_where_nothing_touches_nothing_is_held() -> None:
    assert shear_mean(FOLLOWING, 40e-6, 1e-6, 0.1, RoughContact()) == 0.0
    # Sharp asperities that touch for a moment only.
    sharp = AsperityLaw(5e3, 0.6e-6, 2e-9)
    mean = asperity_mean(sharp.compiled(), 2.6e-6, 2e-6)[0]
    assert shear_mean(FOLLOWING, 2.6e-6, 2e-6, 9.0, sharp) == pytest.approx(mean, rel=1e-9)
