"""The equivalent circuit of a vibrating body near one resonance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm import quantities as si


@si.checked_numbers
@dataclass(frozen=True)
class EquivalentCircuit:
    """Butterworth–Van Dyke: C0 parallel to a series of R1, L1 and C1, near one resonance."""

    frequency: si.Hertz
    quality_factor: si.Dimensionless
    static_capacitance: si.Farad
    motional_resistance: si.Ohm
    motional_inductance: si.Henry
    motional_capacitance: si.Farad

    @si.checked_numbers
    def admittance(self, frequency: si.HertzArray) -> si.ComplexArray:
        """Y (S) of the circuit at frequencies (Hz)."""
        omega = 2 * np.pi * np.asarray(frequency, dtype=float)
        series = (
            self.motional_resistance
            + 1j * omega * self.motional_inductance
            + 1 / (1j * omega * self.motional_capacitance)
        )
        return np.asarray(1j * omega * self.static_capacitance + 1 / series)
