"""One compiled march of a mass on a spring and a damper under set-valued Coulomb friction.

Between two samples the bone's motion is a parabola and the friction limit a line, so the skin's
equation has a closed solution while it sticks and while it slides. Both are stepped with it, and
the instants at which one becomes the other are found inside the step: no velocity is regularised,
and a stuck skin does not move at all.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.contact.sliding.skin_motion import (
    HALVINGS,
    Forces,
    Skin,
    end_of_slip,
    first_rise,
    slide_along,
    slide_by,
    transition,
)

# Slip starts and ends that one sample interval may hold before the march gives up.
MOST_EVENTS = 200
# Three Gauss points: the powers of a step are integrated to its sixth order.
_NODES = (0.5 - math.sqrt(0.15), 0.5, 0.5 + math.sqrt(0.15))
_WEIGHTS = (5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0)


class Drive(NamedTuple):
    """The bone's places (n,), its speeds at the start and the end of each interval (n−1,), the
    kinetic friction force before the ground's factor (n,), the time between samples (s), and the
    parts in which an interval is marched."""

    bone: si.Array
    speed_in: si.Array
    speed_out: si.Array
    limit: si.Array
    time_step: float
    substeps: int


class Law(NamedTuple):
    """Static over kinetic friction, and the speed (m/s) over which it falls; 0: at once."""

    static_ratio: float
    stribeck_speed: float


class Ground(NamedTuple):
    """Factors of friction that belong to places: those from `start` on, `spacing` apart (m)."""

    start: float
    spacing: float
    factor: si.Array


class Track(NamedTuple):
    """What a march writes; `position[0]` and `speed[0]` hold the start.

    `work` (3, n) is the work done by the bone, lost to friction and to damping. `account` is the
    time stuck (s), slips begun, and the largest departure of the friction used from the friction
    law at the middle of a substep (over the limit there).
    """

    position: si.Array
    speed: si.Array
    friction: si.Array
    bone_force: si.Array
    stuck: si.Array
    work: si.Array
    account: si.Array


@compiled()
def at_place(place: float, start: float, spacing: float, profile: si.Array) -> float:
    """The ground's factor (linear between its points, held beyond its ends) at a place (m)."""
    if profile.size == 1:
        return float(profile[0])
    along = (place - start) / spacing
    i = min(max(int(along), 0), profile.size - 2)
    part = min(max(along - i, 0.0), 1.0)
    return float(profile[i] + part * (profile[i + 1] - profile[i]))


@compiled()
def slide_march(drive: Drive, skin: Skin, law: Law, ground: Ground, track: Track) -> int:
    """March the skin over all n samples.

    Returns n, or the interval in which slip started and ended too often.
    """
    bone, speed_in, speed_out, limit, time_step, substeps = drive
    static_ratio, stribeck_speed = law
    start, spacing, profile = ground
    position, speed, friction, bone_force, stuck, work, account = track
    x = position[0]
    v = speed[0]
    k, c = skin.stiffness, skin.damping
    drops = stribeck_speed > 0.0 and static_ratio > 1.0
    bent = drops or profile.size > 1
    h = time_step / substeps
    # Whole substeps are alike: their exponentials are taken once.
    whole = transition(h, skin)
    first = transition(_NODES[0] * h, skin)
    second = transition(_NODES[1] * h, skin)
    third = transition(_NODES[2] * h, skin)
    here = at_place(x, start, spacing, profile)
    load = k * (bone[0] - x) + c * (speed_in[0] - v)
    sign = 0.0
    if v != 0.0:
        sign = math.copysign(1.0, v)
    elif abs(load) > static_ratio * here * limit[0]:
        sign = math.copysign(1.0, load)
        account[1] += 1.0
    bone_force[0] = load
    stuck[0] = sign == 0.0
    force_end = 0.0
    if sign != 0.0:
        force_end = limit[0] * here
        if drops:
            force_end *= 1.0 + (static_ratio - 1.0) * math.exp(-abs(v) / stribeck_speed)
    friction[0] = load if sign == 0.0 else sign * force_end
    for i in range(bone.size - 1):
        v_in = speed_in[i]
        rate = (speed_out[i] - v_in) / time_step
        L0 = limit[i]
        dL = (limit[i + 1] - L0) / time_step
        done = np.zeros(3)
        events = 0
        s = 0.0
        for j in range(substeps):
            goal = time_step if j == substeps - 1 else (j + 1) * h
            tries = 0
            while s < goal:
                span = goal - s
                vb = v_in + rate * s
                xb = bone[i] + s * (v_in + 0.5 * rate * s)
                pull = (k * xb + c * vb, k * vb + c * rate, 0.5 * k * rate)
                L = L0 + dL * s
                here = at_place(x, start, spacing, profile)
                if sign == 0.0:
                    hold = static_ratio * here
                    f = pull[0] - k * x
                    up = first_rise(f - hold * L, pull[1] - hold * dL, pull[2], span)
                    down = first_rise(-f - hold * L, -pull[1] - hold * dL, -pull[2], span)
                    part = span
                    if up >= 0.0 and (down < 0.0 or up <= down):
                        part = up
                        sign = 1.0
                    elif down >= 0.0:
                        part = down
                        sign = -1.0
                    for q in range(3):
                        t = _NODES[q] * part
                        vb_t = vb + rate * t
                        f_t = f + t * (pull[1] + t * pull[2])
                        done[0] += _WEIGHTS[q] * part * f_t * vb_t
                        done[2] += _WEIGHTS[q] * part * c * vb_t * vb_t
                    account[0] += part
                    s = goal if sign == 0.0 else s + part
                    if sign != 0.0:
                        account[1] += 1.0
                        events += 1
                        if events > MOST_EVENTS:
                            return i
                    continue
                # Slip. The friction force is a line over the substep; where it depends on speed
                # or place, its end is found by prediction and two corrections.
                even = abs(span - h) <= 1e-12 * h
                passed = whole if even else transition(span, skin)
                F0 = here * L
                if drops:
                    F0 *= 1.0 + (static_ratio - 1.0) * math.exp(-abs(v) / stribeck_speed)
                dF = here * dL
                if bent:
                    for _ in range(3):
                        forces = Forces(pull, sign * F0, sign * dF)
                        x1, v1, _ = slide_by(passed, span, x, v, forces, skin)
                        F1 = (L + dL * span) * at_place(x1, start, spacing, profile)
                        if drops:
                            v1 = max(sign * v1, 0.0)
                            F1 *= 1.0 + (static_ratio - 1.0) * math.exp(-v1 / stribeck_speed)
                        dF = (F1 - F0) / span
                forces = Forces(pull, sign * F0, sign * dF)
                part = end_of_slip(passed, span, x, v, sign, forces, skin)
                if part == 0.0:
                    # A slip too short to be found: the skin stays, for longer each time.
                    part = min(span * 0.5**HALVINGS * 4.0**tries, span)
                    tries += 1
                    for q in range(3):
                        t = _NODES[q] * part
                        vb_t = vb + rate * t
                        f_t = pull[0] - k * x + t * (pull[1] + t * pull[2])
                        done[0] += _WEIGHTS[q] * part * f_t * vb_t
                        done[2] += _WEIGHTS[q] * part * c * vb_t * vb_t
                    account[0] += part
                    account[1] -= 1.0
                    sign = 0.0
                    s = goal if part == span else s + part
                    continue
                ends = part > 0.0
                if bent and ends:
                    # The friction's line must end where the slip does, not where the substep does.
                    for _ in range(4):
                        forces = Forces(pull, sign * F0, sign * dF)
                        x1, _, _ = slide_along(part, x, v, forces, skin)
                        F1 = (L + dL * part) * at_place(x1, start, spacing, profile)
                        if drops:
                            F1 *= static_ratio
                        steeper = (F1 - F0) / part
                        forces = Forces(pull, sign * F0, sign * steeper)
                        sooner = end_of_slip(passed, span, x, v, sign, forces, skin)
                        if sooner <= 0.0:
                            break
                        dF = steeper
                        part = sooner
                even = even and not ends
                if ends:
                    passed = transition(part, skin)
                else:
                    part = span
                forces = Forces(pull, sign * F0, sign * dF)
                for q in range(3):
                    t = _NODES[q] * part
                    by = first if q == 0 else second if q == 1 else third
                    if not even:
                        by = transition(t, skin)
                    x_t, v_t, _ = slide_by(by, t, x, v, forces, skin)
                    vb_t = vb + rate * t
                    xb_t = xb + t * (vb + 0.5 * rate * t)
                    F_t = F0 + dF * t
                    done[0] += _WEIGHTS[q] * part * (k * (xb_t - x_t) + c * (vb_t - v_t)) * vb_t
                    done[1] += _WEIGHTS[q] * part * F_t * abs(v_t)
                    done[2] += _WEIGHTS[q] * part * c * (vb_t - v_t) ** 2
                    if bent and q == 1:
                        top = (L + dL * t) * at_place(x_t, start, spacing, profile)
                        lawful = top
                        if drops:
                            lawful *= 1.0 + (static_ratio - 1.0) * math.exp(
                                -abs(v_t) / stribeck_speed
                            )
                        if lawful > 0.0:
                            account[2] = max(account[2], abs(F_t / lawful - 1.0))
                x, v, _ = slide_by(passed, part, x, v, forces, skin)
                force_end = F0 + dF * part
                if not ends:
                    s = goal
                    continue
                s = min(s + part, goal)
                v = 0.0
                vb = v_in + rate * s
                f = k * (bone[i] + s * (v_in + 0.5 * rate * s) - x) + c * vb
                here = at_place(x, start, spacing, profile)
                hold = static_ratio * here * (L0 + dL * s)
                sign = 0.0
                if abs(f) > hold:
                    sign = math.copysign(1.0, f)
                    force_end = hold if drops else here * (L0 + dL * s)
                    account[1] += 1.0
                events += 1
                if events > MOST_EVENTS:
                    return i
        position[i + 1] = x
        speed[i + 1] = v
        stuck[i + 1] = sign == 0.0
        bone_force[i + 1] = k * (bone[i + 1] - x) + c * (speed_out[i] - v)
        friction[i + 1] = bone_force[i + 1] if sign == 0.0 else sign * force_end
        for q in range(3):
            work[q, i + 1] = work[q, i] + done[q]
    return int(bone.size)
