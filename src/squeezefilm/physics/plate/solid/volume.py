"""A solved plate as a volume of hexahedra: points, cells, materials, and fields on them.

The elements of high order are cut at their own Gauss–Lobatto nodes into hexahedra with eight
corners, mirrored to the whole plate where the solver used a half or a quarter of it. Fields are
evaluated with the full order at these points. Ceramics that touch each other keep points of their
own on the face between them, since the potential may jump there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.elements.box_model import POTENTIAL_UNIT
from squeezefilm.physics.plate.elements.cross_section import potential_base
from squeezefilm.physics.plate.elements.lobatto import LineMesh
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.modes import PlateModes
from squeezefilm.physics.plate.solid.reduced import class_slices, open_electrodes
from squeezefilm.physics.plate.solid.response import HarmonicResponse
from squeezefilm.physics.plate.solid.symmetry import PlateModel

_CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)


@dataclass(frozen=True, eq=False)
class PlateVolume:
    """Hexahedra of a plate: `points` (points × 3, m; the plate's lower face at z = 0), `cells`
    (cells × 8 points, in VTK's order), `material` of each cell as a number into `materials`, and
    the axes and places that fields are evaluated on (`patch` of a point: −1 where the potential
    is that of the ground)."""

    plate: RectangularPlate
    points: si.FloatArray
    cells: si.IntArray
    material: si.IntArray
    materials: tuple[str, ...]
    axes: tuple[si.MetreArray, si.MetreArray, si.MetreArray]
    place: si.IntArray
    patch: si.IntArray

    def displacement(
        self, solved: PlateModel, vector: si.FloatArray | si.ComplexArray
    ) -> si.FloatArray:
        """(u, v, w) of a solution vector at the points, shape (points, 3)."""
        x, y, z = self.axes
        columns: Any = vector[:, None]  # real or complex: the interpolation is real
        out = np.stack([solved.field(columns, x, y, float(h))[0] for h in z], axis=2)
        return np.asarray(out.reshape(-1, 3)[self.place])

    def potential(
        self,
        solved: PlateModel,
        vector: si.FloatArray | si.ComplexArray,
        electrodes: si.FloatArray | si.ComplexArray,
    ) -> si.FloatArray:
        """φ (V) at the points, for the potentials (V) of the model's electrodes."""
        coefficients = _potential_coefficients(solved, vector, electrodes)
        Ex, Ey, Ez, signs = solved.evaluation(*self.axes)
        out = np.zeros(self.place.size, dtype=coefficients.dtype)
        for number, patch in enumerate(self.plate.patches):
            mine = np.flatnonzero(self.patch == number)
            grid = coefficients[solved.electrode_of[number]]
            values = np.einsum("ai,bj,ck,ijk->abc", Ex, Ey, Ez, grid, optimize=True)
            if solved.swapped:
                values = values.transpose(1, 0, 2)
            values = values * signs[:, :, 2:]
            # A ceramic poled the other way is solved as one under the opposite potential.
            out[mine] = patch.poling * values.reshape(-1)[self.place[mine]]
        return out


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
    patch = _patches(plate, [(n[1:] + n[:-1]) / 2 for n in nodes[:2]], material)
    filled = np.stack(np.nonzero(material >= 0), axis=1)
    shape = tuple(n.size for n in nodes)
    corners = filled[:, None, :] + _CORNERS[None, :, :]
    place = np.ravel_multi_index(tuple(np.moveaxis(corners, -1, 0)), shape)
    own = patch[tuple(filled.T)]
    # A corner shared with metal or glue is on the grounded side: one point serves all.
    grounded = np.zeros(int(np.prod(shape)), dtype=bool)
    grounded[place[own < 0]] = True
    owner_of_corner = np.where(grounded[place], -1, own[:, None])
    keys, cells = np.unique(
        place * (len(plate.patches) + 1) + owner_of_corner + 1, return_inverse=True
    )
    place_of, patch_of = np.divmod(keys, len(plate.patches) + 1)
    index = np.unravel_index(place_of, shape)
    points = np.stack([n[i] for n, i in zip(nodes, index, strict=True)], axis=1)
    return PlateVolume(
        plate,
        points,
        cells.reshape(-1, 8),
        material[tuple(filled.T)],
        tuple(m.name for m in model.media),
        (nodes[0], nodes[1], nodes[2]),
        place_of,
        patch_of - 1,
    )


def mode_fields(
    volume: PlateVolume, modes: PlateModes, mode: int
) -> tuple[si.FloatArray, si.FloatArray]:
    """Displacement (points × 3, 1/√kg) and potential (V per m√kg) of a mode of unit modal mass."""
    solved, vector = modes._fields[mode]
    # In free vibration only a patch that is open has a potential, at which it carries no charge.
    G, C = solved.slabs.electrode_columns
    opened = open_electrodes(solved)
    electrodes = opened @ np.linalg.solve(opened.T @ C @ opened, -opened.T @ (G.T @ vector))
    return volume.displacement(solved, vector), volume.potential(solved, vector, electrodes)


def harmonic_fields(
    volume: PlateVolume, response: HarmonicResponse, at: int
) -> tuple[si.ComplexArray, si.ComplexArray]:
    """Complex displacement (points × 3, m/V) and potential (V/V) of the response per volt of the
    drive at frequency number `at`."""
    moved = np.zeros(volume.points.shape, dtype=complex)
    charged = np.zeros(len(volume.points), dtype=complex)
    parts = response._parts
    for part, own, potentials in zip(parts, class_slices(parts), response._potentials, strict=True):
        vector = part.basis @ response._coordinates[at, own]
        moved += volume.displacement(part.solved, vector)
        charged += volume.potential(part.solved, vector, potentials[at])
    return moved, charged


def _element_of(line: LineMesh) -> si.IntArray:
    """The element of each interval between two nodes of a line."""
    return np.repeat(np.arange(line.elements), line.orders)


def _patches(
    plate: RectangularPlate, centres: list[si.FloatArray], material: si.IntArray
) -> si.IntArray:
    """The patch of each interval box, −1 where it is none."""
    out = np.full(material.shape, -1)
    for number, patch in enumerate(plate.patches):
        x, y = centres
        inside = np.multiply.outer(
            (x > patch.x) & (x < patch.x + patch.length),
            (y > patch.y) & (y < patch.y + patch.width),
        )
        own = material == (1 if patch.face == "bottom" else 2)
        out[inside[:, :, None] & own] = number
    return out


def _potential_coefficients(
    solved: PlateModel,
    vector: si.FloatArray | si.ComplexArray,
    electrodes: si.FloatArray | si.ComplexArray,
) -> si.FloatArray:
    """φ (V) of each ceramic: nodal along x, hierarchic along y and z; shape (ceramics, x nodes,
    y functions, z functions)."""
    slabs, model = solved.slabs, solved.model
    count, base = len(model.electrodes), potential_base(model)
    kind = np.result_type(vector, electrodes, float)
    out = np.zeros((count, model.x.nodes.size, model.y.nodes.size, model.z.nodes.size), dtype=kind)
    for n, (component, iy, iz) in enumerate(slabs.parts):
        electric = component == 3
        ceramic = (slabs.codes[n][electric] - base) % max(count, 1)
        part = vector[slabs.offsets[n] : slabs.offsets[n + 1]][electric]
        out[ceramic, n, iy[electric], iz[electric]] = POTENTIAL_UNIT * part
    for number, electrode in enumerate(model.electrodes):
        rows, columns, _ = np.nonzero(model.ceramic == number)
        first, last = model.x.first_node[rows.min()], model.x.first_node[rows.max() + 1]
        ends = {model.y.first_node[j + k] for j in columns for k in (0, 1)}
        # The electrode's potential is one along y: the functions of the element's ends alone.
        at = np.ix_(np.arange(first, last + 1), np.array(sorted(ends)))
        out[number, :, :, electrode.driven_plane][at] = electrodes[number]
    return np.asarray(out)
