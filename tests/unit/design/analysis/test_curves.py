"""The curves of an analysis against closed forms, and where they end."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.design.analysis.curves import (
    PAPER_CRITERION,
    WavelengthCurve,
    frequency_response,
    friction_curve,
    pressure_profiles,
    wavelength_curves,
)
from squeezefilm.physics.chain.friction import friction_law
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.display import load_display

STATOR = load_display("biet2008-stator")


@pytest.fixture(scope="module")
def point() -> Prediction:
    return predict(STATOR, model="paper2008")


def test_a_measured_mode_responds_as_a_resonator(point: Prediction) -> None:
    found = frequency_response(point)
    assert found.frequency.size == 601
    top = int(np.argmax(found.amplitude_per_volt))
    assert found.frequency[top] == pytest.approx(40.5e3, rel=1e-4)
    assert found.amplitude_per_volt[top] == pytest.approx(2e-6 / 140, rel=1e-3)
    wide = found.frequency[found.amplitude_per_volt > found.amplitude_per_volt[top] / np.sqrt(2)]
    assert np.ptp(wide) == pytest.approx(40.5e3 / 200, rel=0.1)
    assert found.model == point.mode.model


def test_a_solved_mode_responds_as_solved_at_its_lobe(point: Prediction) -> None:
    frequencies = np.array([1.0, 2.0])
    response = SimpleNamespace(
        frequencies=frequencies, amplitude_at=lambda x, y: frequencies * (10 * x + y)
    )
    mode = SimpleNamespace(solid=SimpleNamespace(response=response, lobe=(3, 4)), model="solid")
    found = frequency_response(dataclasses.replace(point, mode=mode))
    assert found.frequency is frequencies
    assert found.amplitude_per_volt.tolist() == [34.0, 68.0]
    assert found.model == "solid"


def test_the_pressure_along_the_contact_has_the_predicted_mean(point: Prediction) -> None:
    dense = dataclasses.replace(point.law.gas, mean_free_path=1e-12)
    law = dataclasses.replace(point.law, gas=dense)
    paper, solved = pressure_profiles(dataclasses.replace(point, law=law))
    assert (paper.model, solved.model) == ("paper2008", "solved film")
    # Without slip the film's own equation has 7.246e-3, half of what its asymptote promises.
    means = point.mean_pressure - 1, 7.246e-3
    for profile, expected_mean in zip((paper, solved), means, strict=True):
        assert profile.position[[0, 2000, -1]] == pytest.approx([-5e-3, 0.0, 5e-3], abs=1e-12)
        mean = np.trapezoid(profile.mean_pressure, profile.position) / 10e-3
        assert mean - 1 == pytest.approx(expected_mean, rel=5e-3)
        # Ridges of 50 µm on the roughness and the amplitude, a groove at the centre.
        x = profile.position
        floor = 0.6e-6 + point.vibration_amplitude
        expected = floor + 50e-6 * (1 + np.cos(2 * np.pi * x / 350e-6))
        assert profile.thickness == pytest.approx(expected, rel=1e-6)
    at = int(np.argmin(np.abs(paper.position - 175e-6)))
    assert paper.mean_pressure[at] > paper.mean_pressure[2000]


def test_a_still_surface_has_no_solved_film() -> None:
    (paper,) = pressure_profiles(predict(STATOR, voltage=0.0, model="paper2008"))
    assert paper.model == "paper2008"
    assert paper.mean_pressure == pytest.approx(1.0)


def test_a_friction_curve_reaches_its_marked_points(point: Prediction) -> None:
    bare = STATOR.surface("bare")
    found = friction_curve(point, bare, "paper2008")
    assert (found.surface, found.roughness, found.model) == ("bare", bare.roughness, "paper2008")
    assert found.amplitude == pytest.approx(np.linspace(0, 10e-6, 201))
    assert found.relative_friction[0] == pytest.approx(1.0)
    law = friction_law(STATOR, 9.35e-3, 40.5e3, surface=bare, model="paper2008")
    assert found.relative_friction == pytest.approx(law.curve(found.amplitude))
    assert PAPER_CRITERION == 0.7
    assert found.amplitude_for_criterion is not None
    assert law.at(found.amplitude_for_criterion) == pytest.approx(0.7, abs=1e-6)
    assert found.zero_friction_amplitude is not None
    assert law.at(found.zero_friction_amplitude * 0.999) > 0
    assert law.at(found.zero_friction_amplitude * 1.001) == 0
    shared = friction_curve(point, bare, "partial-levitation")
    assert shared.amplitude.size == 51
    assert shared.zero_friction_amplitude is None


def test_a_curve_has_room_for_where_the_finger_floats(point: Prediction) -> None:
    adhesive = STATOR.surface("adhesive")

    def end(force: float, amplitude: float = 2e-6) -> tuple[float, float | None]:
        law = dataclasses.replace(point.law, normal_force=force)
        at = dataclasses.replace(point, law=law, vibration_amplitude=amplitude)
        found = friction_curve(at, adhesive, "paper2008")
        return float(found.amplitude[-1]), found.zero_friction_amplitude

    assert end(0.5) == (pytest.approx(10e-6), pytest.approx(7.63e-6, abs=5e-9))
    assert end(0.5, 12e-6)[0] == pytest.approx(15e-6)
    for force in (0.7, 1.0):
        top, zero = end(force)
        assert zero is not None
        assert top == pytest.approx(max(10e-6, 1.1 * min(zero, 15e-6)))
    zeros = [end(force)[1] for force in (0.7, 1.0)]
    assert 10e-6 / 1.1 < (zeros[0] or 0) < 15e-6 < (zeros[1] or 0)
    assert end(5e3) == (pytest.approx(10e-6), None)


def test_half_wavelengths_are_the_papers_with_its_amplitudes(point: Prediction) -> None:
    curves = wavelength_curves(point)
    needed = [curve.amplitude_for_criterion * 1e6 for curve in curves]
    assert needed == pytest.approx([2.33, 1.89, 1.54, 1.35], abs=5e-3)
    assert np.all(np.diff([curve.half_wavelength for curve in curves]) > 0)
    for curve in curves:
        assert curve.model == "paper2008"
        assert curve.amplitude == pytest.approx(np.linspace(0, 4e-6, 121))
        at = np.interp(curve.amplitude_for_criterion, curve.amplitude, curve.relative_friction)
        assert at == pytest.approx(0.7, abs=1e-3)

    def curves_with(**changes: Any) -> tuple[WavelengthCurve, ...]:
        law = dataclasses.replace(point.law, **changes)
        return wavelength_curves(dataclasses.replace(point, law=law))

    hard = curves_with(normal_force=0.7)
    for light, heavy in zip(curves, hard, strict=True):
        assert heavy.amplitude_for_criterion > light.amplitude_for_criterion
        assert np.all(heavy.relative_friction[1:] > light.relative_friction[1:])
    smooth = curves_with(surface=STATOR.surface("bare"))
    for rough, bare in zip(curves, smooth, strict=True):
        assert np.all(bare.relative_friction[1:] < rough.relative_friction[1:])
