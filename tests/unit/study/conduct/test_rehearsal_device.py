"""The twin as a study's device: it measures, it can be off, and its hand explores."""

from __future__ import annotations

import dataclasses
import io
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import DeviceError
from squeezefilm.core.results import config_hash
from squeezefilm.instruments.bench.setup import KnownDevice
from squeezefilm.instruments.session.play.plan import Ending
from squeezefilm.instruments.twin.hand import hand_from
from squeezefilm.instruments.twin.settings import PickupModel, PlateDrift, TwinSettings
from squeezefilm.instruments.twin.working_point import WorkingPoint, working_point
from squeezefilm.physics.display import load_display
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.physics.render.motion.sensor import LVDT_10_KHZ
from squeezefilm.physics.texture_files.texture_file import TextureFile
from squeezefilm.study.conduct import rehearsal_device as module
from squeezefilm.study.conduct.rehearsal_device import StudyTwin
from squeezefilm.study.conduct.study_device import TrialMotion

DISPLAY = load_display("biet2008-plate")
SETTINGS = TwinSettings(sensor=LVDT_10_KHZ, pickup=PickupModel(kind="sensing_patch"))


@pytest.fixture(scope="module")
def point() -> WorkingPoint:
    """The plate solved once."""
    return working_point(DISPLAY, TwinSettings())


def _twin(point: WorkingPoint, **changed: object) -> StudyTwin:
    settings = dataclasses.replace(SETTINGS, **changed)  # type: ignore[arg-type]
    return StudyTwin(DISPLAY, settings, point=point)


def test_a_twin_as_described_is_in_order(point: WorkingPoint) -> None:
    found = _twin(point).verify_device()
    assert found.passed
    # The plate drifts by 1e-4 per kelvin, and the parabola errs by little.
    assert found.resonance_frequency == pytest.approx(found.expected_resonance_frequency, rel=5e-4)
    assert found.amplitude == pytest.approx(found.expected_amplitude, rel=5e-3)


def test_a_twin_that_hears_its_motional_current_is_in_order(point: WorkingPoint) -> None:
    """What `TwinSettings` has by itself: its pickup is calibrated otherwise than a patch."""
    found = _twin(point, pickup=PickupModel()).verify_device()
    assert found.passed
    assert found.amplitude == pytest.approx(found.expected_amplitude, rel=0.01)


def test_a_weak_and_a_detuned_twin_are_off(point: WorkingPoint) -> None:
    weak = _twin(point, drift=PlateDrift(quality_factor_ratio=0.7)).verify_device()
    assert "amplitude" in weak.problems[0]
    assert weak.amplitude == pytest.approx(0.7 * weak.expected_amplitude, rel=0.01)
    off = _twin(point, drift=PlateDrift(offset=0.02)).verify_device()
    assert [one.split()[0] for one in off.problems] == ["resonance"]
    far = _twin(point, drift=PlateDrift(offset=0.2)).verify_device()
    assert len(far.problems) == 2
    blind = _twin(point, pickup=PickupModel(kind="none")).verify_device()
    assert not blind.measurable


@pytest.mark.slow
def test_the_hand_feels_the_grating_that_is_presented(point: WorkingPoint) -> None:
    twin = _twin(point)
    assert twin.stop().trace == ""
    found = {}
    for name, stimulus in (
        ("square", Stimulus("10 mm", 10e-3, "period", low=0.8)),
        ("flat", Stimulus("flat", 10e-3, "period", waveform="constant")),
    ):
        twin.present(stimulus, seed=1)
        felt = twin.stop()
        # There and back over 60 mm.
        assert felt.path_length == pytest.approx(0.12, rel=0.05)
        assert felt.mean_speed == pytest.approx(0.08, rel=0.05)
        assert felt.mean_normal_force == 0.5
        names = felt.trace.splitlines()[1].split(",")
        rows = np.genfromtxt(io.StringIO(felt.trace), delimiter=",", skip_header=2)
        found[name] = dict(zip(names, rows.T, strict=True))
    assert np.nanmin(found["flat"]["relative_friction"]) > 0.99
    x, friction = found["square"]["x_m"], found["square"]["relative_friction"]
    # Where it turns the finger is slower than the loop thinks, and feels less friction.
    known = np.isfinite(friction) & (found["square"]["speed_m_per_s"] > 20e-3)
    assert np.min(friction[known]) == pytest.approx(0.8, abs=0.05)
    assert np.nanmax(friction) > 0.98
    # The place in the period that is slippery: the second half.
    inside = (x / 10e-3) % 1.0
    groove = known & (inside > 0.6) & (inside < 0.9)
    ridge = known & (inside > 0.1) & (inside < 0.4)
    assert np.median(friction[groove]) < np.median(friction[ridge]) - 0.1


def test_a_surface_is_explored_once_and_says_by_what(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is played and for how long; the play itself is asked above."""
    played: list[Any] = []
    outcome = SimpleNamespace(ending=Ending.DURATION, message="as planned")

    def play(plan: Any, device: Any, path: Path, about: dict[str, str], duration: float) -> Any:
        assert path.parent.is_dir()
        assert device is hand
        played.append((plan, about, duration))
        return outcome

    def setup(display: Any, texture: TextureFile, device: KnownDevice) -> Any:
        assert (display, device) == (DISPLAY, KnownDevice(LVDT_10_KHZ, twin=True))
        return SimpleNamespace(plan=texture.title)

    monkeypatch.setattr(module, "virtual_play", play)
    monkeypatch.setattr(module, "play_setup", setup)
    monkeypatch.setattr(StudyTwin, "_twin", lambda _, hand: hand)
    monkeypatch.setattr(module, "read_trace", lambda path: path.name)
    motion = lambda trace, name: TrialMotion(0.12, raw_trace=f"{trace}/{name}")  # noqa: E731
    monkeypatch.setattr(module, "explored", motion)
    hand = hand_from("60 mm in 0.75 s", normal_force=0.7, begin=0.3, repeats=3)
    solved: Any = object()
    twin = StudyTwin(DISPLAY, SETTINGS, hand, solved)
    assert twin.stop() == TrialMotion()
    assert played == []
    fine = Stimulus("fine", 4e-3, "period", low=0.8)
    twin.present(fine, seed=1)
    felt = twin.stop()
    assert (felt.path_length, felt.raw_trace, felt.mean_normal_force) == (0.12, "trace.sqft/", 0.7)
    ((plan, about, duration),) = played
    assert plan == "fine"
    assert duration == pytest.approx(0.3 + 3 * 0.75)
    assert about == {
        "device": "rehearsal", "settings_sha256": config_hash(SETTINGS), "stimulus": "fine",
        "surface_sha256": fine.surface_sha256,
    }  # fmt: skip
    # One that was explored is not explored again.
    assert twin.stop() == TrialMotion()
    assert len(played) == 1
    twin.present(fine, seed=1)
    outcome.ending, outcome.message = Ending.FAULT, "too hot"
    with pytest.raises(DeviceError, match=f"the twin stopped: {Ending.FAULT.value} .too hot."):
        twin.stop()
