"""What the channels of a fingertip see: lines and rhythms of a stroke, gratings at a steady speed.

A displacement along the finger's way has lines at spatial periods λ. Each channel sees a line of
amplitude A through its gain at the temporal frequencies v/λ of the stroke, in the noise of its
threshold θ and of what the mean displacement M masks:

    d′_c(λ) = g_c(λ) A(λ) / √(θ_c² + (m_c M)²).

Channels, and the harmonics of a rhythm of period λ, add in squares. Of all rhythms the clearest has
the greatest Σ_h w_h d′(λ/h) with w_h = harmonic_weight^(h−1): the subharmonic summation of Hermes
1988 (10.1121/1.396427), with which a fundamental wins over its multiples and parts.
"""

from __future__ import annotations

import functools
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

FINEST_PERIOD: si.Metre = 0.25e-3
COARSEST_PERIOD: si.Metre = 20e-3
"""Periods that may be perceived; half the stroke of 4 cm is the longest that repeats in it."""

SPACING: si.Metre = 25e-6
"""Spacing of the samples along the way."""

# Lines are looked for down to the harmonics of the finest period, where a step is a third of the
# half-width that a stroke of 4 cm gives a line. By falling between two steps a line seems fainter
# by at most 2 % at 0.4 mm, 5 % at 0.25 mm and (a harmonic only) 32 % at 0.1 mm.
FINEST_LINE: si.Metre = 0.1e-3
_LOG_STEP = 0.004
# A pass begins with the pad being stretched: this much of it is not looked at.
SETTLING: si.Metre = 2e-3
D_PRIME_OF_75 = 0.9538725524
"""√2 z(0.75): what is told in 75 % of two-interval trials."""
# Passes of many lengths share the waves of the next longer block.
_BLOCK = 512
# A rhythm below this is none: it would never reach a criterion but by noise alone.
_FAINTEST = 0.05
_SPATIAL_SLOPE = 4.25e3
_SPATIAL_ZERO: si.Metre = 0.55e-3
_SPATIAL_LEAST: si.Metre = 0.7e-3
_SPATIAL_MOST: si.Metre = 3e-3


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """Evidence that a surface gives the senses, by spatial period.

    Attributes:
        period: of lines (m), shape (n,), rising.
        amplitude: of skin displacement at each line (m), shape (n,).
        by_channel: d′ of each line in each channel (1), shape (channels, n).
        rhythm: d′ of a rhythm of each period (1), shape (n,).
    """

    period: si.MetreArray
    amplitude: si.MetreArray
    by_channel: si.DimensionlessArray
    rhythm: si.DimensionlessArray

    def at(self, period: si.Metre) -> si.Dimensionless:
        """d′ of the rhythm of a period (m) (1)."""
        return float(np.interp(math.log(period), np.log(self.period), self.rhythm))


@dataclass(frozen=True, slots=True, eq=False)
class Candidates:
    """Periods that compete for being perceived, the clearest first.

    `period` (m) and `d_prime` (1) have the same shape (…, candidates). `d_prime` is in steps of the
    noise of a percept, which grows with the strength once that is clear (`candidates`); −∞ where
    there is none.
    """

    period: si.MetreArray
    d_prime: si.DimensionlessArray


@si.checked_numbers
def percept_deviation(
    weber_fraction: Annotated[si.Dimensionless, si.Above(0.0)],
) -> si.Dimensionless:
    """The standard deviation of one percept's natural logarithm (1) with which a difference of this
    Weber fraction is told in 75 % of two-interval trials."""
    return math.log1p(weber_fraction) / D_PRIME_OF_75


def line_periods() -> si.MetreArray:
    """The spatial periods (m) at which lines are looked for, in steps of 0.4 %."""
    count = math.floor(math.log(COARSEST_PERIOD / FINEST_LINE) / _LOG_STEP) + 1
    periods: si.MetreArray = FINEST_LINE * np.exp(_LOG_STEP * np.arange(count))
    return periods


def line_amplitudes(passes: si.MetreArray) -> si.MetreArray:
    """Amplitudes of lines at `line_periods` (m), of displacements (m) along one or more passes.

    Args:
        passes: sampled at `SPACING` along the way, shape (passes, samples). A line in the way is
            taken out, a Hann window laid over each; powers are averaged over the passes.
    """
    count = passes.shape[1]
    window = np.hanning(count)
    window /= window.sum()
    along = np.linspace(-1.0, 1.0, count)
    level = passes @ window
    tilt = (passes @ (window * along)) / np.sum(window * along**2)
    changing = passes - level[:, None] - tilt[:, None] * along
    lines = (changing * window) @ _waves(-(-count // _BLOCK) * _BLOCK)[:count]
    amplitude: si.MetreArray = 2.0 * np.sqrt(np.mean(np.abs(lines) ** 2, axis=0))
    return amplitude


@functools.lru_cache(maxsize=4)
def _waves(count: int) -> si.ComplexArray:
    way = SPACING * np.arange(count)
    phase = np.outer(-2 * math.pi * way, 1.0 / line_periods())
    waves = np.empty(phase.shape, dtype=complex)
    # A third of the time of an exponential of complex numbers.
    np.cos(phase, out=waves.real)
    np.sin(phase, out=waves.imag)
    return waves


def channel_gains(observer: Observer, speed: si.MetrePerSecondArray) -> si.DimensionlessArray:
    """Root mean square of each channel's gain at each line over the speeds of a stroke (m/s).

    `speed` has any shape, one value per sample of way; the result has shape (channels, n).
    """
    # Speeds enter by their histogram: a stroke has thousands, all alike to a few per cent.
    shares = np.quantile(speed, (np.arange(24) + 0.5) / 24)
    gains = np.array([c.gain(line_periods(), shares[:, None]) for c in observer.channels])
    return np.asarray(np.sqrt(np.mean(gains**2, axis=1)))


def evidence(
    observer: Observer,
    amplitude: si.MetreArray,
    gains: si.DimensionlessArray,
    mean_displacement: si.Metre,
    pattern_period: si.Metre | None = None,
    groove_width: si.Metre = 0.0,
) -> Evidence:
    """The evidence for rhythms in line amplitudes.

    Args:
        observer: whose senses.
        amplitude: of lines (m), as `line_amplitudes` gives them.
        gains: as `channel_gains` gives them.
        mean_displacement: of the skin (m), which masks.
        pattern_period, groove_width: of a real grating (m): its pattern in the skin then takes the
            place of what spatial channels see of lines.
    """
    si.require("mean_displacement", mean_displacement, si.Unit("m"), at_least=0.0)
    noise = np.array([channel.noise(mean_displacement) for channel in observer.channels])
    d_prime = gains * amplitude / noise[:, None]
    periods = line_periods()
    if pattern_period is not None:
        away = (1.0 / periods - 1.0 / pattern_period) / _line_width(observer.stroke_length)
        felt = spatial_sensitivity(groove_width) * np.exp(-0.5 * (2.0 * away) ** 2)
        d_prime[[one.spatial for one in observer.channels]] = felt
    lines = _harmonics(observer, np.sum(d_prime**2, axis=0))
    return Evidence(periods, amplitude, d_prime, np.sqrt(lines.sum(axis=0)))


def _harmonics(observer: Observer, power: si.DimensionlessArray) -> si.DimensionlessArray:
    """d′² (1) of the harmonics of every period, shape (harmonics, n)."""
    log_period = np.log(line_periods())
    shifts = np.log(np.arange(1, observer.harmonics + 1))
    return np.array([np.interp(log_period - s, log_period, power, left=0.0) for s in shifts])


def _line_width(stroke_length: si.Metre) -> si.PerMetre:
    """Width from the middle of a line to its first zero under a Hann window (1/m)."""
    return 2.0 / (stroke_length - SETTLING)


def spatial_sensitivity(groove_width: si.Metre) -> si.Dimensionless:
    """d′ of a grating's pattern in resting skin: 4.25 (g − 0.55) with g in mm, for g > 0.7 mm, 0
    below (Johnson and Phillips 1981). Held at its value of 3 mm beyond, which is assumed."""
    si.require("groove_width", groove_width, si.Unit("m"), at_least=0.0)
    if groove_width <= _SPATIAL_LEAST:
        return 0.0
    return _SPATIAL_SLOPE * (min(groove_width, _SPATIAL_MOST) - _SPATIAL_ZERO)


def candidates(
    observer: Observer, found: Evidence, stroke_length: si.Metre | None = None
) -> Candidates:
    """The clearest rhythms, each in what the clearer ones leave unexplained.

    The lines of a rhythm chosen, and whatever the stroke is too short to tell from them, are taken
    out before the next is looked for; else every rhythm would come with its own multiples. A rhythm
    of evidence e has d′ = asinh(k e)/k, with k of the Weber fraction of strengths: e while it is
    faint, and equal ratios of clear strengths are equally far apart.
    `stroke_length` (m) is the observer's own where it is not given.
    """
    per_metre, width = 1.0 / found.period, _line_width(stroke_length or observer.stroke_length)
    power = np.sum(found.by_channel**2, axis=0)
    inside = found.period >= FINEST_PERIOD
    periods: si.FloatArray = np.full(observer.candidates, FINEST_PERIOD)
    d_prime: si.FloatArray = np.full(observer.candidates, -np.inf)
    deviation = percept_deviation(observer.strength_weber_fraction)
    weight = observer.harmonic_weight ** np.arange(observer.harmonics)
    for k in range(observer.candidates):
        lines = _harmonics(observer, power)
        best = int(np.argmax(np.where(inside, weight @ np.sqrt(lines), 0.0)))
        evident = math.sqrt(lines[:, best].sum())
        if evident <= _FAINTEST:
            break
        periods[k], d_prime[k] = found.period[best], math.asinh(deviation * evident) / deviation
        base = per_metre[best]
        harmonic = np.maximum(np.round(per_metre / base), 1.0)
        power = np.where(np.abs(per_metre - harmonic * base) < width, 0.0, power)
    return Candidates(periods, d_prime)


# A grating that survives the resonator need not be felt, and one that the resonator flattens may
# be. A finger slides steadily at a speed v over a square grating of period λ, the vibration
# switched between two amplitudes with the first-order envelope of the resonator. The friction over
# one passage has the lines µF c_h at the frequencies h v/λ; the skin moves by each of them as the
# fingerpad's mass, spring and damper have it (`physics.contact.finger.fingertip`), and the channels
# make d′ of that as of a stroke's: thresholds, what the mean stretch masks, and the sum over
# harmonics.
#
# What a stroke adds (it speeds up and slows down, the pad lies on the standing wave, the sensor is
# late) is left out; `percepts.percept` has it, a second for each grating.
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
