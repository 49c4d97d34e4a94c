"""Time signals of drive and vibrometer: response, coherence, and what the instrument adds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import (
    Adequacy,
    Estimate,
    FitResult,
    Observation,
    guarded_fit,
)
from squeezefilm.measure.fits.least_squares import fit_separable
from squeezefilm.measure.fits.misfit import adequacy_of
from squeezefilm.measure.fits.vibration.frequency_response import modal_circle
from squeezefilm.measure.recordings.kinds import FrequencyResponse, RawSignals

_FEWEST_POINTS = 256
_SEGMENTS = 16
# From this share of the strongest drive a frequency counts as driven.
_DRIVEN = 1e-2
_COHERENT = 0.8
_TAPER = 0.02
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
    frequency response; `standard_error` (m/V) is that of its size, of noise that does not come from
    the drive. `scale` (m/V) and `delay` (s) are the instrument's, where the recording was said to
    be of a motion in proportion to the voltage.
    """

    recording: RawSignals
    response: FrequencyResponse
    standard_error: si.MetrePerVoltArray
    scale: Estimate | None
    delay: Estimate | None
    adequacy: Adequacy

    @property
    def observations(self) -> tuple[Observation, ...]:
        """No observations of the display: fit the `response`, which has them."""
        return ()


@guarded_fit
def fit_raw_signals(
    recording: RawSignals,
    *,
    instrument: bool = False,
    segment: Annotated[si.Second, si.Above(0)] | None = None,
    band: tuple[si.Hertz, si.Hertz] | None = None,
) -> RawSignalsFit:
    """H1 = S_vx/S_vv (m/V) and its coherence by Welch's averages; an instrument's scale and delay.

    Hann windows of `segment` (s; by default a sixteenth of the recording, up to a half where a
    sharp resonance needs it) overlapping by half, over the `band` (Hz) or where the drive has
    1 % of its greatest density. Noise at the output is averaged away, noise on the recorded
    voltage makes H1 too small. With `instrument` the motion is taken to follow the voltage, as that
    of a calibrator or of the electric signal itself looped back: x(t) = s v(t − τ), fitted to the
    spectrum of all of the recording. Raises `InputError` for fewer than 256 points, uneven
    sampling, or no drive. Source: Bendat and Piersol, Random Data, 4th ed., sections 6.1 and 9.2.
    """
    t, v, x = _recorded(recording)
    rate = (t.size - 1) / float(t[-1] - t[0])
    length = t.size // _SEGMENTS if segment is None else int(segment * rate)
    if not 32 <= length <= t.size // 2:
        raise InputError(
            f"segment = {si.format_quantity(length / rate, si.Unit('s'))} holds {length} of "
            f"{t.size} points; it must hold at least 32 and at most half of them",
            quantity="segment",
        )
    averaged = _averaged(recording, (v, x, rate), length, band)
    while segment is None and 4 * length <= t.size and _resolution(averaged) < _WELL_RESOLVED:
        length *= 2
        averaged = _averaged(recording, (v, x, rate), length, band)
    if not instrument:
        return replace(averaged, adequacy=_coherent(averaged, length / rate))
    f = averaged.response.frequency
    return _as_instrument(averaged, (v, x, rate), (float(f[0]), float(f[-1])))


def _averaged(
    recording: RawSignals,
    signals: tuple[si.VoltArray, si.MetreArray, float],
    length: int,
    band: tuple[si.Hertz, si.Hertz] | None,
) -> RawSignalsFit:
    """H1 and coherence by segments of a length in points."""
    from scipy import signal

    v, x, rate = signals
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
    if band is not None:
        driven &= (f >= band[0]) & (f <= band[1])
    driven[0] = False
    if driven.sum() < 3:
        raise InputError("fewer than 3 frequencies are driven; widen the band or the excitation")
    H = cross[driven] / drive[driven]
    coherence = np.clip(np.abs(cross) ** 2 / (drive * motion + 1e-300), 0.0, 1.0)[driven]
    averages = (2 * v.size / length - 1) / _OVERLAP_COST
    error = np.abs(H) * np.sqrt((1 - coherence) / (2 * np.maximum(coherence, 1e-12) * averages))
    response = FrequencyResponse(f[driven], H, coherence=coherence, told=recording.told)
    unknown = Adequacy(False, float("nan"), float("nan"), "", "")
    return RawSignalsFit(recording, response, error, None, None, unknown)


def _resolution(averaged: RawSignalsFit) -> float:
    """Number of frequencies within the half-power band of the strongest resonance; infinite
    where there is none."""
    f = averaged.response.frequency
    circle = modal_circle(f, np.asarray(averaged.response.displacement_per_volt))
    if circle is None or not f[0] < circle.frequency < f[-1] or circle.roundness > 0.2:
        return float("inf")
    return circle.frequency / abs(circle.quality_factor) / float(f[1] - f[0])


def _recorded(recording: RawSignals) -> tuple[si.SecondArray, si.VoltArray, si.MetreArray]:
    t = np.asarray(recording.time, dtype=float)
    v, x = (
        np.asarray(values, dtype=float) for values in (recording.voltage, recording.displacement)
    )
    good = np.isfinite(t) & np.isfinite(v) & np.isfinite(x)
    if good.sum() < _FEWEST_POINTS:
        raise InputError(
            f"the signals have {int(good.sum())} usable points; a spectrum needs at least "
            f"{_FEWEST_POINTS}"
        )
    t, v, x = t[good], v[good], x[good]
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


def _coherent(averaged: RawSignalsFit, segment: si.Second) -> Adequacy:
    """Judge whether the motion comes from the drive, and segments are long enough."""
    f, coherence = averaged.response.frequency, averaged.response.coherence
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
    resolved = _resolution(averaged)
    if resolved < _RESOLVED:
        shown = si.format_quantity(segment, si.Unit("s"), 3)
        sentence += (
            f" Segments of {shown} are too short for the resonance, whose half-power band holds "
            f"{resolved:.1f} frequencies where {_RESOLVED:g} keep its Q within 1 %: it reads too "
            "low. Record longer, or ask for longer segments."
        )
    return Adequacy(middle >= _COHERENT and resolved >= _RESOLVED, noise, noise, where, sentence)


def _as_instrument(
    averaged: RawSignalsFit,
    signals: tuple[si.VoltArray, si.MetreArray, float],
    band: tuple[si.Hertz, si.Hertz],
) -> RawSignalsFit:
    """Fit with scale and delay by the whole recording's spectra within a band."""
    from scipy.signal.windows import tukey

    v, x, rate = signals
    # A short taper, so that what is delayed out of the recording makes no step at its ends.
    window = tukey(v.size, _TAPER)
    f = np.fft.rfftfreq(v.size, 1 / rate)
    inside = (f >= band[0]) & (f <= band[1])
    f = f[inside]
    V, X = (np.fft.rfft(signal * window)[inside] for signal in (v - v.mean(), x - x.mean()))
    size = float(np.max(np.abs(X)))

    def late(shape: si.FloatArray) -> tuple[si.ComplexArray, si.ComplexArray]:
        turned = (V * np.exp(-1j * shape[0] * f / f[-1]))[:, None]
        return turned, (-1j * (f / f[-1])[:, None] * turned)[None]

    start = _first_delay(averaged.response) * 2 * np.pi * f[-1]
    fit = fit_separable(late, X / size, np.array([start]), real_weights=True)
    adequacy = adequacy_of(
        X,
        fit.residual * size,
        lambda i: f"at {si.format_quantity(f[i], si.Unit('Hz'))}",
        remedy="The response is not that of an instrument alone: a resonance lies in the band. Fit "
        "the response instead, or calibrate on a motion that follows the voltage.",
    )
    return replace(
        averaged,
        scale=fit.estimate(lambda _, weights: size * float(weights[0]), "m/V"),
        delay=fit.estimate(lambda shape, _: shape[0] / (2 * np.pi * f[-1]), "s"),
        adequacy=adequacy,
    )


def _first_delay(response: FrequencyResponse) -> si.Second:
    """The delay (s) by the slope of the phase, each frequency counted by its size."""
    f, H = response.frequency, response.displacement_per_volt
    phase = np.unwrap(np.angle(H))
    return float(-np.polyfit(f, phase, 1, w=np.abs(H))[0] / (2 * np.pi))
