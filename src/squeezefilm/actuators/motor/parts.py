"""Parts of the compiled motors: modes, feet and slider, as plain arrays and numbers."""

from __future__ import annotations

import math
from typing import NamedTuple

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled


@si.checked_numbers
class Stator(NamedTuple):
    """Modes of a stator, of each: modal mass (kg), stiffness (N/m), damping (N·s/m), amplitude of
    the drive's force (N), angular frequency (rad/s), phase (rad), and the amplitude (m) at which it
    is held where `held` is 1. `bend` (1/m), `cube` (1/m²) and `rise` (1/m) are what the freely
    vibrating plate adds: see `spring_at` and `damping_at`."""

    mass: si.FloatArray
    stiffness: si.FloatArray
    damping: si.FloatArray
    force: si.FloatArray
    omega: si.FloatArray
    phase: si.FloatArray
    amplitude: si.FloatArray
    bend: si.FloatArray
    cube: si.FloatArray
    rise: si.FloatArray
    held: bool


@si.checked_numbers
class Feet(NamedTuple):
    """Feet, of each and each mode the motion across and along the face for 1 m of the mode, (feet,
    modes); per foot the stiffnesses (N/m), χ (s/m) and µ."""

    across: si.FloatArray
    along: si.FloatArray
    k_nn: si.FloatArray
    k_nt: si.FloatArray
    k_tt: si.FloatArray
    chi: si.FloatArray
    mu: si.FloatArray


@si.checked_numbers
class Slider(NamedTuple):
    """Mass (kg), preload (N), damping of the guide across (N·s/m), its dry friction along (N), the
    load against +x (N), and whether the speed along is imposed."""

    mass: float
    preload: float
    damping: float
    guide: float
    load: float
    imposed: bool


@compiled()
def spring_at(stator: Stator, j: int, q: float) -> float:
    """The stiffness (N/m) of a mode at its deflection q (m): k (1 + bend |q| + cube q²), a spring
    that keeps its energy."""
    return float(stator.stiffness[j] * (1.0 + stator.bend[j] * abs(q) + stator.cube[j] * q * q))


@compiled()
def mode_energy(stator: Stator, q: si.Array, speed: si.Array) -> float:
    """Kinetic and elastic energy (J) of all modes at deflections (m) and speeds (m/s)."""
    energy = 0.0
    for j in range(q.size):
        size = abs(q[j])
        bent = 0.5 + stator.bend[j] * size / 3.0 + stator.cube[j] * size * size / 4.0
        energy += 0.5 * stator.mass[j] * speed[j] ** 2 + stator.stiffness[j] * size * size * bent
    return energy


@compiled()
def damping_at(stator: Stator, j: int, q: float, speed: float) -> float:
    """The damping (N·s/m) of a mode at deflection (m) and speed (m/s): it rises with the amplitude
    that these two make."""
    return float(
        stator.damping[j] * (1.0 + stator.rise[j] * math.hypot(q, speed / stator.omega[j]))
    )


@compiled(error_model="numpy")
def _yielding(
    depth: float, pull: float, Fx: float, limit: float, springs: tuple[float, float, float]
) -> float:
    """The share that friction leaves of a tangential force that is too large.

    In its own direction, back to where it is `limit` times the elastic normal force, which a
    leaning leg loses or gains as it yields.
    """
    k_nn, k_nt, k_tt = springs
    own = (k_nn - k_nt * k_nt / k_tt) * depth
    return limit * own / (pull - limit * k_nt * Fx / k_tt)


@compiled(error_model="numpy")
def followed(
    i: int, feet: Feet, depth: float, speed: float, moved: tuple[float, float], stretch: si.Array
) -> tuple[float, float, float, float, float]:
    """A foot pressed in by `depth` (m, at `speed`, m/s) that `moved` (m) along and sideways in an
    instant: its forces along and sideways, its elastic normal force (N), and how far it slipped
    along and sideways (m). `stretch` (feet, 2) follows: as it would stick, and back to the limit,
    along the force, where that is more than friction gives."""
    k_nn, k_nt, k_tt = feet.k_nn[i], feet.k_nt[i], feet.k_tt[i]
    limit = feet.mu[i] * (1.0 + feet.chi[i] * speed)
    ex, ey = stretch[i, 0] + moved[0], stretch[i, 1] + moved[1]
    Fx, Fy = k_nt * depth + k_tt * ex, k_tt * ey
    pull = math.hypot(Fx, Fy)
    slip_x, slip_y = 0.0, 0.0
    if pull > limit * (k_nn * depth + k_nt * ex):
        back = _yielding(depth, pull, Fx, limit, (k_nn, k_nt, k_tt))
        Fx, Fy = back * Fx, back * Fy
        slip_x, slip_y = ex - (Fx - k_nt * depth) / k_tt, ey - Fy / k_tt
        ex, ey = ex - slip_x, ey - slip_y
    stretch[i, 0], stretch[i, 1] = ex, ey
    return Fx, Fy, k_nn * depth + k_nt * ex, slip_x, slip_y
