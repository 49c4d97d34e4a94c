"""The rows that one decides from, of an analysis that nothing computed."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.unit.report.made_results import WARM

from squeezefilm.report.display.rows import (
    decision_rows,
    electrical_rows,
    unsaid_warnings,
    vibration_rows,
)
from squeezefilm.report.kit.point_rows import heat_rows


def response(**changes: Any) -> Any:
    """A body that takes 10 mA, 50 mVA and 40 mW for each volt at 30 kHz, twice that at 32."""
    slope = np.array([1.0, 2.0])
    parts = {
        "frequencies": np.array([30e3, 32e3]),
        "current": lambda volts: 0.01 * volts * slope,
        "apparent_power": lambda volts: 0.05 * volts * slope,
        "input_power": lambda volts: 0.04 * volts * slope,
    }
    return SimpleNamespace(**{**parts, **changes})


def point(**changes: Any) -> Any:
    mode = SimpleNamespace(
        resonance_frequency=30e3, frequency_error=0.058, label="(8,0)", quality_factor=60.0,
        amplitude_per_volt=100e-9, solid=SimpleNamespace(response=response()),
    )  # fmt: skip
    parts: dict[str, Any] = {
        "mode": mode, "voltage": 20.0, "frequency": 30e3, "vibration_amplitude": 1.5e-6,
        "touch": SimpleNamespace(free_amplitude=2e-6, kept=0.75, mode="loaded"),
        "relative_friction": 0.312, "normal_force": 0.5, "speed": 0.08, "heat": WARM,
        "surface": SimpleNamespace(name="polished", roughness=0.6e-6),
        "warnings": ("said already", "not yet"),
    }  # fmt: skip
    return SimpleNamespace(**{**parts, **changes})


def analysis(**changes: Any) -> Any:
    table = SimpleNamespace(
        speeds=np.array([0.05, 0.1, 0.2]), finest_period=np.array([1e-4, 2e-4, 4e-4]), kept=0.9,
        fundamental_at_limit=0.68,
    )  # fmt: skip
    parts: dict[str, Any] = {
        "prediction": point(), "fidelity": table, "envelope_time_constant": 1e-3,
        "envelope_bandwidth": 160.0, "sound": None,
        "own_curve": SimpleNamespace(amplitude_for_criterion=0.7e-6),
        "uncertainty": SimpleNamespace(level=0.9, interval=(0.04, 0.786), median=0.37),
        "verdict": (SimpleNamespace(text="said already"),),
    }  # fmt: skip
    return SimpleNamespace(**{**parts, **changes})


def test_key_numbers_go_by_subject_in_the_order_of_the_chain() -> None:
    groups = decision_rows(analysis())
    assert [one.heading for one in groups] == [
        "Vibration", "Friction", "Textures", "Electrical load", "Heat", "Sound",
    ]  # fmt: skip
    said = {label: (text, remark) for one in groups for label, text, remark in one.rows}
    assert said["Relative friction µ′/µ"] == ("0.31", "0.04–0.79 (90 % interval, median 0.37)")
    assert said["Surface roughness"] == ("0.6 µm", "polished; finger 0.5 N at 80 mm/s")
    assert said["Amplitude for µ′/µ = 0.7"][0] == "0.7 µm"
    assert said["Finest grating at 100 mm/s"] == (
        "0.2 mm",
        "90 % of its swing, 68 % of its wave kept",
    )
    assert said["Temperature rise"][0] == "+73.5 K"
    assert said["Sound"][0] == "not known"
    still = decision_rows(analysis(prediction=point(voltage=None), fidelity=None))
    assert [one.heading for one in still] == ["Vibration", "Friction", "Textures"]


def test_the_free_amplitude_is_told_from_that_under_the_finger() -> None:
    rows = {label: (text, remark) for label, text, remark in vibration_rows(point())}
    assert rows["Resonance frequency"] == ("30 kHz", "(8,0), solved to ± 0.058 Hz")
    assert rows["Drive"] == ("20 V", "peak, at 30 kHz, the resonance")
    # 100 nm/V × 20 V: the product is the number it stands beside.
    assert rows["Amplitude, free"] == ("2 µm", "100 nm/V × 20 V, at antinodes")
    assert rows["Amplitude under the finger"] == ("1.5 µm", "the finger leaves 75 %")
    beside = {a: (b, c) for a, b, c in vibration_rows(point(frequency=31e3))}
    assert beside["Drive"][1] == "peak, at 31 kHz, beside the resonance"
    assert "×" not in beside["Amplitude, free"][1]
    given = {a: (b, c) for a, b, c in vibration_rows(point(voltage=None))}
    assert given["Drive"] == ("none", "amplitude given, at 30 kHz, the resonance")
    touch = SimpleNamespace(free_amplitude=2e-6, kept=1.0, mode=None)
    unknown = vibration_rows(point(touch=touch))[-1]
    assert unknown[2].startswith("the finger is taken to change nothing")


def test_the_amplifier_is_asked_at_the_drives_frequency() -> None:
    current, power = electrical_rows(point(frequency=31e3))
    assert current[:2] == ("Current", "300 mA")
    assert power == ("Apparent power", "1.5 VA", "1.2 W of it are real power")


@pytest.mark.parametrize("changes", [{"frequency": 29e3}, {"voltage": None}, {"voltage": 0.0}])
def test_where_no_admittance_was_solved_none_is_said(changes: dict[str, Any]) -> None:
    assert [row[1] for row in electrical_rows(point(**changes))] == ["not known"]


def test_a_plate_whose_power_is_not_known_says_so() -> None:
    assert heat_rows(None)[0][1] == "not known"
    assert len(heat_rows(WARM)) == 5


def test_what_the_verdict_says_is_not_warned_of_again() -> None:
    assert unsaid_warnings(analysis()) == ["not yet"]
