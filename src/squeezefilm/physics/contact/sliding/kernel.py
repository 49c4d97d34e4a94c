"""The compiled march of the skin, under friction by rows over its own speed.

Between two speeds of the grid friction is a line, so that it is one more damper there: the skin's
equation stays linear from knot to knot, and `skin_path` solves it however great that damper is. The
instants at which the speed passes a knot, and at which slips begin and end, are found inside the
step: no speed is regularised, and a stuck skin does not move at all. Where friction changes with
time as well, it is a line in time over a piece; a piece in which that strays from the law is
shortened.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.contact.sliding.skin_motion import HALVINGS, Skin, first_rise
from squeezefilm.physics.contact.sliding.skin_path import (
    TERMS,
    Friction,
    Path,
    Pull,
    passes,
    path_over,
    speed_on,
    way_on,
    works_on,
)

# Slip starts and ends that one sample interval may hold before the march gives up.
MOST_EVENTS = 200
# Of the strongest friction: how far the line used may stray from the law at the end of a piece.
LAW_TOLERANCE = 3e-4
# When within a piece the law's rise with speed is that of the line: where a speed changes evenly,
# what the line has too much before weighs as much as what it has too little after.
_MEAN = 2.0 / 3.0
# Pieces are shortened down to this part of a substep.
_SHORTEST = 2.0**-40
# Of a knot's distance to the next: how far beyond it the speed is when it has passed.
_BEYOND = 1e-10
_ROUNDING = 1e-13
# Of a step: what rounding leaves over.
_LAST = 1e-14
_STAYS, _ABOVE, _BELOW = 0, 1, -1


class Drive(NamedTuple):
    """The bone's places (n,), its speeds at the start and the end of each interval (n−1,), the
    friction force for each unit of a row (n,), the time between samples (s), and the parts in which
    an interval is marched."""

    bone: si.Array
    speed_in: si.Array
    speed_out: si.Array
    limit: si.Array
    time_step: float
    substeps: int


class Track(NamedTuple):
    """Record of a march; `position[0]` and `speed[0]` hold the start.

    `work` (3, n) is the work done by the bone, lost to friction and to damping. `account` is the
    time stuck (s), slips begun, and the largest departure of the friction used from the friction
    law at the end of a piece (over the strongest of all).
    """

    position: si.Array
    speed: si.Array
    friction: si.Array
    bone_force: si.Array
    stuck: si.Array
    work: si.Array
    account: si.Array


class Rows(NamedTuple):
    """Friction coefficients over speeds (k,) that rise from 0: a row for every sample, or one for
    all (n or 1, k). A drive's limit is the force for each of their units."""

    speed: si.Array
    coefficient: si.Array


@compiled()
def on_segment(speed: si.Array, rows: si.Array, i: int, j: int) -> tuple[float, float]:
    """Coefficient of row i at knot j, and its rise with speed above (s/m)."""
    i = min(i, rows.shape[0] - 1)
    low = rows[i, j]
    if j == speed.size - 1:
        return low, 0.0
    return low, (rows[i, j + 1] - low) / (speed[j + 1] - speed[j])


@compiled()
def on_law(speed: si.Array, rows: si.Array, i: int, j: int, pace: float) -> float:
    """Coefficient of row i at a speed (m/s) on the line above knot j."""
    low, rise = on_segment(speed, rows, i, j)
    return float(low + rise * (pace - speed[j]))


@compiled()
def strongest_and_fall(rows: Rows, force: si.Array) -> tuple[float, float]:
    """The strongest friction (N) of all rows at `force` (N) for each of their units, and its
    steepest fall with speed (N·s/m), at least 0."""
    speed, coefficient = rows
    top, fall = np.zeros(speed.size), np.zeros(speed.size)
    for i in range(force.size):
        row, load = coefficient[min(i, coefficient.shape[0] - 1)], force[i]
        # Knot by knot, which a processor does for several at once.
        for j in range(speed.size - 1):
            high = row[j] * load
            down = high - row[j + 1] * load
            top[j] = high if high > top[j] else top[j]
            fall[j] = down if down > fall[j] else fall[j]
        top[-1] = max(top[-1], row[-1] * load)
    return top.max(), (fall[:-1] / np.diff(speed)).max()


@compiled()
def bounds_on(speed: si.Array, j: int, free: bool) -> tuple[float, float]:
    """Speeds (m/s) between which the line above knot j is followed: a little beyond its knots, but
    not below rest; where friction vanishes there (`free`), to the line's mirror image."""
    last = speed.size - 1
    width = speed[min(j + 1, last)] - speed[min(j, last - 1)]
    beyond = _BEYOND * width + _ROUNDING * speed[j]
    high = speed[j + 1] + beyond if j < last else math.inf
    if j > 0:
        return speed[j] - beyond, high
    return (-high if free else 0.0), high


@compiled()
def slip_piece(
    reach: float,
    w: float,
    bounds: tuple[float, float],
    pull: Pull,
    friction: Friction,
    skin: Skin,
    series: si.Array,
) -> tuple[Path, float, int, float]:
    """The skin's path from the speed w over `reach`, how much of it stays within the bounds, and
    which one ends it, and the speed at its end."""
    low, high = bounds
    path = path_over(reach, w, pull, friction, skin, series)
    part, ended = reach, _STAYS
    start = (pull.start - friction.start - skin.damping * w) / skin.mass
    end, end_rate = speed_on(path, reach, series)
    if high < math.inf:
        up = passes(path, reach, high, 1.0, (start, end, end_rate), series)
        if up >= 0.0:
            part, ended = up, _ABOVE
            end, end_rate = speed_on(path, part, series)
    down = passes(path, part, low, -1.0, (start, end, end_rate), series)
    if down >= 0.0:
        part, ended = down, _BELOW
        # A stop is a stop, whatever rounding says of its speed.
        end = speed_on(path, part, series)[0] if low != 0.0 else 0.0
    return path, part, ended, end


@compiled()
def works_of_rest(
    part: float, f: float, pull: tuple[float, float, float], vb: float, rate: float, c: float
) -> tuple[float, float]:
    """Work of the bone and lost to damping (J) while the skin stays, held by f at the start (N)."""
    # The bone's speed is a line and its force a parabola: cubic, with Simpson's rule exact.
    half, end = vb + 0.5 * rate * part, vb + rate * part
    middle = f + 0.5 * part * (pull[1] + 0.5 * part * pull[2])
    last = f + part * (pull[1] + part * pull[2])
    bone = (f * vb + 4.0 * middle * half + last * end) * part / 6.0
    return bone, c * (vb * vb + 4.0 * half * half + end * end) * part / 6.0


@compiled()
def slide_march(
    drive: Drive,
    skin: Skin,
    rows: Rows,
    static_ratio: float,
    strongest: float,
    track: Track,
) -> int:
    """March the skin over all n samples; `strongest` is the strongest friction of all (N).

    Returns n, or the interval in which slip started and ended, or speeds were passed, too often.
    """
    bone, speed_in, speed_out, force, time_step, substeps = drive
    speeds, coefficient = rows
    last_row = coefficient.shape[0] - 1
    position, speed, friction, bone_force, stuck, work, account = track
    k, c = skin.stiffness, skin.damping
    h = time_step / substeps
    tolerance = LAW_TOLERANCE * strongest
    series = np.empty(TERMS)
    x = position[0]
    v = speed[0]
    load = k * (bone[0] - x) + c * (speed_in[0] - v)
    at_rest = force[0] * coefficient[0, 0]
    sign = 0.0
    if v != 0.0:
        sign = math.copysign(1.0, v)
    elif abs(load) > static_ratio * at_rest or coefficient[: min(2, last_row + 1), 0].max() == 0.0:
        sign = math.copysign(1.0, load)
        account[1] += 1.0
    j = 0
    while j < speeds.size - 1 and speeds[j + 1] <= abs(v):
        j += 1
    force_end = force[0] * on_law(speeds, coefficient, 0, j, abs(v))
    bone_force[0] = load
    stuck[0] = sign == 0.0
    friction[0] = load if sign == 0.0 else sign * force_end
    for i in range(bone.size - 1):
        v_in = speed_in[i]
        rate = (speed_out[i] - v_in) / time_step
        L0 = at_rest
        at_rest = force[i + 1] * coefficient[min(i + 1, last_row), 0]
        dL = (at_rest - L0) / time_step
        # Without friction at rest the skin passes through it, and nothing ever holds it.
        free = L0 == 0.0 and dL == 0.0
        done_bone = done_lost = done_damped = 0.0
        events = passed = 0
        trial = h
        s = 0.0
        if sign * v < 0.0:
            sign = -sign
        for part_of_step in range(substeps):
            goal = time_step if part_of_step == substeps - 1 else (part_of_step + 1) * h
            tries = 0
            while s < goal:
                if goal - s <= _LAST * time_step:
                    s = goal
                    break
                reach = min(trial, goal - s)
                vb = v_in + rate * s
                xb = bone[i] + s * (v_in + 0.5 * rate * s)
                pull = (k * xb + c * vb, k * vb + c * rate, 0.5 * k * rate)
                f = pull[0] - k * x
                part = 0.0
                if sign == 0.0 and free:
                    sign = math.copysign(1.0, f)
                    account[1] += 1.0
                    j = 0
                if sign != 0.0:
                    # Friction's line: the law's tangent in speed and time.
                    w = sign * v
                    above = w - speeds[j]
                    low, rise = on_segment(speeds, coefficient, i, j)
                    more, steeper = on_segment(speeds, coefficient, i + 1, j)
                    low *= force[i]
                    rise *= force[i]
                    more = (more * force[i + 1] - low) / time_step
                    steeper = (steeper * force[i + 1] - rise) / time_step
                    low += more * s
                    rise += steeper * s
                    F0 = low + rise * above
                    line = Friction(F0, rise + _MEAN * steeper * reach, more + steeper * above)
                    along = Pull(sign * f, sign * pull[1], sign * pull[2], sign * vb, sign * rate)
                    bounds = bounds_on(speeds, j, free)
                    for _ in range(2):
                        path, part, ended, w_end = slip_piece(
                            reach, w, bounds, along, line, skin, series
                        )
                        force_end = line.start + line.rise * (w_end - w) + line.rate * part
                        if force_end * w_end >= 0.0 and w * w_end >= 0.0:
                            break
                        # Friction never drives: where the line would, the law is held as it was.
                        line = Friction(F0, rise, 0.0)
                if sign == 0.0 or part == 0.0:
                    # It stays, until pulled off; after a slip too short to be found for longer
                    # each time.
                    if sign == 0.0:
                        held, grows = static_ratio * (L0 + dL * s), static_ratio * dL
                        part = goal - s
                        up = first_rise(f - held, pull[1] - grows, pull[2], part)
                        down = first_rise(-f - held, -pull[1] - grows, -pull[2], part)
                        if up >= 0.0 and (down < 0.0 or up <= down):
                            part = up
                            sign = 1.0
                        elif down >= 0.0:
                            part = down
                            sign = -1.0
                        if sign != 0.0:
                            j = 0
                            account[1] += 1.0
                            events += 1
                            if events > MOST_EVENTS:
                                return i
                    else:
                        part = min(reach * 0.5**HALVINGS * 4.0**tries, reach)
                        tries += 1
                        account[1] -= 1.0
                        sign = 0.0
                    towed, damped = works_of_rest(part, f, pull, vb, rate, c)
                    done_bone += towed
                    done_damped += damped
                    account[0] += part
                    s = goal if part == goal - s else s + part
                    trial = h
                    continue
                u = way_on(path, part, series)
                law = low + more * part + (rise + steeper * part) * (w_end - speeds[j])
                astray = abs(force_end - law)
                if steeper != 0.0:
                    # A speed that went and came back has no share in what is seen at the end.
                    w_mid, _ = speed_on(path, 0.5 * part, series)
                    late = _MEAN * reach - 0.5 * part
                    astray = max(astray, abs(steeper * late * (w_mid - w)))
                if astray > tolerance and reach > _SHORTEST * h:
                    trial = part * max(0.1, 0.8 * math.sqrt(tolerance / astray))
                    continue
                account[2] = max(account[2], astray / strongest if strongest > 0.0 else 0.0)
                towed, lost, damped = works_on(path, part, along, line, skin, series)
                done_bone += towed
                done_lost += lost
                done_damped += damped
                s = goal if part >= goal - s else s + part
                trial = (
                    h
                    if astray <= 0.01 * tolerance
                    else min(h, reach * max(1.0, 0.8 * math.sqrt(tolerance / astray)))
                )
                x += sign * u
                v = sign * w_end
                if ended == _STAYS:
                    continue
                passed += 1
                if passed > 2 * MOST_EVENTS * speeds.size:
                    return i
                if ended == _ABOVE:
                    j += 1
                elif j > 0:
                    j -= 1
                elif free:
                    sign = -sign
                    j = 1
                else:
                    v = 0.0
                    f = pull[0] + part * (pull[1] + part * pull[2]) - k * x
                    sign = 0.0
                    if abs(f) > static_ratio * (L0 + dL * s):
                        sign = math.copysign(1.0, f)
                        account[1] += 1.0
                    events += 1
                    if events > MOST_EVENTS:
                        return i
        position[i + 1] = x
        speed[i + 1] = v
        stuck[i + 1] = sign == 0.0
        bone_force[i + 1] = k * (bone[i + 1] - x) + c * (speed_out[i] - v)
        friction[i + 1] = bone_force[i + 1]
        if sign != 0.0:
            # The law itself, from which the line that moved the skin may have strayed.
            law = force[i + 1] * on_law(speeds, coefficient, i + 1, j, abs(v))
            # Where friction vanishes at rest, a skin that has turned is still on its line.
            friction[i + 1] = math.copysign(law, v if v != 0.0 else sign)
        work[0, i + 1] = work[0, i] + done_bone
        work[1, i + 1] = work[1, i] + done_lost
        work[2, i + 1] = work[2, i] + done_damped
    return int(bone.size)
