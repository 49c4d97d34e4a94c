"""The tables of friction, read against an interpolation of SciPy's and at their ends."""

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from squeezefilm.instruments.twin.envelope_step import (
    Fingers,
    FrictionTables,
    at_speed,
    row_between,
    table_place,
)

HIGHEST = 3e-6
FORCES = np.array([0.1, 0.4, 0.5, 2.0])
AMPLITUDES = HIGHEST * (np.arange(6) / 5) ** 2
SPEEDS = np.array([0.0, 1e-3, 0.02, 0.3])
_dice = np.random.default_rng(5)
TABLES = FrictionTables(SPEEDS, _dice.uniform(0.1, 1.0, (4, 6, 4)), _dice.uniform(0.3, 2.0, 4))
FINGERS = Fingers(FORCES, np.zeros((4, 6), dtype=complex), HIGHEST)


def read(force: float, amplitude: float) -> tuple[np.ndarray, float]:
    row = np.full(SPEEDS.size, np.nan)
    i, p, j, q, _ = table_place(force, amplitude, FINGERS)
    return row, row_between(TABLES, i, p, j, q, row)


@pytest.mark.parametrize("force", [0.1, 0.15, 0.45, 2.0])
@pytest.mark.parametrize("amplitude", [0.0, 0.05e-6, 1.3e-6, 3e-6])
def test_a_row_is_linear_in_force_amplitude_and_speed(force: float, amplitude: float) -> None:
    row, coefficient = read(force, amplitude)
    table = RegularGridInterpolator((FORCES, AMPLITUDES, SPEEDS), TABLES.relative)
    for speed in (0.0, 0.4e-3, 1e-3, 0.011, 0.25, 0.3):
        expected = table([[force, amplitude, speed]])[0]
        assert at_speed(SPEEDS, row, speed) == pytest.approx(expected, rel=1e-9)
    expected = np.interp(force, FORCES, TABLES.coefficient)
    assert coefficient == pytest.approx(expected, rel=1e-12)


def test_beyond_its_ends_a_row_is_held() -> None:
    row, coefficient = read(9.0, 9e-6)
    np.testing.assert_allclose(row, TABLES.relative[-1, -1], rtol=1e-12)
    assert coefficient == pytest.approx(TABLES.coefficient[-1])
    assert at_speed(SPEEDS, row, 5.0) == row[-1]
    row, coefficient = read(0.01, 0.0)
    np.testing.assert_allclose(row, TABLES.relative[0, 0], rtol=1e-12)
    assert coefficient == pytest.approx(TABLES.coefficient[0])
    assert at_speed(np.zeros(1), np.array([0.7]), 0.2) == 0.7


def test_friction_that_vanishes_is_exactly_none() -> None:
    relative = TABLES.relative.copy()
    relative[:, 1:, 0] = 0.0
    row = np.full(SPEEDS.size, np.nan)
    # The march lets a skin pass through rest where nothing at all holds it there.
    i, p, j, q, _ = table_place(0.43, 1.3e-6, FINGERS)
    row_between(TABLES._replace(relative=relative), i, p, j, q, row)
    assert row[0] == 0.0
