"""What reaches an ear, beside every limit."""

from __future__ import annotations

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.design.analysis import ears
from squeezefilm.design.analysis.ears import (
    EarExposure,
    MODEL_ERROR_dB,
    ear_exposure,
    moving_surface,
)
from squeezefilm.design.analysis.verdict import ears_finding
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.sound import GUIDANCE, Loudest, exposure_guidance


@pytest.fixture(scope="module")
def disc() -> Display:
    return load_display("winfield2007-tpad")


@pytest.mark.slow
def test_a_disc_is_heard_in_proportion_to_its_amplitude(disc: Display) -> None:
    p = predict(disc)
    found = ear_exposure(disc, p)
    twice = ear_exposure(disc, predict(disc, voltage=2 * disc.drive.voltage))
    assert found is not None
    assert twice is not None
    assert twice.level_dB - found.level_dB == pytest.approx(20 * math.log10(2), abs=1e-6)
    assert (found.low_dB, found.high_dB) == pytest.approx(
        (found.level_dB - MODEL_ERROR_dB, found.level_dB + MODEL_ERROR_dB)
    )
    surface = moving_surface(disc, p)
    assert surface is not None
    top = 2 * np.pi * p.frequency * p.touch.free_amplitude
    assert np.abs(surface.velocity).max() == pytest.approx(top, rel=1e-6)


def test_the_interval_of_the_amplitude_and_the_duty_are_in_the_verdict(
    disc: Display, monkeypatch: pytest.MonkeyPatch
) -> None:
    p = predict(disc)
    at: list[float] = []
    monkeypatch.setattr(ears, "loudest", lambda *_: Loudest(at[-1], 0.0, 0.0))

    def heard(duty: float = 1.0, spread: float = 2.0) -> EarExposure:
        drive = dataclasses.replace(disc.drive, duty=duty)
        a = p.vibration_amplitude
        unsure: Any = SimpleNamespace(amplitude_interval=(a / spread, a * spread))
        found = ear_exposure(dataclasses.replace(disc, drive=drive), p, unsure)
        assert found is not None
        return found

    limit = exposure_guidance(p.frequency)
    assert limit is not None
    reach = 20 * math.log10(2) + MODEL_ERROR_dB
    for level, standing, kind in (
        (limit.level_dB - reach - 0.1, "below", "good"),
        (limit.level_dB - reach + 0.1, "open", "doubt"),
        (limit.level_dB + reach - 0.1, "open", "doubt"),
        (limit.level_dB + reach + 0.1, "above", "limit"),
    ):
        at.append(level)
        found = heard()
        assert (found.standing, ears_finding(found).kind) == (standing, kind)
    # Driven for a tenth of the time the mean square is 10 dB less: above is open then.
    rare = heard(duty=0.1)
    assert rare.standing == "open"
    assert rare.mean_dB == pytest.approx(at[-1] - 10)
    assert "driven 10% of the time" in rare.sentence
    assert "public (IRPA 1984)" in rare.sentence


def test_what_is_not_known_is_said(disc: Display) -> None:
    assert ear_exposure(disc, predict(disc, vibration_amplitude=1e-6)) is None
    assert ear_exposure(disc, predict(disc, voltage=0.0)) is None
    assert ear_exposure(load_display("biet2008-stator"), predict("biet2008-stator")) is None
    assert ears_finding(None).kind == "doubt"
    whistle = EarExposure(10.8e3, 0.5, 1.0, 100.0, 94.0, 106.0, ())
    assert ears_finding(whistle).kind == "limit"
    assert "People hear this frequency" in whistle.sentence
    far = EarExposure(200e3, 0.5, 1.0, 100.0, 94.0, 106.0, ())
    assert "No guidance was found" in far.sentence
    assert ears_finding(far).kind == "doubt"


def test_every_limit_says_what_was_read() -> None:
    assert {one.audience for one in GUIDANCE} == {"public", "occupational"}
    assert all("to be checked" in one.evidence and one.name for one in GUIDANCE)
