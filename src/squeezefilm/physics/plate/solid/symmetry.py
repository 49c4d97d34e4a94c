"""Mirror symmetry of a plate and of its drive: the classes S and A along each axis, the plate as
the solver has it in one of them, and the modes that symmetry forbids.
"""

from __future__ import annotations

import dataclasses
import functools
import itertools
from dataclasses import dataclass
from typing import Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.elements.box_model import BoxModel
from squeezefilm.physics.plate.elements.slabs import Slabs
from squeezefilm.physics.plate.layout import CeramicPatch, FoamSupport, RectangularPlate

Parity = Literal["S", "A"]
Symmetry = tuple[Parity | None, Parity | None]
"""A class of symmetry along x and along y; None where the plate is taken whole."""
SNAP = 1e-9  # m; edges nearer than this are one


def symmetric_axes(plate: RectangularPlate) -> tuple[bool, bool]:
    """True where geometry and supports are their own mirror image along x and along y."""
    return tuple(mirror_map(plate, axis) is not None for axis in (0, 1))  # type: ignore[return-value]


def mirror_map(plate: RectangularPlate, axis: int) -> list[int] | None:
    """The patch that each patch becomes under reflection, or None if it becomes none."""
    edges = ("left", "right") if axis == 0 else ("front", "back")
    if (edges[0] in plate.clamped_edges) != (edges[1] in plate.clamped_edges):
        return None
    span = (plate.length, plate.width)[axis]

    def place(part: CeramicPatch | FoamSupport, mirrored: bool) -> tuple[int, ...]:
        start, extent = [part.x, part.y], [part.length, part.width, part.thickness]
        if mirrored:
            start[axis] = span - start[axis] - extent[axis]
        return tuple(round(v / SNAP / 4) for v in (*start, *extent))

    def alike(a: tuple[int, ...], b: tuple[int, ...]) -> bool:
        return all(abs(p - q) <= 1 for p, q in zip(a, b, strict=True))

    out = []
    for patch in plate.patches:
        want = place(patch, True)
        found = [
            i
            for i, other in enumerate(plate.patches)
            if alike(place(other, False), want)
            and (other.face, other.electrode, other.shunt_resistance)
            == (patch.face, patch.electrode, patch.shunt_resistance)
        ]
        if not found:
            return None
        out.append(found[0])
    springs = [(place(s, False), dataclasses.replace(s, x=0.0, y=0.0)) for s in plate.supports]
    for s in plate.supports:
        want, kind = place(s, True), dataclasses.replace(s, x=0.0, y=0.0)
        if not any(alike(at, want) and other == kind for at, other in springs):
            return None
    return out


def drive_signs(plate: RectangularPlate) -> si.FloatArray:
    """The sign of each patch's potential under the drive; 0 where it is not driven."""
    return np.array([float(patch.drive_sign) for patch in plate.patches])


def only_stretches(plate: RectangularPlate) -> bool:
    """True where plate and drive are their own image in the plate's middle plane: every ceramic and
    support has its like on the other face, with the same sign. Such a drive bends nothing."""
    other_face = {"bottom": "top", "top": "bottom"}

    def place(part: CeramicPatch | FoamSupport) -> tuple[int, ...]:
        sizes = part.x, part.y, part.length, part.width, part.thickness
        return tuple(round(size / SNAP / 4) for size in sizes)

    def kind(part: CeramicPatch | FoamSupport) -> tuple[object, ...]:
        if isinstance(part, FoamSupport):
            return (part.stiffness_per_area, part.quality_factor)
        return (part.drive_sign, part.electrode, part.shunt_resistance)

    def mirrored(part: CeramicPatch | FoamSupport, other: CeramicPatch | FoamSupport) -> bool:
        near = all(abs(a - b) <= 1 for a, b in zip(place(part), place(other), strict=True))
        return near and other.face == other_face[part.face] and kind(part) == kind(other)

    groups: tuple[tuple[CeramicPatch | FoamSupport, ...], ...] = (plate.patches, plate.supports)
    return all(any(mirrored(part, other) for other in group) for group in groups for part in group)


def drive_classes(plate: RectangularPlate) -> list[Symmetry]:
    """The classes of symmetry that the drive excites: those on which its signs have a part, and the
    first of all where nothing is driven."""
    signs = drive_signs(plate)
    every, excited = all_classes(plate), []
    for parity in every:
        part = signs
        for axis in (0, 1):
            mirror = mirror_map(plate, axis)
            if mirror is not None:
                part = part + (1 if parity[axis] == "S" else -1) * part[mirror]
        if np.any(part != 0):
            excited.append(parity)
    return excited or every[:1]


def all_classes(plate: RectangularPlate) -> list[Symmetry]:
    """Every class of symmetry that the plate has: four, two or one."""
    options: list[list[Parity | None]] = [
        ["S", "A"] if axis else [None] for axis in symmetric_axes(plate)
    ]
    return list(itertools.product(options[0], options[1]))


def told_of(parity: Symmetry) -> str:
    """Words for the modes of a class of symmetry, for those who are told how far a solve is."""
    moves = {"S": "alike", "A": "opposite"}
    said = [
        f"{moves[own]} on both halves of the {side}"
        for own, side in zip(parity, ("length", "width"), strict=True)
        if own is not None
    ]
    return f"modes that move {' and '.join(said)}" if said else "all modes"


_SIDES, _ENDS = ("length", "width"), ("left and right", "front and back")


def forbidden_by(plate: RectangularPlate, label: tuple[int, int]) -> str | None:
    """Reason why symmetry keeps the drive from a mode with these nodal lines, in a sentence; None
    where it does not.

    A mode with an odd number of lines across a side is turned over by the mirror in the middle of
    that side, one with an even number is its own image. Where the plate is symmetric, a drive that
    is its own image moves the second kind only, one that is turned over the first.
    """
    if only_stretches(plate):
        return (
            f"symmetry forbids ({label[0]},{label[1]}): every ceramic has its mirror image on the "
            "other face, with the same sign, so that both stretch the plate alike and bend it "
            "against each other. No mode of bending is driven; turn the polarity of the ceramics "
            "on one face"
        )
    classes = drive_classes(plate)
    for axis, lines in enumerate(label):
        driven = {parity[axis] for parity in classes}
        odd = lines % 2 == 1
        if len(driven) > 1 or None in driven or ("A" in driven) == odd:
            continue
        kind, side = "odd" if odd else "even", _SIDES[axis]
        pattern = (
            f"the ceramics' signs are the same on both halves of the {side}"
            if odd
            else f"the ceramics' signs are opposite on the two halves of the {side}"
        )
        return (
            f"symmetry forbids ({label[0]},{label[1]}): {pattern} ({_ENDS[axis]}), and in a mode "
            f"with an {kind} number of nodal lines across the {side} "
            + ("the two halves move against each other" if odd else "both halves move alike")
            + f", so that what one half drives the other cancels. Modes with an "
            f"{'even' if odd else 'odd'} number of lines across the {side} are driven; for this "
            f"one turn the polarity of the ceramics on one half, or choose another nodal_lines"
        )
    return None


def symmetry_in_words(parity: Symmetry) -> str:
    """A class of symmetry as people say it."""
    words = {"S": "even", "A": "odd", None: "no mirror"}
    return f"{words[parity[0]]} along length, {words[parity[1]]} along width"


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
