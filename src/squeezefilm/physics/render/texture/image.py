"""Patterns between values on a lattice: a picture, a scan, a map with a scale, and seeded noise."""

from __future__ import annotations

from dataclasses import field
from typing import Annotated, Any, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import PIXELS, TEXTURE_LENGTH
from squeezefilm.physics.render.opcodes import (
    ADD,
    IMAGE,
    MASK,
    NOISE,
    NOISE_FIELD,
    WEIGH,
    Assembler,
    mixed,
)
from squeezefilm.physics.render.texture.pattern import (
    X_AXIS,
    Coordinate,
    Pattern,
    Place,
    part,
)

LARGEST_PIXEL: si.Metre = 0.1
MOST_PIXELS = int(PIXELS.most)
"""Pixels one image may have."""

OUTSIDE = ("hold", "repeat", "zero")
"""Ways of an image beyond its frame, in the order of the opcode's operand."""


Share = Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)]
"""A pixel's value, in annotations: from 0 to 1."""


@part
class Image(Pattern):
    """Values from 0 to 1 on a grid of square pixels, bilinear between their centres.

    The first row lies at the greatest y, as a picture is seen. The frame's lower left corner is
    at (`left`, `bottom`); it is columns × `pixel` wide and rows × `pixel` high.

    Args:
        values: rows of values (1), each from 0 to 1; all rows of one length.
        pixel: side of a pixel (m): there is no image without a scale. From 1 µm to 0.1 m.
        left, bottom: the frame's corner (m), within ±10 m.
        outside: "hold" goes on with the nearest edge, "repeat" tiles the plane, "zero" is 0.

    Raises:
        InputError: a value outside its range, rows of different lengths, or more than 1 048 576
            pixels.
    """

    values: tuple[tuple[Share, ...], ...]
    pixel: Annotated[si.Metre, si.AtLeast(1e-06), si.AtMost(LARGEST_PIXEL)]
    left: Place = 0.0
    bottom: Place = 0.0
    outside: Literal["hold", "repeat", "zero"] = "hold"
    _grid: si.FloatArray = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        grid = np.array(self.values, dtype=float)
        if not grid.size:
            raise InputError("an image needs at least one value", quantity="values")
        _require_pixels(grid.size)
        grid.setflags(write=False)
        object.__setattr__(self, "_grid", grid)

    @classmethod
    @reads_text
    def from_array(
        cls,
        values: si.DimensionlessArray,
        pixel: si.Metre,
        *,
        left: si.Metre = 0.0,
        bottom: si.Metre = 0.0,
        outside: Literal["hold", "repeat", "zero"] = "hold",
    ) -> Image:
        """The image of an array of floats (rows, columns) from 0 to 1.

        Raises:
            InputError: an array that is not of floats (8-bit grey must be divided by 255), has
                not two axes, or cannot be an image.
        """
        si.require("values", values)
        array: Any = np.asarray(values)
        if array.ndim != 2 or not np.issubdtype(array.dtype, np.floating):
            raise InputError(
                f"values of shape {array.shape} and type {array.dtype} are no image; give floats "
                "from 0 to 1 of shape (rows, columns), 8-bit grey divided by 255",
                quantity="values",
            )
        _require_pixels(array.size)
        return cls(tuple(tuple(row) for row in array.tolist()), pixel, left, bottom, outside)

    def _lower(self, assembler: Assembler) -> None:
        rows, columns = self._grid.shape
        table = assembler.table(self._grid)
        outside = OUTSIDE.index(self.outside)
        assembler.emit(IMAGE, table, rows, columns, self.left, self.bottom, self.pixel, outside)


def _require_pixels(count: int) -> None:
    if count > MOST_PIXELS:
        raise InputError(
            f"an image of {count} pixels cannot be used: it may have at most {MOST_PIXELS}; make "
            "its pixels larger",
            quantity="values",
        )


# Each whole number i has a value between 0 and 1, made from i and a seed by 32-bit integer
# arithmetic alone: the numbers are the same in compiled code, in a browser and in C. Between them
# runs the cubic B-spline of these values, with the lattice spacing h. Its power spectrum is a
# constant times sinc⁸(fh): 99.99 % of the power lies at periods longer than h. The spline keeps the
# noise between 0 and 1 with no clipping, mean ½; its standard deviation is 0.20 along one
# coordinate and 0.14 in the plane.
#
# The mixing function is "lowbias32" (C. Wellons, Hash Prospector, public domain).
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

    def _lower_octave(self, assembler: Assembler, period: si.Metre, state: int) -> None:
        self.along._lower(assembler)
        assembler.emit(NOISE, period, state)


@part
class NoiseField(_Added):
    """Seeded noise in the plane, with nothing finer than `finest_period` along x or y.

    Args and errors as for `Noise`.
    """

    def _lower_octave(self, assembler: Assembler, period: si.Metre, state: int) -> None:
        assembler.emit(NOISE_FIELD, period, state)
