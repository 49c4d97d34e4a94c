"""What is felt of a square grating, against closed forms and the whole chain of a percept."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.contact.finger.fingertip import FingerpadDynamics
from squeezefilm.physics.display import load_display
from squeezefilm.physics.perception.observer import (
    FingerClass,
    Observer,
    SensoryChannel,
    load_observer,
)
from squeezefilm.physics.perception.percepts import Apparatus, percept
from squeezefilm.physics.perception.senses import (
    SETTLING,
    Rubbed,
    finest_felt,
    grating_evidence,
    switched_amplitude,
    tried_periods,
)
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.physics.render.motion.stroke import MinimumJerkStroke


@pytest.fixture(scope="module")
def observer() -> Observer:
    return load_observer()


def test_the_amplitude_settles_between_its_ends() -> None:
    passage = np.array([1e-4, 1e-3, 1.0])
    found = switched_amplitude(passage, 0.5e-3, 2e-6)
    assert found.shape == (3, 256)
    # Swing kept of a square wave: tanh(T/4τ); its mean is half the amplitude.
    top = found[:, 127:129].max(axis=1)
    assert found.mean(axis=1) == pytest.approx(np.full(3, 1e-6), rel=2e-2)
    swing = 2e-6 * np.tanh(passage / 4 / 0.5e-3)
    assert 2 * (top - 1e-6) == pytest.approx(swing, rel=3e-2)
    assert found[2].max() == pytest.approx(2e-6)


def test_one_channel_and_a_slow_grating_are_a_closed_form(observer: Observer) -> None:
    """Without an envelope the fundamental of a square swing S is S/π zero-to-peak on each side."""
    channel = SensoryChannel("all", 0.0, 1e6, 1e-6)
    plain = dataclasses.replace(observer, channels=(channel,), harmonics=1)
    pad = FingerpadDynamics(1000.0, 0.0, 1e-7)
    amplitude = switched_amplitude(np.array([100.0]), 1e-6, 2e-6)
    rubbed = Rubbed(0.45, pad, 0.01)
    found = grating_evidence(
        plain, np.array([2e-3]), amplitude, lambda a: 1 - 0.3 * a / 2e-6, rubbed
    )
    skin = 2 / math.pi * 0.3 * 0.45 / 1000.0
    assert found == pytest.approx([skin / 1e-6], rel=1e-3)
    # In noise that grows with the mean stretch d′ no longer depends on the force.
    blunt = dataclasses.replace(plain, channels=(dataclasses.replace(channel, masking=0.5),))
    weak, strong = (
        grating_evidence(
            blunt,
            np.array([2e-3]),
            amplitude,
            lambda a: 1 - 0.3 * a / 2e-6,
            dataclasses.replace(rubbed, friction=force),
        )
        for force in (0.3, 3.0)
    )
    assert weak == pytest.approx(strong, rel=1e-2)


def test_the_finest_that_reaches_the_criterion(observer: Observer) -> None:
    period = tried_periods()
    assert (period[0], period[-1]) == pytest.approx((0.125e-3, 20e-3))
    d_prime = np.where(period > 1e-3, 2.0, 0.5)
    assert finest_felt(observer, period, d_prime) == period[np.argmax(period > 1e-3)]
    assert finest_felt(observer, period, 0 * d_prime) == math.inf


@pytest.mark.slow
@pytest.mark.parametrize("period", [2e-3, 4e-3])
def test_it_is_what_the_whole_chain_gives_at_the_speeds_of_a_stroke(
    observer: Observer, period: float
) -> None:
    """Within 15 % of the percept of a rendered stroke, the standing wave left out of it: d′ at the
    speeds that the stroke has along its way, as a root mean square."""
    display = load_display("biet2008-plate")
    own = display.finger
    finger = FingerClass(own.contact_length, own.ridge_angle, own.moisture, 0.5, 0.08)
    whole, _ = percept(
        display, Stimulus("it", period, "period"), observer, finger, Apparatus(wave="ignored")
    )
    p = predict(display)
    q = predict(display, vibration_amplitude=p.law.amplitude_for(0.7), speed=0.08)
    stroke = MinimumJerkStroke(observer.stroke_length, observer.stroke_length / 0.08, 1)
    time = np.linspace(0.0, stroke.pass_duration, 2001)
    place = stroke.position(time)
    way = np.linspace(SETTLING, observer.stroke_length - 1e-5, 41)
    found = [
        grating_evidence(
            observer,
            np.array([period]),
            switched_amplitude(
                np.array([period]) / speed, p.envelope_time_constant, q.vibration_amplitude
            ),
            lambda a: q.friction(a, np.full(a.shape, 0.08)),
            Rubbed(q.friction_coefficient * 0.5, own.fingerpad, speed),
        )
        for speed in np.interp(way, place, np.gradient(place, time)).tolist()
    ]
    d_prime = np.sqrt(np.mean(np.square(found)))
    assert d_prime == pytest.approx(whole.evidence.at(period), rel=0.15)
