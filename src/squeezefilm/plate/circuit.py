"""The equivalent circuit of a vibrating body near one resonance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm.quantities import (
    ComplexArray,
    Dimensionless,
    Farad,
    Henry,
    Hertz,
    HertzArray,
    Ohm,
    checked_numbers,
)


@checked_numbers
@dataclass(frozen=True)
class EquivalentCircuit:
    """Butterworth–Van Dyke: C0 parallel to a series of R1, L1 and C1, near one resonance."""

    frequency: Hertz
    quality_factor: Dimensionless
    static_capacitance: Farad
    motional_resistance: Ohm
    motional_inductance: Henry
    motional_capacitance: Farad

    @checked_numbers
    def admittance(self, frequency: HertzArray) -> ComplexArray:
        """Y (S) of the circuit at frequencies (Hz)."""
        omega = 2 * np.pi * np.asarray(frequency, dtype=float)
        series = (
            self.motional_resistance
            + 1j * omega * self.motional_inductance
            + 1 / (1j * omega * self.motional_capacitance)
        )
        return np.asarray(1j * omega * self.static_capacitance + 1 / series)
