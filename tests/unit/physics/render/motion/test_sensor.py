"""Sensors: what is refused, and that a stream has the rate, lateness, noise and loss it says."""

from __future__ import annotations

import dataclasses
import json
import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.results import to_json
from squeezefilm.physics.render.motion.estimator import (
    LVDT_10_KHZ,
    SENSORS,
    TOUCH_PANEL_60_HZ,
    SensorModel,
    sensor_stream,
)


def still(t: np.ndarray) -> np.ndarray:
    return np.full(t.shape, 0.02)


@pytest.mark.parametrize(
    "change",
    [
        {"rate": 0.0},
        {"rate": math.nan},
        {"latency": -1e-3},
        {"jitter": -1e-9},
        {"noise": math.inf},
        {"quantisation": -1e-6},
        {"loss": 1.0},
        {"noise": 0.0, "quantisation": 0.0},
    ],
)
def test_senseless_sensors_are_refused(change: dict[str, float]) -> None:
    with pytest.raises(InputError, match=next(iter(change))):
        dataclasses.replace(TOUCH_PANEL_60_HZ, **change)


def test_every_preset_says_that_it_is_assumed_and_becomes_strict_json() -> None:
    for name, sensor in SENSORS.items():
        assert sensor.name == name
        assert sensor.evidence == "assumed"
        data = json.loads(json.dumps(to_json(sensor), allow_nan=False))
        assert data["rate_Hz"] == sensor.rate
        assert data["latency_s"] == sensor.latency


def test_a_stream_has_the_noise_and_lateness_of_its_sensor() -> None:
    sensor = SensorModel("tested", 1000.0, 10e-3, jitter=1e-4, noise=3e-5, loss=0.2, stamped=False)
    stream = sensor_stream(sensor, still, 20.0, seed=1)
    assert stream.position.size == pytest.approx(0.8 * 20_001, rel=0.02)
    assert np.std(stream.position) == pytest.approx(3e-5, rel=0.03)
    late = stream.arrival - stream.taken
    assert np.mean(late) == pytest.approx(10e-3, rel=1e-3)
    assert np.std(late) == pytest.approx(1e-4, rel=0.03)
    assert np.all(np.diff(stream.arrival) >= 0)
    # Without a clock of its own the sensor's stamps are wrong by the jitter.
    assert np.std(stream.stamp - stream.taken) == pytest.approx(1e-4, rel=0.03)
    assert sensor.stamp_error == 1e-4


def test_quantisation_is_a_grid_and_its_error_a_twelfth_of_its_square() -> None:
    sensor = SensorModel("tested", 1000.0, 0.0, quantisation=1e-4)
    stream = sensor_stream(sensor, lambda t: 0.0123 * t, 10.0, seed=0)
    steps = stream.position / 1e-4
    assert steps == pytest.approx(np.round(steps), abs=1e-9)
    error = stream.position - 0.0123 * stream.taken
    assert np.std(error) == pytest.approx(sensor.position_error, rel=0.01)


def test_one_seed_gives_one_stream() -> None:
    one, same, other = (sensor_stream(LVDT_10_KHZ, still, 0.1, seed) for seed in (5, 5, 6))
    assert np.array_equal(one.position, same.position)
    assert not np.array_equal(one.position, other.position)
    assert one.stamp == pytest.approx(np.arange(1001) * 1e-4)


def test_what_no_motion_can_be_is_refused() -> None:
    with pytest.raises(InputError, match="shape"):
        sensor_stream(LVDT_10_KHZ, lambda t: t[:-1], 0.1, 0)
    with pytest.raises(InputError, match="position = nan"):
        sensor_stream(LVDT_10_KHZ, lambda t: t * np.nan, 0.1, 0)
    with pytest.raises(InputError, match="duration"):
        sensor_stream(LVDT_10_KHZ, still, 0.0, 0)
    with pytest.raises(InputError, match="shorter"):
        sensor_stream(LVDT_10_KHZ, still, 1e5, 0)
