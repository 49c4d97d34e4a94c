"""Sensors without a device: a recording played by a clock, and events from outside."""

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.instruments.device.ports import FingerSample, ReplaySensor, Sensor


def test_a_recording_comes_when_its_time_has_come() -> None:
    now = [100.0]
    time = np.array([5.0, 5.01, 5.03])
    replay = ReplaySensor(
        time, np.array([1.0, 2.0, 3.0]) * 1e-3, np.zeros(3), np.array([1, 0, 1.0]), lambda: now[0]
    )
    sensor: Sensor = replay
    assert sensor.read() == FingerSample(100.0, 1e-3, 0.0, True)
    assert sensor.read() is None
    now[0] = 100.0099
    assert sensor.read() is None
    now[0] = 100.01
    assert sensor.read() == FingerSample(pytest.approx(100.01), 2e-3, 0.0, False)
    assert not replay.ended
    now[0] = 107.0
    assert sensor.read() == FingerSample(pytest.approx(100.03), 3e-3, 0.0, True)
    assert replay.ended
    assert sensor.read() is None


def test_a_reader_who_is_late_gets_the_newest() -> None:
    now = [0.0]
    x = np.arange(1000) * 1e-6
    sensor = ReplaySensor(np.arange(1000) * 1e-3, x, x, clock=lambda: now[0])
    seen = []
    while now[0] < 2.0:
        sample = sensor.read()
        seen += [] if sample is None else [sample.x]
        now[0] += 7e-3
    assert seen == sorted(set(seen))
    assert seen[-1] == pytest.approx(999e-6)
    assert len(seen) == pytest.approx(1000 / 7, abs=2)


@pytest.mark.parametrize(
    ("time", "x", "words"),
    [
        ([0.0, 1.0, 1.0], [0.0, 0.0, 0.0], "does not rise at sample 2"),
        ([0.0, 1.0], [0.0, 0.0, 0.0], "one shape"),
        ([], [], "n at least 1"),
        ([0.0, float("nan")], [0.0, 0.0], "time"),
        ([0.0, 1.0], [0.0, float("inf")], "x"),
    ],
)
def test_recordings_that_cannot_be_played(time: list[float], x: list[float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        ReplaySensor(np.array(time), np.array(x), np.zeros(len(x)))
