"""A friction that is wanted stays what it is while the finger's speed changes, if the renderer
knows the speed: by the law itself, along a stroke of minimum jerk, and what it is worth."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from squeezefilm.core.quantities import FloatArray
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.chain.rendered_texture import render_texture
from squeezefilm.physics.display import load_display
from squeezefilm.physics.render.motion.stroke import MinimumJerkStroke
from squeezefilm.physics.render.program.inverse import LOWEST_SPEED, FrictionInverse
from squeezefilm.physics.render.program.lowering import lower
from squeezefilm.physics.render.program.renderer import MadeForSpeed, render
from squeezefilm.physics.render.texture.levels import RelativeFriction
from squeezefilm.physics.render.texture.shapes import SineWave

STATOR = load_display("biet2008-stator")
# To a peak of 188 mm/s: from creeping to more than twice the speed of the prediction.
STROKE = MinimumJerkStroke(40e-3, 0.4)
TEXTURE = RelativeFriction(SineWave(5e-3), 0.6, 0.9)


@functools.cache
def point() -> Prediction:
    return predict(STATOR)


def _law(amplitude: FloatArray, speed: FloatArray) -> FloatArray:
    """The law itself, not its table, sample by sample."""
    pairs = zip(amplitude, speed, strict=True)
    return np.array([point().law.over_speeds(np.array([a]), np.array([v]))[0, 0] for a, v in pairs])


def _missed(inverse: FrictionInverse, count: int = 60) -> FloatArray:
    """Friction by the law at the amplitudes that a program asks for, minus that wanted."""
    time = np.linspace(0.0, STROKE.duration, 8001)
    x = STROKE.position(time)
    speed = np.gradient(x, time)
    asked = render(lower(TEXTURE, inverse=inverse), x, 0.0, speed, time)
    assert asked.counters.unreachable == 0
    moving = np.flatnonzero(speed > LOWEST_SPEED)
    some = moving[np.linspace(0, moving.size - 1, count).astype(int)]
    wanted = TEXTURE(x, 0.0, speed, time)[some]
    return _law(asked.amplitude[some], speed[some]) - wanted


def test_with_the_speed_the_wanted_friction_is_met_within_the_stated_error() -> None:
    inverse = point().inverse
    assert inverse.max_error < 0.01
    assert np.max(np.abs(_missed(inverse))) <= inverse.max_error


def test_without_the_speed_it_is_missed_by_far_more() -> None:
    p = point()
    nominal = FrictionInverse.from_function(p.friction, p.vibration_amplitude)
    missed = _missed(nominal)
    print(f"nominal speed alone: {missed.min():+.3f} to {missed.max():+.3f}, "
          f"RMS {np.sqrt(np.mean(missed**2)):.3f}")  # fmt: skip
    # Docs quote these: slower than 80 mm/s it is too slippery, faster too sticky.
    assert np.min(missed) < -0.05
    assert np.max(missed) > 0.03
    assert np.max(np.abs(missed)) > 20 * p.inverse.max_error


@pytest.mark.parametrize("sensor", [None, "lvdt-10-khz", "touch-panel-240-hz"])
def test_the_loop_compensates_with_the_speed_that_it_estimates(sensor: str | None) -> None:
    found = render_texture(
        STATOR, RelativeFriction.constant(0.75), STROKE, sensor=sensor, control_rate=4e3, seed=3
    )
    speed = np.abs(found.finger.speed)
    # Away from the start, where an estimator first has to hear of the finger, and from the turn.
    moving = (speed > 20e-3) & (found.finger.time > 0.1)
    miss = found.stroke.relative_friction_rendered[moving] - 0.75
    rms = float(np.sqrt(np.mean(miss**2)))
    nominal = found.prediction.friction(
        np.full(speed.shape, float(found.played.inverse.amplitude_for(0.75))), speed
    )
    blind = float(np.sqrt(np.mean((nominal[moving] - 0.75) ** 2)))
    print(f"{sensor}: RMS {rms:.4f} of friction with the speed, {blind:.4f} without")
    assert rms < blind / 3


def test_what_knows_only_places_says_what_other_speeds_cost() -> None:
    p = point()
    amplitude = p.inverse.amplitude_for(np.linspace(0.6, 0.9, 31))
    made = MadeForSpeed.of(p.friction, amplitude, p.speed)
    half, double = (_law(amplitude, np.full(31, v)) for v in (0.5 * p.speed, 2.0 * p.speed))
    there = _law(amplitude, np.full(31, p.speed))
    assert made.error_at_half == pytest.approx(np.min(half - there), abs=0.01)
    assert made.error_at_double == pytest.approx(np.max(double - there), abs=0.01)
    assert "made for a finger at 80 mm/s" in made.sentence()
    print(made.sentence())
