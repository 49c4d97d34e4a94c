"""Thresholds of friction modulation: closed forms, the published medians, and how rivals part."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from squeezefilm.core import presets
from squeezefilm.core.errors import InputError
from squeezefilm.measure.recordings.kinds import DetectionThresholds
from squeezefilm.measure.recordings.read import read_recording
from squeezefilm.physics.contact.finger.fingertip import (
    FingerpadDynamics,
    skin_displacement_per_friction,
)
from squeezefilm.physics.perception.observer import (
    TUNED_AT,
    Observer,
    SensoryChannel,
    load_observer,
)
from squeezefilm.validation.populations import (
    METHOD_RATIO,
    RIVALS,
    compare_detection,
    detection_medians,
    detection_threshold,
    rival_observer,
)

OBSERVER = load_observer()
PERIODS = np.array([8.0, 4.0, 2.0, 1.0, 0.5, 0.25]) * 1e-3


@pytest.fixture(scope="module")
def measured() -> DetectionThresholds:
    found = read_recording(presets.friction_folder() / "bernard2020-detection.toml")
    assert isinstance(found, DetectionThresholds)
    return found


def through_skin(period: np.ndarray, speed: float, force: float) -> np.ndarray:
    """Skin displacement per friction force (m/N) of sines of these periods."""
    pad = FingerpadDynamics.pressed(force)
    moved = skin_displacement_per_friction(speed / period, pad.stiffness, pad.damping, pad.mass)
    return np.abs(moved)


def single(**changed: float) -> Observer:
    channel = SensoryChannel("all", 0.0, 1e9, 2e-6, **changed)  # type: ignore[arg-type]
    return dataclasses.replace(OBSERVER, channels=(channel,))


def test_one_channel_is_a_closed_form() -> None:
    """A threshold of 2 µm of skin; and one that masking alone makes, which knows no force."""
    found = detection_threshold(single(), PERIODS, 0.08, 0.6)
    expected = 2e-6 / (0.6 * through_skin(PERIODS, 0.08, 0.6))
    assert found == pytest.approx(expected, rel=1e-6)
    masked = dataclasses.replace(
        OBSERVER, channels=(SensoryChannel("all", 0.0, 1e9, 1e-15, masking=0.01),)
    )
    slow = detection_threshold(masked, np.array([0.1]), 0.001, 0.6, 0.8)
    assert slow == pytest.approx(0.01 * 0.8, rel=1e-3)
    assert detection_threshold(masked, np.array([0.1]), 0.001, 0.3, 0.8) == pytest.approx(slow)


def test_five_of_seven_medians_are_met_within_a_factor_of_one_and_a_half(
    measured: DetectionThresholds,
) -> None:
    off = np.abs(np.log(detection_medians(OBSERVER, measured) / measured.amplitude))
    assert np.count_nonzero(off < math.log(1.5)) >= 5
    assert off.max() < math.log(2.0)
    # The preset goes by frequency.
    compared = compare_detection(measured)
    assert dict(compared.rivals)["temporal"] == pytest.approx(detection_medians(OBSERVER, measured))
    summary = compared.summary()
    assert list(summary["rivals_friction_coefficient"]) == list(RIVALS)
    assert summary["recording"]["source"].startswith("Bernard")


def test_rivals_are_alike_at_one_speed_and_part_at_another(measured: DetectionThresholds) -> None:
    at, twice = (
        {
            rival: detection_medians(
                rival_observer(OBSERVER, rival), measured, speed=speed, period=PERIODS
            )
            for rival in RIVALS
        }
        for speed in (TUNED_AT, 2 * TUNED_AT)
    )
    for rival in RIVALS:
        assert at[rival] == pytest.approx(at["temporal"])
    # By frequency: twice the period at twice the speed is the same.
    assert twice["temporal"][:-1] == pytest.approx(at["temporal"][1:])
    # By period: the same but for what the skin passes on, which goes by frequency with all.
    skin = through_skin(PERIODS, TUNED_AT, 0.68) / through_skin(PERIODS, 2 * TUNED_AT, 0.68)
    assert twice["spatial"] == pytest.approx(at["spatial"] * skin)
    # Half by either: the sense of √2 times the speed.
    half = detection_threshold(OBSERVER, PERIODS, math.sqrt(2) * TUNED_AT, 0.68)
    skin = through_skin(PERIODS, math.sqrt(2) * TUNED_AT, 0.68) / through_skin(
        PERIODS, 2 * TUNED_AT, 0.68
    )
    assert twice["mixed"] == pytest.approx(METHOD_RATIO * half * skin)


def test_what_is_no_rival_and_no_threshold_is_refused(measured: DetectionThresholds) -> None:
    with pytest.raises(InputError, match="temporal"):
        rival_observer(OBSERVER, "spectral")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="normal_force"):
        detection_threshold(OBSERVER, PERIODS, 0.05, 3.0)
    with pytest.raises(InputError, match="amplitude"):
        dataclasses.replace(measured, amplitude=-measured.amplitude)
    with pytest.raises(InputError, match="period"):
        dataclasses.replace(measured, period=measured.period[1:])


def test_the_published_pad_at_half_a_newton_is_the_default_one() -> None:
    pad, default = FingerpadDynamics.pressed(0.5), FingerpadDynamics()
    for name in ("stiffness", "damping", "mass"):
        assert getattr(pad, name) == pytest.approx(getattr(default, name), rel=1e-2)
    assert FingerpadDynamics.pressed(1.0).stiffness == 1480.0


def test_a_transient_of_eleven_per_cent_is_told_by_the_same_senses() -> None:
    """Gueorguiev 2017: a fall of friction by 0.11 of itself is detected, whatever the friction. Two
    such steps in a stroke of 4 cm have lines at every odd harmonic; nothing is fitted to it."""
    pad = FingerpadDynamics()
    order = np.arange(1, 1001, 2)
    found = []
    for friction in (0.2, 0.4):
        period = 0.04 / order
        moved = skin_displacement_per_friction(0.08 / period, pad.stiffness, pad.damping, pad.mass)
        skin = 2 / math.pi * 0.11 * friction / order * np.abs(moved)
        power = sum(
            np.sum((c.gain(period, 0.08) * skin / c.noise(friction / pad.stiffness)) ** 2)
            for c in OBSERVER.channels
        )
        found.append(math.sqrt(power / 2))
    # One step of the two; 0.95 is 75 % of two intervals.
    assert 0.95 / 2 < found[0] < 2 * 0.95
    assert found[0] == pytest.approx(found[1], rel=0.1)
