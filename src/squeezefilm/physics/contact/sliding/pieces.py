"""Pieces of the skin's motion: along one line of friction until a knot of the rows or a stop, or at
rest until it is pulled off. All is inlined: as calls the march would take half as long again.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.contact.sliding.skin_path import (
    BonePull,
    Friction,
    LumpedSkin,
    SkinPath,
    first_rise,
    passes,
    path_over,
    speed_on,
    way_on,
    works_on,
)

# When within a piece the law's rise with speed is that of the line: where a speed changes evenly,
# what the line has too much before weighs as much as what it has too little after.
_MEAN = 2.0 / 3.0
# Of a knot's distance to the next: how far beyond it the speed is when it has passed.
_BEYOND = 1e-10
_ROUNDING = 1e-13
STAYS, _ABOVE, _BELOW = 0, 1, -1


class BoneDrive(NamedTuple):
    """The bone's places (n,), its speeds at the start and the end of each interval (n−1,), the
    friction force for each unit of a row (n,), the time between samples (s), and the parts in which
    an interval is marched."""

    bone: si.Array
    speed_in: si.Array
    speed_out: si.Array
    limit: si.Array
    time_step: float
    substeps: int


class Rows(NamedTuple):
    """Friction coefficients over speeds (k,) that rise from 0: a row for every sample, or one for
    all (n or 1, k). A drive's limit is the force for each of their units."""

    speed: si.Array
    coefficient: si.Array


class BoneStep(NamedTuple):
    """An interval between two samples: its number, the bone's place and speed at its start and the
    rate of that speed (m, m/s, m/s²), friction at rest then and its rate (N, N/s), and whether
    nothing ever holds the skin in it."""

    number: int
    bone: float
    bone_speed: float
    bone_rate: float
    hold: float
    hold_rate: float
    free: bool


class SkinState(NamedTuple):
    """The skin's place (m) and speed (m/s), the way it slips (1 or −1; 0: it sticks), and the knot
    of the rows below its speed."""

    place: float
    speed: float
    side: float
    knot: int


class Slip(NamedTuple):
    """A piece of a slip, seen along it: the skin's path, pull and friction, the time for which they
    hold (s), what ends it, the speed then (m/s), and how far friction strays from the law (N)."""

    path: SkinPath
    pull: BonePull
    friction: Friction
    part: float
    ended: int
    speed: float
    astray: float


@compiled(inline="always")
def on_segment(speed: si.Array, rows: si.Array, i: int, j: int) -> tuple[float, float]:
    """Coefficient of row i at knot j, and its rise with speed above (s/m)."""
    i = min(i, rows.shape[0] - 1)
    low = rows[i, j]
    if j == speed.size - 1:
        return low, 0.0
    return low, (rows[i, j + 1] - low) / (speed[j + 1] - speed[j])


@compiled(inline="always")
def on_law(speed: si.Array, rows: si.Array, i: int, j: int, pace: float) -> float:
    """Coefficient of row i at a speed (m/s) on the line above knot j."""
    low, rise = on_segment(speed, rows, i, j)
    return float(low + rise * (pace - speed[j]))


@compiled(inline="always")
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


@compiled(inline="always")
def slip_piece(
    reach: float,
    w: float,
    bounds: tuple[float, float],
    pull: BonePull,
    friction: Friction,
    skin: LumpedSkin,
    series: si.Array,
) -> tuple[SkinPath, float, int, float]:
    """The skin's path from the speed w over `reach`, how much of it stays within the bounds, and
    which one ends it, and the speed at its end."""
    low, high = bounds
    path = path_over(reach, w, pull, friction, skin, series)
    part, ended = reach, STAYS
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


@compiled(inline="always")
def interval_at(i: int, drive: BoneDrive, rows: Rows) -> BoneStep:
    """Interval number i."""
    last = rows.coefficient.shape[0] - 1
    hold = drive.limit[i] * rows.coefficient[min(i, last), 0]
    end = drive.limit[i + 1] * rows.coefficient[min(i + 1, last), 0]
    rate = (drive.speed_out[i] - drive.speed_in[i]) / drive.time_step
    hold_rate = (end - hold) / drive.time_step
    free = hold == 0.0 and hold_rate == 0.0
    return BoneStep(i, drive.bone[i], drive.speed_in[i], rate, hold, hold_rate, free)


@compiled(inline="always")
def pull_at(s: float, now: BoneStep, skin: LumpedSkin) -> BonePull:
    """The pull of bone and pad a time s into an interval."""
    k, c = skin.stiffness, skin.damping
    vb = now.bone_speed + now.bone_rate * s
    xb = now.bone + s * (now.bone_speed + 0.5 * now.bone_rate * s)
    return BonePull(
        k * xb + c * vb, k * vb + c * now.bone_rate, 0.5 * k * now.bone_rate, vb, now.bone_rate
    )


@compiled(inline="always")
def slip_over(
    reach: float,
    s: float,
    at: SkinState,
    pull: BonePull,
    now: BoneStep,
    drive: BoneDrive,
    skin: LumpedSkin,
    rows: Rows,
    series: si.Array,
) -> Slip:
    """A slip from a time s into an interval, over `reach` (s) at the most."""
    i, j, side, force, speeds = now.number, at.knot, at.side, drive.limit, rows.speed
    # Friction's line: the law's tangent in speed and time.
    w = side * at.speed
    above = w - speeds[j]
    low, rise = on_segment(speeds, rows.coefficient, i, j)
    more, steeper = on_segment(speeds, rows.coefficient, i + 1, j)
    low *= force[i]
    rise *= force[i]
    more = (more * force[i + 1] - low) / drive.time_step
    steeper = (steeper * force[i + 1] - rise) / drive.time_step
    low += more * s
    rise += steeper * s
    start = low + rise * above
    line = Friction(start, rise + _MEAN * steeper * reach, more + steeper * above)
    f = pull.start - skin.stiffness * at.place
    along = BonePull(
        side * f, side * pull.rate, side * pull.bend, side * pull.bone_speed, side * pull.bone_rate
    )
    bounds = bounds_on(speeds, j, now.free)
    for _ in range(2):
        path, part, ended, end = slip_piece(reach, w, bounds, along, line, skin, series)
        used = line.start + line.rise * (end - w) + line.rate * part
        if used * end >= 0.0 and w * end >= 0.0:
            break
        # Friction never drives: where the line would, the law is held as it was.
        line = Friction(start, rise, 0.0)
    astray = abs(used - (low + more * part + (rise + steeper * part) * (end - speeds[j])))
    if steeper != 0.0 and part > 0.0:
        # A speed that went and came back has no share in what is seen at the end.
        middle, _ = speed_on(path, 0.5 * part, series)
        astray = max(astray, abs(steeper * (_MEAN * reach - 0.5 * part) * (middle - w)))
    return Slip(path, along, line, part, ended, end, astray)


@compiled(inline="always")
def works_of_rest(part: float, f: float, pull: BonePull, c: float) -> tuple[float, float]:
    """Work of the bone and lost to damping (J) while the skin stays, held by f at the start (N)."""
    # The bone's speed is a line and its force a parabola: cubic, with Simpson's rule exact.
    vb, rate = pull.bone_speed, pull.bone_rate
    half, end = vb + 0.5 * rate * part, vb + rate * part
    middle = f + 0.5 * part * (pull.rate + 0.5 * part * pull.bend)
    last = f + part * (pull.rate + part * pull.bend)
    bone = (f * vb + 4.0 * middle * half + last * end) * part / 6.0
    return bone, c * (vb * vb + 4.0 * half * half + end * end) * part / 6.0


@compiled(inline="always")
def stay(
    at: SkinState,
    s: float,
    goal: float,
    briefly: float,
    pull: BonePull,
    now: BoneStep,
    static_ratio: float,
    skin: LumpedSkin,
    work: si.Array,
) -> tuple[float, float]:
    """The time for which the skin stays, from a time s into an interval: stuck, until it is pulled
    off or to `goal`, else `briefly` (s); and the way it is pulled off then (0: it is not). Works
    (J) are added."""
    f = pull.start - skin.stiffness * at.place
    part, side = briefly, 0.0
    if at.side == 0.0:
        held, grows = static_ratio * (now.hold + now.hold_rate * s), static_ratio * now.hold_rate
        part = goal - s
        up = first_rise(f - held, pull.rate - grows, pull.bend, part)
        down = first_rise(-f - held, -pull.rate - grows, -pull.bend, part)
        if up >= 0.0 and (down < 0.0 or up <= down):
            part, side = up, 1.0
        elif down >= 0.0:
            part, side = down, -1.0
    towed, damped = works_of_rest(part, f, pull, skin.damping)
    work[0] += towed
    work[2] += damped
    return part, side


@compiled(inline="always")
def slipped(
    slip: Slip, at: SkinState, skin: LumpedSkin, series: si.Array, work: si.Array
) -> SkinState:
    """The skin at the end of a slip, whose works (J) are added."""
    towed, lost, damped = works_on(slip.path, slip.part, slip.pull, slip.friction, skin, series)
    work[0] += towed
    work[1] += lost
    work[2] += damped
    place = at.place + at.side * way_on(slip.path, slip.part, series)
    return SkinState(place, at.side * slip.speed, at.side, at.knot)


@compiled(inline="always")
def beyond(
    slip: Slip,
    s: float,
    at: SkinState,
    pull: BonePull,
    now: BoneStep,
    static_ratio: float,
    stiffness: float,
) -> tuple[SkinState, bool]:
    """The skin after a slip that ended at a knot of the rows, a time s into an interval, and
    whether it came to rest there."""
    if slip.ended == _ABOVE:
        return SkinState(at.place, at.speed, at.side, at.knot + 1), False
    if at.knot > 0:
        return SkinState(at.place, at.speed, at.side, at.knot - 1), False
    if now.free:
        return SkinState(at.place, at.speed, -at.side, 1), False
    f = pull.start + slip.part * (pull.rate + slip.part * pull.bend) - stiffness * at.place
    held = static_ratio * (now.hold + now.hold_rate * s)
    return SkinState(at.place, 0.0, math.copysign(1.0, f) if abs(f) > held else 0.0, 0), True
