"""Gratings of a display that are felt: a square grating's rhythm through an observer's senses.

A grating that survives the resonator need not be felt, and one that the resonator flattens may
be. A finger slides steadily at a speed v over a square grating of period λ, the vibration switched
between two amplitudes with the first-order envelope of the resonator. The friction over one
passage has the lines µF c_h at the frequencies h v/λ; the skin moves by each of them as the
fingerpad's mass, spring and damper have it (`physics.contact.finger.fingertip`), and the channels
make d′ of that as in `senses`: thresholds, what the mean stretch masks, and the sum over harmonics.

What a stroke adds (it speeds up and slows down, the pad lies on the standing wave, the sensor is
late) is left out; `percepts.percept` has it, a second for each grating.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.contact.finger.fingertip import (
    FingerpadDynamics,
    skin_displacement_per_friction,
)
from squeezefilm.physics.perception.observer import Observer
from squeezefilm.physics.perception.senses import COARSEST_PERIOD, FINEST_LINE

FINEST_TRIED: si.Metre = 0.125e-3
"""The finest at which thresholds were measured."""
MEAN_FRICTION: si.Dimensionless = 0.5
"""Mean friction coefficient of stimuli that were published without it: assumed."""
_SAMPLES = 256
"""Number of samples over a period; the fifteenth harmonic, the last that counts, has seventeen."""


@si.checked_numbers
@dataclass(frozen=True)
class Rubbed:
    """A finger that slides: its friction without vibration (N), its pad, its speed (m/s)."""

    friction: Annotated[si.Newton, si.Above(0.0)]
    pad: FingerpadDynamics
    speed: Annotated[si.MetrePerSecond, si.Above(0.0)]


def tried_periods(points: int = 81) -> si.MetreArray:
    """The periods (m) that are tried, evenly in their logarithm: 0.125 to 20 mm in steps of
    6.6 %."""
    return np.asarray(np.geomspace(FINEST_TRIED, COARSEST_PERIOD, points))


@si.checked_numbers
def switched_amplitude(
    passage: Annotated[si.SecondArray, si.Above(0.0)],
    time_constant: Annotated[si.Second, si.Above(0.0)],
    high: Annotated[si.Metre, si.Above(0.0)],
) -> si.MetreArray:
    """The amplitude (m) over one period of a square grating between 0 and `high`, settled.

    `passage` is what one period takes (s), shape (n,); the result has shape (n, 256), from where
    the drive is switched on. First-order envelope at resonance, equal grooves and ridges.
    """
    time = (np.arange(_SAMPLES) + 0.5) / _SAMPLES * passage[:, None]
    half = passage[:, None] / 2
    # What is left after half a period, from above and from below.
    most = high / (1 + np.exp(-half / time_constant))
    least = most * np.exp(-half / time_constant)
    rising = high - (high - least) * np.exp(-time / time_constant)
    falling = most * np.exp(-np.maximum(time - half, 0.0) / time_constant)
    return np.asarray(np.where(time < half, rising, falling))


def grating_evidence(
    observer: Observer,
    period: si.MetreArray,
    amplitude: si.MetreArray,
    relative_friction: Callable[[si.MetreArray], si.DimensionlessArray],
    rubbed: Rubbed,
) -> si.DimensionlessArray:
    """d′ (1) of the rhythms of gratings of periods (m, shape (n,)), shape (n,).

    `amplitude` (m) is over each one's passage, evenly spaced, shape (n, samples), and
    `relative_friction` says µ′/µ for it at the finger's speed. The friction must change slowly
    against the ultrasonic period. Source: `physics.perception.senses`.
    """
    friction = rubbed.friction * relative_friction(amplitude)
    lines = np.fft.rfft(friction, axis=1) / friction.shape[1]
    pad, power = rubbed.pad, np.zeros(period.size)
    mean = np.abs(lines[:, 0]) / pad.stiffness
    for harmonic in range(1, observer.harmonics + 1):
        frequency = harmonic * rubbed.speed / period
        moved = skin_displacement_per_friction(frequency, pad.stiffness, pad.damping, pad.mass)
        skin = 2 * np.abs(lines[:, harmonic]) * np.abs(moved)
        seen = np.where(period / harmonic >= FINEST_LINE, skin, 0.0)
        for channel in observer.channels:
            passed = channel.gain(period / harmonic, rubbed.speed) * seen
            power += (passed / channel.noise(mean)) ** 2
    return np.asarray(np.sqrt(power))


def detected_share(
    observer: Observer, period: si.MetreArray, wave: si.FloatArray, rubbed: Rubbed
) -> si.DimensionlessArray:
    """Share of the mean friction (1) that has d′ = 1 as the size of a wave of friction, shape (n,).

    `wave` is of size 1, over each passage of the periods (m, shape (n,)), shape (n, samples).
    Infinite where nothing of a period is felt.
    """
    small = 1e-3
    evidence = grating_evidence(observer, period, wave, lambda share: 1 + small * share, rubbed)
    # d′ is in proportion to the size.
    with np.errstate(divide="ignore"):
        return np.asarray(small / evidence)


def finest_felt(
    observer: Observer, period: si.MetreArray, d_prime: si.DimensionlessArray
) -> si.Metre:
    """The finest of rising periods (m) whose d′ reaches the observer's criterion; infinite where
    none does."""
    felt = np.flatnonzero(d_prime >= observer.detection_criterion)
    return float(period[felt[0]]) if felt.size else math.inf
