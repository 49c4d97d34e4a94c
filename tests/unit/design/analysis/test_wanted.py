"""The voltage that a wanted friction takes, over the draws: the inverse of their friction."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from squeezefilm.core.errors import OutOfRangeError, UnreachableError
from squeezefilm.design.analysis import wanted as room
from squeezefilm.design.analysis.wanted import (
    VoltageInterval,
    Wanted,
    uncertain_voltage,
    wanted_friction,
)
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.uncertainty.draws import Mixture, outcome_of
from squeezefilm.physics.uncertainty.free_amplitude import FreeAmplitude
from squeezefilm.physics.uncertainty.intervals import evaluate
from squeezefilm.physics.uncertainty.uncertainty import POINTS, sobol_points


@pytest.fixture(scope="module")
def point(stator: Display) -> Prediction:
    return predict(stator)


@pytest.fixture(scope="module")
def half(stator: Display, point: Prediction) -> VoltageInterval:
    return uncertain_voltage(stator, point, 0.5, samples=8)


def test_at_its_voltage_each_draw_has_the_friction(
    stator: Display, point: Prediction, half: VoltageInterval
) -> None:
    mixture = Mixture(stator, point, driven=True)
    scale = FreeAmplitude(stator, point)
    points = sobol_points(mixture, 8 * POINTS, 1)
    checked = 0
    for draw, volts in zip(mixture.draws(points), half.voltages, strict=True):
        if not np.isfinite(volts):
            continue
        assert point.voltage is not None
        free = scale(draw.display) * volts / point.voltage
        assert outcome_of(mixture, draw, free).friction == pytest.approx(0.5, abs=2e-3)
        checked += 1
    assert checked >= 7 * POINTS


def test_as_many_reach_it_at_the_drives_voltage_as_lie_below_it_there(
    stator: Display, point: Prediction, half: VoltageInterval
) -> None:
    """The interval of the voltage and that of the friction are of the same draws."""
    mixture = Mixture(stator, point, driven=True)
    drawn, _ = evaluate(mixture, sobol_points(mixture, 8 * POINTS, 1), lambda _: None)
    assert 1 - half.beyond == pytest.approx(np.mean(drawn.friction <= 0.5))
    assert half.limit == stator.drive.voltage
    low, high = half.interval
    assert low is not None
    assert half.median is not None
    assert 0 < low < half.median
    assert high is None or high > half.median


def test_a_driven_plate_has_its_finger_in_the_voltage() -> None:
    """As described the voltage of a draw is that of `voltage_for_friction`."""
    plate = load_display("biet2008-plate")
    p = predict(plate, theory="timoshenko")
    law = p.law
    amplitude = law.amplitude_for(0.6)
    mixture = Mixture(plate, p, driven=True)
    draw = mixture.made({}, {})
    assert room._amplitude(mixture.law(draw), draw, 0.6, 1e-6) == pytest.approx(amplitude, rel=1e-3)
    assert room._amplitude(mixture.law(draw), draw, 0.6, 20e-6) == pytest.approx(
        amplitude, rel=1e-3
    )
    assert room._amplitude(mixture.law(draw), draw, 1e-6, 1e-6) == np.inf


def test_what_it_takes_is_said(stator: Display, point: Prediction, half: VoltageInterval) -> None:
    found = dataclasses.replace(
        half, interval=(20.0, None), median=77.0, beyond=0.22, never=0.05, limit=140.0
    )
    wanted = Wanted(0.5, 1.1e-6, 76.9, uncertain=found)
    said = wanted.summary()
    assert said["voltage_interval_V"] == [20.0, None]
    assert said["share_beyond_drive"] == 0.22
    short = wanted_friction(stator, point, 0.5, samples=0)
    assert (short.uncertain, short.why_no_interval) == (None, "")
    assert wanted_friction(stator, point, 1.0).why_no_interval == "nothing is wanted"


def test_what_nothing_reaches_is_refused_or_said(
    stator: Display, point: Prediction, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(UnreachableError):
        wanted_friction(stator, point, 1e-9, samples=0)
    said = wanted_friction(stator, point, 1e-9, samples=0, strict=False)
    assert said.voltage is None
    assert "not reached by any" in said.why_not

    def refuse(*_: object, **__: object) -> None:
        raise OutOfRangeError("too many are refused")

    monkeypatch.setattr(room, "uncertain_voltage", refuse)
    found = wanted_friction(stator, point, 0.5)
    assert found.voltage is not None
    assert found.why_no_interval == "too many are refused"
