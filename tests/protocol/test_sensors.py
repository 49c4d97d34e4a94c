"""A sensor without a device: a recording played by a clock."""

import numpy as np
import pytest

from squeezefilm.instruments.device.ports import FingerSample, ReplaySensor, Sensor
from squeezefilm.physics.render.motion.stroke import FingerPath


def _replay(duration: float, clock: list[float]) -> Sensor:
    time = np.array([5.0, 5.0 + duration])
    path = FingerPath(time, np.array([1e-3, 1e-3 + duration]), np.zeros(2))
    return ReplaySensor(path.place, path.duration, lambda: clock[0])


def test_a_recording_comes_when_its_time_has_come() -> None:
    now = [100.0]
    sensor = _replay(2.5e-3, now)
    assert sensor.read() == FingerSample(100.0, pytest.approx(1e-3), 0.0, True)
    assert sensor.read() is None
    now[0] = 100.00099
    assert sensor.read() is None
    now[0] = 100.001
    assert sensor.read() == FingerSample(pytest.approx(100.001), pytest.approx(2e-3), 0.0, True)
    now[0] = 107.0
    assert sensor.read() == FingerSample(pytest.approx(100.002), pytest.approx(3e-3), 0.0, True)
    assert sensor.read() is None


def test_a_reader_who_is_late_gets_the_newest() -> None:
    now = [0.0]
    sensor = _replay(1.0, now)
    seen = []
    while now[0] < 2.0:
        sample = sensor.read()
        seen += [] if sample is None else [sample.x]
        now[0] += 7e-3
    assert seen == sorted(set(seen))
    assert seen[-1] == pytest.approx(1.0)
    assert len(seen) == pytest.approx(1000 / 7, abs=2)
