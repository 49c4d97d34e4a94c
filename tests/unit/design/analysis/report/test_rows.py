"""The rows that one decides from, of an analysis that nothing computed."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from tests.unit.made_results import WARM

from squeezefilm.design.analysis.analysis import MeasuredBeside
from squeezefilm.design.analysis.report.folds import (
    more_rows,
    rival_rows,
    sound_rows_at_ear,
    surface_rows,
    texture_rows,
    unsaid_warnings,
    vibration_rows,
    with_measured,
    working_point,
)
from squeezefilm.design.plate.report.terminal import heat_rows


def point(**changes: Any) -> Any:
    mode = SimpleNamespace(
        resonance_frequency=30e3, frequency_error=0.058, label="(8,0)", quality_factor=60.0,
        amplitude_per_volt=100e-9, solid=None,
    )  # fmt: skip
    parts: dict[str, Any] = {
        "mode": mode, "voltage": 20.0, "frequency": 30e3, "vibration_amplitude": 1.5e-6,
        "touch": SimpleNamespace(free_amplitude=2e-6, kept=0.75, mode="loaded"),
        "relative_friction": 0.312, "normal_force": 0.5, "speed": 0.08, "heat": WARM,
        "surface": SimpleNamespace(name="polished", roughness=0.6e-6),
        "warnings": ("said already", "not yet"),
        "place": (0.03, 0.02), "place_said": "at the antinode, x 30 mm, y 20 mm",
        "law": SimpleNamespace(place=None),
    }  # fmt: skip
    return SimpleNamespace(**{**parts, **changes})


def analysis(**changes: Any) -> Any:
    table = SimpleNamespace(
        speeds=np.array([0.05, 0.1, 0.2]), finest_period=np.array([1e-4, 2e-4, 4e-4]), kept=0.9,
        fundamental=0.68,
    )  # fmt: skip
    parts: dict[str, Any] = {
        "prediction": point(), "fidelity": table, "envelope_time_constant": 1e-3,
        "envelope_bandwidth": 160.0, "ears": None, "felt": None,
        "active_area": None, "drive_electronics": None, "measured": (),
        "own_curve": SimpleNamespace(amplitude_for_criterion=0.7e-6),
        "uncertainty": SimpleNamespace(level=0.9, interval=(0.04, 0.786), median=0.37),
        "rivals": {"paper2008": 0.7, "levitation-2016": 0.0},
        "verdict": (SimpleNamespace(text="said already"),),
    }  # fmt: skip
    return SimpleNamespace(**{**parts, **changes})


def test_what_was_measured_stands_beside_what_is_computed() -> None:
    swing = MeasuredBeside("Amplitude, free", 1e-6, 1.5e-6, "m", 15.0, "a laser")
    unsure = MeasuredBeside("Quality factor", 80.0, 60.0, "1", None, "")
    rows = [("Amplitude, free", "3 µm", "made"), ("Quality factor", "60", ""), ("Mass", "1 kg", "")]
    assert with_measured(rows, [swing, unsure], 15.0) == [
        ("Amplitude, free", "3 µm", "+50 % on measured 1 µm (a laser); made"),
        ("Quality factor", "60", "−25 % on measured 80 (source not stated)"),
        ("Mass", "1 kg", ""),
    ]
    (other,) = with_measured(rows[:1], [swing], 30.0)
    assert other[2].startswith("+50 % on measured 1 µm at 15 V (")


def test_friction_and_textures_have_their_rows() -> None:
    said = rows_of(*surface_rows(analysis()), *rival_rows(analysis()), *texture_rows(analysis()))
    assert said["Rival models give µ′/µ"] == (
        "0.00–0.70",
        "interval 0.75 wide, without them",
    )
    assert said["Surface roughness"] == ("0.6 µm", "polished; finger 0.5 N at 80 mm/s")
    assert said["Amplitude for µ′/µ = 0.7"][0] == "0.7 µm"
    assert said["Finest grating at 100 mm/s"] == (
        "0.2 mm",
        "90 % of its swing, 68 % of its wave kept",
    )


def test_the_free_amplitude_is_told_from_that_under_the_finger() -> None:
    rows = {label: (text, remark) for label, text, remark in vibration_rows(point())}
    assert rows["Resonance frequency"] == ("30 kHz", "(8,0), solved to ± 0.058 Hz")
    assert rows["Drive"] == ("20 V", "peak, at 30 kHz, the resonance")
    # 100 nm/V × 20 V: the product is the number it stands beside.
    assert rows["Amplitude, free"] == ("2 µm", "100 nm/V × 20 V, at antinodes")
    assert rows["Peak amplitude, finger on"] == ("1.5 µm", "at antinodes; the finger leaves 75 %")
    assert "Amplitude under the finger" not in rows
    beside = {a: (b, c) for a, b, c in vibration_rows(point(frequency=31e3))}
    assert beside["Drive"][1] == "peak, at 31 kHz, beside the resonance"
    assert "×" not in beside["Amplitude, free"][1]
    given = {a: (b, c) for a, b, c in vibration_rows(point(voltage=None))}
    assert given["Drive"] == ("none", "amplitude given, at 30 kHz, the resonance")
    touch = SimpleNamespace(free_amplitude=2e-6, kept=1.0, mode=None)
    unknown = vibration_rows(point(touch=touch))[-1]
    assert unknown[2] == (
        "at antinodes; the finger is taken to change nothing: no modal mass is known"
    )


def rows_of(*rows: tuple[str, str, str]) -> dict[str, tuple[str, str]]:
    return {label: (text, remark) for label, text, remark in rows}


def test_the_level_at_an_ear_stands_beside_its_limits() -> None:
    limits = [SimpleNamespace(guidance=SimpleNamespace(level_dB=level)) for level in (100, 110)]
    ears: Any = SimpleNamespace(
        distance=0.5, level_dB=123.6, low_dB=115.0, high_dB=132.0, limits=limits
    )
    said = rows_of(*sound_rows_at_ear(ears))["Sound at 0.5 m"]
    assert said == ("124 dB", "115 to 132 dB, loudest direction; guidance 100 dB and 110 dB")
    ears.limits = []
    assert rows_of(*sound_rows_at_ear(ears))["Sound at 0.5 m"][1].endswith("no guidance")
    assert sound_rows_at_ear(None)[0][1] == "not known"


def test_a_plate_whose_power_is_not_known_says_so() -> None:
    assert heat_rows(None)[0][1] == "not known"
    assert len(heat_rows(WARM)) == 5


def test_what_the_verdict_says_is_not_warned_of_again() -> None:
    assert unsaid_warnings(analysis()) == ["not yet"]


def test_the_working_point_is_said_by_what_drives_and_who_touches() -> None:
    assert working_point(point()) == "at 20 V and 30 kHz, finger of 0.5 N at 80 mm/s on polished"
    assert working_point(point(voltage=None)).startswith("at 1.5 µm and 30 kHz, finger of ")


def test_an_appendix_has_what_the_key_numbers_are_made_of() -> None:
    mode = SimpleNamespace(quality_factor=61.26, half_wavelength=8.5e-3)
    p = point(
        mode=mode, squeeze_number=40.256, mean_pressure=1.23456, friction_reduction=0.3456,
        friction_coefficient=0.789,
    )  # fmt: skip
    curve = SimpleNamespace(zero_friction_amplitude=None)
    found = [row[:2] for row in more_rows(analysis(prediction=p, own_curve=curve))]
    assert found[:6] == [
        ("Quality factor", "61.26"), ("Half wavelength", "8.5 mm"), ("Squeeze number", "40.26"),
        ("Mean pressure", "1.2346"), ("Friction reduction µ − µ′", "0.346"),
        ("Amplitude for no friction", "out of reach"),
    ]  # fmt: skip
    # The finest grating at each speed, then what the heat rows say beyond their first two.
    assert found[6:9] == [
        (f"Finest grating at {speed}", period)
        for speed, period in (
            ("50 mm/s", "0.1 mm"), ("100 mm/s", "0.2 mm"), ("200 mm/s", "0.4 mm"),
        )
    ]  # fmt: skip
    assert found[9:] == [row[:2] for row in heat_rows(WARM)[2:]]
    # Without a drive nothing warms, and without a texture nothing is rendered.
    still = dict(vars(p)) | {"voltage": None}
    bare = more_rows(
        analysis(
            prediction=SimpleNamespace(**still), fidelity=None,
            own_curve=SimpleNamespace(zero_friction_amplitude=2.5e-6),
        )
    )  # fmt: skip
    assert len(bare) == 6
    assert bare[5][:2] == ("Amplitude for no friction", "2.5 µm")
