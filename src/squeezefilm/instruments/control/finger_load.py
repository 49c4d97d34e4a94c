"""The finger on the plate, seen by the plate itself: its impedance from voltage and pickup."""

from __future__ import annotations

import math
from typing import Annotated

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.instruments.control.gains import IdentifiedPlate
from squeezefilm.instruments.control.plate_loop import LOCKED, LoopState


@si.checked_numbers
def finger_impedance(
    state: LoopState,
    plate: IdentifiedPlate,
    modal_mass: Annotated[si.Kilogram, si.Above(0.0)],
    free_frequency: Annotated[si.Hertz, si.Above(0.0)],
) -> complex:
    """The mechanical impedance (N s/m) that a finger adds at an antinode, R + i X.

    The loss D that the loops see over the plate's own is R = D 2π f0 M/Q; the frequency that they
    follow has moved from `free_frequency` (Hz, the last one without a finger) by Δf, so that
    X = −4π M Δf: above 0 for a mass, which lowers it. `modal_mass` M (kg) is that of the mode for
    an antinode's amplitude.

    Valid for a load that is small beside the mode's stiffness, and as exact as Q, and as K, are
    known: an error of K is taken for loss. Raises `InputError` for loops that are not locked.
    """
    if state.mode != LOCKED:
        raise InputError(
            "the loops are not locked, so no finger can be seen; wait until they are",
            quantity="state",
        )
    own = 2 * math.pi * plate.frequency * modal_mass / plate.quality_factor
    moved = state.frequency / 256e3 - free_frequency
    return complex(own * state.load / (1 << 20), -4 * math.pi * modal_mass * moved)
