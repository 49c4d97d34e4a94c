"""Fineness of a plate's mesh, what its layers consist of, and the mesh through the thickness."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.elements.box_model import Medium, isotropic_solid, piezoceramic_solid
from squeezefilm.physics.plate.elements.lobatto import LineMesh, apart
from squeezefilm.physics.plate.layout import Face, RectangularPlate
from squeezefilm.physics.plate.solid.symmetry import SNAP


@dataclass(frozen=True)
class Resolution:
    """Fineness of a plate's mesh.

    `edge_layers` are distances of element edges from a ceramic's edge, in units of the thinner of
    plate and ceramic (`edge_layers_y` those across the slices), `bond_layers` those from a bond
    across the thickness, in units of the layer's own. `order_x` is the least order of elements in
    the plane, `order_z` that across each layer; `extra_x` and `extra_y` are added to 0.65 times the
    phase (rad) that the shortest wave covers in an element.
    """

    edge_layers: tuple[float, ...]
    edge_layers_y: tuple[float, ...]
    order_x: int
    extra_x: float
    extra_y: float
    order_z: int
    bond_layers: tuple[float, ...] = ()
    trunk: si.Dimensionless = 1.0


# To list modes in a second: one step from the edges of strips across the slices, none along them.
# On the presets 1 % too high, see tests/verification/test_screening.py.
SCREENING = Resolution((), (0.9,), 3, 1, 1, 2, trunk=1.3)
# From each to the next the error at strip edges and at the bond falls by a factor of three, and all
# three have the orders that make the smooth part small against it (two orders less along a wave
# and it would be ten times the rest on a sheet of glass): only then does the difference of two say
# what the finer one still lacks.
COARSE = Resolution((0.9,), (0.9,), 3, 3, 3, 3)
NORMAL = Resolution((0.2, 1.2), (0.3,), 3, 3, 4, 6)
FINE = Resolution((0.06, 0.4, 1.5), (0.15,), 3, 3, 5.5, 5, (0.1,))


def _losses(plate: RectangularPlate) -> tuple[float, float, float]:
    if plate.substrate.quality_factor is None:
        whole = 1 / plate.quality_factor
        return whole, whole, whole if plate.glue is None else 1 / plate.glue.quality_factor
    glue = 0.0 if plate.glue is None else 1 / plate.glue.quality_factor
    return 1 / plate.substrate.quality_factor, 1 / plate.ceramic.quality_factor, glue


def media(plate: RectangularPlate) -> tuple[Medium, ...]:
    """Substrate, ceramic of either polarity and glue, in the order of their numbers in a mesh."""
    substrate, ceramic, glue = _losses(plate)
    layers = [
        isotropic_solid(plate.substrate, substrate, "substrate"),
        # Poled away from the plate: towards −z below it, where all e change their sign.
        piezoceramic_solid(plate.ceramic, ceramic, "ceramic_bottom", -1),
        piezoceramic_solid(plate.ceramic, ceramic, "ceramic_top"),
    ]
    if plate.glue is not None:
        layers.append(isotropic_solid(plate.glue, glue))
    return tuple(layers)


def thicknesses(plate: RectangularPlate, face: Face) -> list[si.Metre]:
    """The different thicknesses of the ceramics on a face, ascending."""
    return apart((patch.thickness for patch in plate.patches if patch.face == face), SNAP)


def through_thickness(
    plate: RectangularPlate, resolution: Resolution
) -> tuple[LineMesh, dict[str, tuple[int, int]], dict[tuple[Face, int], tuple[int, int]]]:
    """The mesh along z (0 at the plate's lower face), the range of elements of plate and glue by
    name, and that of each patch's ceramic by its face and thickness (in units of `SNAP`)."""
    glue = 0.0 if plate.glue is None else plate.glue.thickness
    edges, orders = [0.0], []
    layers: dict[str, tuple[int, int]] = {}
    ceramics: dict[tuple[Face, int], tuple[int, int]] = {}

    def add(thickness: si.Metre, order: int, *, from_below: bool, from_above: bool) -> None:
        """Add a layer, its elements shrinking towards the bond below or above it."""
        near = [c * thickness for c in resolution.bond_layers]
        inner = [d for d in near if from_below] + [thickness - d for d in near if from_above]
        bottom = edges[-1]
        for part in [*sorted(inner), thickness]:
            edges.append(bottom + part)
            orders.append(order)

    below = thicknesses(plate, "bottom")
    above = thicknesses(plate, "top")
    # Without its start: z = 0 is the plate's lower face, found when all below is known.
    for outer, own in itertools.pairwise([*reversed(below), 0.0]):
        add(outer - own, resolution.order_z, from_below=False, from_above=own == 0.0)
    under = len(orders)
    if below and glue:
        add(glue, min(resolution.order_z, 4), from_below=False, from_above=False)
        layers["glue_bottom"] = (under, len(orders))
    start = len(orders)
    add(plate.thickness, resolution.order_z, from_below=bool(below), from_above=bool(above))
    layers["plate"] = (start, len(orders))
    over = len(orders)
    if above and glue:
        add(glue, min(resolution.order_z, 4), from_below=False, from_above=False)
        layers["glue_top"] = (over, len(orders))
        over = len(orders)
    for own, outer in itertools.pairwise([0.0, *above]):
        add(outer - own, resolution.order_z, from_below=own == 0.0, from_above=False)
    shift = edges[start]
    mesh = LineMesh(tuple(v - shift for v in edges), tuple(orders))
    for thickness in below:
        at = nearest(mesh, mesh.edges[under] - thickness)
        ceramics["bottom", snapped(thickness)] = (at, under)
    for thickness in above:
        at = nearest(mesh, mesh.edges[over] + thickness)
        ceramics["top", snapped(thickness)] = (over, at)
    return mesh, layers, ceramics


def snapped(length: si.Metre) -> int:
    """A length in whole units of `SNAP`, to compare by."""
    return round(length / SNAP)


def nearest(mesh: LineMesh, position: si.Metre) -> int:
    """The number of the edge nearest to a position."""
    return int(np.argmin(np.abs(np.array(mesh.edges) - position)))
