"""A solved plate as a volume of hexahedra: points, cells, materials, and displacements on them.

The elements of high order are cut at their own Gauss–Lobatto nodes into hexahedra with eight
corners, mirrored to the whole plate where the solver used a half or a quarter of it. Displacements
are evaluated with the full order at these points.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.elements.lobatto import LineMesh
from squeezefilm.physics.plate.solid.modes import PlateModes
from squeezefilm.physics.plate.solid.reduced import class_slices
from squeezefilm.physics.plate.solid.response import HarmonicResponse
from squeezefilm.physics.plate.solid.symmetry import PlateModel

_CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)


@dataclass(frozen=True, eq=False)
class PlateVolume:
    """Hexahedra of a plate: `points` (points × 3, m; the plate's lower face at z = 0), `cells`
    (cells × 8 points, in VTK's order), `material` of each cell as a number into `materials`, and
    the axes and places that displacements are evaluated on."""

    points: si.FloatArray
    cells: si.IntArray
    material: si.IntArray
    materials: tuple[str, ...]
    axes: tuple[si.MetreArray, si.MetreArray, si.MetreArray]
    place: si.IntArray

    def displacement(
        self, solved: PlateModel, vector: si.FloatArray | si.ComplexArray
    ) -> si.FloatArray:
        """(u, v, w) of a solution vector at the points, shape (points, 3)."""
        x, y, z = self.axes
        columns: Any = vector[:, None]  # real or complex: the interpolation is real
        out = np.stack([solved.field(columns, x, y, float(h))[0] for h in z], axis=2)
        return np.asarray(out.reshape(-1, 3)[self.place])


def plate_volume(modes: PlateModes, mode: int) -> PlateVolume:
    """The volume of a solved plate, on the mesh that a mode was solved on."""
    solved, _ = modes._fields[mode]
    plate, model = modes.plate, solved.model
    medium = model.medium.transpose(1, 0, 2) if solved.swapped else model.medium
    lines = (model.y, model.x) if solved.swapped else (model.x, model.y)
    nodes, owners = [], []
    for axis, span in enumerate((plate.length, plate.width)):
        line = lines[axis]
        at, owner = line.nodes, _element_of(line)
        if solved.parity[axis] is not None:
            at = np.concatenate([at, span - at[-2::-1]])
            medium = np.concatenate([medium, np.flip(medium, axis)], axis)
            owner = np.concatenate([owner, 2 * line.elements - 1 - owner[::-1]])
        nodes.append(at)
        owners.append(owner)
    nodes.append(model.z.nodes)
    owners.append(_element_of(model.z))
    material = medium[np.ix_(*owners)]
    filled = np.stack(np.nonzero(material >= 0), axis=1)
    shape = tuple(n.size for n in nodes)
    corners = filled[:, None, :] + _CORNERS[None, :, :]
    corner_places = np.ravel_multi_index(tuple(np.moveaxis(corners, -1, 0)), shape)
    place, cells = np.unique(corner_places, return_inverse=True)
    index = np.unravel_index(place, shape)
    points = np.stack([n[i] for n, i in zip(nodes, index, strict=True)], axis=1)
    return PlateVolume(
        points,
        cells.reshape(-1, 8),
        material[tuple(filled.T)],
        tuple(m.name for m in model.media),
        (nodes[0], nodes[1], nodes[2]),
        place,
    )


def mode_motion(volume: PlateVolume, modes: PlateModes, mode: int) -> si.FloatArray:
    """Displacement (points × 3, 1/√kg) of a mode of unit modal mass."""
    return volume.displacement(*modes._fields[mode])


def harmonic_motion(volume: PlateVolume, response: HarmonicResponse, at: int) -> si.ComplexArray:
    """Complex displacement (points × 3, m/V) of the response per volt of the drive at frequency
    number `at`."""
    moved = np.zeros(volume.points.shape, dtype=complex)
    for part, own in zip(response._parts, class_slices(response._parts), strict=True):
        moved += volume.displacement(part.solved, part.basis @ response._coordinates[at, own])
    return moved


def _element_of(line: LineMesh) -> si.IntArray:
    """The element of each interval between two nodes of a line."""
    return np.repeat(np.arange(line.elements), line.orders)
