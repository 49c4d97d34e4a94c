"""The fidelity table: its shape and defaults, and every refusal."""

import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.fidelity.survival import (
    FidelityTable,
    fidelity_table,
    fundamental_kept,
    swing_kept,
)
from squeezefilm.physics.render.fidelity.trace import friction_trace
from squeezefilm.physics.render.motion.stroke import Stroke
from squeezefilm.physics.render.texture.levels import Amplitude
from squeezefilm.physics.render.texture.shapes import SquareWave

TAU = 0.55e-3


def falling(amplitude: np.ndarray, speed: object) -> np.ndarray:
    return np.exp(-amplitude / 3e-6)


def table(**changes: object) -> FidelityTable:
    arguments = {"time_constant": TAU, "relative_friction": falling, "low": 0.0, "high": 2e-6}
    return fidelity_table(**(arguments | changes))


def test_the_paper_s_periods_by_exploring_speeds() -> None:
    result = table()
    assert result.spatial_periods.tolist() == [0.4e-3, 2e-3, 4e-3, 8e-3, 10e-3]
    assert result.speeds.tolist() == [0.01, 0.02, 0.05, 0.1, 0.2]
    assert result.amplitude_kept.shape == result.friction_kept.shape == (5, 5)
    assert result.finest_period.shape == result.lag.shape == (5,)
    assert result.fastest_speed.shape == (5,)
    # Only the finest grating fails, and only under the fastest finger.
    lost = [[0, 4]]
    assert np.argwhere(~result.amplitude_survives).tolist() == lost


def test_a_sine_loses_more_than_a_square() -> None:
    square, sine = table(), table(shape="sine")
    assert np.all(sine.amplitude_kept <= square.amplitude_kept)
    assert np.argwhere(~sine.amplitude_survives).tolist() == [[0, 3], [0, 4]]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"time_constant": 0.0}, "time_constant = 0 s"),
        ({"kept": 1.0}, "kept = 1"),
        ({"shape": "saw"}, "Allowed: square, sine"),
        ({"low": 2e-6, "high": 1e-6}, "low = 2 µm lies above high = 1 µm"),
        ({"spatial_periods": []}, "spatial_periods of shape"),
        ({"spatial_periods": [0.0]}, "spatial_periods = 0 m"),
        ({"speeds": 0.1}, "speeds is one number"),
        ({"speeds": [math.nan]}, "speeds = nan"),
        ({"speeds": [60.0]}, "at most 5 m/s"),
        (
            {"relative_friction": lambda a, v: 1 + 0 * a},
            "relative friction wanted does not change",
        ),
    ],
)
def test_a_table_that_cannot_be_made_is_refused(changes: dict, said: str) -> None:
    with pytest.raises(InputError, match=said):
        table(**changes)


def test_a_swing_that_cannot_be_measured_is_refused() -> None:
    trace = friction_trace(Amplitude(SquareWave(10e-3), 0.0, 2e-6), Stroke(0.1, 8e-3), TAU, falling)
    with pytest.raises(InputError, match="passes of 8 mm are too short"):
        swing_kept(trace)
    with pytest.raises(InputError, match="'amplitude' or 'relative_friction'"):
        swing_kept(trace, "force")
    flat = friction_trace(lambda x, y, v, t: 1e-6 + 0 * x, Stroke(0.1), TAU, falling)
    with pytest.raises(InputError, match="amplitude wanted does not change"):
        swing_kept(flat)
    with pytest.raises(InputError, match="no fundamental"):
        fundamental_kept(flat)


@pytest.mark.parametrize("shape", ["square", "sine"])
def test_the_fundamental_is_that_of_a_lag(shape: str) -> None:
    """A linear envelope damps each wave by itself: measured on a friction linear in amplitude it is
    the gain of a first-order lag, whatever the shape."""
    found = table(shape=shape, relative_friction=lambda a, _: 1 - a / 3e-6)
    assert found.friction_fundamental == pytest.approx(found.amplitude_fundamental, rel=1e-3)
    turn = 2 * math.pi * found.speeds / found.spatial_periods[:, None]
    assert found.amplitude_fundamental == pytest.approx(1 / np.hypot(1, turn * TAU))


def test_peaks_are_left_where_most_of_the_wave_is_not() -> None:
    """PHYSICS' plate: 0.4 mm at 119 mm/s keeps 90 % of its swing and 68 % of its fundamental."""
    found = table(time_constant=0.5687e-3, spatial_periods=[0.4e-3], speeds=[0.1195])
    assert found.amplitude_kept[0, 0] == pytest.approx(0.90, abs=2e-3)
    assert found.amplitude_fundamental[0, 0] == pytest.approx(0.68, abs=5e-3)
    assert found.fundamental_at_limit == pytest.approx(0.684, abs=1e-3)
    assert np.all(table().amplitude_fundamental <= table().amplitude_kept)
    # Of a sine there is nothing else.
    sine = table(shape="sine")
    assert sine.fundamental_at_limit == pytest.approx(sine.kept)
    assert sine.amplitude_fundamental == pytest.approx(sine.amplitude_kept)


def test_the_fundamental_of_a_bent_friction_is_measured_over_whole_periods() -> None:
    stroke = Stroke(0.1, 9.3e-3)
    texture = Amplitude(SquareWave(2e-3), 0.0, 2e-6)
    trace = friction_trace(texture, stroke, TAU, falling)
    slower = friction_trace(texture, Stroke(0.1, 22e-3), TAU, falling)
    for signal in ("amplitude", "relative_friction"):
        kept = fundamental_kept(trace, signal)  # type: ignore[arg-type]
        assert kept == pytest.approx(fundamental_kept(slower, signal), rel=1e-3)  # type: ignore[arg-type]
        assert kept < swing_kept(trace, signal)  # type: ignore[arg-type]
