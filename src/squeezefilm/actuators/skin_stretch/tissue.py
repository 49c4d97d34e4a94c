"""The soft tissue of a fingertip under an array: its constants, and how its surface answers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.actuators.skin_stretch.elastic_layer import (
    Places,
    half_space_motion,
    layer_correction,
)
from squeezefilm.core import hard_limits as hard
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.contact.finger.fingertip import FingerpadDynamics

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
    poisson_ratio: Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(0.5)] = 0.48
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
