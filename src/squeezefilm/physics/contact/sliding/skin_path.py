"""The skin over a piece of time in which friction rises in a line with its speed, however steeply.

Everything is seen along the way the skin slides: its way u and speed w begin at 0 and w0, and

    m ü + (c + G) u̇ + k u = p0 + p1 t + p2 t² − (F0 − G w0) − F' t

where G is friction's rise with speed (N·s/m), and F0 and F' are its value at the start and its
change with time. The solution is a power series, whose first terms are enough for a short piece;
where G is great, what dies out at once is a summand of its own, b exp(−r t), and the series is that
of the rest. Nothing here loses digits as G → ∞, which the form of `slide_by` with its particular
parabola does.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled

# Slips shorter than this power of ½ of a substep are not looked for.
HALVINGS = 20


class LumpedSkin(NamedTuple):
    """A mass on a spring and a damper that hang on the bone."""

    mass: float
    damping: float
    stiffness: float


class Forces(NamedTuple):
    """Forces on a sliding skin over time: the coefficients of k x_bone + c v_bone, and the friction
    force against it with its slope. Three numbers, not an array, whose references numba counts."""

    pull: tuple[float, float, float]
    friction: float
    slope: float


@compiled()
def transition(s: float, skin: LumpedSkin) -> Any:
    """Matrix that takes (y, ẏ) of the free skin to a time s later: y ← a y + b ẏ, ẏ ← c y + d ẏ."""
    mass, damping, stiffness = skin
    decay = damping / (2.0 * mass)
    omega2 = stiffness / mass
    split = decay * decay - omega2
    if abs(split) * s * s < 1e-4:
        # Near critical damping sinh(r s)/r loses its digits; its series does not.
        z = split * s * s
        fade = math.exp(-decay * s)
        even = fade * (1.0 + z / 2.0 * (1.0 + z / 12.0 * (1.0 + z / 30.0)))
        odd = fade * s * (1.0 + z / 6.0 * (1.0 + z / 20.0 * (1.0 + z / 42.0)))
    elif split > 0.0:
        r = math.sqrt(split)
        slow = math.exp(-omega2 / (decay + r) * s)
        fast = math.exp(-(decay + r) * s)
        even = 0.5 * (slow + fast)
        odd = 0.5 * (slow - fast) / r
    else:
        r = math.sqrt(-split)
        fade = math.exp(-decay * s)
        even = fade * math.cos(r * s)
        odd = fade * math.sin(r * s) / r
    return even + decay * odd, odd, -omega2 * odd, even - decay * odd


@compiled()
def first_rise(a: float, b: float, c: float, span: float) -> float:
    """The first s in [0, span] from which a + b s + c s² is positive, or −1."""
    if a > 0.0:
        return 0.0
    if c == 0.0:
        if b <= 0.0:
            return -1.0
        s = -a / b
    else:
        under = b * b - 4.0 * a * c
        if under <= 0.0:
            return -1.0
        # The root at which the parabola rises, without subtracting like numbers.
        s = -2.0 * a / (b + math.sqrt(under)) if b > 0.0 else (math.sqrt(under) - b) / (2.0 * c)
    return s if 0.0 <= s <= span else -1.0


@compiled()
def slide_by(passed: Any, s: float, x: float, v: float, forces: Forces, skin: LumpedSkin) -> Any:
    """Position, speed and acceleration a time s into sliding from x at the speed v.

    `passed` is the `transition` of s, which a march at a fixed step knows beforehand. The
    particular solution is the parabola A + B s + C s².
    """
    pull, force, slope = forces
    mass, damping, stiffness = skin
    C = pull[2] / stiffness
    B = (pull[1] - slope - 2.0 * damping * C) / stiffness
    A = (pull[0] - force - damping * B - 2.0 * mass * C) / stiffness
    y = passed[0] * (x - A) + passed[1] * (v - B)
    w = passed[2] * (x - A) + passed[3] * (v - B)
    return (
        A + s * (B + s * C) + y,
        B + 2.0 * C * s + w,
        2.0 * C - (damping * w + stiffness * y) / mass,
    )


# Terms of the series: over a piece that is short for the skin, the next is below rounding.
TERMS = 16
_PARTS = 1.0 / np.arange(1.0, TERMS + 1.0)
# Of (c + G) t/m: below, the series holds all; above, and t ω ≤ 1/4, the fast part is set apart.
_FAST = 0.6
_ROOT_STEPS = 80
# Four Gauss points: exact to the seventh power.
_INNER = 0.5 * math.sqrt(3.0 / 7.0 - 2.0 / 7.0 * math.sqrt(6.0 / 5.0))
_OUTER = 0.5 * math.sqrt(3.0 / 7.0 + 2.0 / 7.0 * math.sqrt(6.0 / 5.0))
_NODES = (0.5 - _OUTER, 0.5 - _INNER, 0.5 + _INNER, 0.5 + _OUTER)
_LIGHT, _HEAVY = 0.25 - math.sqrt(30.0) / 72.0, 0.25 + math.sqrt(30.0) / 72.0


class BonePull(NamedTuple):
    """The force of bone and pad on a skin held where it is, over time: p0 + p1 t + p2 t² (N), and
    the bone's speed and its rate (m/s, m/s²), all along the way the skin slides."""

    start: float
    rate: float
    bend: float
    bone_speed: float
    bone_rate: float


class Friction(NamedTuple):
    """Friction over a piece: at its start, per speed of the skin, and per time (N, N·s/m, N/s)."""

    start: float
    rise: float
    rate: float


class SkinPath(NamedTuple):
    """A skin's way over `span` (s): speed at the start (m/s), how many terms its series has, and
    the summand b exp(−r t) of its speed: b (m/s) and r (1/s)."""

    span: float
    speed: float
    terms: int
    fast: float
    decay: float


@compiled()
def path_over(
    span: float, w: float, pull: BonePull, friction: Friction, skin: LumpedSkin, series: si.Array
) -> SkinPath:
    """The way over a span from the speed w (m/s); fills `series`, its speed's, in parts of span."""
    mass, damping, stiffness = skin
    braking = damping + friction.rise
    p1 = pull.rate - friction.rate
    a = (pull.start - friction.start - damping * w) / mass
    jerk = (p1 - braking * a - stiffness * w) / mass
    z = abs(braking) * span / mass
    if z <= _FAST:
        terms = 12 if z < 0.4 else TERMS
        d = z if braking >= 0.0 else -z
        e = stiffness * span * span / mass
        series[0] = w
        series[1] = a * span
        series[2] = 0.5 * jerk * span * span
        forced = 2.0 * pull.bend * span**3 / mass
        for n in range(1, terms - 2):
            each = _PARTS[n + 1]
            series[n + 2] = -each * (d * series[n + 1] + e * _PARTS[n] * series[n])
            if n == 1:
                series[3] += forced / 6.0
        return SkinPath(span, w, terms, 0.0, 0.0)
    half = 0.5 * braking / mass
    root = math.sqrt(half * half - stiffness / mass)
    decay = half + root
    slow = stiffness / mass / decay
    bend = 2.0 * pull.bend / (mass * decay)
    fast = (jerk + slow * a - bend) / (decay * (decay - slow))
    first = a + decay * fast
    terms = 9
    series[0] = w - fast
    series[1] = first * span
    series[2] = 0.5 * (bend - slow * first) * span * span
    for n in range(3, terms):
        series[n] = -series[n - 1] * slow * span * _PARTS[n - 1]
    return SkinPath(span, w, terms, fast, decay)


@compiled(forceinline=True)
def speed_on(path: SkinPath, t: float, series: si.Array) -> tuple[float, float]:
    """Speed (m/s) and acceleration (m/s²) a time t into the path."""
    part = t / path.span
    w = series[path.terms - 1]
    a = 0.0
    for n in range(path.terms - 2, -1, -1):
        a = a * part + w
        w = w * part + series[n]
    a /= path.span
    if path.fast != 0.0:
        left = path.fast * math.exp(-path.decay * t)
        w += left
        a -= path.decay * left
    return w, a


@compiled(forceinline=True)
def way_on(path: SkinPath, t: float, series: si.Array) -> float:
    """The way slid (m) a time t into the path."""
    part = t / path.span
    u = 0.0
    for n in range(path.terms - 1, -1, -1):
        u = u * part + series[n] * _PARTS[n]
    u *= t
    if path.fast != 0.0:
        u -= path.fast * math.expm1(-path.decay * t) / path.decay
    return u


@compiled()
def passes(
    path: SkinPath,
    span: float,
    level: float,
    side: float,
    ends: tuple[float, float, float],
    series: si.Array,
) -> float:
    """Time within span at which the speed passes a level upwards (side 1) or down (−1); −1 if not.

    `ends` are the acceleration at the start, and speed and acceleration at the end. It may start on
    the level only where that is 0 and it is downwards: from rest. If it never moved from there, 0.
    """
    w = path.speed
    a, end, a_end = ends
    low, high = 0.0, span
    guess = 0.5 * span
    if side * (end - level) <= 0.0:
        # A slip that has just begun speeds up, whatever rounding says of its acceleration.
        if w == level or not (side * a > 0.0 and side * a_end < 0.0):
            return -1.0
        # The speed turns inside. It stays on this side of where its tangents meet, as it is bent.
        meet = (end - w - a_end * span) / (a - a_end)
        if side * (w + a * meet - level) <= 0.0:
            return -1.0
        for _ in range(_ROOT_STEPS):
            middle = 0.5 * (low + high)
            if middle <= low or middle >= high:
                break
            w_m, a_m = speed_on(path, middle, series)
            if side * (w_m - level) > 0.0:
                high = middle
                break
            if side * a_m > 0.0:
                low = middle
            else:
                high = middle
        w_m, _ = speed_on(path, high, series)
        if side * (w_m - level) <= 0.0:
            return -1.0
        low = 0.0
        guess = 0.5 * high
    elif w == level:
        # It began and ended within: look ever earlier for an instant at which it moved.
        low = 0.5 * span
        moved = False
        for _ in range(HALVINGS):
            w_m, _ = speed_on(path, low, series)
            if side * (w_m - level) < 0.0:
                moved = True
                break
            high = low
            low *= 0.5
        if not moved:
            return 0.0
        guess = 0.5 * (low + high)
    elif side * a > 0.0:
        guess = min((level - w) / a, 0.5 * span)
    root = guess
    for _ in range(_ROOT_STEPS):
        # Newton, and a halving wherever it would leave the bracket.
        w_r, a_r = speed_on(path, root, series)
        if side * (w_r - level) < 0.0:
            low = root
        else:
            high = root
        new = root - (w_r - level) / a_r if a_r != 0.0 else -1.0
        if not low < new < high:
            new = 0.5 * (low + high)
        step = abs(new - root)
        root = new
        if step <= 1e-15 * span:
            break
    return root


@compiled()
def works_on(
    path: SkinPath,
    part: float,
    pull: BonePull,
    friction: Friction,
    skin: LumpedSkin,
    series: si.Array,
) -> tuple[float, float, float]:
    """Work of the bone, lost to friction and lost to damping over the first part of a path (J).

    The smooth part is integrated by Gauss' points, what dies out at once and its product with the
    smooth part in closed form.
    """
    c, k = skin.damping, skin.stiffness
    still = friction.start - friction.rise * path.speed
    z = path.decay * part
    # What has hardly died out is as smooth as the rest.
    apart = z > 0.5
    bone = lost = damped = 0.0
    scale = part / path.span
    w0 = w1 = w2 = w3 = u0 = u1 = u2 = u3 = 0.0
    # All points in one loop: its chains of products do not wait for each other.
    for n in range(path.terms - 1, -1, -1):
        d, way = series[n], series[n] * _PARTS[n]
        w0 = w0 * (_NODES[0] * scale) + d
        w1 = w1 * (_NODES[1] * scale) + d
        w2 = w2 * (_NODES[2] * scale) + d
        w3 = w3 * (_NODES[3] * scale) + d
        u0 = u0 * (_NODES[0] * scale) + way
        u1 = u1 * (_NODES[1] * scale) + way
        u2 = u2 * (_NODES[2] * scale) + way
        u3 = u3 * (_NODES[3] * scale) + way
    speeds, ways = (w0, w1, w2, w3), (u0, u1, u2, u3)
    for q in range(4):
        t = _NODES[q] * part
        w, u = speeds[q], ways[q]
        u *= t
        if apart:
            u += path.fast / path.decay
        elif path.fast != 0.0:
            left = path.fast * math.exp(-path.decay * t)
            w += left
            u += (path.fast - left) / path.decay
        vb = pull.bone_speed + pull.bone_rate * t
        held = pull.start + t * (pull.rate + t * pull.bend) - k * u - c * w
        weight = (_LIGHT if q in (0, 3) else _HEAVY) * part
        bone += weight * held * vb
        lost += weight * (still + friction.rate * t + friction.rise * w) * w
        damped += weight * c * (vb - w) ** 2
    if apart:
        b, r = path.fast, path.decay
        e = math.exp(-z)
        m0 = (1.0 - e) / r
        m1 = (m0 - part * e) / r
        # ∫ of the smooth part times exp(−r t).
        moment, power, both = m0, part, series[0] * m0
        scale = 1.0
        for n in range(1, path.terms):
            moment = (n * moment - power * e) / r
            power *= part
            scale /= path.span
            both += series[n] * scale * moment
        square = (1.0 - e * e) / (2.0 * r)
        towed = pull.bone_speed * m0 + pull.bone_rate * m1
        bone += (k / r - c) * b * towed
        lost += b * (still * m0 + friction.rate * m1 + 2.0 * friction.rise * both)
        lost += friction.rise * b * b * square
        damped += c * b * (b * square - 2.0 * (towed - both))
    # Where friction vanishes with the speed, its line in time may pass below 0 by what a piece may
    # stray: no work comes back from there.
    return bone, max(lost, 0.0), damped
