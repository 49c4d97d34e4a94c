"""The compiled noise against the B-spline of its lattice's values, which SciPy makes by itself."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.interpolate import BSpline

from squeezefilm.physics.render.interpret import field_noise, image, line_noise
from squeezefilm.physics.render.opcodes import STEP_ACROSS, STEP_ALONG, mixed

SEED = 12345


def lattice(cells: range, seed: int, step: int) -> np.ndarray:
    return np.array([mixed(seed ^ (cell * step & 0xFFFFFFFF)) * 2.0**-32 for cell in cells])


def spline(values: np.ndarray, first: int) -> BSpline:
    """The cubic through whose middle the value of a lattice point stands."""
    knots = np.arange(first - 2, first + len(values) + 2, dtype=float)
    return BSpline(knots, values, 3)


@pytest.mark.parametrize("u", [-3.75, -1.0, -0.5, 0.0, 0.125, 2.0, 2.875])
def test_noise_along_a_line_is_the_spline_of_its_lattice(u: float) -> None:
    cells = range(-8, 9)
    wanted = spline(lattice(cells, SEED, STEP_ALONG), cells.start)(u)
    assert line_noise(u, SEED, STEP_ALONG) == pytest.approx(float(wanted), abs=1e-14)


@pytest.mark.parametrize(("u", "w"), [(0.25, 1.5), (-2.5, 0.0), (1.0, -1.75)])
def test_noise_in_the_plane_is_the_spline_of_lines(u: float, w: float) -> None:
    cells = range(-8, 9)
    lines = [
        line_noise(w, mixed(SEED ^ (cell * STEP_ALONG & 0xFFFFFFFF)), STEP_ACROSS) for cell in cells
    ]
    wanted = spline(np.array(lines), cells.start)(u)
    assert field_noise(u, w, SEED) == pytest.approx(float(wanted), abs=1e-14)


@pytest.mark.parametrize("far", [2.0**31, -(2.0**31), math.inf, math.nan])
def test_where_lattice_points_have_no_number_there_is_no_noise(far: float) -> None:
    assert math.isnan(line_noise(far, SEED, STEP_ALONG))
    assert math.isnan(field_noise(far, 0.0, SEED))
    assert math.isnan(field_noise(0.0, far, SEED))


def test_an_image_ends_with_its_outermost_pixels() -> None:
    """Of an image that is 0 outside both its edges belong to it."""
    program, begin, table = np.zeros(80), 30, 60
    program[begin + 1 : begin + 7] = [1, 2, 0.25, 0.5, 0.125, 2]  # rows, columns, left, bottom
    program[table : table + 2] = [0.25, 0.75]
    middle = 0.5625
    for x, value in [(0.25, 0.25), (0.3125, 0.25), (0.375, 0.5), (0.5, 0.75)]:
        assert image(program, table, begin, x, middle) == value
    assert (
        image(program, table, begin, 0.25, 0.5) == image(program, table, begin, 0.25, 0.625) == 0.25
    )
    for x, y in [(0.249, middle), (0.501, middle), (0.375, 0.499), (0.375, 0.626)]:
        assert image(program, table, begin, x, y) == 0.0
