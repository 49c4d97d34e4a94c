"""Random but buildable plates, for the honesty of the error estimate."""

import contextlib
import dataclasses

import numpy as np

from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.plate.elements.slabs import Slabs
from squeezefilm.physics.plate.layout import CeramicPatch, GlueLayer, RectangularPlate
from squeezefilm.physics.plate.solid.forecast import estimated_frequency
from squeezefilm.physics.plate.solid.layers import Resolution
from squeezefilm.physics.plate.solid.mesh import plate_model
from squeezefilm.physics.plate.solid.symmetry import all_classes

SUBSTRATES = (
    ElasticMaterial("copper-beryllium", 123e9, 0.30, 8250),
    ElasticMaterial("glass", 72e9, 0.22, 2480),
    ElasticMaterial("aluminium", 70e9, 0.33, 2700),
    ElasticMaterial("steel", 200e9, 0.29, 7850),
)
CERAMIC = Piezoceramic("P1-91", 67.9e9, 0.2897, 23e9, 7700, -247e-12, 1900, 60)


def random_plate(seed: int) -> RectangularPlate:
    """Two to seven ceramics of random width, thickness and gap, on one or both faces."""
    rng = np.random.default_rng(seed)
    strips, faces = int(rng.integers(2, 8)), ("bottom", "top")[: int(rng.integers(1, 3))]
    gap, strip = rng.uniform(0.5e-3, 4e-3), rng.uniform(6e-3, 14e-3)
    margin = rng.choice([0.0, rng.uniform(1e-3, 6e-3)])
    length = 2 * margin + strips * strip + (strips - 1) * gap
    width = rng.uniform(0.35, 0.8) * max(length, 0.03)
    rim = rng.choice([0.0, rng.uniform(1e-3, 0.2 * width)])
    patches = tuple(
        CeramicPatch(
            margin + k * (strip + gap), rim, strip, width - 2 * rim,
            1e-3, 1 if k % 2 == 0 else -1, face,  # type: ignore[arg-type]
        )
        for face in faces
        for k in range(strips)
    )  # fmt: skip
    thickness = rng.uniform(0.3e-3, 1.2e-3)
    patches = tuple(dataclasses.replace(p, thickness=thickness) for p in patches)
    glue = GlueLayer(rng.uniform(20e-6, 60e-6), 3e9) if rng.random() < 0.3 else None
    return RectangularPlate(
        length=length,
        width=width,
        thickness=rng.uniform(0.7e-3, 2.5e-3),
        nodal_lines=int(np.clip(round(length / rng.uniform(9e-3, 14e-3)), 3, 9)),
        quality_factor=60,
        substrate=SUBSTRATES[int(rng.integers(len(SUBSTRATES)))],
        ceramic=CERAMIC,
        patches=patches,
        glue=glue,
    )


CERAMICS = (
    CERAMIC,
    Piezoceramic("softer", 58e9, 0.31, 21e9, 7500, -190e-12, 1500, 75),
    Piezoceramic("harder", 85e9, 0.28, 30e9, 7600, -120e-12, 1200, 400),
)


def affordable_plate(seed: int) -> RectangularPlate:
    """Like `random_plate`, of one of three ceramics, drawn again until a refined solution of it
    costs less than a minute.

    Restricted: at most 900 unknowns in a slice of the plate of `REFINED`. That leaves out wide
    plates at high frequency and those with a bare rim along the ends of the strips.
    """
    rng = np.random.default_rng([seed, 2026])
    while True:
        plate = random_plate(int(rng.integers(1_000_000, 2_000_000)))
        ceramic = CERAMICS[int(rng.integers(len(CERAMICS)))]
        plate = dataclasses.replace(plate, ceramic=ceramic)
        # Far larger ones are refused before they are solved.
        with contextlib.suppress(InputError):
            if slice_unknowns(plate) <= 900:
                return plate


def guess(plate: RectangularPlate) -> float:
    """The frequency (Hz) at which a random plate is judged: about that of its working mode."""
    return estimated_frequency(plate, plate.working_label)


# Graded towards strip edges and bonds; on the paper's plate 5e-5 above what finer ones give.
REFINED = Resolution((0.02, 0.12, 0.5, 1.7), (0.1,), 3, 4, 5.5, 6, (0.05,))


# The same for a sheet of glass, on which the smooth part takes more of the unknowns.
REFINED_GLASS = Resolution((0.03, 0.2, 0.9), (0.1,), 3, 3.5, 5.5, 6, (0.06,))


def slice_unknowns(plate: RectangularPlate, resolution: Resolution = REFINED) -> int:
    """The largest slice of the refined plate."""
    parity = all_classes(plate)[0]
    model = plate_model(plate, 1.15 * guess(plate), resolution, parity).model
    return max(Slabs(model).sizes)


def screened_plate(seed: int) -> RectangularPlate:
    """A metal plate covered with strips, or a metal or glass plate with strips on a part of it,
    with glue or without, of random polarity: for what looks through the modes of a band."""
    rng = np.random.default_rng([seed, 18])
    length, width = rng.uniform(50e-3, 100e-3), rng.uniform(25e-3, 60e-3)
    covered = seed % 3 == 0
    substrate = (
        SUBSTRATES[int(rng.integers(len(SUBSTRATES)))]
        if covered or rng.random() < 0.3
        else SUBSTRATES[1]
    )
    thickness, ceramic = rng.uniform(0.8e-3, 3e-3), rng.uniform(0.3e-3, 1e-3)
    if covered:
        strips = int(rng.integers(3, 8))
        step = length / strips
        gap = rng.uniform(0.02, 0.2) * step
        places = [(k * step + gap / 2, 0.0, step - gap, width) for k in range(strips)]
    else:
        breadth, inset = rng.uniform(3e-3, 8e-3), rng.choice([0.0, rng.uniform(1e-3, 4e-3)])
        short = rng.choice([0.0, rng.uniform(2e-3, 6e-3)])
        ends = [
            (inset, short, breadth, width - 2 * short),
            (length - inset - breadth, short, breadth, width - 2 * short),
        ]
        sides = [
            (short, inset, length - 2 * short, breadth),
            (short, width - inset - breadth, length - 2 * short, breadth),
        ]
        places = [ends, sides, ends[:1]][int(rng.choice(3, p=[0.35, 0.35, 0.3]))]
    pattern = int(rng.integers(3))
    signs = [
        1 if pattern == 0 else (-1) ** k if pattern == 1 else int(rng.choice([1, -1]))
        for k in range(len(places))
    ]
    patches = tuple(
        CeramicPatch(*place, ceramic, sign)  # type: ignore[arg-type]
        for place, sign in zip(places, signs, strict=True)
    )
    return RectangularPlate(
        length=length,
        width=width,
        thickness=thickness,
        nodal_lines=6,
        quality_factor=60,
        substrate=dataclasses.replace(
            substrate, quality_factor=1000.0 if substrate.name == "glass" else 300.0
        )
        if rng.random() < 0.5
        else substrate,
        ceramic=CERAMICS[int(rng.integers(len(CERAMICS)))],
        patches=patches,
        glue=GlueLayer(rng.uniform(10e-6, 60e-6), rng.uniform(1e9, 4e9))
        if rng.random() < 0.5
        else None,
    )


def affordable_glass(seed: int) -> RectangularPlate:
    """`random_glass`, drawn again until a slice of `REFINED_GLASS` has at most 1200 unknowns."""
    rng = np.random.default_rng([seed, 2027])
    while True:
        plate = random_glass(int(rng.integers(1_000_000, 2_000_000)))
        with contextlib.suppress(InputError):
            if slice_unknowns(plate, REFINED_GLASS) <= 1200:
                return plate


def random_glass(seed: int) -> RectangularPlate:
    """A large sheet of glass with strips on a part of it: along two edges, long or short, or along
    one only, so that it may have one symmetry and not the other."""
    rng = np.random.default_rng([seed, 18])
    length, width = rng.uniform(60e-3, 120e-3), rng.uniform(40e-3, 80e-3)
    strip, thick = rng.uniform(4e-3, 10e-3), rng.uniform(0.2e-3, 0.6e-3)
    # Nodal lines 8 to 13 mm apart, across the strips or along them.
    lines = round(width / rng.uniform(8e-3, 13e-3))
    along = bool(rng.integers(2))
    if along:
        lines = round(length / rng.uniform(8e-3, 13e-3))
    span = length if along else width
    spot = rng.choice([0.0, rng.uniform(1e-3, 4e-3)])
    places = (spot, span - spot - strip)[: 1 if rng.random() < 0.3 else 2]
    patches = tuple(
        CeramicPatch(p, 0.0, strip, width, thick, 1 if k == 0 or lines % 2 == 0 else -1)
        if along
        else CeramicPatch(0.0, p, length, strip, thick, 1 if k == 0 or lines % 2 == 0 else -1)
        for k, p in enumerate(places)
    )
    return RectangularPlate(
        length=length,
        width=width,
        thickness=rng.uniform(0.6e-3, 1.6e-3),
        nodal_lines=lines,
        lines_across="length" if along else "width",
        quality_factor=200,
        substrate=SUBSTRATES[1],
        ceramic=CERAMICS[int(rng.integers(3))],
        patches=patches,
        glue=GlueLayer(rng.uniform(10e-6, 40e-6), 3e9) if rng.random() < 0.5 else None,
    )
