"""The steady vibration of a resonance whose frequency and loss depend on its amplitude.

Solved root by root and followed along a sweep as a plate follows it, with its jumps: written
apart from the fit that it is to test.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si

_GRID = 1500
_POLISHED = 5


class SofteningResonance(NamedTuple):
    """f = f0 (1 + `backbone` a²), 1/Q = (1/Q0)(1 + `damping_rise` a); `amplitude_per_volt` (m/V) is
    that of small voltages at f0."""

    frequency: si.Hertz
    quality_factor: si.Dimensionless
    amplitude_per_volt: si.MetrePerVolt
    backbone: float
    damping_rise: float

    def stiffness(self, frequency: si.Hertz, amplitude: si.FloatLike) -> si.Array:
        """(f(a)/f0)²(1 + i/Q(a)) − (f/f0)² at a frequency (Hz) and amplitudes (m)."""
        a = np.asarray(amplitude)
        lossy = 1 + 1j / self.quality_factor * (1 + self.damping_rise * a)
        found = (1 + self.backbone * a**2) ** 2 * lossy - (frequency / self.frequency) ** 2
        return np.asarray(found)

    def swept(self, frequency: si.HertzArray, voltage: si.Volt) -> si.ComplexArray:
        """Displacement (m, complex) at frequencies (Hz, in the order of the sweep) at a voltage.

        Of several amplitudes the one nearest to that before: a sweep stays on its branch until
        that ends, and then jumps.
        """
        force = self.amplitude_per_volt * voltage / self.quality_factor
        row = np.linspace(0.0, 1.3 * self.amplitude_per_volt * voltage, _GRID)
        found, before = np.empty(frequency.size, dtype=complex), 0.0
        for i, f in enumerate(frequency):
            off = row * np.abs(self.stiffness(f, row)) - force
            at = np.flatnonzero(np.signbit(off[1:]) != np.signbit(off[:-1]))
            roots = row[at] - off[at] * (row[at + 1] - row[at]) / (off[at + 1] - off[at])
            a, step = float(roots[np.argmin(np.abs(roots - before))]), 1e-6 * row[-1]
            for _ in range(_POLISHED):
                low, middle, high = (
                    b * float(np.abs(self.stiffness(f, b))) - force for b in (a - step, a, a + step)
                )
                a -= middle * 2 * step / (high - low)
            before = a
            found[i] = -1j * force / self.stiffness(f, a)
        return found

    def ringing(self, time: si.SecondArray, amplitude: si.Metre, phase: si.Radian) -> si.MetreArray:
        """Displacement (m) at rising times (s) after the drive stopped at an amplitude (m).

        da/dt = −(πf0/Q0) a (1 + r a), marched by Runge and Kutta's fourth order, the phase with it.
        """
        rate, omega = np.pi * self.frequency / self.quality_factor, 2 * np.pi * self.frequency

        def slopes(a: float) -> tuple[float, float]:
            return -rate * a * (1 + self.damping_rise * a), omega * (1 + self.backbone * a**2)

        a, turned, out = amplitude, phase, np.empty(time.size)
        before = float(time[0])
        for i, now in enumerate(time):
            h = float(now) - before
            k1, w1 = slopes(a)
            k2, w2 = slopes(a + h / 2 * k1)
            k3, w3 = slopes(a + h / 2 * k2)
            k4, w4 = slopes(a + h * k3)
            a += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
            turned += h / 6 * (w1 + 2 * w2 + 2 * w3 + w4)
            before = float(now)
            out[i] = a * np.cos(turned)
        return out
