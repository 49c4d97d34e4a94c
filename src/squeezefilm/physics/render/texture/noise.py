"""Seeded spatial noise, the same on every machine: spline noise over hashed lattice points.

Each whole number i has a value between 0 and 1, made from i and a seed by 32-bit integer
arithmetic alone: the numbers are the same in NumPy, in compiled code, in a browser and in C.
Between them runs the cubic B-spline of these values, with the lattice spacing h. Its power
spectrum is a constant times sinc⁸(fh): 99.99 % of the power lies at periods longer than h. The
spline keeps the noise between 0 and 1 with no clipping, mean ½; its standard deviation is 0.20
along one coordinate and 0.14 in the plane.

The mixing function is "lowbias32" (C. Wellons, Hash Prospector, public domain).
"""

from __future__ import annotations

from dataclasses import field
from typing import Annotated, Any, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.hard_limits import TEXTURE_LENGTH
from squeezefilm.physics.render.opcodes import ADD, NOISE, NOISE_FIELD, WEIGH, Assembler
from squeezefilm.physics.render.texture.coordinate import (
    X_AXIS,
    Coordinate,
    FingerSamples,
    require_coordinate,
)
from squeezefilm.physics.render.texture.pattern import Pattern, part

STEP_ALONG = 0x9E3779B1
STEP_ACROSS = 0x85EBCA77
"""Odd numbers that spread neighbouring lattice points over 32 bits."""

_MASK = 0xFFFFFFFF
# So that lattice numbers stay far within 32 bits over ten metres.
Spacing = Annotated[si.Metre, si.AtLeast(1e-6), TEXTURE_LENGTH]
Seed = Annotated[int, si.AtLeast(0), si.AtMost(_MASK)]
Octaves = Annotated[int, si.AtLeast(1), si.AtMost(8)]
Persistence = Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)]


def mixed(value: Any) -> Any:
    """A 32-bit number, or an array of them as `uint64`, mixed into another: "lowbias32"."""
    value = value & _MASK
    value = value ^ (value >> 16)
    value = (value * 0x7FEB352D) & _MASK
    value = value ^ (value >> 15)
    value = (value * 0x846CA68B) & _MASK
    return value ^ (value >> 16)


def _hashed(numbers: si.FloatArray, state: Any, step: int) -> Any:
    cells = numbers.astype(np.int64).astype(np.uint64) & _MASK
    return mixed(state ^ ((cells * step) & _MASK))


def _weights(f: si.FloatArray) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray, si.FloatArray]:
    g = 1.0 - f
    return (
        g * g * g / 6.0,
        (4.0 + f * f * (3.0 * f - 6.0)) / 6.0,
        (4.0 + g * g * (3.0 * g - 6.0)) / 6.0,
        f * f * f / 6.0,
    )


@si.checked_numbers
def line_noise(u: si.FloatArray, state: int) -> si.FloatArray:
    """Noise at `u` lattice spacings from the origin, from a mixed seed; any shape."""
    cell = np.floor(u)
    start = np.full(u.shape, state, dtype=np.uint64)
    total = np.zeros(u.shape)
    for offset, weight in zip((-1, 0, 1, 2), _weights(u - cell), strict=True):
        total = total + weight * (_hashed(cell + offset, start, STEP_ALONG) / 2.0**32)
    return total


@si.checked_numbers
def field_noise(u: si.FloatArray, w: si.FloatArray, state: int) -> si.FloatArray:
    """Noise at (`u`, `w`) lattice spacings from the origin, from a mixed seed; any one shape."""
    column, row = np.floor(u), np.floor(w)
    start = np.full(u.shape, state, dtype=np.uint64)
    total = np.zeros(u.shape)
    for i, along in zip((-1, 0, 1, 2), _weights(u - column), strict=True):
        first = _hashed(column + i, start, STEP_ALONG)
        for j, across in zip((-1, 0, 1, 2), _weights(w - row), strict=True):
            value = _hashed(row + j, first, STEP_ACROSS) / 2.0**32
            total = total + along * across * value
    return total


class _Added(Pattern):
    """Noises that are added, each with twice the period of the one before."""

    __slots__ = ()
    finest_period: Spacing
    seed: Seed
    octaves: Octaves
    persistence: Persistence

    def _octave(self, finger: FingerSamples, period: si.Metre, state: int) -> si.FloatArray:
        raise NotImplementedError

    def _lower_octave(self, assembler: Assembler, period: si.Metre, state: int) -> None:
        raise NotImplementedError

    def _weighed(self) -> list[tuple[si.Metre, int, float]]:
        """Spacing, mixed seed and weight of every octave; the weights sum to 1."""
        count, seed, finest = self.octaves, self.seed, self.finest_period
        weights = [self.persistence ** (count - 1 - k) for k in range(count)]
        total = sum(weights)
        return [(finest * 2.0**k, mixed(seed + k), weights[k] / total) for k in range(count)]

    def _values(self, finger: FingerSamples) -> si.FloatArray:
        total = np.zeros(finger.x.shape)
        for period, state, weight in self._weighed():
            total = total + weight * self._octave(finger, period, state)
        # The weights sum to 1 but for rounding.
        return np.minimum(total, 1.0)

    def _lower(self, assembler: Assembler) -> None:
        for index, (period, state, weight) in enumerate(self._weighed()):
            self._lower_octave(assembler, period, state)
            assembler.emit(WEIGH, weight)
            if index:
                assembler.emit(ADD)


@part
class Noise(_Added):
    """Seeded noise along one coordinate, with nothing finer than `finest_period`.

    Args:
        finest_period: spacing of the lattice (m); from 1 µm to 0.5 m.
        seed: a whole number from 0 to 2³² − 1; the same seed is the same noise everywhere.
        octaves: how many noises are added, each with twice the period of the one before; 1 to 8.
        persistence: weight of an octave over that of the next coarser one; above 0, at most 1.
        along: the coordinate it runs along.

    Raises:
        InputError: a value outside its range.
    """

    finest_period: Spacing
    seed: Seed
    octaves: Octaves = 1
    persistence: Persistence = 0.5
    along: Coordinate = X_AXIS
    type: Literal["noise"] = field(default="noise", repr=False)

    def __post_init__(self) -> None:
        require_coordinate(self.along)

    def _octave(self, finger: FingerSamples, period: si.Metre, state: int) -> si.FloatArray:
        return line_noise(self.along.at(finger.x, finger.y) / period, state)

    def _lower_octave(self, assembler: Assembler, period: si.Metre, state: int) -> None:
        self.along._lower(assembler)
        assembler.emit(NOISE, period, state)


@part
class NoiseField(_Added):
    """Seeded noise in the plane, with nothing finer than `finest_period` along x or y.

    Args and errors as for `Noise`.
    """

    finest_period: Spacing
    seed: Seed
    octaves: Octaves = 1
    persistence: Persistence = 0.5
    type: Literal["noise_field"] = field(default="noise_field", repr=False)

    def _octave(self, finger: FingerSamples, period: si.Metre, state: int) -> si.FloatArray:
        return field_noise(finger.x / period, finger.y / period, state)

    def _lower_octave(self, assembler: Assembler, period: si.Metre, state: int) -> None:
        assembler.emit(NOISE_FIELD, period, state)
