"""A bending actuator as a three-dimensional piezoelectric solid, by the plate room's elements.

Boxes of ceramic and shim, held at x = 0, half of the width, both outer faces driven against the
middle. The elements are of high order and graded towards the clamp; nothing of the geometry but the
electrodes' own thickness is left out.
"""

from __future__ import annotations

import functools
import itertools
from typing import Annotated

import numpy as np

from squeezefilm.actuators.skin_stretch.bimorph import Bender, Bimorph
from squeezefilm.core import quantities as si
from squeezefilm.core.blas_threads import one_blas_thread
from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.physics.plate.elements.box_model import (
    BoxModel,
    Electrode,
    isotropic_solid,
    piezoceramic_solid,
)
from squeezefilm.physics.plate.elements.krylov import modes_near
from squeezefilm.physics.plate.elements.lobatto import LineMesh, gauss_points
from squeezefilm.physics.plate.elements.slab_factor import SlabFactor
from squeezefilm.physics.plate.elements.slabs import Slabs

_GRADED = (0.1, 0.5, 2.0)
"""Element edges near the clamp, in thicknesses and in widths; with the orders below the deflection
of a usual section changes by less than 1e-3 if every order is raised by two (a test checks it)."""

MOST_SLENDER = 320.0
"""Length over thickness up to which digits are kept: at 300 raising all orders by four moves the
deflection by 2e-3, at 640 by 8 %."""


@si.checked_numbers
def solid_bender(
    actuator: Bimorph, more: Annotated[int, si.AtLeast(0), si.AtMost(6)] = 0
) -> Bender:
    """Deflection, stiffness, resonance and capacitance of a bending actuator in three dimensions.

    `more` raises the order of every element, to see what is left of their error. Electrodes' own
    thickness is neglected. Takes some tenths of a second. Raises `OutOfRangeError` for an actuator
    longer than `MOST_SLENDER` thicknesses.
    """
    if actuator.length > MOST_SLENDER * actuator.thickness:
        raise OutOfRangeError(
            f"an actuator {actuator.length / actuator.thickness:.0f} times as long as thick was "
            f"asked for as a solid, whose elements lose their digits above {MOST_SLENDER:.0f}; "
            "take the strip (as_strip)",
            quantity="length",
        )
    return _solved(actuator, more)


# Its blocks are too small to gain by a second thread.
@functools.lru_cache(maxsize=8)
@one_blas_thread()
def _solved(actuator: Bimorph, more: int) -> Bender:
    slabs = Slabs(_boxes(actuator, more))
    solve = SlabFactor(slabs, 0.0).solve
    G, C = slabs.electrode_columns
    drive = np.full(2, actuator.ceramic_share)
    tip = _end_face(slabs)
    answers = solve(np.stack([-(G @ drive), tip], axis=1))
    charge = -drive @ (G.T @ answers[:, 0] + C @ drive)
    lowest = modes_near(
        slabs, solve, 0.0, lambda values: np.argsort(values)[:1], answers[:, 1:], tolerance=1e-8
    )
    # Half of the width was solved: a newton on it is two on the whole.
    return Bender(
        abs(float(tip @ answers[:, 0])),
        2 / float(tip @ answers[:, 1]),
        float(np.sqrt(np.min(lowest.values)) / (2 * np.pi)),
        2 * float(charge),
        "solid",
    )


def _boxes(actuator: Bimorph, more: int) -> BoxModel:
    length, width, thickness = actuator.length, actuator.width, actuator.thickness
    # What the clamp disturbs decays over the larger of thickness and width, from the smaller.
    near = sorted({at * side for at in _GRADED for side in (thickness, width)})
    near = [at for at in near if at < 0.3 * length]
    x = LineMesh((0.0, *near, 0.5 * length, length), (*(4 + more,) * len(near), *(6 + more,) * 2))
    # The free side has a layer as thick as the plate in which its ceramics strain apart.
    edge = thickness if width > 2.5 * thickness else 0.5 * width
    sides = (0.0, width / 2 - edge, width / 2) if edge < 0.5 * width else (0.0, width / 2)
    y = LineMesh(sides, (5 + more,) * (len(sides) - 1))
    own, shim = actuator.ceramic_thickness, actuator.shim_thickness
    # Of a beam much narrower than its ceramics they strain apart within a width of the middle.
    split = [own - width, width] if 2 * width < own else [own]
    heights = [*split, *([shim] if shim > 0 else []), *split[::-1]]
    pieces, core = len(split), [-1] * (shim > 0)
    numbers = [*(0,) * pieces, *core, *(1,) * pieces]
    z = LineMesh((0.0, *itertools.accumulate(heights)), (4 + more,) * len(heights))
    shape = (x.elements, y.elements, len(heights))
    inner = int(z.first_node[pieces]), int(z.first_node[len(heights) - pieces])
    return BoxModel(
        x,
        y,
        z,
        (piezoceramic_solid(actuator.ceramic, 0.0), isotropic_solid(actuator.shim, 0.0)),
        np.broadcast_to(np.array([1 if one < 0 else 0 for one in numbers]), shape).copy(),
        np.broadcast_to(np.array(numbers), shape).copy(),
        (Electrode(0, inner[0]), Electrode(z.nodes.size - 1, inner[1])),
        ("clamped", "free", "symmetric", "free"),
    )


def _end_face(slabs: Slabs) -> si.FloatArray:
    """What takes a solution to the mean deflection of the end face; it is also the load of one
    newton spread over that face."""
    points, weights = gauss_points(12)
    means = []
    for mesh in (slabs.model.y, slabs.model.z):
        total = np.zeros(mesh.nodes.size)
        for a, b in itertools.pairwise(mesh.edges):
            at = a + (b - a) * (points + 1) / 2
            total += weights @ mesh.interpolation(at, hierarchic=True) * (b - a) / 2
        means.append(total / (mesh.edges[-1] - mesh.edges[0]))
    component, iy, iz = slabs.parts[-1]
    out = np.zeros(slabs.unknowns)
    out[slabs.offsets[-2] :] = np.where(component == 2, means[0][iy] * means[1][iz], 0.0)
    return out
