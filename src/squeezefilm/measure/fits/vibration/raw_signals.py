"""Time signals of drive and vibrometer: the response and its coherence."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import (
    Adequacy,
    FitResult,
    guarded_fit,
)
from squeezefilm.measure.fits.vibration.frequency_response import modal_circle
from squeezefilm.measure.recordings.kinds import FrequencyResponse, RawSignals, finite

_FEWEST_POINTS = 256
_SEGMENTS, _LEAST_SEGMENT = 16, 32
# From this share of the strongest drive a frequency counts as driven.
_DRIVEN = 1e-2
_COHERENT = 0.8
# Frequencies within a half-power band, so that a Hann window takes less than 1 % of its peak:
# (1/3)(1.5 Δf Q/f)² (Bendat and Piersol, Random Data, section 8.5).
_RESOLVED = 9.0
# ... and so many where the recording is long enough: 0.2 %, which no model fit sees.
_WELL_RESOLVED = 20.0
# What overlapping Hann windows by half costs of averages (Welch 1967).
_OVERLAP_COST = 1.056


@dataclass(frozen=True, eq=False, repr=False)
class RawSignalsFit(FitResult):
    """The response between two time signals.

    `response` (m/V, with its coherence) at the frequencies that were driven is to be fitted as any
    frequency response, which then has the observations; `standard_error` (m/V) is that of its size,
    of noise that does not come from the drive.
    """

    recording: RawSignals
    response: FrequencyResponse
    standard_error: si.MetrePerVoltArray


@guarded_fit
def fit_raw_signals(recording: RawSignals) -> RawSignalsFit:
    """H1 = S_vx/S_vv (m/V) and its coherence by Welch's averages.

    Hann windows of a sixteenth of the recording, up to a half where a sharp resonance needs it,
    overlapping by half, where the drive has 1 % of its greatest density. Noise at the output is
    averaged away, noise on the recorded voltage makes H1 too small. Raises `InputError` for fewer
    than 256 points, uneven sampling, or no drive. Source: Bendat and Piersol, Random Data, 4th ed.,
    sections 6.1 and 9.2.
    """
    t, v, x = _recorded(recording)
    rate = (t.size - 1) / float(t[-1] - t[0])
    length = max(t.size // _SEGMENTS, _LEAST_SEGMENT)
    response, error = _averaged(v, x, rate, length)
    while 4 * length <= t.size and _resolution(response) < _WELL_RESOLVED:
        length *= 2
        response, error = _averaged(v, x, rate, length)
    response = replace(response, told=recording.told)
    return RawSignalsFit(recording, response, error, adequacy=_coherent(response, length / rate))


def _averaged(
    v: si.VoltArray, x: si.MetreArray, rate: si.Hertz, length: int
) -> tuple[FrequencyResponse, si.MetrePerVoltArray]:
    """H1 with its coherence, and the standard error of its size, by segments of a length in
    points."""
    from scipy import signal

    settings: dict[str, Any] = {
        "fs": rate,
        "window": "hann",
        "nperseg": length,
        "detrend": "linear",
    }
    f, drive = signal.welch(v, **settings)
    _, motion = signal.welch(x, **settings)
    _, cross = signal.csd(v, x, **settings)
    driven = drive > _DRIVEN * drive[1:].max()
    driven[0] = False
    if driven.sum() < 3:
        raise InputError("fewer than 3 frequencies are driven; widen the excitation")
    H = cross[driven] / drive[driven]
    coherence = np.clip(np.abs(cross) ** 2 / (drive * motion + 1e-300), 0.0, 1.0)[driven]
    averages = (2 * v.size / length - 1) / _OVERLAP_COST
    error = np.abs(H) * np.sqrt((1 - coherence) / (2 * np.maximum(coherence, 1e-12) * averages))
    return FrequencyResponse(f[driven], H, coherence=coherence), error


def _resolution(response: FrequencyResponse) -> float:
    """Number of frequencies within the half-power band of the strongest resonance; infinite
    where there is none."""
    f = response.frequency
    circle = modal_circle(f, np.asarray(response.displacement_per_volt))
    if circle is None or not f[0] < circle.frequency < f[-1] or circle.roundness > 0.2:
        return float("inf")
    return circle.frequency / abs(circle.quality_factor) / float(f[1] - f[0])


def _recorded(recording: RawSignals) -> tuple[si.SecondArray, si.VoltArray, si.MetreArray]:
    t, v, x = finite(recording.time, recording.voltage, recording.displacement)
    if t.size < _FEWEST_POINTS:
        raise InputError(
            f"the signals have {t.size} usable points; a spectrum needs at least {_FEWEST_POINTS}"
        )
    steps = np.diff(t)
    if np.any(steps <= 0):
        raise InputError("time does not rise from point to point; sort the recording by time")
    step = float(np.median(steps))
    if np.max(np.abs(steps - step)) > 0.01 * step:
        # Missing points of an even row are put back between their neighbours.
        even = np.arange(round((t[-1] - t[0]) / step) + 1) * step + t[0]
        off = np.max(np.abs((t - t[0]) / step - np.round((t - t[0]) / step)))
        if off > 0.05 or even.size > 1.25 * t.size:
            raise InputError(
                "the signals are not evenly sampled, or a fifth of them is missing; give an even "
                "row of times"
            )
        from scipy.interpolate import CubicSpline

        t, v, x = even, CubicSpline(t, v)(even), CubicSpline(t, x)(even)
    if not np.any(v - v.mean()):
        raise InputError("the voltage does not change; there is nothing to respond to")
    return t, v, x


def _coherent(response: FrequencyResponse, segment: si.Second) -> Adequacy:
    """Judge whether the motion comes from the drive, and segments are long enough."""
    f, coherence = response.frequency, response.coherence
    assert coherence is not None
    noise = float(np.sqrt(1 - np.mean(coherence)))
    where = f"at {si.format_quantity(f[int(np.argmin(coherence))], si.Unit('Hz'))}"
    middle = float(np.median(coherence))
    sentence = (
        f"Coherence of motion and drive is {middle:.3f} in the middle, least {where}, where it is "
        f"{coherence.min():.3f}."
    )
    if middle < _COHERENT:
        sentence += (
            " Most of the motion does not come from the drive: average longer, drive more, or look "
            "for hum and clipping."
        )
    resolved = _resolution(response)
    if resolved < _RESOLVED:
        shown = si.format_quantity(segment, si.Unit("s"), 3)
        sentence += (
            f" Segments of {shown} are too short for the resonance, whose half-power band holds "
            f"{resolved:.1f} frequencies where {_RESOLVED:g} keep its Q within 1 %: it reads too "
            "low. Record longer."
        )
    return Adequacy(middle >= _COHERENT and resolved >= _RESOLVED, noise, noise, where, sentence)
