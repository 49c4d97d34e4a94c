"""The inverse of a friction curve: round trip, its stated error, and what is refused."""

import math

import numpy as np
import pytest
from tests.friction_tables import inverse_over_speeds

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.program.inverse import (
    LOWEST_SPEED,
    FrictionInverse,
    FrictionTable,
)


def law(amplitude: np.ndarray) -> np.ndarray:
    return 0.2 + 0.8 * np.exp(-((amplitude / 2e-6) ** 2))


def test_the_error_stated_is_met_and_falls_with_the_square_of_the_spacing() -> None:
    wanted = np.linspace(0.25, 1.0, 5001)
    stated, met = [], []
    for knots in (65, 129, 257):
        inverse = FrictionInverse.from_function(law, 4e-6, knots=knots)
        stated.append(inverse.max_error)
        met.append(float(np.max(np.abs(law(inverse.amplitude_for(wanted)) - wanted))))
    assert np.all(np.array(met) <= 1.02 * np.array(stated))
    assert np.all(np.array(met) > 0.5 * np.array(stated))
    orders = np.log2(np.array(stated[:-1]) / np.array(stated[1:]))
    assert orders == pytest.approx([2.0, 2.0], abs=0.1)


def test_its_ends_are_those_of_the_curve() -> None:
    inverse = FrictionInverse.from_function(law, 4e-6, knots=101)
    assert inverse.least_friction == pytest.approx(law(np.array(4e-6)))
    assert inverse.largest_amplitude == 4e-6


def test_a_straight_curve_is_inverted_exactly() -> None:
    inverse = FrictionInverse.from_function(lambda a: 1 - 0.5 * a / 4e-6, 4e-6, knots=9)
    assert inverse.max_error < 1e-15
    assert inverse.amplitude_for(0.75) == pytest.approx(2e-6)
    assert inverse.amplitude_for(np.array([1.0, 0.5])) == pytest.approx([0.0, 4e-6])


def test_a_flat_end_is_left_out_and_noise_is_flattened_if_allowed() -> None:
    def floored(amplitude: np.ndarray) -> np.ndarray:
        return np.maximum(1 - amplitude / 2e-6, 0.4)

    inverse = FrictionInverse.from_function(floored, 4e-6)
    assert inverse.largest_amplitude == pytest.approx(1.2e-6, abs=4e-6 / 256)
    rng = np.random.default_rng(0)
    places = np.linspace(0, 4e-6, 201)
    noisy = law(places) + np.append(0.0, rng.normal(0, 5e-4, 200))

    def rough(amplitude: np.ndarray) -> np.ndarray:
        return np.interp(amplitude, places, noisy)

    with pytest.raises(InputError, match="friction rises by"):
        FrictionInverse.from_function(rough, 4e-6, knots=201)
    smoothed = FrictionInverse.from_function(rough, 4e-6, knots=201, rise_allowed=3e-3)
    assert smoothed.relative_friction.shape == (1, smoothed.amplitude.size)
    assert np.all(np.diff(smoothed.relative_friction) < 0)
    assert 2e-4 < smoothed.max_error < 3e-3


def law_at(amplitude: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Less is left of a vibration's effect under a faster finger."""
    return 0.2 + 0.8 * np.exp(-((amplitude / 2e-6) ** 2) / (1.0 + 4.0 * speed[:, None]))


GRID = 4e-6 * np.linspace(0.0, 1.0, 65) ** 2
TWO_SPEEDS = np.array([0.1, 1.0])


def rows(count: int = 24) -> FrictionInverse:
    return inverse_over_speeds(law_at, GRID, np.geomspace(1e-3, 2.0, count), 0.08)


def test_a_friction_wanted_at_a_speed_is_what_the_law_makes_at_that_speed() -> None:
    rng = np.random.default_rng(17)
    stated = []
    for count in (12, 24, 48):
        inverse = rows(count)
        speed = np.exp(rng.uniform(np.log(LOWEST_SPEED), np.log(2.0), 4000))
        least = inverse.least_friction_at(speed)
        wanted = least + (1.0 - least) * rng.random(speed.size)
        amplitude = inverse.amplitude_for(wanted, -speed)
        met = np.array(
            [law_at(a, v)[0, 0] for a, v in zip(amplitude[:, None], speed[:, None], strict=True)]
        )
        error = float(np.max(np.abs(met - wanted)))
        # Measured in the middle of each cell, so that somewhere it may be a little more.
        assert 0.5 * inverse.max_error < error < 1.1 * inverse.max_error
        stated.append(inverse.max_error)
        # What compensating for the nominal speed alone would miss it by.
        fixed = inverse.amplitude_for(np.maximum(wanted, inverse.least_friction))
        blind = np.array(
            [law_at(a, v)[0, 0] for a, v in zip(fixed[:, None], speed[:, None], strict=True)]
        )
        assert np.max(np.abs(blind - wanted)) > 10 * error
    assert stated[0] > 2.5 * stated[1] > 6 * stated[2]


def test_beyond_its_speeds_the_nearest_row_holds() -> None:
    inverse = rows()
    assert inverse.speed[0] == LOWEST_SPEED
    assert np.all(np.diff(inverse.speed) > 0.0)
    slow = inverse.amplitude_for(0.8, np.array([0.0, 1e-3, LOWEST_SPEED]))
    assert np.all(slow == slow[0])
    fast = inverse.amplitude_for(0.8, np.array([2.0, 30.0]))
    assert fast[0] == fast[1]
    assert inverse.amplitude_for(0.8) == inverse.amplitude_for(0.8, 0.08)
    assert inverse.least_friction == float(inverse.least_friction_at(-0.08))
    assert inverse.friction_at(1.0, 0.3) == inverse.least_friction_at(0.3)


def test_where_friction_is_flat_the_least_amplitude_that_makes_it_is_taken() -> None:
    def flat_at_rest_and_at_its_end(amplitude: np.ndarray, speed: np.ndarray) -> np.ndarray:
        start = np.where(speed > 0.5, 1e-6, 0.0)[:, None]
        return np.clip(1.0 - (amplitude - start) / 2e-6, 0.25, 1.0)

    knots = 0.25e-6 * np.arange(17)
    inverse = inverse_over_speeds(
        flat_at_rest_and_at_its_end, knots, np.array([0.01, 0.1, 1.0, 2.0]), 0.1
    )
    for speed in (0.05, 0.4, 1.0, 1.7):
        assert inverse.amplitude_for(1.0, speed) == 0.0
        assert inverse.amplitude_for(np.nextafter(1.0, 0.0), speed) <= 1.001e-6
    assert inverse.amplitude_for(0.25, 0.05) == pytest.approx(1.5e-6)
    assert inverse.amplitude_for(0.25, 1.5) == pytest.approx(2.5e-6)
    assert inverse.amplitude_for(0.5, 1.5) == pytest.approx(2e-6)


def test_what_is_known_at_the_knots_is_not_asked_again() -> None:
    asked = []

    def counted(amplitude: np.ndarray, speed: np.ndarray) -> np.ndarray:
        asked.append((speed.size, amplitude.size))
        return law_at(amplitude, speed)

    speed = np.geomspace(1e-3, 2.0, 24)
    inverse = FrictionTable(GRID, speed, law_at(GRID, speed), 0.08).inverse(counted, GRID[-1])
    assert asked == [(inverse.speed.size - 1, GRID.size - 1)]
    assert np.array_equal(inverse.relative_friction, rows().relative_friction)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (
            lambda: inverse_over_speeds(law_at, GRID[::-1], TWO_SPEEDS, 0.1),
            "amplitude .* must rise",
        ),
        (lambda: inverse_over_speeds(law_at, GRID, TWO_SPEEDS[::-1], 0.1), "speed .* must rise"),
        (lambda: inverse_over_speeds(law_at, GRID, 4e-3 * TWO_SPEEDS, 0.1), "above 5 mm/s"),
        (
            lambda: inverse_over_speeds(
                lambda a, v: np.ones((v.size, a.size)), GRID, TWO_SPEEDS, 0.1
            ),
            "not fall",
        ),
        (
            lambda: inverse_over_speeds(
                lambda a, v: 1 - 1e5 * (a - a**2 / 5e-6) + 0 * v[:, None], GRID, TWO_SPEEDS, 0.1
            ),
            "friction rises by",
        ),
        (
            lambda: FrictionTable(GRID, TWO_SPEEDS, law_at(GRID, TWO_SPEEDS), 0.1).inverse(
                lambda a, v: law_at(a, v)[0], GRID[-1]
            ),
            "a row of amplitudes for each speed",
        ),
        (lambda: rows().amplitude_for(0.21, np.array([0.01, 2.0])), "relative_friction = 0.21"),
        (
            lambda: FrictionInverse(GRID, np.zeros(1), np.ones((2, GRID.size)), 0.0, 0.0),
            "one row for each speed",
        ),
    ],
)
def test_what_is_no_law_over_speeds_is_refused(make: object, said: str) -> None:
    with pytest.raises(InputError, match=said):
        make()


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: FrictionInverse.from_function(law, 0.0), "largest_amplitude = 0 m"),
        (lambda: FrictionInverse.from_function(law, 2.0), "at most 1 mm"),
        (lambda: FrictionInverse.from_function(law, 1e-6, knots=2), "knots = 2"),
        (lambda: FrictionInverse.from_function(lambda a: 0.5 * law(a), 1e-6), "at rest is 0.5"),
        (lambda: FrictionInverse.from_function(lambda a: 2 - law(a), 1e-6), "friction rises by"),
        (lambda: FrictionInverse.from_function(np.ones_like, 1e-6), "does not fall"),
        (lambda: FrictionInverse.from_function(lambda a: 1.0, 1e-6), "shape \\(\\)"),
        (lambda: FrictionInverse.from_function(lambda a: a * math.nan, 1e-6), "nan"),
        (
            lambda: FrictionInverse.from_function(law, 4e-6).amplitude_for(0.1),
            "relative_friction = 0.1",
        ),
    ],
)
def test_what_is_no_falling_curve_is_refused(make: object, said: str) -> None:
    with pytest.raises(InputError, match=said):
        make()
