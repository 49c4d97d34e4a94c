"""What the compiled motors compute at one instant, and in the mean, against plain NumPy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from squeezefilm.actuators.motor import kernel
from squeezefilm.actuators.motor.average_kernel import (
    MEANS,
    Swing,
    average_contact,
    settled_height,
)
from squeezefilm.actuators.motor.parts import damping_at, mode_energy, spring_at

from .test_plane_kernel import FEET, MODES, foot, made

TOTALS = 2 * MODES + 4 + FEET


def test_energy_is_the_work_of_the_springs_and_half_of_mass_by_the_square_of_speed() -> None:
    stator, *_ = made(3, held=False, imposed=False)
    q, speed = np.array([0.7, -0.4]), np.array([0.3, 1.1])
    elastic = [quad(lambda x, j=j: spring_at(stator, j, x) * x, 0.0, q[j])[0] for j in range(MODES)]
    expected = sum(elastic) + stator.mass @ speed**2 / 2
    assert mode_energy(stator, q, speed) == pytest.approx(expected)
    assert damping_at(stator, 1, 0.3, stator.omega[1] * 0.4) == pytest.approx(
        stator.damping[1] * (1 + 0.5 * stator.rise[1])
    )


def instant(y, stator, feet, slider, contact, guide, t):
    """The state as the kernel leaves it, its derivative and events."""
    y, dy = y.copy(), np.zeros_like(y)
    events = np.ones(2 * FEET + 1)
    q, speeds = y[:MODES], y[MODES : 2 * MODES]
    if stator.held:
        angle = stator.omega * t + stator.phase
        q[:] = stator.amplitude * np.cos(angle)
        speeds[:] = -stator.amplitude * stator.omega * np.sin(angle)
    z, rise, _, v = y[2 * MODES : 2 * MODES + 4]
    stretch, total = y[2 * MODES + 4 : TOTALS], dy[TOTALS:]
    depth, pressed = feet.across @ q - z, feet.across @ speeds - rise
    along = feet.along @ speeds - v
    g, signs = 1 + feet.chi * pressed, {kernel.SLIP_UP: 1.0, kernel.SLIP_DOWN: -1.0}

    def part(i: int, g: complex) -> complex:
        """e/δ where k_nt δ + k_tt e is ±µ g (k_nn δ + k_nt e)."""
        limit = signs[contact[i]] * feet.mu[i] * g
        return (limit * feet.k_nn[i] - feet.k_nt[i]) / (feet.k_tt[i] - limit * feet.k_nt[i])

    force, normal = np.zeros(FEET), np.zeros(FEET)
    for i in range(FEET):
        events[2 * i] = -depth[i] if contact[i] == kernel.OPEN else depth[i]
        if contact[i] == kernel.OPEN:
            continue
        if contact[i] in signs:
            stretch[i] = depth[i] * part(i, g[i]).real
        elastic = feet.k_nn[i] * depth[i] + feet.k_nt[i] * stretch[i]
        force[i] = feet.k_nt[i] * depth[i] + feet.k_tt[i] * stretch[i]
        normal[i] = g[i] * elastic
        total[kernel.CONTACT_LOSS] += feet.chi[i] * pressed[i] ** 2 * elastic
        if contact[i] == kernel.STICK:
            dy[2 * MODES + 4 + i] = along[i]
            events[2 * i + 1] = feet.mu[i] * normal[i] - abs(force[i])
    onto = -(normal @ feet.across + force @ feet.along)
    dy[:MODES] = speeds
    if stator.held:
        total[kernel.DRIVE] = -onto @ speeds
        dy[MODES : 2 * MODES] = -(stator.omega**2) * q
    else:
        push = stator.force * np.cos(stator.omega * t + stator.phase)
        rising = 1 + stator.rise * np.hypot(q, speeds / stator.omega)
        lost = stator.damping * rising * speeds
        back = stator.stiffness * (1 + stator.bend * abs(q) + stator.cube * q**2) * q
        total[kernel.DRIVE], total[kernel.MODAL_LOSS] = push @ speeds, lost @ speeds
        dy[MODES : 2 * MODES] = (onto + push - lost - back) / stator.mass
    thrust, lift = force.sum(), normal.sum()
    total[kernel.THRUST], total[kernel.NORMAL] = thrust, lift
    upwards = (lift - slider.preload - slider.damping * rise) / slider.mass
    dy[2 * MODES : 2 * MODES + 3] = rise, upwards, v
    total[kernel.PRELOAD] = -slider.preload * rise
    total[kernel.GUIDE_LOSS] = slider.damping * rise**2
    if slider.imposed:
        total[kernel.OUTPUT] = thrust * v - slider.guide * abs(v)
        total[kernel.GUIDE_LOSS] += slider.guide * abs(v)
    elif guide == 0:
        events[-1] = slider.guide - abs(thrust - slider.load)
    else:
        dy[2 * MODES + 3] = (thrust - slider.load - guide * slider.guide) / slider.mass
        total[kernel.OUTPUT] = slider.load * v
        total[kernel.GUIDE_LOSS] += guide * slider.guide * v
        events[-1] = guide * v
    deeper = feet.across @ dy[MODES : 2 * MODES] - upwards
    for i in (i for i in range(FEET) if contact[i] in signs):
        # de/dt of e = δ part(g), by a step into the complex plane.
        slope = part(i, g[i] + 1e-20j).imag / 1e-20
        yielding = pressed[i] * part(i, g[i]).real + depth[i] * slope * feet.chi[i] * deeper[i]
        slip = along[i] - yielding
        events[2 * i + 1] = signs[contact[i]] * slip
        total[kernel.FRICTION] += force[i] * slip
    return y, dy, events


@pytest.mark.parametrize("imposed", [False, True])
@pytest.mark.parametrize("held", [False, True])
def test_rates_are_those_of_the_equations_in_every_contact(held: bool, imposed: bool) -> None:
    for seed in range(12):
        random = np.random.default_rng(seed)
        stator, feet, _, slider = made(seed, held=held, imposed=imposed)
        y = 0.3 * random.standard_normal(TOTALS + kernel.TOTALS)
        contact, guide = random.integers(0, 4, FEET).astype(float), float(random.integers(-1, 2))
        march = kernel.March(
            y.copy(), contact, np.array([guide]), np.zeros((2, FEET)), np.zeros((8, y.size)),
            np.zeros(2 * FEET + 1), np.zeros(2 * FEET + 1),
        )  # fmt: skip
        dy = np.empty_like(y)
        kernel.rates(0.6, march.state, stator, feet, slider, march, dy)
        state, rates, events = instant(y, stator, feet, slider, contact.tolist(), guide, 0.6)
        assert march.state == pytest.approx(state, rel=1e-9, abs=1e-11)
        assert dy == pytest.approx(rates, rel=1e-9, abs=1e-11)
        assert march.events == pytest.approx(events, rel=1e-9, abs=1e-11)


def test_means_are_the_sums_over_the_instants_that_count() -> None:
    swing = Swing(0.05, -0.03, 16, 1, 2)
    for seed in range(6):
        stator, feet, sideways, _ = made(seed, held=True, imposed=True)
        height = 0.2 * seed / 5
        means = np.full(MEANS, np.nan)
        average_contact(stator, feet, sideways, height, swing, means)
        dt = 2 * np.pi / stator.omega[0] / 16
        expected, met, slipped = np.zeros(MEANS), 0, 0
        stretch, last, was = np.zeros((FEET, 2)), np.zeros((FEET, 2)), np.zeros(FEET)
        for n in range(48):
            angle = stator.omega * n * dt + stator.phase
            w, dw = stator.amplitude * np.cos(angle), -stator.amplitude * np.sin(angle)
            dw = dw * stator.omega
            gone = np.array([0.05, -0.03]) * n * dt
            for i in range(FEET):
                ways = np.array([feet.along[i], sideways[i]])
                depth, pressed = feet.across[i] @ w - height, feet.across[i] @ dw
                place = ways @ w - gone
                moved = place - last[i]
                if was[i] < 0 < depth:
                    moved = moved * depth / (depth - was[i])
                last[i], was[i] = place, depth
                if depth <= 0:
                    stretch[i] = 0.0
                    continue
                force, elastic, slip = foot(feet, i, depth, pressed, stretch[i] + moved)
                stretch[i] += moved - slip
                if n < 16:
                    continue
                normal = elastic * (1 + feet.chi[i] * pressed)
                met, slipped = met + 1, slipped + (np.linalg.norm(slip) > 1e-12)
                push = -(normal * feet.across[i] + force @ ways)
                expected[:3] += [*force, normal]
                expected[5] += feet.chi[i] * pressed**2 * elastic
                expected[6] += force @ slip / dt
                expected[7::2] += 2 * push * np.cos(angle)
                expected[8::2] += 2 * push * np.sin(angle)
        expected /= 32
        expected[3:5] = met / (32 * FEET), slipped / met
        assert means == pytest.approx(expected, rel=1e-8, abs=1e-10)


def test_the_slider_settles_where_the_feet_carry_its_preload() -> None:
    stator, feet, sideways, _ = made(2, held=True, imposed=True)
    swing, found, there = Swing(0.05, -0.03, 64, 1, 2), np.zeros(MEANS), np.zeros(MEANS)
    for preload in (0.05, 2.0, 30.0):
        height = settled_height(stator, feet, sideways, preload, swing, found)
        average_contact(stator, feet, sideways, height, swing, there)
        assert found == pytest.approx(there)
        assert found[2] == pytest.approx(preload, rel=1e-6)
