"""What a vibrating body is to the amplifier: its admittance, and a circuit near one resonance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm import quantities as si


class DrivenResponse:
    """The response of a body to one volt (zero to peak) on its drive, at `frequencies` (Hz).

    `admittance` in siemens, time factor e^{iωt}; `maximum` is the largest amplitude per volt
    anywhere on the touched face (m/V). All have the shape (frequencies,).
    """

    frequencies: si.HertzArray
    admittance: si.ComplexArray

    @property
    def maximum(self) -> si.FloatArray:
        """The largest amplitude per volt (m/V) on the touched face, for every frequency."""
        raise NotImplementedError

    @property
    def resonance(self) -> int:
        """The number of the frequency with the largest amplitude."""
        return int(np.argmax(self.maximum))

    @property
    def impedance(self) -> si.ComplexArray:
        """Z = 1/Y (Ω)."""
        return 1 / self.admittance

    @si.checked_numbers
    def current(self, voltage: si.Volt) -> si.FloatArray:
        """The amplifier's current amplitude (A) at a voltage amplitude."""
        return np.abs(self.admittance) * voltage

    @si.checked_numbers
    def apparent_power(self, voltage: si.Volt) -> si.FloatArray:
        """Vrms · Irms (VA): what the amplifier must be able to give."""
        return self.current(voltage) * voltage / 2

    @si.checked_numbers
    def input_power(self, voltage: si.Volt) -> si.FloatArray:
        """Mean electrical power (W) taken at a voltage amplitude."""
        return self.admittance.real * voltage**2 / 2


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
