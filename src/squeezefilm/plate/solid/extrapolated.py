"""A reduced plate whose resonance stands at the frequency extrapolated from two meshes."""

from __future__ import annotations

import dataclasses

import numpy as np
from scipy.linalg import eigh

from squeezefilm import quantities as si
from squeezefilm.plate.elements.krylov import modes_near, prolonged
from squeezefilm.plate.elements.slab_factor import SlabFactor
from squeezefilm.plate.elements.slabs import Slabs
from squeezefilm.plate.solid.mesh import plate_model
from squeezefilm.plate.solid.reduced import ReducedClass, resolved_frequency
from squeezefilm.plate.solid.refined_modes import LEVELS, extrapolated
from squeezefilm.plate.solid.resolution import COARSE


def extrapolated_class(one: ReducedClass, band: tuple[si.Hertz, si.Hertz]) -> ReducedClass:
    """The same class with its stiffness and loss scaled so that the most strongly driven mode near
    the band stands at its frequency extrapolated from two meshes.

    Other modes move by the same ratio, nearer to theirs than the mesh alone. Unchanged where no
    driven mode is near, and on meshes that have no coarser one to compare with.
    """
    built, slabs = one.solved.built, one.solved.slabs
    level = next((k for k, res in enumerate(LEVELS) if res == one.resolution), None)
    coarser = (COARSE, *LEVELS)[level] if level is not None else None
    values, shapes = eigh(one.stiffness, one.mass)
    f = np.sqrt(np.maximum(values, 0.0)) / (2 * np.pi)
    force = np.abs(shapes.T @ (one.coupling @ one.drive))
    near = np.flatnonzero((f > 0.9 * band[0]) & (f < 1.1 * band[1]) & (force > 1e-3 * force.max()))
    if coarser is None or level is None or near.size == 0:
        return one
    # Response at the band's nearest frequency: force squared over the distance of the squares.
    distance = np.maximum(0.0, np.maximum(band[0] - f[near], f[near] - band[1])) / f[near]
    mode = int(near[np.argmax(force[near] ** 2 / (distance + 0.01))])
    vector = (one.basis @ shapes[:, mode])[:, None]
    rough = Slabs(
        plate_model(one.solved.plate, resolved_frequency(band), coarser, built.parity).model
    )
    shift = values[mode] * (1 + 2e-3)
    start = prolonged(slabs, rough, vector)
    pairs = modes_near(
        rough,
        SlabFactor(rough, shift).solve,
        shift,
        lambda v: np.array([np.argmin(np.abs(v - shift))]),
        start,
        tolerance=1e-6,
    )
    wanted, _ = extrapolated(pairs.values, values[mode : mode + 1], level)
    ratio = float(wanted[0] / f[mode]) ** 2
    return dataclasses.replace(one, stiffness=ratio * one.stiffness, loss=ratio * one.loss)
