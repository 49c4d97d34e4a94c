"""A plate turned by 90° is the same plate: the same modes and motion, for the same work."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from tests.verification.random_plates import random_plate

from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import RectangularPlate, turned
from squeezefilm.physics.plate.solid.forecast import estimated_frequency, solve_size
from squeezefilm.physics.plate.solid.layers import COARSE, NORMAL
from squeezefilm.physics.plate.solid.mesh import plate_model
from squeezefilm.physics.plate.solid.solve import solve_modes
from squeezefilm.physics.plate.solid.symmetry import all_classes


def require_same_work(plate: RectangularPlate) -> None:
    """Fail where the turned plate's meshes are others, of any class of symmetry."""
    other = turned(plate)
    for resolution in (COARSE, NORMAL):
        for parity in all_classes(plate):
            here = plate_model(plate, 30e3, resolution, parity).slabs
            there = plate_model(other, 30e3, resolution, parity[::-1]).slabs
            assert here.unknowns == there.unknowns
            assert here.memory == there.memory
            assert here.products == there.products


def require_same_modes(plate: RectangularPlate) -> None:
    """Fail where the turned plate's working mode is another."""
    other, label = turned(plate), plate.working_label
    near = estimated_frequency(plate, label)
    here = solve_modes(plate, near=near, count=2, tolerance=0.02)
    there = solve_modes(other, near=near, count=2, tolerance=0.02)
    np.testing.assert_allclose(there.frequencies, here.frequencies, rtol=1e-7)
    scale = float(np.max(np.abs(here.drive_forces)))
    np.testing.assert_allclose(there.drive_forces, here.drive_forces, atol=1e-4 * scale)
    for k in range(here.count):
        x, y = np.linspace(0, plate.length, 9), np.linspace(0, plate.width, 7)
        w = here.field(k, x, y, plate.thickness)[:, :, 2]
        v = there.field(k, y, x, plate.thickness)[:, :, 2].T
        assert np.max(np.abs(np.abs(v) - np.abs(w))) < 1e-3 * np.max(np.abs(w))


@pytest.mark.slow
def test_turned_plates_take_the_same_work() -> None:
    for seed in range(900, 910):
        require_same_work(random_plate(seed))


def test_slices_follow_each_other_where_that_is_less_work() -> None:
    # Strips along the long edges of a narrow sheet, in a mode with six lines across its short side:
    # that has more edges, and slices across the long one would be eight times the work.
    sheet = load_display("touchpad-glass").actuator
    assert isinstance(sheet, RectangularPlate)
    strip = dataclasses.replace(sheet.patches[0], x=0.0, y=0.0, length=5e-3, width=135e-3)
    narrow = dataclasses.replace(
        sheet,
        length=25e-3,
        width=135e-3,
        nodal_lines=6,
        lines_across="length",
        patches=(strip, dataclasses.replace(strip, x=20e-3)),
        supports=(),
    )
    for plate in (narrow, turned(narrow)):
        solved = plate_model(plate, 130e3, NORMAL, ("S", "S"))
        assert solved.swapped == (plate.length < plate.width)
        assert solved.model.x.nodes[-1] == pytest.approx(135e-3 / 2)


@pytest.mark.slow
def test_turned_plates_have_the_same_modes() -> None:
    for seed in (901, 904):
        require_same_modes(random_plate(seed))


@pytest.mark.parametrize(
    "seeds",
    [
        pytest.param(range(1000, 1025), marks=pytest.mark.nightly),
        pytest.param(range(1025, 1050), marks=pytest.mark.campaign),
    ],
)
def test_turned_plates_take_the_same_work_and_have_the_same_modes(seeds: range) -> None:
    for seed in seeds:
        plate = random_plate(seed)
        require_same_work(plate)
        if solve_size(plate, plate.working_label, 30e3).seconds < 20:
            require_same_modes(plate)
