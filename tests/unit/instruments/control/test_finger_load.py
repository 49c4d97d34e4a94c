"""A finger's impedance is found from voltage and pickup, over the measured range of fingers."""

import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.instruments.control.gains import finger_impedance, loop_gains
from squeezefilm.instruments.control.plate_loop import LOCKED, LoopState, first_state

from .simulated_plate import FREQUENCY, LOAD, held
from .test_plate_loop import AIMS, F0, identified, true

MASS = 8.5e-3
"""Modal mass (kg) of the plate on which 86 fingers were measured (Monnoyer et al. 2018)."""


@pytest.mark.parametrize(("resistance", "mass"), [(4.0, 0.03e-3), (16.0, 0.06e-3), (33.0, 0.12e-3)])
@pytest.mark.parametrize("quality", [50, 300])
def test_a_known_impedance_is_found(quality: int, resistance: float, mass: float) -> None:
    own = 2 * math.pi * F0 * MASS / quality
    blank = np.zeros(15_000)
    shift = -F0 * mass / (2 * MASS)
    gains = loop_gains(identified(quality), AIMS)
    rows = held(
        gains,
        true(quality, noise=20.0),
        blank + 10e6,
        blank + F0 + shift,
        blank + resistance / own,
    )
    ends = []
    for row in rows[-2000::100]:
        state = first_state(gains)._replace(
            mode=LOCKED,
            load=round(row[LOAD] * 2**20),
            frequency=round(row[FREQUENCY] * 256e3),
        )
        ends.append(finger_impedance(state, identified(quality), MASS, F0))
    seen = np.mean(ends)
    assert seen.real == pytest.approx(resistance, rel=0.02)
    assert seen.imag == pytest.approx(2 * math.pi * F0 * mass, rel=0.03)


def test_loops_that_are_not_locked_see_no_finger() -> None:
    state: LoopState = first_state(loop_gains(identified(100), AIMS))
    with pytest.raises(InputError, match="not locked"):
        finger_impedance(state, identified(100), MASS, F0)
