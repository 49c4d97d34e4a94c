"""The power that a driven plate loses, summed over what loses it: equal to the power it takes."""

from __future__ import annotations

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.solid.reduced import class_slices
from squeezefilm.physics.plate.solid.response import HarmonicResponse


def lost_power(response: HarmonicResponse, voltage: float) -> si.FloatArray:
    """Mean power (W) lost in materials, supports and shunts at a voltage (V), by frequency."""
    lost, parts = np.zeros(response.frequencies.size), response._parts
    omega = 2 * np.pi * response.frequencies
    for part, at, V in zip(parts, class_slices(parts), response._potentials, strict=True):
        q = response._coordinates[:, at]
        lost += omega / 2 * np.einsum("fi,ij,fj->f", q.conj(), part.loss, q).real
        for number, resistance, share in part.circuit:
            if np.isfinite(resistance):
                lost += part.solved.copies / share * np.abs(V[:, number]) ** 2 / (2 * resistance)
    return lost * voltage**2
