"""Cost of knowing only a place, as a device's tile or a file does: made for one speed.

The friction that an amplitude makes depends on how fast the finger slides, and only a loop that
knows the speed can follow it. This says what it costs not to.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from squeezefilm.core import quantities as si

_SPEED = si.Unit("m/s")


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class MadeForSpeed:
    """The finger's speed for which amplitudes over places were chosen, and the error at others.

    Attributes:
        speed: it (m/s), above 0.
        error_at_half, error_at_double: by how much relative friction is off where it is most (1,
            with its sign; 0 where friction does not depend on the speed), under a finger at half
            and at double that speed.
    """

    speed: Annotated[si.MetrePerSecond, si.Above(0.0)]
    error_at_half: si.Dimensionless
    error_at_double: si.Dimensionless

    @classmethod
    @si.checked_numbers
    def of(
        cls,
        law: Callable[[si.MetreArray, si.MetrePerSecondArray], si.DimensionlessArray],
        amplitude: si.MetreArray,
        speed: Annotated[si.MetrePerSecond, si.Above(0.0)],
    ) -> MadeForSpeed:
        """Cost by a law from vibration amplitudes (m) and speeds (m/s) to µ′/µ (1), each of shape
        (n,): of amplitudes over places (m) that were chosen for a speed (m/s, above 0).

        Raises `InputError` for a law that returns another shape.
        """
        a = np.asarray(amplitude, dtype=float)
        rows = [
            si.returned("law", law(a, np.full(a.shape, v)), a, "one value per amplitude")
            for v in (0.5 * speed, speed, 2.0 * speed)
        ]
        half, double = (_largest(row - rows[1]) for row in (rows[0], rows[2]))
        return cls(speed, half, double)

    def summary(self) -> dict[str, Any]:
        """The numbers, with units in their keys."""
        return {
            "made_for_speed_m_per_s": self.speed,
            "friction_error_at_half_speed": self.error_at_half,
            "friction_error_at_double_speed": self.error_at_double,
        }

    def sentence(self) -> str:
        """Sentence for people and for a file's description."""
        made = f"made for a finger at {si.format_quantity(self.speed, _SPEED)}"
        if self.error_at_half == 0.0 and self.error_at_double == 0.0:
            return f"{made}; by this model friction does not depend on the speed"
        return (
            f"{made}; at half that speed relative friction is off by up to "
            f"{self.error_at_half:+.2g}, at double by up to {self.error_at_double:+.2g}"
        )


def _largest(difference: si.FloatArray) -> float:
    return float(difference.flat[int(np.argmax(np.abs(difference)))])
