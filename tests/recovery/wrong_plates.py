"""Plates that no description has: what the solver says of them, and the calibration is not told."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np

from squeezefilm.design.plate.solved import with_glue
from squeezefilm.physics.plate.layout import CeramicPatch, FoamSupport, RectangularPlate


def _with_one(
    plate: RectangularPlate, random: np.random.Generator, change: Callable[[CeramicPatch], dict]
) -> RectangularPlate:
    """The plate with one of its ceramics changed."""
    at = int(random.integers(len(plate.patches)))
    patches = list(plate.patches)
    patches[at] = dataclasses.replace(patches[at], **change(patches[at]))
    return dataclasses.replace(plate, patches=tuple(patches))


def glue_left_out(plate: RectangularPlate, random: np.random.Generator) -> RectangularPlate:
    """A soft bond line, 20 to 80 µm."""
    return with_glue(plate, random.uniform(20e-6, 80e-6), random.uniform(0.5e9, 3e9))


def uneven(plate: RectangularPlate, random: np.random.Generator) -> RectangularPlate:
    """Ceramics by turns 3 to 8 % thicker and thinner, as on uneven glue."""
    by = random.uniform(0.03, 0.08)
    patches = tuple(
        dataclasses.replace(one, thickness=one.thickness * (1 + by * (-1) ** k))
        for k, one in enumerate(plate.patches)
    )
    return dataclasses.replace(plate, patches=patches)


def loose_end(plate: RectangularPlate, random: np.random.Generator) -> RectangularPlate:
    """One ceramic does without 10 to 40 % of its length."""
    left = random.uniform(0.6, 0.9)
    return _with_one(plate, random, lambda one: {"length": left * one.length})


def broken_wire(plate: RectangularPlate, random: np.random.Generator) -> RectangularPlate:
    """One ceramic is not driven."""
    return _with_one(plate, random, lambda _: {"electrode": "open"})


def cut_large(plate: RectangularPlate, random: np.random.Generator) -> RectangularPlate:
    """A plate up to 1.2 % longer and wider than drawn."""
    return dataclasses.replace(
        plate,
        length=plate.length * random.uniform(1.0, 1.012),
        width=plate.width * random.uniform(1.0, 1.012),
    )


def on_foam(plate: RectangularPlate, random: np.random.Generator) -> RectangularPlate:
    """A strip of foam across the middle of the plate."""
    strip = FoamSupport(
        0.48 * plate.length, 0.0, 1.5e-3, plate.width, 1e-3, random.uniform(1e6, 8e6), face="top"
    )
    return dataclasses.replace(plate, supports=(strip,))


MECHANISMS = (glue_left_out, uneven, loose_end, broken_wire, cut_large, on_foam)
