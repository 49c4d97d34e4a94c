"""What a calibration and a blind prediction print."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.core import quantities as si
from squeezefilm.measure.calibration.blind import BlindPrediction, Predicted
from squeezefilm.measure.calibration.calibration import CalibratedValue
from squeezefilm.measure.report.calibration_page import prediction_lines, show_calibration


def test_each_value_stands_before_and_after_with_what_was_left_out(
    capsys: pytest.CaptureFixture[str],
) -> None:
    value = CalibratedValue(
        "actuator.glue.thickness", si.Unit("m"), (5e-6, 40e-6), 21e-6, 2e-6, (18e-6, 25e-6), 0.17
    )
    calibration: Any = SimpleNamespace(
        display=SimpleNamespace(name="a-plate"), values=(value,), fits=True,
        sentences=("The plate's data fit.", "Next: weigh it."),
    )  # fmt: skip
    found: Any = SimpleNamespace(
        calibration=calibration, file=Path("c.toml"), left_out=("a.csv: torn",)
    )
    show_calibration(found)
    said = " ".join(capsys.readouterr().out.split())
    assert "a-plate, calibrated" in said
    assert "actuator.glue.thickness 5 µm to 40 µm 21 µm 18 µm to 25 µm 17 %" in said
    assert "The plate's data fit. Next: weigh it. left out a.csv: torn" in said


def test_a_prediction_is_said_with_its_conditions_and_its_hash() -> None:
    one = Predicted("relative_friction", {"normal_force": 0.5}, 0.412345, (0.3, 0.5), 0.05)
    lines = list(prediction_lines(BlindPrediction("a-plate", "plates drawn", (one,), {}, "abc")))
    assert lines == [
        "Of a-plate, by plates drawn (SI units):",
        "  relative friction, normal_force 0.5: 0.41235 (0.3 to 0.5, 90 %)",
        "SHA-256 abc",
    ]
