"""Resonances out of a frequency response: frequency, Q and modal constant of every mode in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import Adequacy, Estimate, Observation
from squeezefilm.measure.fits.guarded import guarded_fit
from squeezefilm.measure.fits.misfit import adequacy_of
from squeezefilm.measure.fits.nonlinear import inverse_of
from squeezefilm.measure.fits.separable import SeparableFit, fit_separable
from squeezefilm.measure.fits.vibration.modal_band import ModalBand, band_poles
from squeezefilm.measure.fits.vibration.modal_circle import ModalCircle, modal_circle
from squeezefilm.measure.recordings.kinds import FrequencyResponse

MOST_MODES = 12
"""So many modes are fitted to one response at most."""

_TRIED_MODES = 4
_PEAKS_SUFFICE = 2
_FEWEST_POINTS = 12
# A wider band needs curved residuals; one mode's band is narrow.
_WIDEST = 3.0


@dataclass(frozen=True)
class FittedMode:
    """One mode of a response: frequency (Hz), Q, modal constant and amplitude per volt at its
    resonance (m/V).

    `amplitude_per_volt` is |modal constant| · Q, of this mode alone; `phase` (rad) that of the
    modal constant, 0 or π for a mode that moves alike everywhere.
    """

    frequency: Estimate
    quality_factor: Estimate
    modal_constant: Estimate
    amplitude_per_volt: Estimate
    phase: Estimate


@dataclass(frozen=True, eq=False)
class FrequencyResponseFit:
    """The modes of a response, the strongest first, and what else is in it.

    `model` (m/V, complex) is what was fitted, `residual` what it leaves, at the recording's
    frequencies (those that were recorded as finite numbers). `circle` is the strongest mode by its
    circle alone. `phase_reversed` says that the phase was recorded with the other sign (it rises
    through the resonance), and that the fit is of the complex conjugate. `delay` (s) where it was
    asked for: what the instrument adds, for modal constants taken to be real.
    """

    recording: FrequencyResponse
    frequency: si.HertzArray
    model: si.ComplexArray
    residual: si.ComplexArray
    modes: tuple[FittedMode, ...]
    largest_per_volt: Estimate
    circle: ModalCircle | None
    phase_reversed: bool
    delay: Estimate | None
    adequacy: Adequacy

    @property
    def observations(self) -> tuple[Observation, ...]:
        """What a calibration may use: resonance, Q and amplitude per volt of the strongest mode.

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
        return (
            *(
                Observation(name, one.value, one.standard_error, under)
                for name, one in (
                    ("resonance_frequency", first.frequency),
                    ("quality_factor", first.quality_factor),
                )
            ),
            Observation("amplitude_per_volt", largest.value, error, under),
        )


@guarded_fit
def fit_frequency_response(
    recording: FrequencyResponse,
    *,
    modes: Annotated[int, si.AtLeast(1), si.AtMost(MOST_MODES)] | None = None,
    delay: bool = False,
    level: si.Dimensionless = 0.95,
) -> FrequencyResponseFit:
    """Frequency (Hz), Q and modal constant (m/V) of the modes in a response, with intervals.

    H(f) = e^{−2πifτ} [Σ A_k f_k²/(f_k²(1 + i/Q_k) − f²) + R0 + R1 f]: structural damping, complex
    modal constants, a straight remainder for modes outside the band, τ = 0 unless `delay` asks for
    it (modal constants and remainder are then taken to be real: an assumption). Without `modes`
    as many as the data call for by Schwarz's criterion, up to 4; where more than two are asked for
    they start from the poles of sdypy-EMA's complex-frequency fit. Intervals at `level` are of
    noise alike at all points, wider where neighbouring residuals are alike.

    A phase recorded with the other sign is noticed, said, and does not change frequency and Q.
    Raises `InputError` for fewer than 12 points, a response without phase, or a band of more than
    a factor 3. Source: Ewins, Modal Testing, 2nd ed., sections 4.3 and 4.4.
    """
    f, H = _recorded(recording)
    if modes is not None:
        si.require("modes", modes, at_least=1, at_most=MOST_MODES)
    reversed_phase, start = _first_mode(f, H)
    if reversed_phase:
        H = H.conj()
    size = float(np.max(np.abs(H)))
    band = ModalBand.over(f)
    fit = (
        _as_many_as_needed(band, H / size, start)
        if modes is None
        else _with_modes(band, H / size, start, modes)
    )
    if delay:
        count = (fit.shape.size) // 2
        fit = fit_separable(
            band.delayed, H / size, np.append(fit.shape[: 2 * count], 0.0), real_weights=True
        )
    return _FittedResponse(recording, band, H, fit, size, reversed_phase, delay, level).read()


def _recorded(recording: FrequencyResponse) -> tuple[si.HertzArray, si.ComplexArray]:
    """Rising frequencies and what was recorded as a finite number there."""
    f = np.asarray(recording.frequency, dtype=float)
    H = np.asarray(recording.displacement_per_volt)
    good = np.isfinite(f) & np.isfinite(H) & (f > 0)
    order = np.argsort(f[good], kind="stable")
    f, H = f[good][order], H[good][order]
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


def _first_mode(f: si.HertzArray, H: si.ComplexArray) -> tuple[bool, tuple[float, float]]:
    """Whether the phase has the other sign, and frequency and loss of the strongest mode."""
    circle = modal_circle(f, H)
    if circle is None:
        peak = int(np.argmax(np.abs(H)))
        return False, (float(f[peak]), 0.02)
    loss = 1 / circle.quality_factor
    if not f[0] / 1.2 < circle.frequency < f[-1] * 1.2:
        return loss < 0, (float(f[np.argmax(np.abs(H))]), min(abs(loss), 0.2))
    return loss < 0, (circle.frequency, min(abs(loss), 0.5))


def _as_many_as_needed(
    band: ModalBand, H: si.ComplexArray, start: tuple[float, float]
) -> SeparableFit:
    """One mode more as long as what is left calls for it."""
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


def _one_more(band: ModalBand, H: si.ComplexArray, fit: SeparableFit) -> SeparableFit | None:
    """The fit with a mode more, which starts where the residual is largest."""
    found = modal_circle(band.f, fit.residual)
    at = float(band.f[np.argmax(np.abs(fit.residual))])
    loss = float(abs(fit.shape[1]))
    candidates = [(at, loss)]
    if found is not None and band.f[0] < found.frequency < band.f[-1]:
        candidates.append((found.frequency, min(abs(1 / found.quality_factor), 0.2)))
    fits = []
    for one in candidates:
        start = np.append(fit.shape, band.shape_of([one]))
        fitted = fit_separable(band.columns, H, start, reach=band.width / band.middle)
        # A mode with gain, or as broad as the band, is none.
        losses, places = fitted.shape[1::2], fitted.shape[::2]
        if np.all(losses > 0) and np.all(np.abs(places) < band.width / band.middle):
            fits.append(fitted)
    return min(fits, key=lambda one: float(np.sum(np.abs(one.residual) ** 2)), default=None)


def _with_modes(
    band: ModalBand, H: si.ComplexArray, start: tuple[float, float], count: int
) -> SeparableFit:
    """The fit with a number of modes that was asked for."""
    fit = fit_separable(band.columns, H, band.shape_of([start]))
    if count > _PEAKS_SUFFICE:
        poles = band_poles(band, H, count)
        if len(poles) == count:
            return fit_separable(band.columns, H, band.shape_of(poles))
    while fit.shape.size // 2 < count:
        more = _one_more(band, H, fit)
        if more is None:
            raise InputError(
                f"modes = {count} were asked for and only {fit.shape.size // 2} can be told apart "
                f"between {band.f[0]:.6g} Hz and {band.f[-1]:.6g} Hz; ask for fewer",
                quantity="modes",
            )
        fit = more
    return fit


@dataclass(frozen=True, eq=False)
class _FittedResponse:
    """A fit in its own numbers, to be read off."""

    recording: FrequencyResponse
    band: ModalBand
    response: si.ComplexArray
    fit: SeparableFit
    size: float
    reversed_phase: bool
    delay: bool
    level: float

    def read(self) -> FrequencyResponseFit:
        count = self.fit.shape.size // 2
        strength = [abs(self.fit.weights[k] / self.fit.shape[2 * k + 1]) for k in range(count)]
        order = sorted(range(count), key=lambda k: -strength[k])
        model = np.asarray(self.fit.model * self.size, dtype=complex)
        return FrequencyResponseFit(
            recording=self.recording,
            frequency=self.band.f,
            model=model,
            residual=self.response - model,
            modes=tuple(self._mode(k) for k in order),
            largest_per_volt=self._largest(order[0]),
            circle=modal_circle(self.band.f, self.response),
            phase_reversed=self.reversed_phase,
            delay=self._delay() if self.delay else None,
            adequacy=self._adequacy(),
        )

    def _mode(self, k: int) -> FittedMode:
        fit, level = self.fit, self.level
        loss = fit.estimate(lambda shape, _: shape[2 * k + 1], "1", level=level)
        return FittedMode(
            frequency=fit.estimate(
                lambda shape, _: self.band.middle * (1 + shape[2 * k]), "Hz", level=level
            ),
            quality_factor=inverse_of(loss),
            modal_constant=fit.estimate(
                lambda _, weights: abs(weights[k]) * self.size, "m/V", positive=True, level=level
            ),
            amplitude_per_volt=fit.estimate(
                lambda shape, weights: abs(weights[k] / shape[2 * k + 1]) * self.size,
                "m/V",
                positive=True,
                level=level,
            ),
            phase=self._phase(k),
        )

    def _phase(self, k: int) -> Estimate:
        # From the fitted one, so that no interval is cut at ±π.
        own = self.fit.weights[k]
        turned = self.fit.estimate(
            lambda _, weights: float(np.angle(weights[k] * np.conj(own))), "rad", level=self.level
        )
        angle = float(np.angle(own))
        low, high = turned.interval
        ends = angle + low, angle + high
        return Estimate(angle, turned.standard_error, ends, "rad", self.level)

    def _largest(self, k: int) -> Estimate:
        """The largest size of the fitted response within the strongest mode's band."""
        columns = self.band.delayed if self.delay else self.band.columns
        own, loss = self.band.middle * (1 + self.fit.shape[2 * k]), self.fit.shape[2 * k + 1]
        near = ModalBand(
            own * (1 + loss * np.linspace(-1, 1, 81)), self.band.middle, self.band.width
        )
        dense = near.delayed if self.delay else near.columns
        at = int(np.argmax(np.abs(dense(self.fit.shape)[0] @ self.fit.weights)))
        # At the place of a maximum its shift changes the value to second order only.
        point = ModalBand(near.f[at : at + 1], self.band.middle, self.band.width)
        columns = point.delayed if self.delay else point.columns
        return self.fit.estimate(
            lambda shape, weights: float(abs((columns(shape)[0] @ weights)[0])) * self.size,
            "m/V",
            positive=True,
            level=self.level,
        )

    def _delay(self) -> Estimate:
        scale = 2 * np.pi * self.band.width
        return self.fit.estimate(lambda shape, _: shape[-1] / scale, "s", level=self.level)

    def _adequacy(self) -> Adequacy:
        said = (
            "The phase was recorded with the other sign (it rises through the resonance); the fit "
            "is of the complex conjugate. "
            if self.reversed_phase
            else ""
        )
        return adequacy_of(
            self.response,
            self.fit.residual * self.size,
            lambda i: f"at {si.format_quantity(self.band.f[i], si.Unit('Hz'), 5)}",
            remedy="Ask for more modes, cut the band to the resonance, or drive less: a mode that "
            "shifts with its amplitude is none of a linear plate.",
            said=said,
        )
