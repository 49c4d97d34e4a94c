"""Change of a freely vibrating plate's resonance and losses with its amplitude."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Annotated

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import OutOfRangeError

# From this change of the frequency on the first harmonic is no longer most of the motion.
_MOST = 0.05


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
