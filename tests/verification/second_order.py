"""A carrier played into a resonator of the second order, stepped by SciPy: what an envelope of
the first order leaves out."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.signal import cont2discrete, lfilter, ss2tf

from squeezefilm.core.quantities import FloatArray
from squeezefilm.physics.render.resonator.envelope import carrier_block


class Carried(NamedTuple):
    """Time (s), place and envelope (m) at each converter sample."""

    time: FloatArray
    displacement: FloatArray
    amplitude: FloatArray


def carried(
    command: FloatArray,
    samples: int,
    frequency: float,
    quality: float,
    *,
    resonance: float | None = None,
    rate: float = 192e3,
    phase: float = 0.0,
    made_up: bool = True,
) -> Carried:
    """Amplitudes (m), each held over `samples`, as a carrier into a resonator at rest before.

    x'' + (w/Q) x' + w² x = (w²/Q) u(t), u held from sample to sample; the hold's gain sinc(f/f_s)
    is made up for unless told otherwise.
    """
    gain = 1 / float(np.sinc(frequency / rate)) if made_up else 1.0
    drive = np.empty(command.size * samples)
    carrier_block(phase, 2 * math.pi * frequency / rate, command, samples, gain, drive)
    w = 2 * math.pi * (frequency if resonance is None else resonance)
    # In x and x'/w.
    A = w * np.array([[0.0, 1.0], [-1.0, -1 / quality]])
    B = w * np.array([[0.0], [1 / quality]])
    step, push, *_ = cont2discrete((A, B, np.eye(2), np.zeros((2, 1))), 1 / rate)
    above, below = ss2tf(step, push, np.eye(2), np.zeros((2, 1)))
    place, quadrature = (np.asarray(lfilter(row, below, drive)) for row in above)
    return Carried(np.arange(drive.size) / rate, place, np.hypot(place, quadrature))
