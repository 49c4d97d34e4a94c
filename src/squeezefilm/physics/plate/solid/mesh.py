"""Box model of a described plate: cells, media, electrodes, symmetry, graded elements.

The `Resolution` says how fine. Its numbers come from measured convergence of the paper's plate:
every strip edge is a singular line, and there layers that shrink towards it pay; across the
thickness and along y one element of high order does, its mixed high orders left out (`trunk`).
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import GeometryError, OutOfRangeError
from squeezefilm.core.hard_limits import FREQUENCY
from squeezefilm.physics.plate.elements.box_model import (
    BoxModel,
    EndCondition,
    Foundation,
    ModelElectrode,
    kept_products,
    require_aspect,
    require_half_wave,
)
from squeezefilm.physics.plate.elements.lobatto import MAX_ORDER, LineMesh, apart
from squeezefilm.physics.plate.elements.slabs import require_countable
from squeezefilm.physics.plate.layout import CeramicPatch, Face, FoamSupport, RectangularPlate
from squeezefilm.physics.plate.solid.layers import (
    NORMAL,
    Resolution,
    media,
    snapped,
    through_thickness,
)
from squeezefilm.physics.plate.solid.symmetry import (
    SNAP,
    PlateModel,
    Symmetry,
    mirror_map,
    symmetric_axes,
)

# Largest side of the plate over its thinnest layer. Measured on the paper's plate: a layer of glue
# with the plate's own constants moves (8,0) in proportion to its thickness, to 2e-6, up to a
# ratio of 8e6; digits are lost from 8e7. The limit keeps far from that.
_THINNEST = 2e4
# Half a wave over the plate's thickness. Measured on free square plates: the lowest mode is within
# 4e-5 of thin-plate theory at 290, within 1e-4 at 230, and off by 1e-3 at 430 and by 22 % at 1400,
# where bending is lost in the rounding of membrane stiffness.
_SLENDEREST = 250.0


def wave_number(plate: RectangularPlate, frequency: float) -> float:
    """The largest flexural wave number (rad/m) to resolve at a frequency: that of the bare plate,
    with a first-order correction for shear."""
    E = plate.substrate.plane_strain_modulus
    h, rho = plate.thickness, plate.substrate.density
    omega = 2 * math.pi * frequency
    bending = E * h**3 / 12
    k2 = omega * math.sqrt(rho * h / bending)
    shear = plate.substrate.shear_modulus * h * 5 / 6
    k2 = 0.5 * omega**2 * rho * h / shear + math.sqrt(
        (0.5 * omega**2 * rho * h / shear) ** 2 + k2**2
    )
    return math.sqrt(k2)


def _breaks(plate: RectangularPlate, axis: int, half: bool) -> tuple[list[float], list[float]]:
    """All element edges that the layout asks for along an axis, and those of ceramics."""
    span = (plate.length, plate.width)[axis]
    ceramics: list[float] = []
    springs: list[float] = []
    parts: tuple[CeramicPatch | FoamSupport, ...] = (*plate.patches, *plate.supports)
    for part in parts:
        start, extent = ((part.x, part.length), (part.y, part.width))[axis]
        (ceramics if isinstance(part, CeramicPatch) else springs).extend([start, start + extent])
    stop = span / 2 if half else span
    inside = [v for v in ceramics + springs if SNAP < v < stop - SNAP]
    every = apart([0.0, *inside, stop], SNAP)
    # An edge that coincides with the plate's own is snapped to it.
    sharp = [v for v in every if any(abs(v - c) < 2 * SNAP for c in ceramics)]
    return every, sharp


def _line(
    breaks: tuple[list[float], list[float]],
    half: bool,
    thickness: float,
    wave: float,
    resolution: Resolution,
    *,
    cut: bool,
) -> LineMesh:
    """A graded mesh; `cut`, for the axis along which slices follow each other, puts an element edge
    at the middle of each interval."""
    every, sharp = breaks
    layers = resolution.edge_layers if cut else resolution.edge_layers_y
    extra = resolution.extra_x if cut else resolution.extra_y
    edges: list[float] = [every[0]]
    distances = [c * thickness for c in layers]
    for a, b in itertools.pairwise(every):
        last_half = half and b == every[-1]
        near = distances if a in sharp else []
        far = distances if b in sharp and not last_half else []
        span = b - a if last_half else (b - a) / 2
        # The last layer inside a short interval (a gap) still resolves its edge.
        limit = max(0.3 * span, 1e-12)
        near = [d for d in near if d < 0.75 * span] or ([limit] if near else [])
        far = [d for d in far if d < 0.75 * span] or ([limit] if far else [])
        pieces = [a, *(a + d for d in near), *(b - d for d in reversed(far)), b]
        middle = (a + b) / 2
        if cut and not last_half and (near or far):
            pieces = sorted({*pieces, middle})
        edges += pieces[1:]
    fine: list[float] = [edges[0]]
    orders: list[int] = []
    for a, b in itertools.pairwise(edges):
        # No element longer than about one wavelength: higher orders cost more than elements.
        number = max(1, math.ceil(wave * (b - a) / (4.5 if cut else 11.0)))
        for k in range(number):
            fine.append(a + (b - a) * (k + 1) / number)
            need = 0.65 * wave * (b - a) / number + extra
            orders.append(int(min(max(resolution.order_x, round(need)), MAX_ORDER)))
    return LineMesh(tuple(fine), tuple(orders))


def plate_model(
    plate: RectangularPlate,
    frequency: float,
    resolution: Resolution = NORMAL,
    parity: Symmetry = (None, None),
) -> PlateModel:
    """The box model of a plate for modes up to about `frequency`, in one class of symmetry.

    Raises `InputError` for a frequency beyond its hard limit, before elements are counted,
    `GeometryError` for a class that the plate does not have, `OutOfRangeError` for a plate so thin
    against its length that elements lose their digits, or so thick that waves stand across a layer
    which its elements do not resolve. `InputError` too for a model that would not fit into memory.
    """
    # What resolves a band lies somewhat above it.
    si.require("frequency", frequency, si.Unit("Hz"), above=0, at_most=2 * FREQUENCY.most)
    for axis in (0, 1):
        if parity[axis] is not None and not symmetric_axes(plate)[axis]:
            raise GeometryError(
                f"the plate is not symmetric along {'xy'[axis]}; parity None is allowed there"
            )
    wave = wave_number(plate, frequency)
    _require_thick(plate, frequency, wave)
    require_thin(plate, frequency)
    z, layers, ceramics = through_thickness(plate, resolution)
    ways = [_in_plane(plate, along, wave, resolution, parity) for along in (0, 1)]
    work = [_work(x, y, z, resolution.trunk) for x, y in ways]
    # Slices follow each other where that is less work; the longer way where it is the same.
    swapped = (work[1], -plate.width) < (work[0], -plate.length)
    x, y = ways[1 if swapped else 0]
    require_countable(x, y, z, resolution.trunk)
    cells = _Cells(plate, swapped, x, y, z, layers)
    electrode_of, sign_of = _electrode_map(plate, parity)
    medium, ceramic, electrodes, number_of = cells.filled(ceramics, electrode_of)
    model = BoxModel(
        x,
        y,
        z,
        media(plate),
        medium,
        ceramic,
        electrodes,
        _ends(plate, parity, swapped),
        cells.foundations(),
        resolution.trunk,
    )
    solved = PlateModel(
        plate,
        model,
        parity,
        2 ** sum(own is not None for own in parity),
        swapped,
        tuple(number_of[electrode_of[i]] for i in range(len(plate.patches))),
        sign_of,
        tuple(_share(plate, patch, parity) for patch in plate.patches),
    )
    solved.slabs.require_memory()
    return solved


def _in_plane(
    plate: RectangularPlate, along: int, wave: float, resolution: Resolution, parity: Symmetry
) -> tuple[LineMesh, LineMesh]:
    """The meshes along and across, where slices follow each other along one axis of the plate."""
    across = 1 - along
    half = [own is not None for own in parity]
    thickness = min(plate.thickness, *(patch.thickness for patch in plate.patches))
    breaks = _breaks(plate, along, half[along])
    x = _line(breaks, half[along], thickness, wave, resolution, cut=True)
    # A ceramic that ends with the plate's own edge ends there without a corner.
    every, sharp = _breaks(plate, across, half[across])
    inner = [v for v in sharp if v > 0 and v != every[-1]]
    return x, _line((every, inner), half[across], thickness, wave, resolution, cut=False)


def _work(x: LineMesh, y: LineMesh, z: LineMesh, trunk: float) -> int:
    """Work of factorising meshes, to compare: elements along x times the cube of the functions of a
    slice."""
    return x.elements * int(np.count_nonzero(kept_products(y, z, trunk))) ** 3


def _require_thick(plate: RectangularPlate, frequency: float, wave: float) -> None:
    """Refuse a plate so thin, against its sides or half a wave, that elements lose their digits."""
    thinnest = min(
        plate.thickness,
        *(patch.thickness for patch in plate.patches),
        math.inf if plate.glue is None else plate.glue.thickness,
    )
    require_aspect("layer", thinnest, "plate", max(plate.extent), _THINNEST)
    if math.pi / wave > _SLENDEREST * plate.thickness:
        ratio = math.pi / wave / plate.thickness
        raise OutOfRangeError(
            f"at {frequency:.4g} Hz half a wave on the plate is {ratio:.0f} times its thickness; "
            f"above {_SLENDEREST:.0f} three-dimensional elements lose their digits; ask for a "
            "higher frequency or use a plate theory"
        )


@si.checked_numbers
def require_thin(
    plate: RectangularPlate, frequency: si.Hertz, asked: str = "a mesh for modes up to"
) -> None:
    """Refuse a frequency (Hz, told as `asked`) of waves across a layer: see `require_half_wave`."""
    substrate, ceramic = plate.substrate, plate.ceramic
    times = {"the plate": plate.thickness / math.sqrt(substrate.shear_modulus / substrate.density)}
    if plate.patches:
        thickest = max(patch.thickness for patch in plate.patches)
        times["a ceramic"] = thickest / math.sqrt(ceramic.shear_modulus / ceramic.density)
    require_half_wave(frequency, times, asked)


@dataclass(frozen=True, eq=False)
class _Cells:
    """The cells of three line meshes: which lie over a part, and what fills them; `layers` as
    `through_thickness` gives them."""

    plate: RectangularPlate
    swapped: bool
    x: LineMesh
    y: LineMesh
    z: LineMesh
    layers: dict[str, tuple[int, int]]

    def over(self, part: CeramicPatch | FoamSupport) -> tuple[si.IntArray, si.IntArray]:
        """The cells along x and y of the model that a part covers."""
        spans = [(part.x, part.x + part.length), (part.y, part.y + part.width)]
        along, across = (1, 0) if self.swapped else (0, 1)
        (x0, x1), (y0, y1) = spans[along], spans[across]
        centre_x, centre_y = (
            (np.array(m.edges[1:]) + np.array(m.edges[:-1])) / 2 for m in (self.x, self.y)
        )
        return (
            np.flatnonzero((centre_x > x0) & (centre_x < x1)),
            np.flatnonzero((centre_y > y0) & (centre_y < y1)),
        )

    def filled(
        self, ceramics: dict[tuple[Face, int], tuple[int, int]], electrode_of: list[int]
    ) -> tuple[si.IntArray, si.IntArray, tuple[ModelElectrode, ...], dict[int, int]]:
        """The medium and the number of the ceramic of each cell, the electrodes, and which of them
        a patch has; `ceramics` as `through_thickness` gives them."""
        medium, ceramic = np.full((2, self.x.elements, self.y.elements, self.z.elements), -1)
        medium[:, :, slice(*self.layers["plate"])] = 0
        electrodes: list[ModelElectrode] = []
        number_of: dict[int, int] = {}
        patches = self.plate.patches
        # Ceramics are numbered across first, then along: the same order in every slice.
        order = sorted(
            range(len(patches)),
            key=lambda i: (patches[i].y, patches[i].x)[:: 1 if not self.swapped else -1],
        )
        for i in order:
            patch = patches[i]
            rows, columns = self.over(patch)
            if electrode_of[i] != i or rows.size == 0 or columns.size == 0:
                continue
            number_of[i] = len(electrodes)
            first, last = ceramics[patch.face, snapped(patch.thickness)]
            block, below = np.ix_(rows, columns, np.arange(first, last)), patch.face == "bottom"
            medium[block] = 1 if below else 2
            ceramic[block] = number_of[i]
            if self.plate.glue is not None:
                glued = np.arange(*self.layers[f"glue_{patch.face}"])
                medium[np.ix_(rows, columns, glued)] = 3
            low, high = self.z.first_node[first], self.z.first_node[last]
            electrodes.append(ModelElectrode(low, high) if below else ModelElectrode(high, low))
        return medium, ceramic, tuple(electrodes), number_of

    def foundations(self) -> tuple[Foundation, ...]:
        """The supports that the model holds a part of."""
        bottom, top = (self.z.first_node[k] for k in self.layers["plate"])
        foundations = []
        for support in self.plate.supports:
            rows, columns = self.over(support)
            if rows.size and columns.size:
                kx, ky, kz = support.stiffness_per_area
                foundations.append(
                    Foundation(
                        (int(rows[0]), int(rows[-1]) + 1),
                        (int(columns[0]), int(columns[-1]) + 1),
                        top if support.face == "top" else bottom,
                        (ky, kx, kz) if self.swapped else (kx, ky, kz),
                        1 / support.quality_factor,
                    )
                )
        return tuple(foundations)


def _ends(
    plate: RectangularPlate, parity: Symmetry, swapped: bool
) -> tuple[EndCondition, EndCondition, EndCondition, EndCondition]:
    """Ends of the model: at both ends of its x, then of its y."""
    ends: list[EndCondition] = []
    for axis in (1, 0) if swapped else (0, 1):
        names = ("left", "right") if axis == 0 else ("front", "back")
        ends.append("clamped" if names[0] in plate.clamped_edges else "free")
        own = parity[axis]
        if own is None:
            ends.append("clamped" if names[1] in plate.clamped_edges else "free")
        else:
            ends.append("symmetric" if own == "S" else "antisymmetric")
    return ends[0], ends[1], ends[2], ends[3]


def _share(plate: RectangularPlate, patch: CeramicPatch, parity: Symmetry) -> float:
    share = 1.0
    for axis in (0, 1):
        middle = (plate.length, plate.width)[axis] / 2
        start, extent = ((patch.x, patch.length), (patch.y, patch.width))[axis]
        if parity[axis] is not None and start < middle - SNAP and start + extent > middle + SNAP:
            share *= 2.0 if parity[axis] == "S" else 0.0
    return share


def _electrode_map(
    plate: RectangularPlate, parity: Symmetry
) -> tuple[list[int], tuple[float, ...]]:
    """The patch in the modelled part that stands for each patch, and its relative sign."""
    stands = list(range(len(plate.patches)))
    signs = [1.0] * len(plate.patches)
    for axis in (0, 1):
        if parity[axis] is None:
            continue
        mirror = mirror_map(plate, axis)
        assert mirror is not None
        middle = ((plate.length, plate.width)[axis]) / 2
        for i, patch in enumerate(plate.patches):
            start = (patch.x, patch.y)[axis]
            if start >= middle - SNAP:
                image = mirror[i]
                if parity[axis] == "A":
                    signs[i] = -signs[i]
                stands = [image if s == i else s for s in stands]
    return stands, tuple(signs)
