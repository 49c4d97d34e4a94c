"""A first-order plate in the frame of its carrier, with the loops around it; compiled."""

from __future__ import annotations

import cmath
import math
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.instruments.control.plate_loop import LoopGains, first_state, plate_step
from squeezefilm.instruments.twin.plant_kernel import gaussian

MODE, FREQUENCY, RESONANCE, RE, SIZE, LEVEL, LOAD, FLAGS, LOST, FALSE = range(10)
PARTS = 5  # of a step, in which the plate is stepped exactly


class TruePlate(NamedTuple):
    """What the loops do not know.

    Quality factor, ratio, delay (s), phase at 0 Hz (rad), interval (s), softening (Hz at 1 V of the
    pickup), noise (µV), what of the drive leaks into the pickup (V/V), whole steps by which the
    pickup is late, and whether it shows the end of a step or the mean over it.
    """

    quality: float
    ratio: float
    delay: float
    phase: float
    interval: float
    softening: float = 0.0
    noise: float = 0.0
    leak: float = 0.0
    late: int = 0
    at_end: bool = False


@compiled()
def held(
    gains: LoopGains, plate: TruePlate, wanted: si.Array, resonance: si.Array, load: si.Array
) -> si.Array:
    """Rows of what happened, one a step; wanted levels (µV), resonances (Hz) and D are given."""
    rows = np.zeros((wanted.size, 10))
    state = first_state(gains)
    z = 0j
    level, carrier = 0, gains.highest_frequency
    first = (0, 0)
    queue = [first] * plate.late
    for n in range(wanted.size):
        f = carrier * 1e-3
        mean = 0j
        for _ in range(PARTS):
            f0 = resonance[n] - plate.softening * (abs(z) * 1e-6) ** 2
            tau = plate.quality / (math.pi * f0)
            rate = complex(1.0 + load[n], 2.0 * plate.quality * (f - f0) / f0)
            rest = plate.ratio * level / rate
            mean += 0.5 * z / PARTS
            z = rest + (z - rest) * cmath.exp(-rate * plate.interval / tau / PARTS)
            mean += 0.5 * z / PARTS
        chain = cmath.exp(1j * (plate.phase - 2.0 * math.pi * f * plate.delay))
        seen = (z if plate.at_end else mean) * chain + plate.leak * level
        seen += plate.noise * complex(gaussian(1, 0, n), gaussian(1, 1, n))
        queue.append((round(seen.real), round(seen.imag)))
        state, command = plate_step(gains, state, queue.pop(0), int(wanted[n]), level)
        level, carrier = command.level, command.frequency
        row = rows[n]
        row[MODE], row[FREQUENCY], row[RESONANCE], row[RE] = state.mode, f, f0, z.real
        row[SIZE], row[LEVEL], row[LOAD] = abs(z), level, state.load / 2**20
        row[FLAGS], row[LOST], row[FALSE] = command.flags, state.lost, state.false
    return rows
