"""Laws of friction over amplitude and speed as tables that are read backwards."""

from __future__ import annotations

import numpy as np

from squeezefilm.physics.render.program.inverse import (
    FrictionInverse,
    FrictionTable,
    LawOverSpeeds,
)


def inverse_over_speeds(
    law: LawOverSpeeds, amplitude: np.ndarray, speed: np.ndarray, nominal_speed: float
) -> FrictionInverse:
    """The inverse of a law by its table at amplitudes (m) and speeds (m/s)."""
    table = FrictionTable(amplitude, speed, law(amplitude, speed), nominal_speed)
    return table.inverse(law, float(amplitude[-1]))
