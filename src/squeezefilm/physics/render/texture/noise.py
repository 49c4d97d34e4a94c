"""Seeded spatial noise, the same on every machine: spline noise over hashed lattice points.

Each whole number i has a value between 0 and 1, made from i and a seed by 32-bit integer
arithmetic alone: the numbers are the same in compiled code, in a browser and in C.
Between them runs the cubic B-spline of these values, with the lattice spacing h. Its power
spectrum is a constant times sinc⁸(fh): 99.99 % of the power lies at periods longer than h. The
spline keeps the noise between 0 and 1 with no clipping, mean ½; its standard deviation is 0.20
along one coordinate and 0.14 in the plane.

The mixing function is "lowbias32" (C. Wellons, Hash Prospector, public domain).
"""

from __future__ import annotations

from dataclasses import field
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.hard_limits import TEXTURE_LENGTH
from squeezefilm.physics.render.opcodes import (
    ADD,
    MASK,
    NOISE,
    NOISE_FIELD,
    WEIGH,
    Assembler,
    mixed,
)
from squeezefilm.physics.render.texture.coordinate import X_AXIS, Coordinate, require_coordinate
from squeezefilm.physics.render.texture.pattern import Pattern, part


@part
class _Added(Pattern):
    """Noises that are added, each with twice the period of the one before."""

    # So that lattice numbers stay far within 32 bits over ten metres.
    finest_period: Annotated[si.Metre, si.AtLeast(1e-6), TEXTURE_LENGTH]
    seed: Annotated[int, si.AtLeast(0), si.AtMost(MASK)]
    octaves: Annotated[int, si.AtLeast(1), si.AtMost(8)] = 1
    persistence: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)] = 0.5

    def _lower_octave(self, assembler: Assembler, period: si.Metre, state: int) -> None:
        raise NotImplementedError

    def _lower(self, assembler: Assembler) -> None:
        weights = [self.persistence ** (self.octaves - 1 - k) for k in range(self.octaves)]
        total = sum(weights)
        for k, weight in enumerate(weights):
            self._lower_octave(assembler, self.finest_period * 2.0**k, mixed(self.seed + k))
            assembler.emit(WEIGH, weight / total)
            if k:
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

    along: Coordinate = X_AXIS
    type: Literal["noise"] = field(default="noise", repr=False)

    def __post_init__(self) -> None:
        require_coordinate(self.along)

    def _lower_octave(self, assembler: Assembler, period: si.Metre, state: int) -> None:
        self.along._lower(assembler)
        assembler.emit(NOISE, period, state)


@part
class NoiseField(_Added):
    """Seeded noise in the plane, with nothing finer than `finest_period` along x or y.

    Args and errors as for `Noise`.
    """

    type: Literal["noise_field"] = field(default="noise_field", repr=False)

    def _lower_octave(self, assembler: Assembler, period: si.Metre, state: int) -> None:
        assembler.emit(NOISE_FIELD, period, state)
