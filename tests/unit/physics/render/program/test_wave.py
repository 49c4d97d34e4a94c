"""The wave's local share, and that dividing by it makes the friction even."""

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.program.inverse import FrictionInverse, WaveCompensation
from squeezefilm.physics.render.program.lowering import lower
from squeezefilm.physics.render.program.renderer import render
from squeezefilm.physics.render.texture.levels import Amplitude, RelativeFriction
from squeezefilm.physics.render.texture.pattern import AlongDirection, AlongY, FromPoint
from squeezefilm.physics.render.texture.shapes import SquareWave

HALF = 8e-3


def law(amplitude: np.ndarray) -> np.ndarray:
    return 0.2 + 0.8 * np.exp(-((amplitude / 2e-6) ** 2))


def local_share(x: np.ndarray) -> np.ndarray:
    """The share of the amplitude that a contact meets, over the greatest, made up."""
    return 0.7 + 0.3 * np.cos(2 * np.pi * x / HALF)


def compensation(count: int = 1024, **options: object) -> WaveCompensation:
    places = np.arange(count) / count * HALF
    return WaveCompensation(HALF, tuple(local_share(places).tolist()), **options)


def samples(x: np.ndarray) -> tuple:
    return x, 0.0, 0.1, np.arange(x.size) * 1e-3


def test_dividing_by_the_factor_makes_a_rippled_friction_even() -> None:
    x = np.linspace(-0.03, 0.03, 601)
    inverse = FrictionInverse.from_function(law, 6e-6, knots=2049)
    wave = compensation()
    wanted = RelativeFriction(SquareWave(3e-3), 0.5, 0.9)
    plain = render(lower(wanted, inverse=inverse), *samples(x))
    evened = render(lower(wanted, inverse=inverse, compensation=wave), *samples(x))
    local = local_share(x)
    target = wanted(x, 0, 0.1, 0)
    left = np.abs(law(evened.amplitude * local) - target)
    assert evened.counters.unreachable == 0
    assert np.max(left) < 1e-4
    assert np.max(np.abs(law(plain.amplitude * local) - target)) > 0.03
    assert evened.amplitude * wave.factor(x) == pytest.approx(plain.amplitude, rel=1e-9)


def test_the_factor_from_a_rippled_friction_is_the_one_that_made_it() -> None:
    places = np.arange(64) / 64 * HALF
    inverse = FrictionInverse.from_function(law, 6e-6, knots=2049)
    local = local_share(places)
    wave = WaveCompensation.from_ripple(places, law(1.5e-6 * local), inverse, HALF)
    assert wave.factors == pytest.approx(local, abs=2e-4)


def test_what_cannot_be_made_up_for_is_counted() -> None:
    wave = compensation(along=AlongY())
    program = lower(Amplitude.constant(2.8e-6), largest_amplitude=4e-6, compensation=wave)
    y = np.linspace(0.0, HALF, 101)
    found = render(program, 0.0, y, 0.1, np.arange(101) * 1e-3)
    short, over = local_share(y) < 0.69, local_share(y) < 0.71
    assert np.count_nonzero(short) <= found.counters.saturated <= np.count_nonzero(over)
    assert found.amplitude.max() == 4e-6


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: WaveCompensation(HALF, (1.0,)), "1 factors"),
        (lambda: WaveCompensation(HALF, (1.0, 0.0)), "factors = 0"),
        (lambda: WaveCompensation(HALF, (1.0, 0.5), FromPoint()), "along a direction"),
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
    tilted = compensation(along=AlongDirection(0.5))
    assert tilted.factor(np.cos(0.5) * HALF, np.sin(0.5) * HALF) == pytest.approx(1.0)
