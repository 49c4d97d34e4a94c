"""The inverse of a friction curve: round trip, its stated error, and what is refused."""

import math

import numpy as np
import pytest

from squeezefilm.errors import InputError
from squeezefilm.render.program.inverse import FrictionInverse


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
    assert np.all(np.diff(smoothed.relative_friction) < 0)
    assert 2e-4 < smoothed.max_error < 3e-3


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
