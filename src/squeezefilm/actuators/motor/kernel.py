"""The compiled march of a slider over the feet of a vibrating plate, event by event.

Every foot is open, sticks, or slips one way or the other; the guide holds the slider or lets it
go. While nothing of that changes the motion is smooth and is stepped by the classical Runge–Kutta
method of fourth order; the instants at which something changes are found inside the steps.

A foot that is pressed in by δ and stretched along by e has, on the slider,

    N = g (k_nn δ + k_nt e),   F = k_nt δ + k_tt e,   g = 1 + χ δ'   (Hunt and Crossley 1975),

sticks with e' = the plate's speed less the slider's while |F| ≤ µ N, and slips with F = ±µ N.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from squeezefilm.actuators.motor.assembled import Feet, Slider, Stator, damping_at, spring_at
from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled

OPEN, STICK, SLIP_UP, SLIP_DOWN = 0, 1, 2, 3
DRIVE, PRELOAD, OUTPUT, MODAL_LOSS, CONTACT_LOSS, FRICTION, GUIDE_LOSS = range(7)
THRUST, NORMAL = 7, 8
TOTALS = 9
"""Works (J) in the order above, then the impulses along and across the slider (N·s)."""
# Events that one step may hold before the march gives up.
MOST_EVENTS = 400
_NO_EVENT = 1.0
_LATER = 1e-3


class March(NamedTuple):
    """The state (see `layout`), each foot's contact, the guide's (0 holds, ±1 slides), time (s) in
    contact of each foot, room to work in (8, state), the events as the last rates left them, and
    how far each must be below 0 to be more than rounding."""

    state: si.Array
    contact: si.Array
    guide: si.Array
    shares: si.Array
    room: si.Array
    events: si.Array
    rounding: si.Array


@compiled()
def _slip_stretch(sign: float, g: float, k_nn: float, k_nt: float, k_tt: float, mu: float) -> float:
    """e/δ of a foot that slips."""
    limit = sign * mu * g
    return (limit * k_nn - k_nt) / (k_tt - limit * k_nt)


@compiled()
def rates(
    t: float, y: si.Array, stator: Stator, feet: Feet, slider: Slider, march: March, dy: si.Array
) -> None:
    """The state's derivative `dy`, and `march.events`: all positive while nothing changes."""
    J, n_feet = stator.mass.size, feet.mu.size
    dy[:] = 0.0
    for j in range(J):
        if stator.held:
            angle = stator.omega[j] * t + stator.phase[j]
            y[j] = stator.amplitude[j] * math.cos(angle)
            y[J + j] = -stator.amplitude[j] * stator.omega[j] * math.sin(angle)
        dy[j] = y[J + j]
    for i in range(n_feet):
        march.events[2 * i] = _NO_EVENT
        march.events[2 * i + 1] = _NO_EVENT
        _press(i, y, stator, feet, march, dy)
    _drive(t, y, stator, 2 * J + 4 + n_feet, dy)
    _push(y, stator, feet, slider, march, dy)
    _slips(y, stator, feet, march, dy)


@compiled()
def _press(i: int, y: si.Array, stator: Stator, feet: Feet, march: March, dy: si.Array) -> None:
    """A foot's forces, from places and speeds alone: on the modes, and in the impulses' rates."""
    J, n_feet = stator.mass.size, feet.mu.size
    at = 2 * J
    totals = at + 4 + n_feet
    depth, speed, along = -y[at], -y[at + 1], -y[at + 3]
    for j in range(J):
        depth += feet.across[i, j] * y[j]
        speed += feet.across[i, j] * y[J + j]
        along += feet.along[i, j] * y[J + j]
    state = march.contact[i]
    if state == OPEN:
        march.events[2 * i] = -depth
        return
    march.events[2 * i] = depth
    k_nn, k_nt, k_tt, mu = feet.k_nn[i], feet.k_nt[i], feet.k_tt[i], feet.mu[i]
    g = 1.0 + feet.chi[i] * speed
    e = y[at + 4 + i]
    if state == STICK:
        dy[at + 4 + i] = along
    else:
        sign = 1.0 if state == SLIP_UP else -1.0
        e = depth * _slip_stretch(sign, g, k_nn, k_nt, k_tt, mu)
        y[at + 4 + i] = e
    elastic = k_nn * depth + k_nt * e
    N = g * elastic
    F = k_nt * depth + k_tt * e
    if state == STICK:
        march.events[2 * i + 1] = mu * N - abs(F)
    dy[totals + NORMAL] += N
    dy[totals + THRUST] += F
    dy[totals + CONTACT_LOSS] += feet.chi[i] * speed * speed * elastic
    for j in range(J):
        dy[J + j] -= N * feet.across[i, j] + F * feet.along[i, j]


@compiled()
def _drive(t: float, y: si.Array, stator: Stator, totals: int, dy: si.Array) -> None:
    """The modes' accelerations, from the feet's forces on them that stand in their places."""
    J = stator.mass.size
    for j in range(J):
        if stator.held:
            dy[totals + DRIVE] -= dy[J + j] * y[J + j]
            dy[J + j] = -(stator.omega[j] ** 2) * y[j]
        else:
            push = stator.force[j] * math.cos(stator.omega[j] * t + stator.phase[j])
            lost = damping_at(stator, j, y[j], y[J + j]) * y[J + j]
            dy[totals + DRIVE] += push * y[J + j]
            dy[totals + MODAL_LOSS] += lost * y[J + j]
            back = spring_at(stator, j, y[j]) * y[j]
            dy[J + j] = (dy[J + j] + push - lost - back) / stator.mass[j]


@compiled()
def _push(
    y: si.Array, stator: Stator, feet: Feet, slider: Slider, march: March, dy: si.Array
) -> None:
    """The slider's motion under the feet, its preload and guide."""
    J, n_feet = stator.mass.size, feet.mu.size
    at = 2 * J
    totals = at + 4 + n_feet
    vz, v = y[at + 1], y[at + 3]
    thrust = dy[totals + THRUST]
    dy[at] = vz
    dy[at + 1] = (dy[totals + NORMAL] - slider.preload - slider.damping * vz) / slider.mass
    dy[totals + PRELOAD] = -slider.preload * vz
    dy[totals + GUIDE_LOSS] = slider.damping * vz * vz
    dy[at + 2] = v
    march.events[2 * n_feet] = _NO_EVENT
    if slider.imposed:
        dy[totals + OUTPUT] = (thrust - slider.guide * math.copysign(1.0, v)) * v
        dy[totals + GUIDE_LOSS] += slider.guide * abs(v)
    elif march.guide[0] == 0:
        march.events[2 * n_feet] = slider.guide - abs(thrust - slider.load)
    else:
        held_back = slider.guide * march.guide[0]
        dy[at + 3] = (thrust - slider.load - held_back) / slider.mass
        dy[totals + OUTPUT] = slider.load * v
        dy[totals + GUIDE_LOSS] += held_back * v
        if slider.guide > 0.0:
            march.events[2 * n_feet] = v * march.guide[0]


@compiled()
def _slips(y: si.Array, stator: Stator, feet: Feet, march: March, dy: si.Array) -> None:
    """The slip speeds of feet that slip, which need the accelerations: events and loss."""
    J, n_feet = stator.mass.size, feet.mu.size
    at = 2 * J
    totals = at + 4 + n_feet
    for i in range(n_feet):
        if march.contact[i] < SLIP_UP:
            continue
        sign = 1.0 if march.contact[i] == SLIP_UP else -1.0
        depth, speed, rise, along = -y[at], -y[at + 1], -dy[at + 1], -y[at + 3]
        for j in range(J):
            depth += feet.across[i, j] * y[j]
            speed += feet.across[i, j] * y[J + j]
            rise += feet.across[i, j] * dy[J + j]
            along += feet.along[i, j] * y[J + j]
        k_nn, k_nt, k_tt, mu = feet.k_nn[i], feet.k_nt[i], feet.k_tt[i], feet.mu[i]
        g = 1.0 + feet.chi[i] * speed
        part = _slip_stretch(sign, g, k_nn, k_nt, k_tt, mu)
        bend = sign * mu * (k_nn * k_tt - k_nt * k_nt) / (k_tt - sign * mu * g * k_nt) ** 2
        slip = along - part * speed - depth * bend * feet.chi[i] * rise
        march.events[2 * i + 1] = sign * slip
        F = depth * (k_nt + k_tt * part)
        dy[totals + FRICTION] += F * slip


@compiled()
def _stepped(t: float, h: float, stator: Stator, feet: Feet, slider: Slider, march: March) -> None:
    """Make a Runge–Kutta step from `march.state` into room 5, with the events there."""
    y, room = march.state, march.room
    rates(t, y, stator, feet, slider, march, room[0])
    room[4, :] = y + 0.5 * h * room[0]
    rates(t + 0.5 * h, room[4], stator, feet, slider, march, room[1])
    room[4, :] = y + 0.5 * h * room[1]
    rates(t + 0.5 * h, room[4], stator, feet, slider, march, room[2])
    room[4, :] = y + h * room[2]
    rates(t + h, room[4], stator, feet, slider, march, room[3])
    room[5, :] = y + h / 6.0 * (room[0] + 2.0 * (room[1] + room[2]) + room[3])
    rates(t + h, room[5], stator, feet, slider, march, room[6])


@compiled()
def _first_event(
    t: float, h: float, before: si.Array, stator: Stator, feet: Feet, slider: Slider, march: March
) -> tuple[int, float]:
    """Event that comes first within a step that ends past one, and its time; the state just past it
    stands in room 5. By the Illinois method, on steps from the same start."""
    events = march.events
    high = h
    while True:
        which = -1
        soonest = 2.0
        for k in range(events.size):
            if events[k] < -march.rounding[k]:
                part = before[k] / (before[k] - events[k]) if before[k] > 0.0 else 0.0
                if part < soonest:
                    which, soonest = k, part
        low, f_low, f_high = 0.0, before[which], events[which]
        if f_low <= 0.0:
            # A foot that has just begun to stick is at its limit, and leaves it slowly.
            low = _LATER * high
            _stepped(t, low, stator, feet, slider, march)
            f_low = events[which]
            if f_low <= 0.0:
                # It has come already: nothing moves before it.
                _stepped(t, 0.0, stator, feet, slider, march)
                return which, 0.0
        side = 0
        for _ in range(60):
            if high - low <= 1e-13 * h:
                break
            middle = (low * f_high - high * f_low) / (f_high - f_low)
            if not low < middle < high:
                middle = 0.5 * (low + high)
            _stepped(t, middle, stator, feet, slider, march)
            f = events[which]
            if f < 0.0:
                high, f_high = middle, f
                if side == -1:
                    f_low *= 0.5
                side = -1
            else:
                low, f_low = middle, f
                if side == 1:
                    f_high *= 0.5
                side = 1
                if f == 0.0:
                    high = middle
        _stepped(t, low, stator, feet, slider, march)
        again = False
        for k in range(events.size):
            if k != which and events[k] < -march.rounding[k]:
                again = True
        if not again or low == 0.0:
            _stepped(t, high, stator, feet, slider, march)
            return which, high
        high = low


@compiled()
def _change(which: int, stator: Stator, feet: Feet, slider: Slider, march: March) -> None:
    """Change the foot, or the guide, whose event has come."""
    J, n_feet = stator.mass.size, feet.mu.size
    at = 2 * J
    y, contact = march.state, march.contact
    if which == 2 * n_feet:
        if march.guide[0] == 0:
            pull = march.room[6][at + 4 + n_feet + THRUST] - slider.load
            march.guide[0] = 1.0 if pull > 0.0 else -1.0
        else:
            march.guide[0] = 0.0
            y[at + 3] = 0.0
        return
    i = which // 2
    if which % 2 == 1:
        if contact[i] == STICK:
            depth = -y[at]
            for j in range(J):
                depth += feet.across[i, j] * y[j]
            pull = feet.k_nt[i] * depth + feet.k_tt[i] * y[at + 4 + i]
            contact[i] = SLIP_UP if pull > 0.0 else SLIP_DOWN
        else:
            contact[i] = STICK
        return
    if contact[i] != OPEN:
        contact[i] = OPEN
        y[at + 4 + i] = 0.0
        return
    speed, along = -y[at + 1], -y[at + 3]
    for j in range(J):
        speed += feet.across[i, j] * y[J + j]
        along += feet.along[i, j] * y[J + j]
    # What sticking would need, per time, against what friction gives.
    needed = feet.k_nt[i] * speed + feet.k_tt[i] * along
    g = 1.0 + feet.chi[i] * speed
    given = feet.mu[i] * g * (feet.k_nn[i] * speed + feet.k_nt[i] * along)
    y[at + 4 + i] = 0.0
    contact[i] = STICK
    if abs(needed) > given:
        contact[i] = SLIP_UP if needed > 0.0 else SLIP_DOWN


@compiled()
def march_steps(
    start: float, h: float, steps: int, parts: tuple[Stator, Feet, Slider, March]
) -> int:
    """March `steps` steps of `h` (s) from the time `start`. Returns the steps done: fewer where one
    held too many events."""
    stator, feet, slider, march = parts
    n_feet = feet.mu.size
    before = np.empty_like(march.events)
    for step in range(steps):
        t = start + step * h
        end = start + (step + 1) * h
        events = 0
        while t < end:
            left = end - t
            rates(t, march.state, stator, feet, slider, march, march.room[7])
            before[:] = march.events
            _stepped(t, left, stator, feet, slider, march)
            gone = left
            which = -1
            for k in range(march.events.size):
                if march.events[k] < -march.rounding[k]:
                    which = k
            if which >= 0:
                which, gone = _first_event(t, left, before, stator, feet, slider, march)
            march.state[:] = march.room[5]
            for i in range(n_feet):
                if march.contact[i] != OPEN:
                    march.shares[i] += gone
            if which < 0:
                break
            _change(which, stator, feet, slider, march)
            t += gone
            events += 1
            if events > MOST_EVENTS:
                return step
    return steps
