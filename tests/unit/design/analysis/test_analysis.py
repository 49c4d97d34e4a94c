"""The analysis as a whole and the paper's design procedure."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.kept.store import CACHE_VARIABLE
from squeezefilm.core.results import to_json
from squeezefilm.design.analysis.analysis import KEPT, Analysis
from squeezefilm.design.analysis.analyze import analyze
from squeezefilm.design.analysis.curves import pressure_profiles
from squeezefilm.design.analysis.paper_procedure import design_plate, friction_criterion
from squeezefilm.physics.chain.friction import friction_law
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.laminate import plate_laminate
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.uncertainty.intervals import description_of


@pytest.fixture(scope="module")
def plate() -> Analysis:
    steps: list[str] = []
    analysis = analyze(load_display("biet2008-plate"), samples=8, progress=steps.append)
    assert len(steps) >= 4
    return analysis


@pytest.mark.slow
def test_the_result_is_strict_json_with_units_in_its_keys(plate: Analysis) -> None:
    text = json.dumps(plate.summary(), allow_nan=False)
    result = json.loads(text)
    # τ = Q/πf; a square of period p keeps tanh(p / 4vτ) of its swing
    tau = 60 / np.pi / result["resonance_frequency_Hz"]
    assert result["envelope_time_constant_s"] == pytest.approx(tau)
    finest = 4 * 0.1 * tau * np.arctanh(0.9)
    assert result["finest_period_m"]["100 mm/s"] == pytest.approx(finest, rel=1e-3)
    full = to_json(pressure_profiles(plate.prediction)[0])
    assert set(full) == {"position_m", "thickness_m", "mean_pressure", "model"}


def test_response_peaks_at_the_resonance_with_the_stated_amplitude(plate: Analysis) -> None:
    response, p = plate.response, plate.prediction
    top = int(np.argmax(response.amplitude_per_volt))
    assert response.frequency[top] == pytest.approx(p.mode.resonance_frequency, rel=1e-3)
    assert response.amplitude_per_volt[top] == pytest.approx(p.mode.amplitude_per_volt, rel=0.01)
    half_power = response.frequency[
        response.amplitude_per_volt > response.amplitude_per_volt[top] / np.sqrt(2)
    ]
    assert np.ptp(half_power) == pytest.approx(p.mode.resonance_frequency / 60, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["biet2008-plate", "biet2008-stator", "winfield2007-tpad"])
def test_what_takes_long_beside_an_analysis_is_found_on_disk(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = analyze(load_display(name), samples=0)
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    first.compute(KEPT, lambda _: None)
    again, steps = dataclasses.replace(first), list[str]()
    again.compute(KEPT, steps.append)
    assert steps == []
    direct = dataclasses.replace(first)
    for part in KEPT:
        assert to_json(getattr(again, part)) == to_json(getattr(direct, part))
    pressed = dataclasses.replace(first.prediction, normal_force=0.4)
    asked = {description_of(first.display, p, more) for p in (first.prediction, pressed)
             for more in ("quick", "solved")}  # fmt: skip
    assert len(asked) == 4


def test_curves_pass_through_their_marked_points(plate: Analysis) -> None:
    for curve in plate.friction_curves:
        assert curve.amplitude_for_criterion is not None
        if curve.model == "levitation":
            # Something always touches.
            assert curve.zero_friction_amplitude is None
            at = np.interp(curve.amplitude_for_criterion, curve.amplitude, curve.relative_friction)
            assert at == pytest.approx(0.7, abs=5e-3)
            continue
        assert curve.zero_friction_amplitude is not None
        at = np.interp(
            [curve.amplitude_for_criterion, curve.zero_friction_amplitude],
            curve.amplitude,
            curve.relative_friction,
        )
        assert at == pytest.approx([0.7, 0.0], abs=2e-3)


def test_the_verdict_speaks_of_validation_and_of_assumptions(plate: Analysis) -> None:
    text = " ".join(finding.text for finding in plate.verdict)
    assert "fitted to published friction of people" in text
    assert "assumed" in text
    assert any(finding.kind == "doubt" for finding in plate.verdict)


@pytest.mark.slow
def test_a_display_that_does_not_vibrate_keeps_no_grating() -> None:
    still = analyze(load_display("biet2008-stator"), voltage=0.0)
    assert still.fidelity is None
    json.dumps(still.summary(), allow_nan=False)


def test_the_paper_s_procedure_leads_to_the_paper_s_plate() -> None:
    display = load_display("biet2008-plate")
    assert isinstance(display.actuator, RectangularPlate)
    gap = friction_law(display, 10e-3, 40.5e3, model="paper2008").gap(0.0)
    section = plate_laminate(display.actuator, "paper")
    gas = display.gas
    design = design_plate(section, gap, gas.viscosity, gas.ambient_pressure, 0.5)
    # Five cover the mean explored area; the paper takes seven without saying why.
    assert design.ceramics == 5
    assert design.lowest_frequency == pytest.approx(20.6e3, rel=1e-3)
    assert design.longest_half_wavelength_euler == pytest.approx(14.94e-3, rel=1e-3)
    assert design.amplitudes * 1e6 == pytest.approx([2.33, 1.89, 1.54, 1.35], abs=0.005)
    assert design.area > 28.18e-4
    assert len(design.contradictions) == 4
    paper = design_plate(section, gap, gas.viscosity, gas.ambient_pressure, 0.5, 40e-4)
    assert (paper.ceramics, paper.nodal_lines) == (7, 8)
    assert paper.length == pytest.approx(83e-3)
    assert paper.area == pytest.approx(40.67e-4)
    with pytest.raises(InputError, match="largest explored area"):
        design_plate(section, gap, gas.viscosity, gas.ambient_pressure, 0.5, 128e-4)


def test_friction_criterion_is_nan_where_nothing_reaches_it() -> None:
    display = load_display("biet2008-plate")
    gap = friction_law(display, 10e-3, 40.5e3, model="paper2008").gap(0.0)
    # A finger pressed with 5 kN is never lifted by 50 µm.
    found = friction_criterion(gap, (10e-3,), 0.1, 5e3, display.gas.ambient_pressure)
    assert np.all(np.isnan(found))
