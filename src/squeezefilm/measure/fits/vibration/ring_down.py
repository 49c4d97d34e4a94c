"""A decay in time: frequency, Q, and how both depend on the amplitude."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import (
    Estimate,
    FitResult,
    Observation,
    adequacy_of,
    correlation_factor,
    guarded_fit,
    inverse_of,
    observed,
)
from squeezefilm.measure.fits.least_squares import (
    NonlinearFit,
    SeparableFit,
    fit_nonlinear,
    fit_separable,
)
from squeezefilm.measure.recordings.kinds import RingDown, finite

_FEWEST_POINTS = 40
_FEWEST_PERIODS = 5.0
# Points of the slow envelope by which residuals are judged: some to the decay time, each an average
# over several periods.
_BLOCKS = 64
# Beyond what chance gives once in a thousand does the damping depend on the amplitude.
_CHANCE = 1e-3


@dataclass(frozen=True, eq=False, repr=False)
class RingDownFit(FitResult):
    """A decay: frequency (Hz) and Q of what rings longest, its amplitude (m) when the recording
    begins (all lengths in the recording's unit, where it holds another signal).

    `damping_rise` (1/m) says how the loss 1/Q rises with the amplitude, 1/Q = (1/Q0)(1 + r a), and
    `frequency_rise` (1/m²) how the frequency does, f = f0 (1 + s a²); both None where what was
    recorded does not tell them from zero, and then frequency and Q are those of all of the decay.
    Otherwise they are those of the smallest amplitudes. `second` is a second mode that beats with
    the first, where one is told. `model` and `residual` (m) are at `time` (s).
    """

    recording: RingDown
    time: si.SecondArray
    model: si.MetreArray
    residual: si.MetreArray
    frequency: Estimate
    quality_factor: Estimate
    amplitude: Estimate
    damping_rise: Estimate | None
    frequency_rise: Estimate | None
    second: tuple[Estimate, Estimate] | None

    @property
    def observations(self) -> tuple[Observation, ...]:
        """Observations for a calibration: resonance frequency and Q; none of an inadequate fit.

        With losses of 1/Q the free decay rings at the resonance but for a share 1/8Q².
        """
        if not self.adequacy.adequate:
            return ()
        return observed({}, resonance_frequency=self.frequency, quality_factor=self.quality_factor)


@guarded_fit
def fit_ring_down(recording: RingDown) -> RingDownFit:
    """Frequency (Hz) and Q of a free decay, its amplitude (m), and how they depend on amplitude.

    w = a(t) cos φ(t) + constant + slope, first with a = A e^{−πft/Q}; where the residual calls for
    it at a chance below 1 in 1000, with da/dt = −(πf/Q0) a (1 + r a) and f = f0(1 + s a²), which
    have closed forms; a second decay that beats with the first (both linear) where neither
    describes what was recorded, and it does. Valid while the plate rings freely: cut off what was
    recorded before the drive stopped. Raises `InputError` for fewer than 40 points or 5 periods.
    """
    t, w = _recorded(recording)
    size = float(np.max(np.abs(w - w.mean())))
    if size == 0:
        raise InputError("the ring-down does not move; nothing was recorded")
    decay = _Decay(t, w / size, size)
    fit = fit_separable(decay.columns, decay.w, decay.start, reach=decay.reach)
    blocks = _Blocks(t, float(fit.shape[0]))
    curved = _Bent.of(decay, fit)
    # A dependence on the amplitude that does not describe the decay stands for something else.
    is_other = curved.chance > _CHANCE or blocks.misfits(decay.w - curved.model)
    bent = None if is_other else curved
    two = False
    if bent is None and blocks.misfits(fit.residual):
        pair = _with_second(decay, fit)
        two = not blocks.misfits(pair.residual) and bool(np.all(pair.shape[1::2] > 0))
        fit = pair if two else fit
    fit = fit.with_widening(correlation_factor(blocks.of(fit.residual)))
    return _told(recording, decay, blocks, fit, bent, two=two)


def _recorded(recording: RingDown) -> tuple[si.SecondArray, si.MetreArray]:
    t, w = finite(recording.time, recording.displacement)
    order = np.argsort(t, kind="stable")
    t, w = t[order], w[order]
    if t.size < _FEWEST_POINTS or not t[-1] > t[0]:
        raise InputError(
            f"the ring-down has {t.size} usable points; a decay needs at least {_FEWEST_POINTS}"
        )
    return t - t[0], w


@dataclass(frozen=True, eq=False)
class _Decay:
    """A decay over its largest `size`, and the columns of decays: shape is f and the rate πf/Q."""

    t: si.SecondArray
    w: si.FloatArray
    size: float

    @cached_property
    def start(self) -> si.FloatArray:
        f = _strongest_line(self.t, self.w)
        if f * self.t[-1] < _FEWEST_PERIODS:
            raise InputError(
                f"the ring-down holds {f * self.t[-1]:.1f} periods; a decay needs at least "
                f"{_FEWEST_PERIODS:g}"
            )
        return np.array([f, _rate(self.t, self.w, f)])

    @property
    def reach(self) -> si.FloatArray:
        """Distance that frequency and rate may be from where spectrum and envelope have them."""
        return np.array([20.0 / self.t[-1], 30.0 * self.start[1]])

    def columns(self, shape: si.FloatArray) -> tuple[si.FloatArray, si.FloatArray]:
        """Cosine and sine of every decay, a constant and a slope; with their derivatives."""
        t, rows = self.t, []
        bent = np.zeros((shape.size, t.size, shape.size + 2))
        for k in range(0, shape.size, 2):
            turn, fall = 2 * np.pi * shape[k] * t, np.exp(-shape[k + 1] * t)
            cosine, sine = fall * np.cos(turn), fall * np.sin(turn)
            rows += [cosine, sine]
            bent[k, :, k], bent[k, :, k + 1] = -2 * np.pi * t * sine, 2 * np.pi * t * cosine
            bent[k + 1, :, k], bent[k + 1, :, k + 1] = -t * cosine, -t * sine
        rows += [np.ones(t.size), t / t[-1] - 0.5]
        return np.stack(rows, axis=1), bent


def _strongest_line(t: si.SecondArray, w: si.FloatArray) -> float:
    """The frequency of the largest line, between the lines of the spectrum by a parabola."""
    count = t.size
    even = np.linspace(0.0, t[-1], count)
    spectrum = np.abs(np.fft.rfft((np.interp(even, t, w) - w.mean()) * np.hanning(count)))
    at = int(np.argmax(spectrum[1:])) + 1
    shift = 0.0
    if 1 < at < spectrum.size - 1:
        low, middle, high = np.log(spectrum[at - 1 : at + 2] + 1e-300)
        shift = float((low - high) / (2 * (low - 2 * middle + high) or -1.0))
    return float((at + np.clip(shift, -0.5, 0.5)) * (count - 1) / count / t[-1])


def _rate(t: si.SecondArray, w: si.FloatArray, f: float) -> float:
    """The rate at which the envelope falls (1/s), by a straight line through its logarithm."""
    blocks = _Blocks(t, f)
    size = np.abs(blocks.of(w))
    from_start = size > max(0.1 * size.max(), 3 * np.median(size[-size.size // 8 - 1 :]))
    use = np.flatnonzero(from_start)
    if use.size < 4:
        use = np.arange(min(8, size.size))
    slope = np.polyfit(blocks.time[use], np.log(size[use] + 1e-300), 1, w=size[use])[0]
    return float(np.clip(-slope, 0.1 / t[-1], np.pi * f))


@dataclass(frozen=True, eq=False)
class _Blocks:
    """Averages over blocks of a signal turned back by a frequency: what changes slowly in it."""

    t: si.SecondArray
    f: si.Hertz

    @cached_property
    def edges(self) -> si.IntArray:
        # At least two periods to a block, and some points.
        periods = max(int(self.f * self.t[-1]), 1)
        count = int(np.clip(min(_BLOCKS, periods // 2, self.t.size // 6), 4, _BLOCKS))
        return np.linspace(0, self.t.size, count + 1).astype(int)

    @cached_property
    def time(self) -> si.SecondArray:
        return self._mean(self.t)

    def of(self, w: si.FloatArray) -> si.ComplexArray:
        return 2 * self._mean(w * np.exp(-2j * np.pi * self.f * self.t))

    def misfits(self, residual: si.FloatArray) -> bool:
        """True where a residual has a structure that noise has not."""
        return correlation_factor(self.of(residual)) > 1

    def _mean(self, values: si.Array) -> si.Array:
        sums = np.add.reduceat(values, self.edges[:-1])
        return np.asarray(sums / np.diff(self.edges))


def _with_second(decay: _Decay, fit: SeparableFit) -> SeparableFit:
    """The fit with a decay more, which starts at the strongest line of what is left."""
    f = _strongest_line(decay.t, fit.residual)
    start = np.concatenate([fit.shape, [f, fit.shape[1]]])
    reach = np.tile(decay.reach, 2)
    pair = fit_separable(decay.columns, decay.w, start, reach=reach)
    swing = np.hypot(pair.weights[0:4:2], pair.weights[1:4:2])
    if swing[1] > swing[0]:
        # The stronger first.
        order = np.array([2, 3, 0, 1])
        pair = fit_separable(decay.columns, decay.w, pair.shape[order], reach=reach)
    return pair


@dataclass(frozen=True, eq=False)
class _Bent:
    """The decay with losses and frequency that depend on the amplitude.

    Numbers: f0, rate, amplitude, phase, r (in sizes), s (in sizes squared), constant, slope.
    """

    fit: NonlinearFit
    model: si.FloatArray
    chance: float

    @classmethod
    def of(cls, decay: _Decay, straight: SeparableFit) -> _Bent:
        cosine, sine = straight.weights[:2]
        swing, phase = float(np.hypot(cosine, sine)), float(np.arctan2(-sine, cosine))
        start = np.array([*straight.shape, swing, phase, 0.0, 0.0, *straight.weights[2:]])
        steps = np.array([1e-8 * start[0], 1e-5 * start[1], *np.full(6, 1e-5)])
        fit = fit_nonlinear(lambda at: _bent_decay(decay.t, at) - decay.w, start, steps)
        from scipy.special import fdtrc

        squares, before = (float(row @ row) for row in (fit.residual, straight.residual))
        gain = max((before - squares) / 2 / (squares / fit.freedom), 0.0)
        widening = correlation_factor(_Blocks(decay.t, float(fit.numbers[0])).of(fit.residual))
        model = decay.w + fit.residual
        return cls(fit.with_widening(widening), model, float(fdtrc(2, fit.freedom, gain)))

    def estimate(self, i: int, unit: str, factor: float) -> Estimate:
        return self.fit.estimate(lambda at: factor * float(at[i]), unit)


def _bent_decay(t: si.SecondArray, numbers: si.FloatArray) -> si.FloatArray:
    """a = A e^{−ct}/(1 + rA(1 − e^{−ct})), and the phase that f0(1 + s a²) makes of it.

    ∫a² dt = [a/r − ln(1 + ra)/r²]/c from a to A, by its series where r a is small.
    """
    f, rate, swing, phase, r, s, constant, slope = numbers
    fall = np.exp(-rate * t)
    a = swing * fall / (1 + r * swing * (1 - fall))

    def primitive(a: si.FloatLike) -> si.FloatLike:
        if abs(r) * swing < 1e-3:
            return np.asarray(np.asarray(a) ** 2 / 2 - r * np.asarray(a) ** 3 / 3)
        return np.asarray(np.asarray(a) / r - np.log1p(r * np.asarray(a)) / r**2)

    turned = 2 * np.pi * f * (t + s * (primitive(swing) - primitive(a)) / rate)
    return np.asarray(a * np.cos(turned + phase) + constant + slope * (t / t[-1] - 0.5))


def _told(
    recording: RingDown,
    decay: _Decay,
    blocks: _Blocks,
    fit: SeparableFit,
    bent: _Bent | None,
    *,
    two: bool,
) -> RingDownFit:
    """A fit in its own numbers, read off."""
    size, unit = decay.size, recording.unit
    numbers = _straight(decay, fit, 0, unit) if bent is None else _slight(decay, bent, unit)
    frequency, quality, amplitude = numbers
    model = fit.model if bent is None else bent.model
    residual = decay.w - model
    adequacy = adequacy_of(
        blocks.of(decay.w) * size,
        blocks.of(residual) * size,
        lambda i: f"{1e3 * blocks.time[i]:.3g} ms after the start",
        remedy="Cut off what came before the drive stopped, or drive less.",
        said="Damping or frequency depend on the amplitude; frequency and Q are those of the "
        "smallest amplitudes. "
        if bent is not None
        else "",
    )
    return RingDownFit(
        recording=recording,
        time=decay.t,
        model=model * size,
        residual=residual * size,
        frequency=frequency,
        quality_factor=quality,
        amplitude=amplitude,
        damping_rise=bent.estimate(4, f"1/{unit}", 1 / size) if bent is not None else None,
        frequency_rise=bent.estimate(5, f"1/{unit}2", size**-2) if bent is not None else None,
        second=_straight(decay, fit, 1, unit)[:2] if two else None,
        adequacy=adequacy,
    )


def _straight(
    decay: _Decay, fit: SeparableFit, k: int, unit: str
) -> tuple[Estimate, Estimate, Estimate]:
    """Frequency, Q and first amplitude of a decay that no amplitude changes."""
    loss = fit.estimate(lambda shape, _: shape[2 * k + 1] / (np.pi * shape[2 * k]), "1")
    return (
        fit.estimate(lambda shape, _: shape[2 * k], "Hz"),
        inverse_of(loss),
        fit.estimate(
            lambda _, weights: decay.size * float(np.hypot(*weights[2 * k : 2 * k + 2])),
            unit,
            positive=True,
        ),
    )


def _slight(decay: _Decay, bent: _Bent, unit: str) -> tuple[Estimate, Estimate, Estimate]:
    """Frequency, Q and first amplitude, the former two of slight amplitudes."""
    frequency = bent.estimate(0, "Hz", 1.0)
    loss = bent.estimate(1, "1", 1 / (np.pi * frequency.value))
    return frequency, inverse_of(loss), bent.estimate(2, unit, decay.size)
