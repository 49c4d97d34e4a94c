"""The skin between two samples: its motion in closed form, and when a slip begins."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

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
