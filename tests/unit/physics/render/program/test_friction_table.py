"""A law as a table: straight between its points, and known in its range only."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.physics.render.program.inverse import FrictionTable

AMPLITUDE = np.array([0.0, 1e-6, 3e-6])
TABLE = FrictionTable(AMPLITUDE, np.zeros(1), np.array([[1.0, 0.6, 0.2]]), 0.1)
PACED = FrictionTable(
    AMPLITUDE, np.array([0.0, 0.1, 0.3]), np.array([[1, 0, 0], [1, 0.6, 0.2], [1, 0.8, 0.6]]), 0.1
)


def test_it_is_straight_between_its_points() -> None:
    asked = np.array([[0.0, 0.5e-6], [2e-6, 3e-6]])
    assert TABLE(asked) == pytest.approx(np.array([[1.0, 0.8], [0.4, 0.2]]))
    assert TABLE(np.array([3e-6 * (1 + 1e-10)])) == pytest.approx([0.2])


def test_over_speeds_it_is_straight_too_and_held_beyond_the_last() -> None:
    amplitude, speed = np.array([0.5e-6, 2e-6, 2e-6, 3e-6]), np.array([0.1, -0.2, 9.0, 0.0])
    assert PACED(amplitude, speed) == pytest.approx([0.8, 0.55, 0.7, 0.0])
    assert PACED(amplitude[:2]) == pytest.approx([0.8, 0.4])
    assert PACED(amplitude[:2], 0.05) == pytest.approx([0.65, 0.2])
    assert PACED.at_speed(-0.2) == pytest.approx([1.0, 0.7, 0.4])
    assert PACED(np.array([2e-6]), PACED.speed[:, None]) == pytest.approx(
        np.array([[0.0], [0.4], [0.7]])
    )
    # One row stands for every speed.
    assert TABLE(amplitude, speed) == pytest.approx(TABLE(amplitude))
    assert TABLE.at_speed(7.0) == pytest.approx([1.0, 0.6, 0.2])


@pytest.mark.parametrize("amplitude", [-1e-9, 3.1e-6])
def test_outside_of_its_range_it_is_not_known(amplitude: float) -> None:
    with pytest.raises(OutOfRangeError, match="tabulate it higher"):
        TABLE(np.array([1e-6, amplitude]))


@pytest.mark.parametrize("amplitude", [np.array([np.nan]), np.zeros(0)])
def test_what_is_no_number_is_refused(amplitude: np.ndarray) -> None:
    with pytest.raises(InputError):
        TABLE(amplitude)


KNOTS, SPEEDS = 3e-6 * np.linspace(0.0, 1.0, 33) ** 2, np.geomspace(1e-3, 2.0, 40)


def law(amplitude: np.ndarray, speed: np.ndarray) -> np.ndarray:
    return np.exp(-amplitude / (1e-6 + 2e-6 * speed[:, None]))


def test_its_inverse_makes_the_friction_that_was_wanted_by_the_table_itself() -> None:
    table = FrictionTable(KNOTS, SPEEDS, law(KNOTS, SPEEDS), 0.08)
    rng = np.random.default_rng(5)
    speed = rng.uniform(5e-3, 2.0, 500)
    for share in (1.0, 0.8):
        inverse = table.inverse(law, share * KNOTS[-1], share)
        wanted = rng.uniform(0.6, 1.0, 500)
        amplitude = inverse.amplitude_for(wanted, speed)
        assert table(amplitude / share, speed) == pytest.approx(wanted, abs=1e-12)
    again = table.inverse(law, KNOTS[-1])
    assert again(KNOTS[::4], 0.3) == pytest.approx(table(KNOTS[::4], 0.3), abs=1e-12)
    assert again.nominal_speed == 0.08


def test_without_a_speed_the_inverse_has_one_row() -> None:
    inverse = TABLE.inverse(law, 3e-6)
    assert inverse.speed.size == 1
    assert inverse.amplitude_for(0.6) == pytest.approx(1e-6, rel=0.02)
    assert inverse(np.array([1e-6])) == pytest.approx([0.6], abs=5e-3)


@pytest.mark.parametrize(
    ("amplitude", "speed", "friction"),
    [
        (KNOTS[::-1], SPEEDS, law(KNOTS, SPEEDS)),
        (KNOTS, SPEEDS[::-1], law(KNOTS, SPEEDS)),
        (KNOTS, SPEEDS, law(KNOTS, SPEEDS).T),
        (KNOTS[1:], SPEEDS, law(KNOTS[1:], SPEEDS)),
        (KNOTS, SPEEDS, 1.1 + 0 * law(KNOTS, SPEEDS)),
    ],
)
def test_what_is_no_table_is_refused(
    amplitude: np.ndarray, speed: np.ndarray, friction: np.ndarray
) -> None:
    with pytest.raises(InputError, match=r"no table|must rise|relative_friction = 1\.1"):
        FrictionTable(amplitude, speed, friction, 0.08)


def test_what_a_solver_leaves_beyond_0_and_1_is_taken_off() -> None:
    table = FrictionTable(np.array([0.0, 1e-6]), np.zeros(1), np.array([[1 + 1e-9, -1e-9]]), 0.0)
    assert table.relative_friction.tolist() == [[1.0, 0.0]]
