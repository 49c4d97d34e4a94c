"""One exact step of the plate's complex envelope, its tables, and what the amplifier can give.

The mode answers a carrier of frequency f and amplitude u (in metres of what it holds at its
resonance) with x(t) = Re(−i z e^{iωt}), and in the frame of the carrier

    τ ż = u − (1 + Q δ_i + i Q (f²/f0² − 1 − δ_r)) z,   τ = Q/(π f0),

δ being the finger's modal stiffness over the mode's own (`physics.plate.loaded_mode`). Its steady
state is the amplitude and, to 1/Q, the phase of that mode; between steps it is solved in closed
form. The way there leaves out terms of 1/Q.
"""

from __future__ import annotations

import cmath
import math
from typing import Any, NamedTuple

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled

_STILL = 1e-15  # m; below it the plate stands, and no number becomes subnormal


class Fingers(NamedTuple):
    """The load δ on the mode, shape (forces, points), under forces (N) and at amplitudes (m) of
    highest·(j/(points − 1))²."""

    forces: si.Array
    load: si.Array
    highest: float


class Resonance(NamedTuple):
    """The carrier over the resonance frequency, the quality factor, and the time constant (s)."""

    ratio: float
    quality: float
    time_constant: float


class Electrical(NamedTuple):
    """Capacitance (F), its loss tangent, and the force factor (A·s/m)."""

    capacitance: float
    loss: float
    force_factor: float


class EnvelopeLimits(NamedTuple):
    """The amplifier's largest voltage (V), current (A) and slew rate (V/s)."""

    voltage: float
    current: float
    slew_rate: float


@compiled()
def table_place(force: float, amplitude: float, fingers: Fingers) -> Any:
    """Place of a force (N) and an amplitude (m) in the tables: indices and shares of both, and
    whether the amplitude is beyond."""
    forces, highest, points = fingers.forces, fingers.highest, fingers.load.shape[1]
    i = 0
    while i < forces.size - 2 and force > forces[i + 1]:
        i += 1
    p = (force - forces[i]) / (forces[i + 1] - forces[i])
    p = min(max(p, 0.0), 1.0)
    if amplitude >= highest:
        return i, p, points - 2, 1.0, amplitude > highest * (1.0 + 1e-9)
    j = min(int(math.sqrt(amplitude / highest) * (points - 1)), points - 2)
    low = highest * (j / (points - 1)) ** 2
    high = highest * ((j + 1) / (points - 1)) ** 2
    return i, p, j, min(max((amplitude - low) / (high - low), 0.0), 1.0), False


@compiled()
def between(table: si.Array, i: int, p: float, j: int, q: float) -> Any:
    """A table's value between four of its points."""
    low = table[i, j] + q * (table[i, j + 1] - table[i, j])
    high = table[i + 1, j] + q * (table[i + 1, j + 1] - table[i + 1, j])
    return low + p * (high - low)


@compiled()
def finger_on_mode(force: float, amplitude: float, fingers: Fingers) -> complex:
    """δ under a force (N) at an amplitude (m); in proportion to the force below the lightest."""
    if force <= 0.0:
        return 0j
    i, p, j, q, _ = table_place(force, amplitude, fingers)
    return complex(between(fingers.load, i, p, j, q) * min(1.0, force / fingers.forces[0]))


@compiled()
def decay_rate(plate: Resonance, load: complex) -> complex:
    """λ of ż = u/τ − λ z (1/s)."""
    ratio, quality, tau = plate
    tuned = quality * (ratio * ratio - 1.0 - load.real)
    return complex(1.0 + quality * load.imag, tuned) / tau


@compiled()
def envelope_step(
    z: complex, held: float, h: float, plate: Resonance, force: float, fingers: Fingers
) -> complex:
    """The envelope (m) a time h (s) later; `held` (m) is the drive, u.

    Exact for a constant load. The finger's load follows the amplitude, and is taken at half the
    step: second order.
    """
    if held == 0.0 and abs(z) < _STILL:
        return 0j
    rate = decay_rate(plate, finger_on_mode(force, abs(z), fingers))
    rest = held / (plate.time_constant * rate)
    if force > 0.0:
        half = rest + (z - rest) * cmath.exp(-0.5 * h * rate)
        rate = decay_rate(plate, finger_on_mode(force, abs(half), fingers))
        rest = held / (plate.time_constant * rate)
    return rest + (z - rest) * cmath.exp(-h * rate)


@compiled()
def drawn_current(voltage: float, z: complex, omega: float, plate: Electrical) -> complex:
    """The amplifier's current (A, complex amplitude): the capacitance's and the motional one."""
    capacitance, loss, force_factor = plate
    return complex(omega * capacitance * voltage * complex(loss, 1.0) + omega * force_factor * z)


@compiled()
def voltage_given(
    wanted: float, z: complex, omega: float, plate: Electrical, limits: EnvelopeLimits
) -> float:
    """The voltage on the plate (V) within the amplifier's rail, slew rate and current."""
    capacitance, loss, force_factor = plate
    highest_voltage, highest_current, slew_rate = limits
    given = min(wanted, highest_voltage, slew_rate / omega)
    if abs(drawn_current(given, z, omega, plate)) <= highest_current:
        return given
    # |ωC(tan δ + i) V + ωφ z| = I, the larger root; zero where even that is too much.
    a = (omega * capacitance) ** 2 * (1.0 + loss * loss)
    b = omega * omega * capacitance * force_factor * (loss * z.real + z.imag)
    c = (omega * force_factor * abs(z)) ** 2 - highest_current**2
    under = b * b - a * c
    return 0.0 if under < 0.0 else max(0.0, min(given, (math.sqrt(under) - b) / a))


class FrictionTables(NamedTuple):
    """Tables of a skin's friction.

    `speed` (k,) rises from 0 (m/s), and is one place where friction does not depend on it.
    `relative` is µ′/µ, shape (forces, points, k), the speeds side by side in memory; `coefficient`
    (forces,) is µ without vibration. Forces and amplitudes are those of `envelope_step.Fingers`.
    """

    speed: si.Array
    relative: si.Array
    coefficient: si.Array


@compiled()
def row_between(tables: FrictionTables, i: int, p: float, j: int, q: float, row: si.Array) -> float:
    """Write µ′/µ over the speeds into `row` (k,), at a place that `table_place` found; returns µ
    there."""
    _, relative, coefficient = tables
    for m in range(row.size):
        low = relative[i, j, m] + q * (relative[i, j + 1, m] - relative[i, j, m])
        high = relative[i + 1, j, m] + q * (relative[i + 1, j + 1, m] - relative[i + 1, j, m])
        row[m] = low + p * (high - low)
    return float(coefficient[i] + p * (coefficient[i + 1] - coefficient[i]))


@compiled()
def at_speed(speed: si.Array, row: si.Array, pace: float) -> float:
    """A row's value at a speed (m/s, at least 0): linear between the knots, held beyond the
    last."""
    m = 0
    while m < speed.size - 1 and speed[m + 1] <= pace:
        m += 1
    if m == speed.size - 1:
        return float(row[m])
    return float(row[m] + (pace - speed[m]) / (speed[m + 1] - speed[m]) * (row[m + 1] - row[m]))
