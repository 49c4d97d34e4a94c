"""A fingertip's soft tissue under an array: a layer on bone, or a half-space, and how it answers.

The half-space is Cerruti's and Boussinesq's solution. A force Q along x at the origin moves the
surface by u_x = Q/(2πG) [(1 − ν)/r + ν x²/r³] and u_y = Q/(2πG) ν xy/r³; a force across it by
u_z = Q (1 − ν)/(2πG r) (Johnson 1985, Contact Mechanics, 10.1017/CBO9781139171731, eqs 3.19 and
3.75). Over a rectangle the three integrals are elementary: ∬ 1/r = x ln(y + r) + y ln(x + r),
∬ x²/r³ = y ln(x + r), ∬ xy/r³ = −r, at the corners.

The layer: in the Fourier plane of the surface a traction of wave number k moves it along the wave
vector, across it in the plane, and up: three compliances in closed form. What they are more than
those of a half-space dies out as e^(−2kh), is smooth in place, and is brought back by Hankel
transforms of order 0 and 2. Source: plane strain of a layer bonded to a rigid base, for example
Johnson 1985, section 5.8; the tests derive it anew by integrating Navier's equations in depth.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import jv

from squeezefilm.core import hard_limits as hard
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.contact.finger.fingertip import FingerpadDynamics
from squeezefilm.physics.plate.elements.lobatto import gauss_points

Places = Annotated[
    si.MetreArray, si.AtLeast(-hard.STROKE_START.most), si.AtMost(hard.STROKE_START.most)
]
"""Places on a surface, at most 10 m from its middle."""
Ratio = Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(0.5)]


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
    for from_x, sign_x in ((x + length / 2, 1.0), (x - length / 2, -1.0)):
        for from_y, sign_y in ((y + width / 2, 1.0), (y - width / 2, -1.0)):
            r = np.hypot(from_x, from_y)
            first = from_y * _log(from_x, from_y, r)
            sign = sign_x * sign_y
            inverse += sign * (from_x * _log(from_y, from_x, r) + first)
            along += sign * first
            mixed -= sign * r
    return inverse, along, mixed


@si.checked_numbers
def half_space_motion(
    x: Places,
    y: Places,
    length: Annotated[si.Metre, hard.SIDE],
    width: Annotated[si.Metre, hard.SIDE],
    poisson_ratio: Ratio,
) -> tuple[si.MetreArray, si.MetreArray, si.MetreArray]:
    """u_x and u_y per traction along x, and u_z per pressure, at places of the surface (m), times
    the shear modulus (so in metres), of a rectangle `length` × `width` about the origin.

    `x` and `y` broadcast. Finite everywhere; the strain is not, at the edges across x. Raises
    `InputError` for sizes not above 0 or a Poisson ratio outside 0 to 0.5.
    """
    inverse, along, mixed = _corners(*together(x, y), length, width)
    scale = 1 / (2 * math.pi)
    sunk = scale * (1 - poisson_ratio) * inverse
    return sunk + scale * poisson_ratio * along, scale * poisson_ratio * mixed, sunk


_NODES, _REACH = 400, 18.0
"""Quadrature nodes in k h up to a reach where e^(−2kh) is 2e-16."""
_FARTHEST = 12.0
"""Distance over thickness up to which the tables go; beyond, the surface of a layer is at rest."""


@si.checked_numbers
def layer_compliances(
    depth: Annotated[si.DimensionlessArray, si.Above(0)], poisson_ratio: Ratio
) -> tuple[si.DimensionlessArray, si.DimensionlessArray, si.DimensionlessArray]:
    """G u/(q h) of a bonded layer for tractions of wave number k = `depth`/h: along the wave
    vector, across it, and normal to the surface.

    For the first two the surface is free of normal traction, for the third of shear. Raises
    `InputError` for a depth not above 0 or a Poisson ratio outside 0 to 0.5.
    """
    kappa = 3 - 4 * poisson_ratio
    # Numerator and denominator over cosh 2kh, so that nothing overflows.
    small = 1 / np.cosh(np.minimum(2 * depth, 700.0))
    below = 2 * kappa + (4 * depth**2 + 1 + kappa**2) * small
    grown = 2 * kappa * np.tanh(2 * depth)
    scale = (1 - poisson_ratio) / depth
    return (
        scale * (grown + 4 * depth * small) / below,
        np.tanh(depth) / depth,
        scale * (grown - 4 * depth * small) / below,
    )


@functools.lru_cache(maxsize=1)
def _waves() -> tuple[si.FloatArray, si.FloatArray, si.FloatArray, si.FloatArray, si.FloatArray]:
    """Depths k h and their weights, distances r/h, and J₀(k r) and J₂(k r), shape (r, k)."""
    points, weights = gauss_points(_NODES)
    k, w = _REACH * (points + 1) / 2, _REACH * weights / 2
    r = np.linspace(0.0, _FARTHEST, 601)
    return k, w, r, jv(0, np.outer(r, k)), jv(2, np.outer(r, k))


@functools.lru_cache(maxsize=16)
def _tables(poisson_ratio: float) -> tuple[CubicSpline, CubicSpline, CubicSpline]:
    """Corrections of a layer less a half-space, over r/h: the parts of G h u/Q that do not turn
    with direction, that go with cos 2θ, and the normal one."""
    k, w, r, J0, J2 = _waves()
    along, across, normal = layer_compliances(k, poisson_ratio)
    along, across = along - (1 - poisson_ratio) / k, across - 1 / k
    normal = normal - (1 - poisson_ratio) / k
    measure = w * k / (2 * np.pi)
    return (
        CubicSpline(r, J0 @ (measure * (along + across) / 2)),
        CubicSpline(r, -J2 @ (measure * (along - across) / 2)),
        CubicSpline(r, J0 @ (measure * normal)),
    )


def _tabled(table: CubicSpline, r: si.FloatArray, half_space: float) -> si.FloatArray:
    """A table's value, and beyond it what takes away the half-space's `half_space`/(2πr)."""
    near = table(np.minimum(r, _FARTHEST))
    return np.where(r <= _FARTHEST, near, -half_space / (2 * np.pi * np.maximum(r, _FARTHEST)))


@si.checked_numbers
def layer_correction(
    x: Places,
    y: Places,
    length: Annotated[si.Metre, hard.SIDE],
    width: Annotated[si.Metre, hard.SIDE],
    poisson_ratio: Ratio,
    thickness: Annotated[si.Metre, hard.SIDE],
) -> tuple[si.MetreArray, si.MetreArray, si.MetreArray]:
    """What bone at depth `thickness` (m) adds to `half_space_motion` (m; negative near).

    Beyond 12 thicknesses both together are nothing. For patches up to two thicknesses wide, and
    layers not thinner than that. Raises `InputError` for sizes not above 0.
    """
    x, y = together(x, y)
    steady, turning, normal = _tables(float(poisson_ratio))
    points, weights = gauss_points(4)
    total = np.zeros((3, *x.shape))
    for a, wa in zip(points * length / 2, weights, strict=True):
        for b, wb in zip(points * width / 2, weights, strict=True):
            dx, dy = x - a, y - b
            r2 = dx**2 + dy**2
            r = np.sqrt(r2) / thickness
            cos = np.divide(dx**2 - dy**2, r2, out=np.zeros_like(r2), where=r2 > 0)
            sin = np.divide(2 * dx * dy, r2, out=np.zeros_like(r2), where=r2 > 0)
            first = _tabled(steady, r, 1 - poisson_ratio / 2)
            second = _tabled(turning, r, poisson_ratio / 2)
            sunk = _tabled(normal, r, 1 - poisson_ratio)
            total += wa * wb * np.array([first + second * cos, second * sin, sunk])
    u, v, w = total * length * width / 4 / thickness
    return u, v, w


Sizes = Annotated[tuple[si.Metre, si.Metre], hard.SIDE]


@si.checked_numbers
@dataclass(frozen=True)
class Tissue:
    """An elastic layer of `thickness` on rigid bone (None: a half-space), linear, isotropic.

    All defaults are assumed: 4 mm of pulp to the bone, nearly incompressible, and a shear modulus
    at which one contactor of 1 × 1.6 mm alone meets the 500 N/m that follow from the source paper's
    figures (`load_line.IMPLIED_STIFFNESS`). That modulus stands for the whole sandwich of a stiff
    outer skin and soft pulp; a real one spreads a pull farther. `relaxation_time` is near the
    published 1.2 ms, c/k of `FingerpadDynamics`, so G(1 + iωτ): loss without relaxation.
    """

    shear_modulus: Annotated[si.Pascal, hard.MODULUS] = 125e3
    poisson_ratio: Ratio = 0.48
    thickness: Annotated[si.Metre, hard.LAYER] | None = 4e-3
    relaxation_time: Annotated[si.Second, si.AtLeast(0), si.AtMost(1e3)] = 1e-3

    @si.checked_numbers
    def shifts(
        self,
        x: Places,
        y: Places,
        length: Annotated[si.Metre, hard.SIDE],
        width: Annotated[si.Metre, hard.SIDE],
    ) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray]:
        """u_x and u_y of the surface at places (m) per newton along x, and u_z per newton across
        it, spread evenly over a rectangle about the origin (m/N). `x` and `y` broadcast."""
        moved = np.array(half_space_motion(x, y, length, width, self.poisson_ratio))
        if self.thickness is not None:
            bone = layer_correction(x, y, length, width, self.poisson_ratio, self.thickness)
            moved += np.array(bone)
        u, v, w = moved / (self.shear_modulus * length * width)
        return u, v, w

    @si.checked_numbers
    def contactor_stiffness(
        self,
        length: Annotated[si.Metre, hard.SIDE],
        width: Annotated[si.Metre, hard.SIDE],
    ) -> si.NewtonPerMetre:
        """Stiffness met by one contactor alone, pulling along its `length` (N/m): force over the
        mean displacement under it, for an even traction (a rigid one is some percent stiffer)."""
        at_rest = np.zeros(1)
        return float(1 / _means_under(self, at_rest, at_rest, (length, width))[0, 0])

    @si.checked_numbers
    def under_contactor(
        self,
        length: Annotated[si.Metre, hard.SIDE],
        width: Annotated[si.Metre, hard.SIDE],
    ) -> FingerpadDynamics:
        """The lumped skin under one contactor: its stiffness, and damping k τ. Its mass is taken as
        nothing: 1100 kg/m³ over a cube of the contactor's side weighs 2 mg, against some 50
        mg of a bending actuator."""
        stiffness = self.contactor_stiffness(length, width)
        return FingerpadDynamics(stiffness, stiffness * self.relaxation_time, hard.PAD_MASS.least)


def _rows(x: si.FloatArray, y: si.FloatArray) -> tuple[si.FloatArray, si.FloatArray]:
    si.require("x", x, si.Unit("m"), axes=1)
    si.require("y", y, si.Unit("m"), axes=1)
    if x.shape != y.shape or not x.size:
        raise InputError(
            f"x and y of contactors have the shapes {x.shape} and {y.shape}; give as many of one "
            "as of the other, at least one",
            quantity="x",
        )
    return x, y


def _means_under(tissue: Tissue, x: si.FloatArray, y: si.FloatArray, size: Sizes) -> si.FloatArray:
    """The means of `Tissue.shifts` over contactors at `x`, `y` from the one that is loaded."""
    points, weights = np.polynomial.legendre.leggauss(8)
    a, b = np.meshgrid(points * size[0] / 2, points * size[1] / 2, indexing="ij")
    moved = tissue.shifts(x[:, None] + a.ravel(), y[:, None] + b.ravel(), *size)
    return np.asarray(np.array(moved) @ np.outer(weights, weights).ravel() / 4)


@si.checked_numbers
def influence_matrix(
    tissue: Tissue, x: Places, y: Places, size: Sizes, normal: bool = False
) -> si.FloatArray:
    """Displacement of the skin under every contactor by a newton on each (m/N): shape (contactors,
    contactors), row by row what is moved.

    Contactors of `size` (along x, along y) at `x`, `y` (m) of the unrolled surface; forces and
    displacements along x, or across the surface if `normal`. Symmetric and positive definite.
    Even tractions, mean displacements. Raises `InputError` for places that are no rows of one
    length.
    """
    x, y = _rows(x, y)
    # Contactors at the same distance from each other answer alike: only distances are computed.
    apart = np.stack(
        [np.abs(np.subtract.outer(places, places)).ravel() for places in (x, y)], axis=1
    )
    unique, place = np.unique(np.round(apart, 12), axis=0, return_inverse=True)
    means = _means_under(tissue, unique[:, 0], unique[:, 1], size)[2 if normal else 0]
    return np.asarray(means[place.ravel()].reshape(x.size, x.size))


@si.checked_numbers
def strain_matrices(
    tissue: Tissue, x: Places, y: Places, size: Sizes, cell: Annotated[si.Metre, hard.SIDE]
) -> tuple[si.MetreArray, si.MetreArray, si.FloatArray]:
    """The edges along x and y (m) of square cells of the surface over and around contactors, and
    the mean strains in each per newton on each contactor: shape (3, cells x, cells y, contactors),
    ε_xx, ε_yy and γ_xy.

    Means over cells, made of displacements at their corners: these are finite where the strain at
    the edge of a contactor is not. Raises `InputError` for a cell so small that there are more than
    40 000, or places that are no rows of one length.
    """
    px, py = _rows(x, y)
    margins = [
        (np.ptp(places) + 2 * side) / cell for places, side in ((px, size[0]), (py, size[1]))
    ]
    si.require("number of cells", float(np.prod(np.ceil(margins))), at_most=40_000)
    edges = [
        (np.arange(int(np.ceil(n)) + 1) - np.ceil(n) / 2) * cell + (places.min() + places.max()) / 2
        for n, places in zip(margins, (px, py), strict=True)
    ]
    at_x, at_y = np.meshgrid(*edges, indexing="ij")
    u, v, _ = (
        np.stack(part, axis=-1)
        for part in zip(
            *(tissue.shifts(at_x - a, at_y - b, *size) for a, b in zip(px, py, strict=True)),
            strict=True,
        )
    )

    def slope(field: si.FloatArray, axis: int) -> si.FloatArray:
        steps = np.diff(field, axis=axis) / cell
        other = 1 - axis
        count = steps.shape[other]
        return np.asarray(
            (steps.take(range(count - 1), other) + steps.take(range(1, count), other)) / 2
        )

    strains = np.stack([slope(u, 0), slope(v, 1), slope(u, 1) + slope(v, 0)])
    return edges[0], edges[1], strains
