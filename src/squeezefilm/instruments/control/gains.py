"""An identified plate: its resonance, loss, pickup and their delay; the settings of the loops that
follow from it, and the finger that they show on it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, get_type_hints

import numpy as np
from scipy.optimize import least_squares

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.instruments.control.plate_loop import LOCKED, ONE, SHARE, LoopGains, LoopState

_TURN = 1 << 32
_SWEEP_STEPS = 3  # of a half-bandwidth while the plate answers, in time constants
_FASTEST_SWEEP = 20e3  # Hz/s
_JITTER = 0.2  # of a half-bandwidth; noise moves the frequency by half of that at most
_MOST_LEFT = 0.1  # of a sweep's peak
_MOST_SOFT = 16.0  # V, what the step can square


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class IdentifiedPlate:
    """Properties of a free plate as a sweep shows them.

    Args:
        frequency: of its resonance (Hz).
        quality_factor: of that resonance.
        ratio: the pickup's amplitude over the drive's at resonance (V/V).
        phase: of the pickup against the drive at resonance (rad), by electronics and delay alone.
        delay: by which that phase falls with frequency (s): half a sample of a converter's hold
            is 1/(2 rate).

    Raises:
        InputError: a value outside its range.
    """

    frequency: Annotated[si.Hertz, si.Above(0.0)]
    quality_factor: Annotated[si.Dimensionless, si.AtLeast(5.0), si.AtMost(1e4)]
    ratio: Annotated[si.Dimensionless, si.AtLeast(4e-5), si.AtMost(4.0)]
    phase: si.Radian = 0.0
    delay: Annotated[si.Second, si.AtLeast(0.0), si.AtMost(1.95e-3)] = 0.0

    @property
    def time_constant(self) -> si.Second:
        """Q/(π f0), of the envelope (s)."""
        return self.quality_factor / (math.pi * self.frequency)

    @property
    def half_bandwidth(self) -> si.Hertz:
        """f0/(2 Q) (Hz)."""
        return self.frequency / (2 * self.quality_factor)


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class LoopAims:
    """Aims of the loops, and their limits.

    Args:
        lowest_frequency, highest_frequency: of the carrier (Hz); a search begins at the highest.
        highest_voltage: of the drive (V, zero-to-peak).
        search_voltage: of the drive while it searches (V).
        lowest_voltage: 0, or below it where the amplifier can turn the phase, to brake (V).
        interval: between two steps (s).
        tracking_bandwidth: ω/2π of the frequency's loop (Hz), see `tracking_bandwidth`.
        amplitude_time: time constant of the amplitude (s); 95 % of a step takes three of it.
        load_bandwidth: of what is believed of a finger's load (Hz).
        floor: amplitude of the pickup below which it tells nothing (V).
        noise: standard deviation of each quadrature of the pickup in a step (V). The bandwidths
            fall at small amplitudes, so that it moves the frequency by at most a tenth of the
            half-bandwidth.
        heaviest_load: the largest loss of a finger over the plate's own.

    Raises:
        InputError: a value outside its range, or limits in the wrong order.
    """

    lowest_frequency: Annotated[si.Hertz, si.Above(0.0), si.Below("highest_frequency")]
    highest_frequency: Annotated[si.Hertz, si.Above(0.0)]
    highest_voltage: Annotated[si.Volt, si.Above(0.0), si.AtMost(2000.0)]
    search_voltage: Annotated[si.Volt, si.Above(0.0), si.AtMost("highest_voltage")]
    lowest_voltage: Annotated[si.Volt, si.AtMost(0.0), si.AtLeast(-2000.0)] = 0.0
    interval: Annotated[si.Second, si.AtLeast(1e-5), si.AtMost(1e-3)] = 100e-6
    tracking_bandwidth: Annotated[si.Hertz, si.Above(0.0)] = 700.0
    amplitude_time: Annotated[si.Second, si.Above(0.0)] = 1.5e-3
    load_bandwidth: Annotated[si.Hertz, si.Above(0.0)] = 100.0
    floor: Annotated[si.Volt, si.AtLeast(1e-6), si.AtMost(10.0)] = 1e-3
    noise: Annotated[si.Volt, si.AtLeast(0.0), si.AtMost(1.0)] = 0.0
    heaviest_load: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(60.0)] = 15.0


@si.checked_numbers
def calibrated_phase(
    frequency: si.HertzArray, phase: Annotated[si.FloatArray, si.Unit("rad")]
) -> tuple[si.Hertz, si.Radian, si.Second, si.Radian]:
    """The chain's phase as a line: the mean frequency (Hz), the phase there (rad), the delay (s),
    and the largest departure of a point from that line (rad).

    `phase` (rad) is measured with the plate replaced by a resistor, or far from its modes, at each
    `frequency` (Hz); jumps of a turn are taken out. Raises `InputError` for fewer than three points
    or other shapes.
    """
    if frequency.ndim != 1 or frequency.shape != phase.shape or frequency.size < 3:
        raise InputError(
            f"a phase needs one value at each of at least three frequencies; the shapes are "
            f"{phase.shape} and {frequency.shape}",
            quantity="phase",
        )
    whole = np.unwrap(phase)
    middle = float(frequency.mean())
    slope, offset = np.polyfit(frequency - middle, whole, 1)
    rest = whole - offset - slope * (frequency - middle)
    return middle, float(offset), float(-slope / (2 * math.pi)), float(np.abs(rest).max())


@si.checked_numbers
def identified_plate(
    frequency: si.HertzArray, response: si.ComplexArray
) -> tuple[IdentifiedPlate, si.Dimensionless]:
    """Properties of a free plate by its sweep, and the noise of each quadrature of `response` (1).

    `response` is the pickup's complex amplitude over the drive's (V/V) at each `frequency` (Hz),
    both shape (n,), n ≥ 8: one resonance, K e^{i(φ − 2π τ (f − f0))}/(1 + i δ), by least squares,
    with δ in half-bandwidths. Raises `InputError` for other shapes, a resonance at the sweep's end,
    and a response that is no single resonance (more than a tenth of K is left, RMS).
    """
    size = np.abs(response)
    if frequency.ndim != 1 or frequency.shape != response.shape or frequency.size < 8:
        raise InputError(
            f"a sweep needs one response at each of at least eight frequencies; the shapes are "
            f"{response.shape} and {frequency.shape}",
            quantity="response",
        )
    order = np.argsort(frequency)
    f, h, top = frequency[order], response[order], int(np.argmax(size[order]))
    if top in (0, f.size - 1):
        raise InputError(
            f"the response is largest at the sweep's end, {f[top]:g} Hz; sweep over the resonance",
            quantity="frequency",
        )
    wide = f[np.abs(h) > abs(h[top]) / math.sqrt(2)]
    half = max(float(np.ptp(wide)), float(f[top + 1] - f[top - 1])) / 2
    middle, phase, delay, _ = calibrated_phase(f, np.angle(h * (1 + 1j * (f - f[top]) / half)))
    phase -= 2 * math.pi * delay * (f[top] - middle)

    def model(p: si.FloatArray) -> si.ComplexArray:
        off = (f - f[top]) / half - p[0]
        turned = np.exp(1j * (p[3] - p[4] * off))
        return np.asarray(p[2] * turned / (1 + 1j * off * np.exp(p[1])))

    def left(p: si.FloatArray) -> si.FloatArray:
        rest = (model(p) - h) / abs(h[top])
        return np.concatenate([rest.real, rest.imag])

    start = [0.0, 0.0, abs(h[top]), phase, 2 * math.pi * delay * half]
    fit = least_squares(left, start, x_scale=[1.0, 1.0, abs(h[top]), 1.0, 1.0])
    noise = math.sqrt(2 * fit.cost / (2 * f.size - 5))
    if noise > _MOST_LEFT:
        raise InputError(
            f"the response is no single resonance: {100 * noise:.0f} % of its peak is left, and "
            f"at most {100 * _MOST_LEFT:g} % may be; sweep nearer to it, or with more voltage",
            quantity="response",
        )
    resonance = float(f[top] + half * fit.x[0])
    plate = IdentifiedPlate(
        resonance,
        resonance / (2 * half * math.exp(-fit.x[1])),
        float(fit.x[2]),
        float(fit.x[3]),
        max(float(fit.x[4]) / (2 * math.pi * half), 0.0),
    )
    return plate, noise * float(abs(h[top]))


@si.checked_numbers
def loop_gains(plate: IdentifiedPlate, aims: LoopAims) -> LoopGains:
    """The loops' settings for a plate, rounded to the integers that they count in.

    The amplitude gets a pole e^{−interval/amplitude_time} by κ = (a − pole)/(1 − a); the frequency
    two equal poles. Raises `OutOfRangeError` where a loop would be faster than its steps, the
    resonance lies outside the allowed frequencies, or a device would refuse what comes of them.
    """
    step = aims.interval
    for name, pace in (
        ("tracking_bandwidth", aims.tracking_bandwidth),
        ("load_bandwidth", aims.load_bandwidth),
        ("1/(2π amplitude_time)", 1 / (2 * math.pi * aims.amplitude_time)),
    ):
        if pace * step > 0.1:
            raise OutOfRangeError(
                f"{name} = {pace:g} Hz is too fast for steps of {step:g} s; at most a tenth of "
                f"their rate, {0.1 / step:g} Hz, is held"
            )
    if not aims.lowest_frequency < plate.frequency < aims.highest_frequency:
        raise OutOfRangeError(
            f"the plate's resonance at {plate.frequency:g} Hz is outside the allowed "
            f"{aims.lowest_frequency:g} to {aims.highest_frequency:g} Hz; widen these"
        )
    keep = math.exp(-step / plate.time_constant)
    pole = math.exp(-step / aims.amplitude_time)
    track = 1 - math.exp(-2 * math.pi * aims.tracking_bandwidth * step)
    load = 1 - math.exp(-2 * math.pi * aims.load_bandwidth * step)
    sweep = min(plate.half_bandwidth / (_SWEEP_STEPS * plate.time_constant), _FASTEST_SWEEP)
    gains = LoopGains(
        keep=round(keep * SHARE),
        take=SHARE - round(keep * SHARE),
        turnover=round(ONE / (1 - keep)),
        ratio=round(plate.ratio * SHARE),
        inverse=round(ONE / plate.ratio),
        correction=round((keep - pole) / (1 - keep) * ONE),
        half_bandwidth=round(plate.half_bandwidth * 1e3),
        track_share=round(track * SHARE),
        rate_share=round(track**2 / 4 * SHARE),
        load_share=round(load * SHARE),
        lowest_frequency=round(aims.lowest_frequency * 1e3),
        highest_frequency=round(aims.highest_frequency * 1e3),
        sweep=max(1, round(sweep * step * 256e3)),
        turn=(round(plate.phase / (2 * math.pi) * _TURN) + _TURN // 2) % _TURN - _TURN // 2,
        reference=round(plate.frequency * 1e3),
        turn_per_mhz=-round(plate.delay * 1e-3 * 256 * _TURN),
        lowest_level=round(aims.lowest_voltage * 1e6),
        highest_level=round(aims.highest_voltage * 1e6),
        search_level=round(aims.search_voltage * 1e6),
        floor=round(max(aims.floor, 5 * aims.noise) * 1e6),
        soft=round(min(track * aims.noise / (_JITTER * (1 - keep)), _MOST_SOFT) * 1e6),
        heaviest=round(aims.heaviest_load * ONE),
        patience=50 + math.ceil(3 * plate.time_constant / step),
    )
    for name, value in gains._asdict().items():
        low, high = _BOUNDS[name]
        # A level below 0 is for amplifiers that turn the phase, which no device has.
        if name != "lowest_level" and not low <= value <= high:
            scale, unit, remedy = _MENDED.get(name, (1.0, "", "change plate or aims"))
            raise OutOfRangeError(
                f"{name} = {value / scale:g}{unit} is not what a device counts in its loops, which "
                f"is {low / scale:g} to {high / scale:g}{unit}; {remedy}"
            )
    return gains


_MENDED = {
    "half_bandwidth": (1e3, " Hz", "it is frequency/(2 quality_factor): take a plate that rings"),
    "highest_frequency": (1e3, " Hz", "lower it"),
    "search_level": (1e6, " V", "raise search_voltage"),
}
"""Gains that can leave their bounds: counts in a unit, the unit, what to do."""
_BOUNDS: dict[str, tuple[int, int]] = {
    name: hint.__metadata__[0]
    for name, hint in get_type_hints(LoopGains, include_extras=True).items()
}


def within_bounds(
    gains: LoopGains, lowest_frequency: int, highest_frequency: int, highest_level: int
) -> bool:
    """True where no step with these gains can overflow 64 bits, turns the phase, or leaves these
    frequencies (mHz) and this level (µV): what a device asks of gains that a host sends it.

    The twin of `sf_loop_allowed` in `firmware/squeezefilm_loops.c`.
    """
    pairs = zip(gains, _BOUNDS.values(), strict=True)
    return (
        all(low <= value <= high for value, (low, high) in pairs)
        and gains.keep + gains.take == SHARE
        and lowest_frequency <= gains.lowest_frequency <= gains.reference
        and gains.reference <= gains.highest_frequency <= highest_frequency
        and gains.search_level <= gains.highest_level <= highest_level
    )


@si.checked_numbers
def tracking_bandwidth(gains: LoopGains, interval: Annotated[si.Second, si.Above(0.0)]) -> si.Hertz:
    """ω/2π (Hz) of the frequency's loop, whose error follows a drift r (Hz/s) as 4 r/ω² s² e^…:
    at most 4 r/(e ω), and 0 once it is steady."""
    return -math.log(1 - gains.track_share / SHARE) / (2 * math.pi * interval)


@si.checked_numbers
def finger_impedance(
    state: LoopState,
    plate: IdentifiedPlate,
    modal_mass: Annotated[si.Kilogram, si.Above(0.0)],
    free_frequency: Annotated[si.Hertz, si.Above(0.0)],
) -> complex:
    """The mechanical impedance (N s/m) that a finger adds at an antinode, R + i X.

    The loss D that the loops see over the plate's own is R = D 2π f0 M/Q; the frequency that they
    follow has moved from `free_frequency` (Hz, the last one without a finger) by Δf, so that
    X = −4π M Δf: above 0 for a mass, which lowers it. `modal_mass` M (kg) is that of the mode for
    an antinode's amplitude.

    Valid for a load that is small beside the mode's stiffness, and as exact as Q, and as K, are
    known: an error of K is taken for loss. Raises `InputError` for loops that are not locked.
    """
    if state.mode != LOCKED:
        raise InputError(
            "the loops are not locked, so no finger can be seen; wait until they are",
            quantity="state",
        )
    own = 2 * math.pi * plate.frequency * modal_mass / plate.quality_factor
    moved = state.frequency / 256e3 - free_frequency
    return complex(own * state.load / (1 << 20), -4 * math.pi * modal_mass * moved)
