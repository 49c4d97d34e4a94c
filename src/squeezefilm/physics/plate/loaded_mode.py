"""A mode that is changed: detuned and damped by what lies on the surface, or by its amplitude."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import OutOfRangeError

# From this change of the frequency on the first harmonic is no longer most of the motion.
_MOST = 0.05


@si.checked_numbers
@dataclass(frozen=True)
class LoadedMode:
    """A mode with a load on it: its new resonance and quality factor.

    `load_ratio` δ is the load's modal stiffness over the mode's own, complex.
    """

    free_frequency: si.Hertz
    free_quality_factor: si.Dimensionless
    load_ratio: complex

    @property
    def resonance_frequency(self) -> si.Hertz:
        """f0 √(1 + Re δ) (Hz)."""
        return float(self.free_frequency * np.sqrt(1 + self.load_ratio.real))

    @property
    def quality_factor(self) -> si.Dimensionless:
        """(1 + Re δ)/(1/Q + Im δ)."""
        loss = 1 / self.free_quality_factor + self.load_ratio.imag
        return float((1 + self.load_ratio.real) / loss)

    @si.checked_numbers
    def amplitude_ratio(self, frequency: Annotated[si.Hertz, si.Above(0.0)]) -> si.Dimensionless:
        """The amplitude at a frequency (Hz), over that of the free mode at its resonance.

        1/(Q |1 + i/Q + δ − (f/f0)²|): of this mode alone. Raises `InputError` unless f > 0.
        """
        Q, x = self.free_quality_factor, frequency / self.free_frequency
        return float(1 / abs(Q * (1 + self.load_ratio - x**2) + 1j))

    @si.checked_numbers
    def power(
        self,
        modal_mass: Annotated[si.Kilogram, si.Above(0.0)],
        frequency: Annotated[si.Hertz, si.Above(0.0)],
        amplitude: Annotated[si.Metre, si.AtLeast(0.0)],
    ) -> si.Watt:
        """Power that mode and load lose (W, period's mean) at an amplitude (m) and frequency (Hz).

        ½ ω M ω0² (1/Q + Im δ) A², the loss of a stiffness M ω0² with structural damping. At the
        resonance it goes with the amplitude times the force that drives it: with a load that takes
        half of the amplitude, half of the power is drawn.
        """
        own, omega = 2 * np.pi * self.free_frequency, 2 * np.pi * frequency
        loss = 1 / self.free_quality_factor + self.load_ratio.imag
        return float(0.5 * omega * modal_mass * own**2 * loss * amplitude**2)


@si.checked_numbers
def mean_square_wave(
    half_wavelength: Annotated[si.Metre, si.Above(0.0)],
    contact_length: Annotated[si.Metre, si.Above(0.0)],
    position: si.Metre = 0.0,
) -> si.Dimensionless:
    """⟨cos²(πx/half_wavelength)⟩ over a contact centred `position` (m) from an antinode."""
    k = 2 * np.pi / half_wavelength
    reach = k * contact_length / 2
    return float((1 + np.cos(k * position) * np.sin(reach) / reach) / 2)


@si.checked_numbers
def loaded_mode(
    frequency: Annotated[si.Hertz, si.Above(0.0)],
    quality_factor: Annotated[si.Dimensionless, si.Above(0.0)],
    modal_mass: Annotated[si.Kilogram, si.Above(0.0)],
    stiffness_per_area: complex,
    area: Annotated[si.SquareMetre, si.Above(0.0)],
    mean_square: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1e4)],
) -> LoadedMode:
    """A mode of `frequency` (Hz) and Q that moves `modal_mass` (kg, for unit amplitude at an
    antinode), with a load of complex `stiffness_per_area` (Pa/m) on `area` (m²), over which the
    square of the mode's shape has the mean `mean_square`: above 1 where free ends, or neighbours
    of a mode that is hardly driven, move more than its antinode.

    First order in the load. On the paper's plate a damper's effect at the finger agrees with the
    whole solved plate to a sixth, a spring's or mass's to two fifths: they also mix modes nearby.
    Raises `InputError` for a frequency, Q, mass or area that is not above 0, or a load with gain
    (negative loss).
    """
    si.require("the load's loss", stiffness_per_area.imag, si.Unit("Pa/m"), at_least=0)
    own = modal_mass * (2 * np.pi * frequency) ** 2
    return LoadedMode(frequency, quality_factor, stiffness_per_area * area * mean_square / own)


@si.checked_numbers
@dataclass(frozen=True)
class FreePlate:
    """A plate's nonlinearity without a slider, by the amplitude a (m, zero-to-peak at the lobe).

    Its resonance is f0 (1 + `by_amplitude` a + `by_square` a²), its losses rise with
    `loss_rise`: 1/Q = (1/Q0)(1 + loss_rise a). Negative where the plate softens; a cubic spring
    bends by the square, ceramics mostly in proportion. Measured by sweeps at several voltages: see
    `measure.fits.vibration.voltage_sweeps.VoltageSweepsFit.free_plate`.
    """

    by_amplitude: Annotated[si.PerMetre, si.AtLeast(-1e6), si.AtMost(1e6)] = 0.0
    by_square: Annotated[float, si.Unit("1/m2"), si.AtLeast(-1e12), si.AtMost(1e12)] = 0.0
    loss_rise: Annotated[si.PerMetre, si.AtLeast(0.0), si.AtMost(1e8)] = 0.0

    @si.checked_numbers
    def terms(
        self, amplitude: Annotated[si.Metre, si.AtLeast(0.0)]
    ) -> tuple[si.PerMetre, float, si.PerMetre]:
        """`bend` (1/m), `cube` (1/m²) and `rise` (1/m) of the spring k (1 + bend |q| + cube q²) and
        the damping that have this backbone, for use up to `amplitude` (m).

        By harmonic balance: |q| q has the first harmonic 8/(3π) a², q³ has 3/4 a³ (Nayfeh and Mook,
        Nonlinear Oscillations, section 2.3), to first order in the change of the frequency. Raises
        `OutOfRangeError` for an amplitude that changes it by more than 5 %.
        """
        change = self.by_amplitude * amplitude + self.by_square * amplitude**2
        if abs(change) > _MOST:
            raise OutOfRangeError(
                f"an amplitude of {si.format_quantity(amplitude, si.Unit('m'))} would change the "
                f"free plate's resonance by {100 * change:.2g} %; the law holds to "
                f"{100 * _MOST:.0f} %: drive it less, or check the units of [motor.free_plate]",
                quantity="free_plate",
            )
        return self.by_amplitude * 3 * pi / 4, self.by_square * 8 / 3, self.loss_rise
