"""What the terminal says of a rendered texture: asked for against rendered."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.unit.printed import printed

from squeezefilm.design.report.texture_page import (
    render_rows,
    show_lost,
    show_render,
    show_textures,
)
from squeezefilm.physics.texture_files.hjif import HjifExport

NAN = float("nan")


def stroke(**changes: Any) -> SimpleNamespace:
    """A stroke of two steps whose place is known."""
    values = {
        "relative_friction_rendered": np.array([0.7, 0.9]), "sensor": None,
        "envelope": SimpleNamespace(amplitude_limit=1.2345e-6), "control_rate": 19.234e3,
        "compensation": "inverse", "saturated_top": 0.012, "saturated_bottom": 0.0345,
    }  # fmt: skip
    return SimpleNamespace(**{**values, **changes})


def judged(lag: float, **changes: Any) -> SimpleNamespace:
    """Contrast at two periods, of which the pattern has one."""
    values = {
        "spatial_frequency": np.array([1 / 4.3216e-3, 1000.0]),
        "contrast_kept": np.array([0.876, NAN]),
        "swing_kept": np.array([0.91, 0.2]), "lag": lag, "lag_time": lag / 0.06,
        "mean_speed": 0.06012,
    }  # fmt: skip
    return SimpleNamespace(**{**values, **changes})


def prediction(**changes: Any) -> SimpleNamespace:
    """The display at its limit of 15 V."""
    values = {
        "voltage": 15.0, "model": "a-model", "normal_force": 0.5, "warnings": ("mind this",),
        "surface": SimpleNamespace(name="copper"),
        "mode": SimpleNamespace(half_wavelength=9.8765e-3),
    }  # fmt: skip
    return SimpleNamespace(**{**values, **changes})


def result(**changes: Any) -> Any:
    """A texture rendered with the standing wave felt."""
    values = {
        "stroke": stroke(),
        "prediction": prediction(),
        "fidelity": judged(0.1234e-3),
        "unjudged": None,
        "counters": SimpleNamespace(
            unreachable=9, ticks=50, too_slippery=4, too_sticky=3, saturated=2, negative=1
        ),
        "played": SimpleNamespace(name="sine"),
        "least_friction": 0.43216,
        "mean_speed": 0.0601,
        "time_constant": 1.2345e-3,
        "asked": np.array([0.5, 0.9]),
        "rms_error": 0.12345,
        "force": SimpleNamespace(friction_force=np.array([-0.1, 0.02468]), stuck_share=0.0123),
        "wave": "felt",
        "factor": np.array([0.72345, 0.9, 0.98765]),
        "display": SimpleNamespace(title="A plate", name="plate", whose_finger="person 3's"),
    }  # fmt: skip
    return SimpleNamespace(**{**values, **changes})


def row(label: str, **changes: Any) -> tuple[str, str, str]:
    """The only row of that label."""
    (found,) = [one for one in render_rows(result(**changes)) if one[0] == label]
    return found


def labels(**changes: Any) -> list[str]:
    return [one[0] for one in render_rows(result(**changes))]


def test_a_rendered_texture_is_said_with_all_that_there_is() -> None:
    assert render_rows(result()) == [
        ("Largest amplitude", "1.23 µm", "at 15 V, the limit"),
        ("Least friction µ′/µ", "0.432", "a-model, 0.5 N on copper, 60.1 mm/s"),
        ("Finger", "", "person 3's"),
        ("Time constant", "1.23 ms", "of the envelope, finger on it"),
        ("Loop", "19.2 kHz", "the finger's place is known; compensation: inverse"),
        ("Friction asked for", "0.700 ± 0.200", "mean and RMS swing of µ′/µ"),
        ("Friction rendered", "0.800 ± 0.100", ""),
        ("RMS error of µ′/µ", "0.123", "rendered − asked for"),
        ("Contrast kept at 4.32 mm", "88 %", "in its place; 91 % of that wave anywhere"),
        ("Lag", "0.123 mm", "behind the finger, 2.1 ms at 60.1 mm/s"),
        ("Drive at a limit", "4.65 %", "of the time"),
        (
            "Beyond the display",
            "9 of 50",
            "samples: 4 too slippery, 3 too sticky, 2 too large, 1 below 0",
        ),
        ("Tangential force", "62.3 mN", "on average; the skin sticks 1.2 % of the time"),
        (
            "Standing wave",
            "72.3–98.8 %",
            "of the amplitude on an antinode is met, felt; period 9.88 mm",
        ),
    ]


def test_a_sensor_is_named_with_its_evidence() -> None:
    sensor = SimpleNamespace(name="touch-panel-120-hz", evidence="assumed")
    assert row("Loop", stroke=stroke(sensor=sensor))[2] == (
        "touch-panel-120-hz (assumed); compensation: inverse"
    )


def test_an_amplitude_that_was_given_has_no_voltage() -> None:
    assert row("Largest amplitude", prediction=prediction(voltage=None))[2] == ""


@pytest.mark.parametrize(
    ("lag", "value", "remark"),
    [
        (-0.1234e-3, "-0.123 mm", "ahead of the finger, 2.1 ms at 60.1 mm/s"),
        (0.0, "0.000 mm", "behind the finger, 0 s at 60.1 mm/s"),
    ],
)
def test_a_pattern_may_come_early(lag: float, value: str, remark: str) -> None:
    assert row("Lag", fidelity=judged(lag)) == ("Lag", value, remark)


def test_what_could_not_be_judged_is_said_with_the_reason() -> None:
    assert row("Contrast, lag", fidelity=None, unjudged="too short") == (
        "Contrast, lag", "–", "too short",
    )  # fmt: skip
    assert row("Contrast, lag", fidelity=None) == ("Contrast, lag", "–", "")
    assert "Lag" not in labels(fidelity=None)
    assert "Lag" not in labels(fidelity=judged(NAN))
    assert "Contrast, lag" not in labels()


def test_contrasts_and_periods_must_be_as_many() -> None:
    with pytest.raises(ValueError, match="shorter"):
        render_rows(result(fidelity=judged(0.0, contrast_kept=np.array([0.876]))))


def test_a_wave_that_is_ignored_is_not_spoken_of() -> None:
    assert "Standing wave" not in labels(wave="ignored")


def test_the_table_stands_below_its_heading_and_above_the_warnings() -> None:
    lines = printed(lambda: show_render(result()))
    assert lines[0] == "sine on A plate [plate]"
    assert lines[1] == "Largest amplitude 1.23 µm at 15 V, the limit"
    assert lines[-1] == "! mind this"
    # Neither labels nor values are broken where there is little room.
    narrow = printed(lambda: show_render(result()), 50)
    assert any(line.startswith("Contrast kept at 4.32 mm 88 %") for line in narrow)
    assert any(line.startswith("Friction asked for 0.700 ± 0.200") for line in narrow)


def test_what_an_export_lost_is_listed() -> None:
    export = HjifExport({}, ("the second dimension", "speed"), 0.01234, 0.3)
    assert printed(lambda: show_lost(export)) == [
        "texture.hjif holds one line of the texture; lost:",
        "- the second dimension",
        "- speed",
        "- friction differs by 0.012 RMS, 0.3 at most",
    ]


def test_textures_are_listed_by_unbroken_names() -> None:
    listing = [{"name": "biet2008-square-0.4mm", "title": "long " * 20, "quantity": "friction"}]
    lines = printed(lambda: show_textures(listing), 50)
    assert lines[0] == "texture title quantity"
    assert lines[1].startswith("biet2008-square-0.4mm long")
