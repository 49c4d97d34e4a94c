"""Rendered against wanted friction, in numbers: error, contrast by spatial frequency, lag.

`design.analysis.felt` asks what a steady grating keeps in closed form; this measures
whatever was rendered.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import LAG_PRODUCTS, require_within
from squeezefilm.core.kit.numbers import M, S, shown
from squeezefilm.physics.render.fidelity.rendered_stroke import LoopRun, RenderedStroke

PerMetreArray = Annotated[si.FloatArray, si.Unit("1/m")]
_Mask = np.ndarray[tuple[int], np.dtype[np.bool_]]
_Passes = list[tuple[si.FloatArray, si.FloatArray, si.FloatArray]]

# After fifteen time constants 3e-7 of the start is left.
_SETTLING = 15
_PER_PERIOD = 64
_LONGEST_LAG: si.Metre = 5e-3
_FEWEST_PERIODS = 4
# Below this share of the wanted pattern's power a spatial frequency counts as not in it.
_FAINT = 1e-6
_MOST_LINES = 6
_FAINT_LINE = 0.01


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class FidelityReport(LoopRun):
    """Report on the friction rendered beside the friction wanted; every field has a JSON form.

    Attributes beside those of `LoopRun`:
        texture, trajectory: as text.
        judged: time that was judged, without the start (s).
        mean_speed: of the finger meanwhile (m/s).
        wanted_swing: peak to peak of the relative friction wanted (1).
        rms_error: of relative friction, rendered minus wanted (1).
        relative_error: `rms_error` over the standard deviation of the friction wanted (1); 1 is
            what a constant friction at the right mean would score.
        spatial_frequency: at which contrast was measured (1/m), shape (f,).
        contrast_kept: share of the wanted pattern's swing at each that is rendered *in its place*
            (1), shape (f,): |Σ R W*| / Σ |W|² over passes. NaN where the pattern has nothing.
        swing_kept: share of the wave at each, wherever it lies (1), shape (f,):
            √(Σ|R|² / Σ|W|²). Of a grating the first is its fundamental, and not peak to peak.
        lag: by which the rendered pattern trails the finger (m), by cross-correlation; within
            half a period for a periodic texture. Negative where it comes early.
        lag_time: `lag` over the mean speed (s).
        position_error, speed_error: RMS of the estimate (m, m/s); None without a sensor.
        samples_refused: outliers, doubles and the like; None without a sensor.
    """

    texture: str
    trajectory: str
    judged: si.Second
    mean_speed: si.MetrePerSecond
    wanted_swing: si.Dimensionless
    rms_error: si.Dimensionless
    relative_error: si.Dimensionless
    spatial_frequency: PerMetreArray
    contrast_kept: si.DimensionlessArray
    swing_kept: si.DimensionlessArray
    lag: si.Metre
    lag_time: si.Second
    position_error: si.Metre | None
    speed_error: si.MetrePerSecond | None
    samples_refused: int | None


def fidelity_report(
    stroke: RenderedStroke, spatial_frequencies: Sequence[float] | si.FloatArray | None = None
) -> FidelityReport:
    """Judge a rendered stroke.

    The start is left out: fifteen time constants, and with a sensor its latency and ten samples
    as well. Contrast and lag are measured over position, pass by pass, along the way the finger
    goes, so that a pass there and one back count alike.

    Args:
        stroke: from `rendered_stroke`.
        spatial_frequencies: at which to measure contrast (1/m). Without them the first, third
            and fifth harmonic of a grating along x, else eight from four periods
            a pass to one per 0.5 mm.

    Raises:
        InputError: a stroke that ends before its start has settled, friction wanted that doesn't
            change, a frequency not above 0, or no pass of four periods at the lowest frequency.
    """
    skip, judged = _judged(stroke)
    wanted = stroke.relative_friction_wanted[judged]
    error = _rms(stroke.relative_friction_rendered[judged] - wanted)
    passes = _passes(stroke, judged)
    frequencies = _frequencies(stroke, passes, spatial_frequencies)
    contrast, swing = _contrast(passes, frequencies)
    mean_speed = float(np.mean(np.abs(stroke.speed[judged])))
    lag = _lag(passes, getattr(stroke.texture, "spatial_period", None), float(frequencies.max()))
    position_error, speed_error, refused = _errors_of_estimate(stroke, judged)
    return FidelityReport(
        **{field.name: getattr(stroke, field.name) for field in dataclasses.fields(LoopRun)},
        texture=repr(stroke.texture),
        trajectory=repr(stroke.trajectory),
        judged=float(stroke.time[-1] - skip),
        mean_speed=mean_speed,
        wanted_swing=float(np.ptp(wanted)),
        rms_error=error,
        relative_error=error / float(np.std(wanted)),
        spatial_frequency=frequencies,
        contrast_kept=contrast,
        swing_kept=swing,
        lag=lag,
        lag_time=lag / mean_speed,
        position_error=position_error,
        speed_error=speed_error,
        samples_refused=refused,
    )


def _judged(stroke: RenderedStroke) -> tuple[si.Second, _Mask]:
    """The start that is left out (s), and which steps are judged. Raises as `fidelity_report`."""
    slowest = max(stroke.envelope.rise_time_constant, stroke.envelope.fall_time_constant)
    skip = _SETTLING * slowest
    if stroke.sensor is not None:
        skip += stroke.sensor.latency + 10 / stroke.sensor.rate
    judged = stroke.time >= skip
    if np.count_nonzero(judged) < 2:
        raise InputError(
            f"the stroke of {stroke.time[-1]:.4g} s ends before its start has settled "
            f"({skip:.4g} s); make it longer"
        )
    # The deviation of equal numbers is rounding, not zero.
    if np.ptp(stroke.relative_friction_wanted[judged]) <= 1e-12:
        raise InputError(
            "the friction wanted does not change along the stroke, so there is no fidelity to "
            "judge; choose a texture, or amplitudes, that change it"
        )
    return skip, judged


def _errors_of_estimate(
    stroke: RenderedStroke, judged: _Mask
) -> tuple[si.Metre | None, si.MetrePerSecond | None, int | None]:
    """RMS errors of place and speed, and how many samples were refused; None without a sensor."""
    if stroke.estimate is None:
        return None, None, None
    seen, c = judged & stroke.estimate.fresh, stroke.estimate.counts
    return (
        _rms((stroke.estimate.position - stroke.position)[seen]),
        _rms((stroke.estimate.speed - stroke.speed)[seen]),
        c.not_finite + c.duplicate + c.backwards + c.outlier,
    )


def _rms(values: si.FloatArray) -> float:
    return math.sqrt(float(np.mean(values**2))) if values.size else math.nan


def _passes(stroke: RenderedStroke, judged: _Mask) -> _Passes:
    """Way (m, rising), wanted and rendered friction of each pass in one direction."""
    direction = np.sign(np.diff(stroke.position))
    passes = []
    edges = np.flatnonzero(np.diff(direction)) + 1
    for part in np.split(np.arange(direction.size), edges):
        if direction[part[0]] == 0:
            continue
        inside = part[judged[part]]
        if inside.size >= 2:
            passes.append(
                (
                    direction[part[0]] * stroke.position[inside],
                    stroke.relative_friction_wanted[inside],
                    stroke.relative_friction_rendered[inside],
                )
            )
    return passes


def _frequencies(
    stroke: RenderedStroke,
    passes: _Passes,
    asked: Sequence[float] | si.FloatArray | None,
) -> si.FloatArray:
    longest = max((float(np.ptp(way)) for way, _, _ in passes), default=0.0)
    period = getattr(stroke.texture, "spatial_period", None)
    if asked is not None:
        frequencies = np.array(asked, dtype=float)
    elif period is not None:
        frequencies = np.array([1.0, 3.0, 5.0]) / period
    else:
        frequencies = np.geomspace(_FEWEST_PERIODS / max(longest, 1e-9), 1 / 0.5e-3, 8)
    if frequencies.ndim != 1 or frequencies.size == 0:
        raise InputError(
            f"spatial_frequencies of shape {frequencies.shape} cannot be used: give a list of at "
            "least one"
        )
    si.require("spatial_frequencies", frequencies, si.Unit("1/m"), above=0.0)
    if longest * float(frequencies.min()) < _FEWEST_PERIODS * (1 - 1e-9):
        raise InputError(
            f"no pass shows {_FEWEST_PERIODS} periods at {float(frequencies.min()):.4g} 1/m: the "
            f"longest judged is {longest:.4g} m; lengthen the stroke or raise the frequency"
        )
    return frequencies


def _contrast(passes: _Passes, frequencies: si.FloatArray) -> tuple[si.FloatArray, si.FloatArray]:
    cross = np.zeros(frequencies.size, dtype=complex)
    wanted_power, rendered_power = np.zeros((2, frequencies.size))
    whole = 0.0
    for way, wanted, rendered in passes:
        length = float(way[-1] - way[0])
        enough = length * frequencies >= _FEWEST_PERIODS * (1 - 1e-9)
        # Trapezoids over the way: samples are even in time, not along it.
        weight = np.gradient(way) * np.sin(np.pi * (way - way[0]) / length) ** 2
        weight /= weight.sum()
        w, r = wanted - weight @ wanted, rendered - weight @ rendered
        W, R = np.zeros((2, frequencies.size), dtype=complex)
        # One at a time: all of them together would be the largest array of a rendered stroke.
        for k, frequency in enumerate(frequencies):
            wave = np.exp(-2j * math.pi * frequency * way) * weight
            W[k], R[k] = wave @ w, wave @ r
        cross += np.where(enough, R * W.conj(), 0)
        wanted_power += np.where(enough, np.abs(W) ** 2, 0)
        rendered_power += np.where(enough, np.abs(R) ** 2, 0)
        whole += float(weight @ w**2)
    there = wanted_power > _FAINT * whole
    power = np.where(there, wanted_power, np.nan)
    return np.abs(cross) / power, np.sqrt(rendered_power / power)


def _lag(passes: _Passes, period: float | None, highest_frequency: float) -> float:
    step = 1 / (_PER_PERIOD * highest_frequency)
    reach = _LONGEST_LAG if period is None else period / 2
    most = max(2, math.ceil(reach / step))
    step = reach / most
    points = sum(float(way[-1] - way[0]) / step for way, _, _ in passes)
    require_within(
        LAG_PRODUCTS, points * (2 * most + 1), enough="take a coarser texture or a shorter stroke"
    )
    shifts = np.arange(-most, most + 1)
    score = np.zeros(shifts.size)
    for way, wanted, rendered in passes:
        grid = np.arange(way[0], way[-1], step)
        if grid.size <= 4 * most:
            continue
        w, r = np.interp(grid, way, wanted), np.interp(grid, way, rendered)
        # Weighted so that a period cut at the end of a pass cannot pull the answer.
        weight = np.hanning(grid.size - 2 * most + 2)[1:-1]
        weight /= weight.sum()
        inner = r[most:-most]
        inner = weight * (inner - weight @ inner)
        # What lies at a place now was wanted a lag earlier on the way: w from `most - shift` on,
        # its weighted mean taken out. All shifts at once, by the Fourier transform; about a mean
        # of nought, so that little is lost to rounding where squares are subtracted.
        w = w - w.mean()
        mean, square = _sliding(w, weight, most), _sliding(w**2, weight, most)
        spread = np.sqrt(np.maximum(square - mean**2, 0.0) * float(inner @ (inner / weight)))
        there = spread > 1e-9 * max(float(np.ptp(w)) * float(np.ptp(r)), 1e-300)
        height = _sliding(w, inner, most)[there] / spread[there]
        score[there] += grid.size * height
    best = int(np.argmax(score))
    if not 0 < best < shifts.size - 1:
        return float(shifts[best] * step) if np.any(score) else math.nan
    left, here, right = score[best - 1 : best + 2]
    bend = left - 2 * here + right
    return float((shifts[best] + (0.5 * (left - right) / bend if bend else 0.0)) * step)


def _sliding(values: si.FloatArray, weight: si.FloatArray, most: int) -> si.FloatArray:
    """Sums of weight times values from each of 2 `most` + 1 beginnings, the last one first."""
    size = next_fast_len(values.size, real=True)
    product = rfft(values, size) * np.conj(rfft(weight, size))
    return np.asarray(irfft(product, size)[: 2 * most + 1][::-1])


def strongest_lines(stroke: RenderedStroke, period: si.Metre | None) -> si.FloatArray | None:
    """Spatial frequencies (1/m) at which a texture without a period has its contrast.

    The strongest lines of the first pass's spectrum, at most six; elsewhere a share of next to
    nothing would be measured. None where `fidelity_report` knows better.
    """
    turns = np.flatnonzero(np.diff(np.sign(np.diff(stroke.position))) != 0)
    end = int(turns[0]) + 2 if turns.size else stroke.position.size
    way, wanted = stroke.position[:end], stroke.relative_friction_wanted[:end]
    length = abs(float(way[-1] - way[0]))
    if period is not None or length == 0.0 or way.size < 64:
        return None
    rising = 1 if way[-1] > way[0] else -1
    even = np.linspace(way.min(), way.max(), 8192)
    values = np.interp(even, way[::rising], wanted[::rising])
    power = np.abs(np.fft.rfft((values - values.mean()) * np.hanning(even.size))) ** 2
    # A pass whose start is left out must still show four periods.
    least = math.ceil(5 / (1 - 0.2))
    lines = np.arange(least, power.size - 1)
    peaks = lines[(power[lines] >= power[lines - 1]) & (power[lines] > power[lines + 1])]
    strong = peaks[power[peaks] > _FAINT_LINE * power[least:].max(initial=0.0)]
    best = np.sort(strong[np.argsort(power[strong])[::-1][:_MOST_LINES]])
    return np.asarray(best / length, dtype=float) if best.size else None


def contrast_rows(judged: FidelityReport, what: str) -> list[tuple[str, str, str]]:
    """Rows on the share of each wave of the pattern that is kept, in its place and anywhere."""
    waves = zip(judged.spatial_frequency, judged.contrast_kept, judged.swing_kept, strict=True)
    return [
        (
            f"{what} {shown(1 / frequency, M, 3)}",
            f"{100 * kept:.0f} %",
            f"in its place; {100 * swing:.0f} % of that wave anywhere",
        )
        for frequency, kept, swing in waves
        if math.isfinite(kept)
    ]


def lag_rows(judged: FidelityReport, what: str = "Lag") -> list[tuple[str, str, str]]:
    """Row on how far the rendered pattern trails the finger; none where that is not known."""
    if not math.isfinite(judged.lag):
        return []
    word = "behind" if judged.lag >= 0 else "ahead of"
    late = f"{shown(abs(judged.lag_time), S, 2)} at {1e3 * judged.mean_speed:.3g} mm/s"
    return [(what, f"{1e3 * judged.lag:.3f} mm", f"{word} the finger, {late}")]
