"""Resonances out of a frequency response: frequency, Q and modal constant of every mode in it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import (
    Estimate,
    FitResult,
    Observation,
    adequacy_of,
    guarded_fit,
    inverse_of,
    observed,
)
from squeezefilm.measure.fits.least_squares import SeparableFit, fit_separable
from squeezefilm.measure.recordings.kinds import FrequencyResponse, finite


@dataclass(frozen=True)
class ModalCircle:
    """A mode by the circle through its response: `roundness` is the mean distance of the points
    from it over its radius. A negative `quality_factor` is that of a phase recorded with the other
    sign."""

    frequency: si.Hertz
    quality_factor: si.Dimensionless
    roundness: si.Dimensionless


def modal_circle(frequency: si.HertzArray, response: si.ComplexArray) -> ModalCircle | None:
    """The mode at the largest response (m/V, complex) among frequencies (Hz), both (points,).

    H = R + A f0²/(f0²(1 + i/Q) − f²) maps the frequencies onto a circle (Kennedy and Pancu 1947,
    10.2514/8.1535); H f² = p H − (A f0² + R p) + R f² with p = f0²(1 + i/Q) is linear in its three
    complex numbers, so it needs no starting value. Taken within twice the half-power band of the
    peak; noise biases it, so that it serves as a start and a check. None where fewer than 6
    points lie there or no resonance comes out.
    """
    peak = int(np.argmax(np.abs(response)))
    near = _around(np.abs(response), peak, 0.45)
    if near.size < 6:
        near = np.arange(max(peak - 4, 0), min(peak + 5, frequency.size))
    if near.size < 6:
        return None
    middle, size = float(frequency[peak]), float(np.abs(response[peak]))
    if size == 0:
        return None
    f, H = frequency[near] / middle, response[near] / size
    # In distances from the peak, as f² hardly changes over the band.
    s = f**2 - 1
    matrix = np.stack([H, -np.ones_like(H), s.astype(complex)], axis=1)
    (p, c, R), *_ = np.linalg.lstsq(matrix, H * s, rcond=None)
    squared = 1 + p.real
    if squared <= 0 or p.imag == 0:
        return None
    A = c - R * p
    radius = abs(A / p.imag) / 2
    distance = np.abs(H - R - A / (2j * p.imag))
    return ModalCircle(
        frequency=middle * float(np.sqrt(squared)),
        quality_factor=float(squared / p.imag),
        roundness=float(np.mean(np.abs(distance - radius)) / radius),
    )


def _around(size: si.FloatArray, peak: int, share: float) -> si.IntArray:
    """The points next to a peak that are above a share of it, without a gap."""
    low = high = peak
    while low > 0 and size[low - 1] > share * size[peak]:
        low -= 1
    while high < size.size - 1 and size[high + 1] > share * size[peak]:
        high += 1
    return np.arange(low, high + 1)


PHASE_REVERSED = (
    "The phase was recorded with the other sign (it rises through the resonance); the fit is of "
    "the complex conjugate. "
)
_TRIED_MODES = 4
_FEWEST_POINTS = 12
# A wider band needs curved residuals; one mode's band is narrow.
_WIDEST = 3.0


@dataclass(frozen=True)
class FittedMode:
    """A mode of a response: frequency (Hz), Q, modal constant and amplitude per volt at its
    resonance (m/V).

    `amplitude_per_volt` is |modal constant| · Q, of this mode alone; `phase` (rad) that of the
    modal constant, 0 or π for a mode that moves alike everywhere.
    """

    frequency: Estimate
    quality_factor: Estimate
    modal_constant: Estimate
    amplitude_per_volt: Estimate
    phase: Estimate


@dataclass(frozen=True, eq=False, repr=False)
class FrequencyResponseFit(FitResult):
    """The modes of a response, the strongest first, and what else is in it.

    `model` (m/V, complex) is what was fitted, `residual` what it leaves, at the recording's
    frequencies (those that were recorded as finite numbers). `phase_reversed` says that the phase
    was recorded with the other sign (it rises through the resonance), and that the fit is of the
    complex conjugate.
    """

    recording: FrequencyResponse
    frequency: si.HertzArray
    model: si.ComplexArray
    residual: si.ComplexArray
    modes: tuple[FittedMode, ...]
    largest_per_volt: Estimate
    phase_reversed: bool

    @property
    def observations(self) -> tuple[Observation, ...]:
        """Observations for a calibration: resonance, Q and amplitude per volt of the strongest
        mode.

        The amplitude is the largest of the whole response near that mode, as the library's
        `amplitude_per_volt` is. Whether the remainder beside the mode is its neighbours' or the
        instrument's nobody can tell: half of what it adds or takes is in the standard error. None
        where the fit is not adequate.
        """
        if not self.adequacy.adequate:
            return ()
        under = {} if self.recording.voltage is None else {"voltage": self.recording.voltage}
        if self.recording.place is not None:
            under |= dict(zip("xy", self.recording.place, strict=True))
        first, largest = self.modes[0], self.largest_per_volt
        remainder = (largest.value - first.amplitude_per_volt.value) / 2
        error = float(np.hypot(largest.standard_error, remainder))
        return observed(
            under,
            resonance_frequency=first.frequency,
            quality_factor=first.quality_factor,
            amplitude_per_volt=replace(largest, standard_error=error),
        )


@guarded_fit
def fit_frequency_response(recording: FrequencyResponse) -> FrequencyResponseFit:
    """Frequency (Hz), Q and modal constant (m/V) of the modes in a response, with intervals.

    H(f) = Σ A_k f_k²/(f_k²(1 + i/Q_k) − f²) + R0 + R1 f: structural damping, complex modal
    constants, a straight remainder for modes outside the band; as many modes as the data call for
    by Schwarz's criterion, up to 4. Intervals are of noise alike at all points, wider where
    neighbouring residuals are alike.

    A phase recorded with the other sign is noticed, said, and does not change frequency and Q.
    Raises `InputError` for fewer than 12 points, a response without phase, or a band of more than
    a factor 3. Source: Ewins, Modal Testing, 2nd ed., sections 4.3 and 4.4.
    """
    f, H = _recorded(recording)
    reversed_phase, start = _first_mode(f, H)
    if reversed_phase:
        H = H.conj()
    size = float(np.max(np.abs(H)))
    band = _Band.over(f)
    fit = _as_many_as_needed(band, H / size, start)
    count = fit.shape.size // 2
    strength = [abs(fit.weights[k] / fit.shape[2 * k + 1]) for k in range(count)]
    order = sorted(range(count), key=lambda k: -strength[k])
    model = np.asarray(fit.model * size, dtype=complex)
    return FrequencyResponseFit(
        recording=recording,
        frequency=f,
        model=model,
        residual=H - model,
        modes=tuple(_mode(band, fit, size, k) for k in order),
        largest_per_volt=_largest(band, fit, size, order[0]),
        phase_reversed=reversed_phase,
        adequacy=adequacy_of(
            H,
            fit.residual * size,
            lambda i: f"at {si.format_quantity(f[i], si.Unit('Hz'), 5)}",
            remedy="Cut the band to the resonance, or drive less: a mode that shifts with its "
            "amplitude is none of a linear plate.",
            said=PHASE_REVERSED if reversed_phase else "",
        ),
    )


def _recorded(recording: FrequencyResponse) -> tuple[si.HertzArray, si.ComplexArray]:
    """Rising frequencies and what was recorded as a finite number there."""
    f, H = finite(recording.frequency, recording.displacement_per_volt)
    f, H = f[f > 0], H[f > 0]
    order = np.argsort(f, kind="stable")
    f, H = f[order], H[order]
    if f.size < _FEWEST_POINTS:
        raise InputError(
            f"the frequency response has {f.size} usable points; a resonance needs at least "
            f"{_FEWEST_POINTS}, most of them within its half-power band"
        )
    if not np.iscomplexobj(H) or not np.any(H.imag):
        raise InputError(
            "the frequency response has no phase (its imaginary part is zero everywhere); record "
            "magnitude and phase, or real and imaginary part"
        )
    if not f[-1] > f[0]:
        raise InputError("the response is of one frequency only; sweep over the resonance")
    if f[-1] > _WIDEST * f[0]:
        raise InputError(
            f"the response runs from {si.format_quantity(f[0], si.Unit('Hz'))} to "
            f"{si.format_quantity(f[-1], si.Unit('Hz'))}; a fit holds over a factor of "
            f"{_WIDEST:g}: cut out the band around the resonance"
        )
    return f, H


@dataclass(frozen=True, eq=False)
class _Band:
    """Frequencies `f` (Hz, (points,)) and the columns of modes over them.

    A mode's numbers are f_k over `middle`, less 1, and its loss 1/Q_k.
    """

    f: si.HertzArray
    middle: si.Hertz
    width: si.Hertz

    @classmethod
    def over(cls, f: si.HertzArray) -> _Band:
        """The band of rising frequencies (Hz)."""
        return cls(f, float(np.median(f)), float(np.ptp(f)))

    @cached_property
    def place(self) -> si.FloatArray:
        """Frequencies from the middle, over the width."""
        return (self.f - self.middle) / self.width

    def columns(self, shape: si.FloatArray) -> tuple[si.ComplexArray, si.ComplexArray]:
        """Modes, a constant and a slope; their derivatives by every number of `shape`."""
        count = shape.size // 2
        matrix = np.empty((self.f.size, count + 2), dtype=complex)
        bent = np.zeros((2 * count, self.f.size, count + 2), dtype=complex)
        squared = (self.f / self.middle) ** 2
        for k in range(count):
            own, loss = 1 + shape[2 * k], shape[2 * k + 1]
            below = own**2 * (1 + 1j * loss) - squared
            matrix[:, k] = own**2 / below
            bent[2 * k, :, k] = -2 * own * squared / below**2
            bent[2 * k + 1, :, k] = -1j * own**4 / below**2
        matrix[:, count] = 1.0
        matrix[:, count + 1] = self.place
        return matrix, bent

    def shape_of(self, modes: list[tuple[float, float]]) -> si.FloatArray:
        """The numbers of modes of these frequencies (Hz) and losses."""
        return np.array([number for f, loss in modes for number in (f / self.middle - 1, loss)])


def _first_mode(f: si.HertzArray, H: si.ComplexArray) -> tuple[bool, tuple[float, float]]:
    """True where the phase has the other sign; frequency and loss of the strongest mode."""
    circle = modal_circle(f, H)
    if circle is None:
        peak = int(np.argmax(np.abs(H)))
        return False, (float(f[peak]), 0.02)
    loss = 1 / circle.quality_factor
    if not f[0] / 1.2 < circle.frequency < f[-1] * 1.2:
        return loss < 0, (float(f[np.argmax(np.abs(H))]), min(abs(loss), 0.2))
    return loss < 0, (circle.frequency, min(abs(loss), 0.5))


def _as_many_as_needed(band: _Band, H: si.ComplexArray, start: tuple[float, float]) -> SeparableFit:
    """Fit one mode more as long as what is left calls for it."""
    best = fit_separable(band.columns, H, band.shape_of([start]))
    while best.shape.size // 2 < _TRIED_MODES:
        count = best.shape.size // 2 + 1
        if 2 * H.size <= 2 * (2 * count + 2) + 8:
            break
        more = _one_more(band, H, best)
        if more is None or _criterion(more, H.size) > _criterion(best, H.size) - 6:
            break
        best = more
    return best


def _criterion(fit: SeparableFit, points: int) -> float:
    """Schwarz's: less is better (10.1214/aos/1176344136)."""
    squares = float(np.sum(np.abs(fit.residual) ** 2)) or 1e-300
    return float(2 * points * np.log(squares) + fit.covariance.shape[0] * np.log(2 * points))


def _one_more(band: _Band, H: si.ComplexArray, fit: SeparableFit) -> SeparableFit | None:
    """The fit with a mode more, which starts where the residual is largest."""
    circle = modal_circle(band.f, fit.residual)
    at = float(band.f[np.argmax(np.abs(fit.residual))])
    loss = float(abs(fit.shape[1]))
    candidates = [(at, loss)]
    if circle is not None and band.f[0] < circle.frequency < band.f[-1]:
        candidates.append((circle.frequency, min(abs(1 / circle.quality_factor), 0.2)))
    fits = []
    for candidate in candidates:
        start = np.append(fit.shape, band.shape_of([candidate]))
        fitted = fit_separable(band.columns, H, start, reach=band.width / band.middle)
        # A mode with gain, beside the band, or narrower than the points are apart, is none.
        losses, places = fitted.shape[1::2], fitted.shape[::2]
        steps = np.interp(band.middle * (1 + places), band.f, np.gradient(band.f)) / band.middle
        if np.all(losses > steps) and np.all(np.abs(places) < band.width / band.middle):
            fits.append(fitted)
    return min(fits, key=lambda more: float(np.sum(np.abs(more.residual) ** 2)), default=None)


def _mode(band: _Band, fit: SeparableFit, size: si.MetrePerVolt, k: int) -> FittedMode:
    loss = fit.estimate(lambda shape, _: shape[2 * k + 1], "1")
    return FittedMode(
        frequency=fit.estimate(lambda shape, _: band.middle * (1 + shape[2 * k]), "Hz"),
        quality_factor=inverse_of(loss),
        modal_constant=fit.estimate(
            lambda _, weights: abs(weights[k]) * size, "m/V", positive=True
        ),
        amplitude_per_volt=fit.estimate(
            lambda shape, weights: abs(weights[k] / shape[2 * k + 1]) * size, "m/V", positive=True
        ),
        phase=fit.angle(lambda _, weights: complex(weights[k])),
    )


def _largest(band: _Band, fit: SeparableFit, size: si.MetrePerVolt, k: int) -> Estimate:
    """The largest size of the fitted response within the strongest mode's band."""
    own, loss = band.middle * (1 + fit.shape[2 * k]), fit.shape[2 * k + 1]
    near = replace(band, f=own * (1 + loss * np.linspace(-1, 1, 81)))
    at = int(np.argmax(np.abs(near.columns(fit.shape)[0] @ fit.weights)))
    # At the place of a maximum its shift changes the value to second order only.
    point = replace(near, f=near.f[at : at + 1])
    return fit.estimate(
        lambda shape, weights: float(abs((point.columns(shape)[0] @ weights)[0])) * size,
        "m/V",
        positive=True,
    )
