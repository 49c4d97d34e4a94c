"""What is counted of a model before it is made: its unknowns exactly, its memory nearly."""

from __future__ import annotations

import dataclasses
import tracemalloc

import numpy as np
import pytest
from tests.verification.random_plates import random_plate

from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import SOLID_MEMORY
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.elements import slabs
from squeezefilm.physics.plate.elements.box_model import BoxModel
from squeezefilm.physics.plate.elements.cross_section import CrossSection
from squeezefilm.physics.plate.elements.slab_modes import SlabFactor, modes_near
from squeezefilm.physics.plate.layout import CeramicPatch, GlueLayer, RectangularPlate
from squeezefilm.physics.plate.solid.layers import COARSE, FINE, NORMAL, Resolution
from squeezefilm.physics.plate.solid.mesh import plate_model
from squeezefilm.physics.plate.solid.symmetry import all_classes

GLASS = ElasticMaterial("soda-lime glass", 72e9, 0.22, 2480)
CERAMIC = Piezoceramic("P1-91", 67.9e9, 0.2897, 23e9, 7700, -247e-12, 1900, 60)
# Sheet glass with four small ceramics along each short edge, as in friction displays.
PLACES = [(x, y) for x in (0.0, 88e-3) for y in (2e-3, 17.5e-3, 33.5e-3, 49e-3)]
SHEET = RectangularPlate(
    length=93e-3,
    width=65e-3,
    thickness=0.9e-3,
    nodal_lines=12,
    quality_factor=60,
    substrate=GLASS,
    ceramic=CERAMIC,
    patches=tuple(CeramicPatch(x, y, 5e-3, 14e-3, 0.5e-3) for x, y in PLACES),
    glue=GlueLayer(20e-6, 3e9),
)


@pytest.mark.parametrize("seed", range(4))
def test_the_count_of_every_slice_is_that_of_the_assembled_model(seed: int) -> None:
    plate = random_plate(seed)
    for parity in all_classes(plate):
        solved = plate_model(plate, 30e3, COARSE, parity)
        slabs = solved.slabs
        for codes, section in zip(slabs.element_codes, slabs.sections, strict=True):
            np.testing.assert_array_equal(codes, section.codes)
        inside = [section.codes.size for section in slabs.sections]
        assert slabs.squares == sum(size**2 for size in inside)
        assert slabs.products == sum(size**3 for size in inside)


def test_slices_that_differ_in_the_numbers_of_their_ceramics_are_assembled_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made: list[int] = []
    assembled = slabs.cross_section

    def counted(model: BoxModel, element: int) -> CrossSection:
        made.append(element)
        return assembled(model, element)

    monkeypatch.setattr(slabs, "cross_section", counted)
    # A long ceramic and, beside it, two short ones after another.
    places = ((10e-3, 2e-3, 60e-3), (12e-3, 49e-3, 10e-3), (40e-3, 49e-3, 10e-3))
    patches = tuple(CeramicPatch(x, y, length, 14e-3, 0.5e-3) for x, y, length in places)
    other = dataclasses.replace(SHEET, patches=patches)
    solved = plate_model(other, 30e3, COARSE, all_classes(other)[0])
    assert {one.electrodes for one in solved.slabs.sections} == {(), (0,), (0, 1), (0, 2)}
    assert len(made) == 3


def test_glass_with_small_ceramics_fits_into_four_gigabytes() -> None:
    for parity in all_classes(SHEET):
        count = plate_model(SHEET, 37.7e3, FINE, parity).slabs
        assert count.memory < 4e9
        assert 100_000 < count.unknowns < 150_000


def test_a_model_that_memory_does_not_hold_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    lower = dataclasses.replace(SOLID_MEMORY, most=1e8)
    monkeypatch.setattr(slabs, "SOLID_MEMORY", lower)
    with pytest.raises(InputError, match=r"slices of up to \d+ unknowns are too many"):
        plate_model(SHEET, 37.7e3, NORMAL, ("S", "S"))


def _peak(plate: RectangularPlate, frequency: float, resolution: Resolution) -> float:
    """The counted memory over the peak of what a mesh's factors and ten modes take."""
    solved = plate_model(plate, 1.15 * frequency, resolution, all_classes(plate)[0])
    shift = (2 * np.pi * frequency) ** 2
    tracemalloc.start()
    slabs = solved.slabs
    start = np.random.default_rng(1).standard_normal((slabs.unknowns, 4))
    start[(slabs.components == 3) | slabs.held] = 0
    solve = SlabFactor(slabs, shift).solve
    modes_near(
        slabs,
        solve,
        shift,
        lambda values: np.argsort(np.abs(values - shift))[:10],
        start,
        tolerance=1e-6,
    )
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return slabs.memory / peak


@pytest.mark.slow
def test_the_counted_memory_is_what_a_solve_takes() -> None:
    metal = load_display("biet2008-plate").actuator
    assert isinstance(metal, RectangularPlate)
    assert 0.7 < _peak(metal, 33.6e3, FINE) < 1.4
    assert 0.7 < _peak(SHEET, 32.8e3, NORMAL) < 1.4
