"""Demands on a sweep of impedance that is to be fitted, and what is read off it without a model."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.recordings.kinds import ImpedanceSweep

_FEWEST_POINTS = 16


@dataclass(frozen=True)
class SweepPeaks:
    """Peaks that can be read off a sweep without any model: the largest conductance (S) and the
    largest resistance (Ω), the real parts of Y and of 1/Y, and the frequencies (Hz) of both."""

    conductance_frequency: si.Hertz
    conductance: si.Siemens
    resistance_frequency: si.Hertz
    resistance: si.Ohm


def require_passive(sweep: ImpedanceSweep) -> None:
    """Refuse what is no sweep of a passive, capacitive body. Raises `InputError`.

    Off resonance, here the tenth of the points at either end, a body is a capacitor: its
    admittance leads by nearly 90°. Resonances and noise leave a real part that is positive on
    average. A sweep without a recorded phase has nothing of this to look at.
    """
    y, f = sweep.admittance, sweep.frequency
    if y.ndim != 1 or f.shape != y.shape or y.size < _FEWEST_POINTS:
        raise InputError(
            f"the sweep has {y.size} points; a fit needs at least {_FEWEST_POINTS}, on both sides "
            "of a resonance",
            quantity="admittance",
        )
    if not (np.all(np.isfinite(y)) and np.all(np.isfinite(f)) and np.all(y != 0)):
        raise InputError(
            "the sweep has points that are not finite or have no admittance at all; leave them "
            "out, missing points do no harm",
            quantity="admittance",
        )
    if f[0] <= 0 or np.any(np.diff(f) <= 0):
        raise InputError(
            "the frequencies do not rise; sort the points and join those at one frequency",
            quantity="frequency",
        )
    if not sweep.phase_recorded:
        return
    unit = y / np.abs(y)
    rim = max(2, y.size // 10)
    ends = np.concatenate([unit[:rim], unit[-rim:]])
    lead = math.degrees(math.atan2(float(np.median(ends.imag)), float(np.median(ends.real))))
    if float(np.mean(unit.real)) < 0:
        raise InputError(
            f"the sweep gives out power: the real part of its admittance is negative at "
            f"{int(np.sum(y.real < 0))} of {y.size} points, and away from resonance the admittance "
            f"leads by {lead:.0f}° where a capacitor's leads by up to 90°. The phase was probably "
            "recorded with an offset of 180°; look at it, and if so write correct = "
            '"phase 180 deg" in the TOML beside the recording',
            quantity="admittance",
        )
    if lead < 0:
        raise InputError(
            f"away from resonance the admittance leads by {lead:.0f}°, as that of a coil; a "
            "ceramic is a capacitor there and leads by up to 90°. The phase was probably recorded "
            "with the wrong sign, or as that of the admittance; look at it, and if so write "
            'correct = "phase sign" in the TOML beside the recording',
            quantity="admittance",
        )


def sweep_peaks(sweep: ImpedanceSweep) -> SweepPeaks:
    """The largest conductance and resistance, by a parabola through the three highest points of
    the inverse of each, which is one near a resonance. Noise makes them too large by some of it.
    Raises `InputError` as `fit_impedance` does.
    """
    require_passive(sweep)
    at_series = _peak(sweep.frequency, sweep.admittance.real)
    at_parallel = _peak(sweep.frequency, (1 / sweep.admittance).real)
    return SweepPeaks(*at_series, *at_parallel)


def _peak(frequency: si.HertzArray, values: si.FloatArray) -> tuple[float, float]:
    top = int(np.argmax(values))
    near = slice(max(top - 1, 0), top + 2)
    if values[near].size < 3 or np.any(values[near] <= 0):
        return float(frequency[top]), float(values[top])
    x = frequency[near] - frequency[top]
    a, b, c = np.polyfit(x, 1 / values[near], 2)
    if a <= 0 or not x[0] <= -b / (2 * a) <= x[-1]:
        return float(frequency[top]), float(values[top])
    return float(frequency[top] - b / (2 * a)), float(1 / (c - b**2 / (4 * a)))
