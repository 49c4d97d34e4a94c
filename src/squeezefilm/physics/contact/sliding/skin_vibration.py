"""What a sliding finger's skin vibrates with: spectra, and the lines that a texture draws."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.contact.sliding.march import MetrePerSquareSecondArray, Sliding

SquareMetrePerHertzArray = Annotated[si.FloatArray, si.Unit("m2*s")]
AccelerationPsdArray = Annotated[si.FloatArray, si.Unit("m2/s3")]
SquareNewtonPerHertzArray = Annotated[si.FloatArray, si.Unit("N2*s")]

# Segments overlap by half: 8 of them still show a line a hundredth of the window's width apart.
_SEGMENTS = 8
_FEWEST = 16
# Of the skin's slower time constant: what is left of a start by then is 1 %.
_SETTLING = 5.0


@dataclass(frozen=True, slots=True, eq=False)
class SkinVibration:
    """Spectra of the skin's stretch and acceleration and of the tangential force at the bone.

    Power spectral densities are one-sided, after removing a line from each segment, so that their
    integral over frequency is the mean square of the vibration. Amplitudes are zero-to-peak.

    Attributes:
        start, end: the window analysed (s since the motion began).
        fundamental: temporal frequency of the texture (Hz).
        frequency: of the densities (Hz), shape (bins,).
        displacement_psd: of the skin relative to the bone (m²/Hz), shape (bins,).
        acceleration_psd: of the skin ((m/s²)²/Hz), shape (bins,).
        force_psd: of the force at the bone (N²/Hz), shape (bins,).
        harmonic_frequency: fundamental and harmonics (Hz), shape (harmonics,).
        displacement_amplitude: at the harmonics (m), shape (harmonics,).
        acceleration_amplitude: at the harmonics (m/s²), shape (harmonics,).
        force_amplitude: at the harmonics (N), shape (harmonics,).
    """

    start: si.Second
    end: si.Second
    fundamental: si.Hertz
    frequency: si.HertzArray
    displacement_psd: SquareMetrePerHertzArray
    acceleration_psd: AccelerationPsdArray
    force_psd: SquareNewtonPerHertzArray
    harmonic_frequency: si.HertzArray
    displacement_amplitude: si.MetreArray
    acceleration_amplitude: MetrePerSquareSecondArray
    force_amplitude: si.NewtonArray
    model: str = "Welch, Hann window, half overlap; lines by least squares over whole periods"


@si.closed_form(positive="speed spatial_period")
def texture_frequency(speed: si.MetrePerSecondLike, spatial_period: si.MetreLike) -> si.HertzLike:
    """Temporal frequency at which a grating passes under a finger (Hz): speed/spatial_period.

    Arguments (m/s, m) broadcast. Raises `InputError` unless both are above 0.
    """
    return speed / spatial_period


def settled_after(motion: Sliding) -> si.Second:
    """When a pad that began relaxed has been stretched until it slides, and five of its slower time
    constants have passed (s)."""
    free = np.flatnonzero(~motion.sticking)
    first = float(motion.time[free[0]]) if free.size else 0.0
    return first + _SETTLING * motion.fingerpad.settling_time_constant


@si.checked_numbers
def first_pass_vibration(
    motion: Sliding,
    speed: si.MetrePerSecond,
    pass_duration: si.Second,
    spatial_period: si.Metre,
    harmonics: Annotated[int, si.AtLeast(1)] = 5,
) -> SkinVibration:
    """Spectra of the skin in the settled part of a stroke's first pass (s), with the lines of a
    texture's period (m) under a finger at a speed (m/s).

    Raises `InputError` for a pass with fewer than two periods after the start has settled.
    """
    return skin_vibration(
        motion,
        float(texture_frequency(speed, spatial_period)),
        harmonics,
        start=min(settled_after(motion), pass_duration),
        end=min(pass_duration, float(motion.time[-1])),
    )


@si.checked_numbers
def skin_vibration(
    motion: Sliding,
    fundamental: si.Hertz,
    harmonics: Annotated[int, si.AtLeast(1)] = 5,
    *,
    start: si.Second = 0.0,
    end: si.Second | None = None,
) -> SkinVibration:
    """Spectra of a sliding skin, and its amplitudes at a texture's frequency and harmonics.

    Args:
        motion: what `slide` gave.
        fundamental: frequency of the lines looked at (Hz), see `texture_frequency`.
        harmonics: how many lines, the fundamental included; those at or above half the sample rate
            are left out.
        start, end: window within the motion (s); the whole of it if not given. Leave out the start
            and the turns of a stroke, where the pad is being stretched.

    Raises:
        InputError: a window that is outside the motion, shorter than 16 samples or than two
            periods of the fundamental, or a fundamental not below half the sample rate.
    """
    si.require("fundamental", fundamental, si.Unit("Hz"), above=0.0, below=0.5 / motion.time_step)
    last = float(motion.time[-1])
    si.require("start", start, si.Unit("s"), at_least=0.0, below=last)
    stop = last if end is None else end
    si.require("end", stop, si.Unit("s"), above=start, at_most=last * (1 + 1e-12))
    signals = _window(motion, start, stop, fundamental)
    from scipy.signal import (
        detrend,
        welch,
    )  # importing scipy.signal takes longer than all of this room

    length = max(_FEWEST, 2 * signals.shape[1] // (_SEGMENTS + 1))
    frequency, density = welch(
        signals, 1 / motion.time_step, "hann", nperseg=length, detrend=detrend
    )
    lines: si.HertzArray = fundamental * np.arange(1.0, harmonics + 1)
    lines = lines[lines < 0.5 / motion.time_step]
    amplitude = line_amplitudes(signals, motion.time_step, lines)
    return SkinVibration(
        start=start,
        end=stop,
        fundamental=fundamental,
        frequency=np.asarray(frequency),
        displacement_psd=density[0],
        acceleration_psd=density[1],
        force_psd=density[2],
        harmonic_frequency=lines,
        displacement_amplitude=amplitude[0],
        acceleration_amplitude=amplitude[1],
        force_amplitude=amplitude[2],
    )


def _window(motion: Sliding, start: float, stop: float, fundamental: float) -> si.FloatArray:
    """Stretch, acceleration and force at the bone between two times (s), shape (3, samples).

    Raises `InputError` where that is too little for spectra.
    """
    inside = slice(
        math.ceil(start / motion.time_step - 1e-9), math.floor(stop / motion.time_step + 1e-9) + 1
    )
    signals: si.FloatArray = np.array(
        [motion.stretch, motion.skin_acceleration, motion.bone_force]
    )[:, inside]
    periods = signals.shape[1] * motion.time_step * fundamental
    if signals.shape[1] < _FEWEST or periods < 2:
        raise InputError(
            f"a window of {si.format_quantity(stop - start, si.Unit('s'))} with {signals.shape[1]} "
            f"samples is too short: give at least {_FEWEST} samples and two periods of "
            f"{si.format_quantity(1 / fundamental, si.Unit('s'))}"
        )
    return signals


@si.checked_numbers
def line_amplitudes(
    signals: si.FloatArray, time_step: Annotated[si.Second, si.Above(0.0)], lines: si.HertzArray
) -> si.FloatArray:
    """Zero-to-peak amplitudes of sines at the frequencies `lines` (Hz) in signals (…, samples).

    Least squares of a line in time and all the sines together over as many whole periods of the
    first line as fit, so that neither a drift nor the window's ends leak into them. The result has
    shape (…, lines) and the unit of the signals.
    """
    si.require("lines", lines, si.Unit("Hz"), above=0, axes=1)
    periods = signals.shape[-1] * time_step * lines[0]
    if not 1 <= periods + 1e-9 <= signals.shape[-1] / 2:
        raise InputError(
            f"{signals.shape[-1]} samples hold {periods:.4g} periods of the first line; at least "
            "one whole period is needed, of two samples or more",
            quantity="lines",
        )
    whole = math.floor(periods + 1e-9) / lines[0]
    count = min(signals.shape[-1], round(whole / time_step))
    t = np.arange(count) * time_step
    phase = 2 * math.pi * np.outer(t, lines)
    columns = np.column_stack([np.ones(count), t / t[-1] - 0.5, np.cos(phase), np.sin(phase)])
    flat = np.reshape(signals[..., :count], (-1, count))
    found = np.linalg.lstsq(columns, flat.T, rcond=None)[0][2:]
    size = np.hypot(found[: lines.size], found[lines.size :]).T
    return np.asarray(size.reshape((*signals.shape[:-1], lines.size)))
