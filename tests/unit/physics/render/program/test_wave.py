"""The wave's local share, and that dividing by it makes the friction even."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.program.inverse import FrictionInverse
from squeezefilm.physics.render.program.lowering import lower
from squeezefilm.physics.render.program.renderer import render
from squeezefilm.physics.render.program.wave import WaveCompensation, wave_factor
from squeezefilm.physics.render.texture.coordinate import AlongDirection, AlongY, FromPoint
from squeezefilm.physics.render.texture.levels import Amplitude, RelativeFriction
from squeezefilm.physics.render.texture.shapes import SquareWave

HALF = 8e-3


def law(amplitude: np.ndarray) -> np.ndarray:
    return 0.2 + 0.8 * np.exp(-((amplitude / 2e-6) ** 2))


@pytest.mark.parametrize("contact", [1e-3, 4e-3, 8e-3, 13e-3, 30e-3])
def test_the_factor_is_the_mean_over_the_contact(contact: float) -> None:
    for place in (-0.011, 0.0, 1.3e-3, 4e-3, 0.1):
        nodes = (np.arange(-30, 31) + 0.5) * HALF
        low, high = place - contact / 2, place + contact / 2
        cuts = [low, *nodes[(nodes > low) & (nodes < high)], high]
        total = sum(
            quad(lambda u: abs(np.cos(np.pi * u / HALF)), a, b)[0] for a, b in pairwise(cuts)
        )
        assert wave_factor(place, HALF, contact) == pytest.approx(total / contact, abs=1e-9)


def test_a_point_meets_the_wave_itself_and_a_half_wave_no_ripple() -> None:
    x = np.linspace(-0.02, 0.02, 101)
    assert wave_factor(x, HALF) == pytest.approx(np.abs(np.cos(np.pi * x / HALF)))
    assert wave_factor(x, HALF, HALF) == pytest.approx(np.full(101, 2 / np.pi))
    nearly = wave_factor(x, HALF, 1e-4 * HALF)
    assert nearly == pytest.approx(wave_factor(x, HALF), abs=1e-4)


def samples(x: np.ndarray) -> tuple:
    return x, 0.0, 0.1, np.arange(x.size) * 1e-3


def test_dividing_by_the_factor_makes_a_rippled_friction_even() -> None:
    x = np.linspace(-0.03, 0.03, 601)
    inverse = FrictionInverse.from_function(law, 6e-6, knots=2049)
    wave = WaveCompensation.over_contact(HALF, 6e-3, count=1024)
    wanted = RelativeFriction(SquareWave(3e-3), 0.5, 0.9)
    plain = render(lower(wanted, inverse=inverse), *samples(x))
    evened = render(lower(wanted, inverse=inverse, compensation=wave), *samples(x))
    local = wave_factor(x, HALF, 6e-3) / wave_factor(0.0, HALF, 6e-3)
    target = wanted(x, 0, 0.1, 0)
    left = np.abs(law(evened.amplitude * local) - target)
    assert evened.counters.unreachable == 0
    assert np.max(left) < 1e-4
    assert np.max(np.abs(law(plain.amplitude * local) - target)) > 0.03
    assert evened.amplitude * wave.factor(x) == pytest.approx(plain.amplitude, rel=1e-9)


def test_the_factor_from_a_rippled_friction_is_the_one_that_made_it() -> None:
    places = np.arange(64) / 64 * HALF
    inverse = FrictionInverse.from_function(law, 6e-6, knots=2049)
    local = wave_factor(places, HALF, 6e-3) / wave_factor(0.0, HALF, 6e-3)
    wave = WaveCompensation.from_ripple(places, law(1.5e-6 * local), inverse, HALF)
    assert wave.factors == pytest.approx(local, abs=2e-4)


def test_what_cannot_be_made_up_for_is_counted() -> None:
    wave = WaveCompensation.over_contact(HALF, 0.0, along=AlongY())
    program = lower(Amplitude.constant(2e-6), largest_amplitude=4e-6, compensation=wave)
    y = np.linspace(0.0, HALF, 101)
    found = render(program, 0.0, y, 0.1, np.arange(101) * 1e-3)
    short = np.abs(np.cos(np.pi * y / HALF)) < 0.49
    over = np.abs(np.cos(np.pi * y / HALF)) < 0.51
    assert np.count_nonzero(short) <= found.counters.saturated <= np.count_nonzero(over)
    assert found.amplitude.max() == 4e-6


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: wave_factor(0.0, 0.0), "half_wavelength = 0 m"),
        (lambda: wave_factor(np.nan, HALF), "position = nan"),
        (lambda: wave_factor(0.0, HALF, -1.0), "contact_length = -1 m"),
        (lambda: WaveCompensation(HALF, (1.0,)), "1 factors"),
        (lambda: WaveCompensation(HALF, (1.0, 0.0)), "factors = 0"),
        (lambda: WaveCompensation(HALF, (1.0, 0.5), FromPoint()), "along a direction"),
        (lambda: WaveCompensation.over_contact(HALF, 0.0, least=0.0), "least = 0"),
        (lambda: WaveCompensation.over_contact(HALF, 0.0, count=1), "count = 1"),
    ],
)
def test_what_is_no_wave_is_refused(make: object, said: str) -> None:
    with pytest.raises(InputError, match=said):
        make()


def test_a_ripple_must_cover_one_half_wavelength_evenly() -> None:
    inverse = FrictionInverse.from_function(law, 6e-6)
    with pytest.raises(InputError, match="evenly spaced"):
        WaveCompensation.from_ripple(np.arange(8) * 1e-3, law(np.full(8, 1e-6)), inverse, 0.009)
    with pytest.raises(InputError, match="one length"):
        WaveCompensation.from_ripple(np.arange(8) * 1e-3, np.ones(3), inverse, HALF)
    with pytest.raises(InputError, match="nothing vibrates"):
        WaveCompensation.from_ripple(np.arange(8) * 1e-3, np.ones(8), inverse, HALF)
    tilted = WaveCompensation.over_contact(HALF, 0.0, along=AlongDirection(0.5))
    assert tilted.factor(np.cos(0.5) * HALF, np.sin(0.5) * HALF) == pytest.approx(1.0)
