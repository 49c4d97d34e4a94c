"""The report's numbers against what a lag, a shift, a blur and an inverse must give."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from tests.verification.square_swing import square_swing_compensated

from squeezefilm.core.quantities import FloatArray
from squeezefilm.physics.render.fidelity.rendered_stroke import RenderedStroke, rendered_stroke
from squeezefilm.physics.render.fidelity.report import fidelity_report
from squeezefilm.physics.render.motion.estimator import (
    LVDT_10_KHZ,
    SENSORS,
    SensorModel,
)
from squeezefilm.physics.render.motion.stroke import MinimumJerkStroke, Stroke
from squeezefilm.physics.render.resonator.envelope import (
    DrivenEnvelope,
    sine_swing_kept,
)
from squeezefilm.physics.render.texture.levels import Amplitude
from squeezefilm.physics.render.texture.shapes import SineWave, SquareWave

LIMIT, TAU = 1e-6, 0.57e-3
FREE = DrivenEnvelope(TAU, TAU, 100 * LIMIT, braking=True)
TIGHT = DrivenEnvelope(TAU, TAU, LIMIT, braking=True)


def straight(amplitude: FloatArray, speed: object = None) -> FloatArray:
    return np.asarray(1 - amplitude / (2.5 * LIMIT))


@pytest.mark.parametrize("period", [0.4e-3, 1e-3, 4e-3])
def test_open_loop_a_sine_keeps_and_trails_as_a_first_order_lag(period: float) -> None:
    speed = 0.1
    stroke = rendered_stroke(
        Amplitude(SineWave(period), 0.0, LIMIT),
        Stroke(speed, 0.04, 2),
        TIGHT,
        straight,
        control_rate=200e3,
    )
    report = fidelity_report(stroke)
    kept = sine_swing_kept(period, speed, TAU)
    assert report.contrast_kept[0] == pytest.approx(kept, rel=1e-3)
    assert report.swing_kept[0] == pytest.approx(kept, rel=1e-3)
    assert np.all(np.isnan(report.contrast_kept[1:]))  # a sine has no harmonics to keep
    omega = 2 * math.pi * speed / period
    assert report.lag == pytest.approx(math.atan(omega * TAU) / omega * speed, rel=0.01)
    assert report.lag_time == pytest.approx(report.lag / speed, rel=1e-4)
    # |1 − H| of a first-order lag, as a share of the sine's own deviation.
    assert report.relative_error == pytest.approx(
        omega * TAU / math.hypot(1, omega * TAU), rel=5e-3
    )


def test_open_loop_every_harmonic_of_a_square_keeps_what_the_lag_leaves_it() -> None:
    stroke = rendered_stroke(
        Amplitude(SquareWave(2e-3), 0.0, LIMIT),
        Stroke(0.1, 0.04, 3),
        TIGHT,
        straight,
        control_rate=200e3,
    )
    report = fidelity_report(stroke)
    omega = 2 * math.pi * 0.1 * report.spatial_frequency
    assert report.contrast_kept == pytest.approx(1 / np.hypot(1, omega * TAU), rel=3e-3)


def test_the_inverse_renders_what_is_wanted_where_nothing_saturates() -> None:
    for compensation in ("inverse", "preview"):
        stroke = rendered_stroke(
            Amplitude(SineWave(1e-3), 0.0, LIMIT),
            Stroke(0.1),
            FREE,
            straight,
            compensation=compensation,
        )
        report = fidelity_report(stroke)
        assert report.relative_error < 1e-6
        assert report.contrast_kept[0] == pytest.approx(1.0, abs=1e-6)
        assert report.saturated_top == report.saturated_bottom == 0.0
        assert abs(report.lag) < 1e-6


def test_a_saturated_square_keeps_the_swing_of_the_closed_form() -> None:
    period, speed = 0.4e-3, 0.2763
    stroke = rendered_stroke(
        Amplitude(SquareWave(period), 0.0, 0.8 * LIMIT), Stroke(speed, 0.04), TIGHT, straight,
        compensation="inverse", control_rate=250 * speed / period,
    )  # fmt: skip
    late = stroke.time > 20 * TAU
    law = square_swing_compensated(period, speed, TIGHT, 0.0, 0.8 * LIMIT)
    assert np.ptp(stroke.amplitude[late]) / (0.8 * LIMIT) == pytest.approx(law, abs=0.01)


def shifted(stroke: RenderedStroke, by: float) -> RenderedStroke:
    """The same stroke with what was wanted a little way back rendered, in either direction."""
    back = stroke.position - by * np.sign(stroke.speed)
    late = stroke.texture(back, 0.0, 0.0, 0.0)
    return dataclasses.replace(stroke, relative_friction_rendered=straight(late))


@pytest.mark.parametrize("by", [-0.3e-3, 0.0, 0.05e-3, 0.4e-3])
def test_a_known_shift_is_found_in_either_direction(by: float) -> None:
    stroke = rendered_stroke(
        Amplitude(SineWave(2e-3), 0.0, LIMIT), Stroke(0.1, 0.04, 4), TIGHT, straight
    )
    report = fidelity_report(shifted(stroke, by))
    assert report.lag == pytest.approx(by, abs=2e-6)
    # All of it is there, only elsewhere.
    assert report.contrast_kept[0] == pytest.approx(1.0, abs=0.01)


def test_a_position_error_blurs_a_sine_by_its_gaussian() -> None:
    """Coherent contrast exp(−(2πσ/λ)²/2), σ the estimate's RMS error; nothing else is lost."""
    sensor = SensorModel("tested", 1000.0, 20e-3, noise=0.15e-3)
    kept, expected = [], []
    for period in (1e-3, 2e-3, 4e-3):
        stroke = rendered_stroke(
            Amplitude(SineWave(period), 0.0, LIMIT), Stroke(0.1, 2.0), FREE, straight,
            compensation="inverse", sensor=sensor, seed=5, control_rate=5e3,
        )  # fmt: skip
        report = fidelity_report(stroke)
        assert report.position_error is not None
        kept.append(float(report.contrast_kept[0]))
        expected.append(math.exp(-((2 * math.pi * report.position_error / period) ** 2) / 2))
    assert kept == pytest.approx(expected, abs=0.05)
    assert kept[0] < 0.8 < kept[-1]


def test_fast_sensors_render_in_place_what_slow_ones_do_not() -> None:
    reports = [
        fidelity_report(
            rendered_stroke(
                Amplitude(SquareWave(1e-3), 0.0, 0.8 * LIMIT),
                MinimumJerkStroke(passes=10), TIGHT, straight,
                compensation="inverse", sensor=sensor,
            )
        )
        for sensor in SENSORS.values()
    ]  # fmt: skip
    contrasts = [float(report.contrast_kept[0]) for report in reports]
    errors = [report.position_error for report in reports]
    assert contrasts[-1] > 0.95
    assert contrasts[0] < 0.2
    assert errors == sorted(errors, reverse=True)  # type: ignore[type-var]


def test_preview_with_a_good_sensor_takes_the_lag_away() -> None:
    lags, errors = [], []
    for compensation in ("none", "inverse", "preview"):
        stroke = rendered_stroke(
            Amplitude(SquareWave(0.4e-3), 0.0, 0.8 * LIMIT), Stroke(0.2, 0.04, 4), TIGHT, straight,
            compensation=compensation, sensor=LVDT_10_KHZ, control_rate=40e3,
        )  # fmt: skip
        report = fidelity_report(stroke)
        lags.append(report.lag)
        errors.append(report.relative_error)
    assert lags[0] > lags[1] > 10 * abs(lags[2])
    assert errors[0] > errors[1] > errors[2]
