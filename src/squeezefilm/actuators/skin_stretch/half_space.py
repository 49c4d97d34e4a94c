"""An elastic half-space under a rectangle of even traction: Cerruti's and Boussinesq's solution.

A force Q along x at the origin moves the surface by u_x = Q/(2πG) [(1 − ν)/r + ν x²/r³] and
u_y = Q/(2πG) ν xy/r³; a force across it by u_z = Q (1 − ν)/(2πG r) (Johnson 1985, Contact
Mechanics, 10.1017/CBO9781139171731, eqs 3.19 and 3.75). Over a rectangle the three integrals are
elementary: ∬ 1/r = x ln(y + r) + y ln(x + r), ∬ x²/r³ = y ln(x + r), ∬ xy/r³ = −r, at the corners.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from squeezefilm.core import hard_limits as hard
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

Places = Annotated[
    si.MetreArray, si.AtLeast(-hard.STROKE_START.most), si.AtMost(hard.STROKE_START.most)
]
"""Places on a surface, at most 10 m from its middle."""


@si.checked_numbers
def together(x: Places, y: Places) -> tuple[si.MetreArray, si.MetreArray]:
    """x and y (m) in their common shape. Raises `InputError` where they have none."""
    try:
        a, b = np.broadcast_arrays(x, y)
    except ValueError as error:
        raise InputError(
            f"x and y have the shapes {np.shape(x)} and {np.shape(y)}, which do not go together; "
            "give places that broadcast"
        ) from error
    return a, b


def _log(along: si.FloatArray, across: si.FloatArray, r: si.FloatArray) -> si.FloatArray:
    """ln(along + r), without losing digits where along is near −r; 0 on the line across = 0 behind,
    where what multiplies it is 0 too."""
    square = across**2
    safe = np.where(along > 0, along + r, square / np.maximum(r - along, 1e-300))
    return np.asarray(np.log(np.where(safe > 0, safe, 1.0)))


def _corners(
    x: si.FloatArray, y: si.FloatArray, length: float, width: float
) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray]:
    """∬ 1/r, ∬ x²/r³ and ∬ xy/r³ over a rectangle about the origin, seen from x, y."""
    inverse, along, mixed = (np.zeros(np.broadcast(x, y).shape) for _ in range(3))
    for one, sign_x in ((x + length / 2, 1.0), (x - length / 2, -1.0)):
        for other, sign_y in ((y + width / 2, 1.0), (y - width / 2, -1.0)):
            r = np.hypot(one, other)
            first = other * _log(one, other, r)
            sign = sign_x * sign_y
            inverse += sign * (one * _log(other, one, r) + first)
            along += sign * first
            mixed -= sign * r
    return inverse, along, mixed


@si.checked_numbers
def tangential_patch(
    x: Places,
    y: Places,
    length: Annotated[si.Metre, hard.SIDE],
    width: Annotated[si.Metre, hard.SIDE],
    poisson_ratio: Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(0.5)],
) -> tuple[si.MetreArray, si.MetreArray]:
    """u_x and u_y at places of the surface (m), times the shear modulus and per traction along x
    (so in metres), of a rectangle `length` × `width` about the origin.

    `x` and `y` broadcast. Finite everywhere; the strain is not, at the edges across x. Raises
    `InputError` for sizes not above 0 or a Poisson ratio outside 0 to 0.5.
    """
    inverse, along, mixed = _corners(*together(x, y), length, width)
    scale = 1 / (2 * math.pi)
    return (
        scale * ((1 - poisson_ratio) * inverse + poisson_ratio * along),
        scale * poisson_ratio * mixed,
    )


@si.checked_numbers
def normal_patch(
    x: Places,
    y: Places,
    length: Annotated[si.Metre, hard.SIDE],
    width: Annotated[si.Metre, hard.SIDE],
    poisson_ratio: Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(0.5)],
) -> si.MetreArray:
    """u_z at places of the surface, times the shear modulus and per pressure (so in metres), of a
    rectangle about the origin. As `tangential_patch`."""
    return (1 - poisson_ratio) / (2 * math.pi) * _corners(*together(x, y), length, width)[0]
