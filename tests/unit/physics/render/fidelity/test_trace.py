"""Friction traces: what they hold, other people's textures, and every refusal."""

import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.fidelity.trace import friction_trace
from squeezefilm.physics.render.motion.stroke import Stroke
from squeezefilm.physics.render.texture.levels import Amplitude
from squeezefilm.physics.render.texture.shapes import SineWave, SquareWave

TAU = 0.55e-3
SQUARE = Amplitude(SquareWave(4e-3), 0.0, 2e-6)


def falling(amplitude: np.ndarray, speed: object) -> np.ndarray:
    return 1 - amplitude / 5e-6


def test_a_trace_holds_what_made_it_and_consistent_arrays() -> None:
    stroke = Stroke(0.1, passes=2)
    trace = friction_trace(SQUARE, stroke, TAU, falling)
    assert (trace.texture, trace.stroke, trace.time_constant) == (SQUARE, stroke, TAU)
    assert "first-order" in trace.model
    assert trace.time.shape == trace.position.shape == trace.command.shape
    assert trace.amplitude.shape == trace.relative_friction_rendered.shape == trace.time.shape
    assert np.array_equal(trace.command, SQUARE(trace.position, 0.0, 0.1, trace.time))
    assert np.array_equal(trace.relative_friction_rendered, falling(trace.amplitude, None))
    assert np.array_equal(trace.relative_friction_wanted, falling(trace.command, None))
    assert trace.amplitude[0] == trace.command[0]
    assert trace.lag == pytest.approx(0.055e-3)


def test_the_default_rate_fits_texture_resonator_and_stroke() -> None:
    assert friction_trace(SQUARE, Stroke(0.1), TAU, falling).sample_rate >= 50 / TAU
    fine = friction_trace(Amplitude(SineWave(0.1e-3), 0, 1e-6), Stroke(0.2, 0.01), TAU, falling)
    assert fine.sample_rate == pytest.approx(128 * 2000)
    own = friction_trace(lambda x, y, v, t: 1e-6 + 0 * x, Stroke(0.1), 1.0, falling)
    assert own.sample_rate == pytest.approx(2500)
    assert friction_trace(SQUARE, Stroke(0.1), TAU, falling, 2e3).sample_rate == 2e3


def test_a_texture_may_depend_on_time_and_speed() -> None:
    trace = friction_trace(lambda x, y, v, t: v * 1e-5 * t, Stroke(0.1), TAU, falling)
    assert trace.command == pytest.approx(1e-6 * trace.time)
    # A ramp, once settled, is followed τ late.
    assert trace.amplitude[-1] == pytest.approx(1e-6 * (trace.time[-1] - TAU), rel=1e-9)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((SQUARE, Stroke(0.1), 0.0, falling), "time_constant = 0 s"),
        ((SQUARE, Stroke(0.1), math.nan, falling), "time_constant = nan"),
        ((SQUARE, Stroke(0.1), TAU, falling, 0.0), "sample_rate = 0 Hz"),
        ((SQUARE, Stroke(0.1), TAU, falling, 50.0), "25 Hz|25 times|at least 100 Hz"),
        ((SQUARE, Stroke(0.1), 1e-9, falling), "20 million|below 50 MHz"),
        ((lambda x, y, v, t: np.float64(1e-6), Stroke(0.1), TAU, falling), "texture returned .*()"),
        ((lambda x, y, v, t: -1e-6 + 0 * x, Stroke(0.1), TAU, falling), "texture = -1 µm"),
        ((lambda x, y, v, t: math.nan + 0 * x, Stroke(0.1), TAU, falling), "texture = nan"),
        ((SQUARE, Stroke(0.1), TAU, lambda a, v: 1.0), "relative_friction returned"),
        ((SQUARE, Stroke(0.1), TAU, lambda a, v: a - 1), "relative_friction = -1"),
    ],
)
def test_a_trace_that_cannot_be_made_is_refused(arguments: tuple, said: str) -> None:
    with pytest.raises(InputError, match=said):
        friction_trace(*arguments)
