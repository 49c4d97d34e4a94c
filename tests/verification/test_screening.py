"""The modes of a band by screening against those of the solved plate, on random plates.

The seeds were taken as they come; what is judged is stated in the issue's words: every driven mode
that the three-dimensional solver finds in 20 to 60 kHz with more than 2 nm/V is found, its
frequency within 5 %, one for one within its class of symmetry.
"""

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.resonances import SCREENING_ERROR, DrivenMode, screened_modes
from squeezefilm.physics.plate.solid.solve import solve_modes

from .random_plates import screened_plate

BAND = 20e3, 60e3
DRIVEN = 2e-9  # m/V


def likeness(shape: np.ndarray, found: list[DrivenMode]) -> np.ndarray:
    """How alike a shape (x, y) is to those of some modes: 1 for the same, 0 for orthogonal."""
    others = np.array([mode.shape for mode in found]).reshape(len(found), -1)
    product = others @ shape.ravel()
    return np.asarray(product**2 / np.sum(others**2, axis=1) / np.sum(shape**2))


def judged(plate: RectangularPlate, band: tuple[float, float]) -> list[tuple[float, float, float]]:
    """Of every solved mode above 2 nm/V: frequency, relative distance of the screened one, and the
    share of its shape that screened modes within the bound make."""
    solved = solve_modes(plate, band=band, driven_only=True, tolerance=0.05)
    screened = screened_modes(plate, band)
    largest = np.max(np.abs(solved.shapes), axis=(1, 2))
    omega = 2 * np.pi * solved.frequencies
    per_volt = solved.quality_factors * solved.drive_forces * largest / omega**2
    rows = []
    for parity in set(solved.parities):
        wanted = [
            i for i in range(solved.count) if solved.parities[i] == parity and per_volt[i] > DRIVEN
        ]
        found = [mode for mode in screened if mode.parity == parity]
        assert len(found) >= len(wanted)
        if not wanted:
            continue
        own = np.array([mode.frequency for mode in found])
        # One for one: shapes first, where two modes have come near and mixed the distance.
        off = np.abs(own[None, :] / solved.frequencies[wanted][:, None] - 1)
        alike = np.array([likeness(solved.shapes[i], found) for i in wanted])
        cost = np.where(off < SCREENING_ERROR, off / SCREENING_ERROR - 3 * alike, 100.0)
        for row, column in zip(*linear_sum_assignment(cost), strict=True):
            near = off[row] < SCREENING_ERROR
            rows.append(
                (
                    float(solved.frequencies[wanted[row]]),
                    float(off[row, column]),
                    float(np.sum(alike[row, near])),
                )
            )
    return rows


def check(rows: list[tuple[float, float, float]]) -> None:
    """Each found within the bound, and mostly where its shape is."""
    assert rows
    for frequency, off, shape in rows:
        assert off <= SCREENING_ERROR, frequency
        assert shape > 0.5, frequency


# Metal with strips all over, glass with strips at two edges, a strip at one end only.
@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 2, 16])
def test_three_random_plates_keep_their_modes(seed: int) -> None:
    check(judged(screened_plate(seed), BAND))


@pytest.mark.nightly
@pytest.mark.parametrize("seed", range(20))
def test_twenty_random_plates_keep_their_modes(seed: int) -> None:
    check(judged(screened_plate(seed), BAND))


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["basdogan2020-glass", "touchpad-glass"])
def test_the_glass_presets_keep_their_modes(name: str) -> None:
    plate = load_display(name).actuator
    assert isinstance(plate, RectangularPlate)
    check(judged(plate, (20e3, 45e3)))


@pytest.mark.slow
def test_the_papers_plate_keeps_its_modes() -> None:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    rows = judged(plate, BAND)
    check(rows)
    assert len(rows) >= 10
    assert max(off for _, off, _ in rows) < 0.03
