"""What the compiled motors compute at one instant, and in the mean, against plain NumPy."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from squeezefilm.actuators.motor import kernel
from squeezefilm.actuators.motor.assembled import Working, damping_at, mode_energy, spring_at
from squeezefilm.actuators.motor.average_kernel import (
    MEANS,
    Swing,
    average_contact,
)
from squeezefilm.actuators.motor.averaged import _means

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
            y.copy(), contact, np.array([guide]), np.zeros(FEET), np.zeros((8, y.size)),
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
    # Two modes beat: 64 periods count, after two.
    swing, there = Swing(0.05, -0.03, 64, 2, 64), np.zeros(MEANS)
    for preload in (0.05, 2.0, 30.0):
        slider: Any = SimpleNamespace(preload=preload)
        motor: Any = SimpleNamespace(
            feet=feet, sideways=sideways, slider=lambda *_, imposed, s=slider: s
        )
        height, found = _means(motor, Working(amplitude=1e-6), stator, (0.05, -0.03), 64)
        average_contact(stator, feet, sideways, height, swing, there)
        assert found == pytest.approx(there)
        assert found[2] == pytest.approx(preload, rel=1e-6)


def begun(y, contact, guide):
    contact = np.array(contact, dtype=float)
    rounding = np.full(2 * FEET + 1, 1e-12)
    return kernel.March(
        y.copy(), contact, np.array([guide]), np.zeros(FEET), np.zeros((8, y.size)),
        np.zeros(2 * FEET + 1), rounding,
    )  # fmt: skip


@pytest.mark.parametrize("held", [False, True])
def test_while_nothing_changes_the_march_is_the_solution_of_the_rates(held: bool) -> None:
    """Feet pressed in deeply, one of them slipping: against an integrator of many digits."""
    stator, feet, _, slider = made(5, held=held, imposed=False)
    feet = feet._replace(mu=np.array([9.0, 9.0, 9.0, 9.0, 0.05]), chi=np.full(FEET, 1e-3))
    contact, steps, h = [1, 1, 1, 1, 3], 20, 2e-3
    y = np.zeros(TOTALS + kernel.TOTALS)
    y[2 * MODES], y[2 * MODES + 3] = -2.0, 3.0
    y, _, events = instant(y, stator, feet, slider, contact, 1.0, 0.2)

    def rates(t, y):
        return instant(y, stator, feet, slider, contact, 1.0, t)[1]

    exact = solve_ivp(rates, (0.2, 0.2 + steps * h), y, rtol=1e-11, atol=1e-12)
    end, _, after = instant(exact.y[:, -1], stator, feet, slider, contact, 1.0, 0.2 + steps * h)
    assert min(*events, *after) > 0
    march = begun(y, contact, 1.0)
    done = kernel.march_steps(0.2, h, steps, (stator, feet, slider, march))
    assert done == steps
    assert march.state == pytest.approx(end, rel=1e-6, abs=1e-7)
    assert march.contact.tolist() == contact
    assert march.shares == pytest.approx(np.full(FEET, steps * h))


def test_each_event_changes_what_it_is_of_and_nothing_else() -> None:
    e, totals = 2 * MODES + 4, TOTALS
    kinds = set()
    for seed in range(40):
        random = np.random.default_rng(seed)
        stator, feet, _, slider = made(seed, held=False, imposed=False)
        y = 0.3 * random.standard_normal(totals + kernel.TOTALS)
        contact = random.integers(0, 4, FEET).astype(float)
        march = begun(y, contact, float(random.integers(-1, 2)))
        march.room[6, totals + kernel.THRUST] = thrust = 3 * random.standard_normal()
        state, guide = y.copy(), march.guide[0]
        i, loosened = int(random.integers(0, FEET)), bool(random.integers(0, 2))
        which = 2 * FEET if seed % 5 == 0 else 2 * i + loosened
        across, along = feet.across[i], feet.along[i]
        if which == 2 * FEET:
            guide = np.sign(thrust - slider.load) if guide == 0 else 0.0
            state[2 * MODES + 3] *= abs(guide)
        elif loosened and contact[i] in (kernel.SLIP_UP, kernel.SLIP_DOWN, kernel.OPEN):
            contact[i] = kernel.STICK
        elif loosened:
            pull = feet.k_nt[i] * (across @ y[:MODES] - y[2 * MODES]) + feet.k_tt[i] * y[e + i]
            contact[i] = kernel.SLIP_UP if pull > 0 else kernel.SLIP_DOWN
        elif contact[i] != kernel.OPEN:
            contact[i], state[e + i] = kernel.OPEN, 0.0
        else:
            press = across @ y[MODES : 2 * MODES] - y[2 * MODES + 1]
            drag = along @ y[MODES : 2 * MODES] - y[2 * MODES + 3]
            needed = feet.k_nt[i] * press + feet.k_tt[i] * drag
            given = feet.k_nn[i] * press + feet.k_nt[i] * drag
            holds = abs(needed) <= feet.mu[i] * (1 + feet.chi[i] * press) * given
            slips = kernel.SLIP_UP if needed > 0 else kernel.SLIP_DOWN
            contact[i], state[e + i] = kernel.STICK if holds else slips, 0.0
        kinds.add((which == 2 * FEET, loosened, contact[i]))
        kernel._change(which, stator, feet, slider, march)
        assert march.contact.tolist() == contact.tolist()
        assert march.guide[0] == guide
        assert march.state.tolist() == state.tolist()
    assert len(kinds) > 9


def test_a_foot_that_leaves_within_a_step_leaves_at_its_time() -> None:
    """A free slider over one foot on a plate that stands still: it swings on the spring."""
    stator, feet, _, slider = made(1, held=True, imposed=False)
    stator = stator._replace(amplitude=np.zeros(MODES))
    feet = feet._replace(k_nn=np.r_[9.0, np.zeros(FEET - 1)], k_nt=np.zeros(FEET))
    feet = feet._replace(chi=np.zeros(FEET), mu=np.full(FEET, 50.0))
    slider = slider._replace(mass=1.0, preload=0.5, damping=0.0, guide=1.0, load=0.0)
    y = np.zeros(TOTALS + kernel.TOTALS)
    y[2 * MODES], y[2 * MODES + 1] = 0.0, -0.6
    march = begun(y, [1, 0, 0, 0, 0], 0.0)
    # m z″ = −k z − preload from z = 0 down and back to z = 0, then a throw under the preload.
    rate, middle = 3.0, -0.5 / 9
    size, begin = np.hypot(middle, 0.6 / rate), np.arctan2(0.6 / rate, -middle)
    lifted = (2 * np.pi - 2 * begin) / rate
    assert middle + size * np.cos(rate * lifted + begin) == pytest.approx(0.0, abs=1e-12)
    steps, h = 8, lifted / 7.5
    assert kernel.march_steps(0.0, h, steps, (stator, feet, slider, march)) == 8
    flown = steps * h - lifted
    assert march.contact.tolist() == [0.0] * FEET
    assert march.shares[0] == pytest.approx(lifted, rel=1e-3)
    assert march.state[2 * MODES] == pytest.approx(0.6 * flown - 0.25 * flown**2, rel=2e-2)
