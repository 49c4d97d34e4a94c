"""A plate as the solver has it, in one class of symmetry: what fields are evaluated on."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.elements.box_model import BoxModel
from squeezefilm.physics.plate.elements.slabs import Slabs
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.symmetry import Symmetry


@dataclass(frozen=True, eq=False)
class PlateModel:
    """A plate, or the half or quarter of it that one class of symmetry needs, as a box model.

    `parity` is the class along x and y (None where that half is not used); `copies` how many
    times the model makes the plate; `swapped` whether the model's x is the plate's y;
    `electrode_of[i]` the model's electrode for patch i and `sign_of[i]` the sign of its potential
    relative to it; `share_of[i]` is how many times the model's part of that ceramic makes a whole
    one (0 where antisymmetry makes its charge vanish and allows it no potential).
    """

    plate: RectangularPlate
    model: BoxModel
    parity: Symmetry
    copies: int
    swapped: bool
    electrode_of: tuple[int, ...]
    sign_of: tuple[float, ...]
    share_of: tuple[float, ...]

    @functools.cached_property
    def slabs(self) -> Slabs:
        """The model discretised."""
        return Slabs(self.model)

    def field(
        self, vectors: si.FloatArray, x: si.FloatArray, y: si.FloatArray, z: float
    ) -> si.FloatArray:
        """Displacements at the grid of `x` and `y` (plate coordinates, m) at height `z` (m, the
        plate's lower face at 0): shape (vectors, x, y, 3)."""
        Ex, Ey, Ez, signs = self.evaluation(x, y, np.array([z]))
        out = np.empty((vectors.shape[1], len(x), len(y), 3), dtype=vectors.dtype)
        for column in range(vectors.shape[1]):
            grid = np.tensordot(self.slabs.grid(vectors[:, column]), Ez[0], axes=(2, 0))
            values = np.einsum("ai,bj,ijc->abc", Ex, Ey, grid, optimize=True)
            if self.swapped:
                values = values.transpose(1, 0, 2)[:, :, [1, 0, 2]]
            out[column] = values
        return out * signs

    def force(
        self, x: si.FloatArray, y: si.FloatArray, z: float, w: si.FloatArray
    ) -> si.FloatArray:
        """The load vector of forces `w` (N, along z, shape (x, y)) at the grid of points: the
        adjoint of `field`, projected on the class of symmetry; shape (unknowns,)."""
        Ex, Ey, Ez, signs = self.evaluation(x, y, np.array([z]))
        weighted = np.asarray(w, dtype=float) * signs[:, :, 2]
        if self.swapped:
            weighted = weighted.T
        plane = Ex.T @ weighted @ Ey
        parts = []
        for n, (component, iy, iz) in enumerate(self.slabs.parts):
            parts.append(np.where(component == 2, plane[n, iy] * Ez[0, iz], 0.0))
        out = np.concatenate(parts) / self.copies
        out[self.slabs.held] = 0
        return out

    def evaluation(
        self, x: si.FloatArray, y: si.FloatArray, z: si.FloatArray
    ) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray, si.FloatArray]:
        """The matrices that take a solution along the model's x, y and z to values at points of
        the plate (m), and the sign (x, y, 3) that each displacement has there against its image in
        the model; the potential has that of w."""
        folded, signs = [], []
        for axis, points in enumerate((np.asarray(x, dtype=float), np.asarray(y, dtype=float))):
            parity, span = self.parity[axis], self.plate.extent[axis]
            beyond = (points > span / 2) & (parity is not None)
            folded.append(np.where(beyond, span - points, points))
            normal, other = (-1.0, 1.0) if parity == "S" else (1.0, -1.0)
            sign = np.ones((points.size, 3))
            sign[beyond] = other
            sign[beyond, axis] = normal
            signs.append(sign)
        along, across = folded[::-1] if self.swapped else folded
        return (
            self.model.x.interpolation(along),
            self.model.y.interpolation(across, hierarchic=True),
            self.model.z.interpolation(z, hierarchic=True),
            signs[0][:, None, :] * signs[1][None, :, :],
        )
