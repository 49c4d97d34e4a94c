"""What a calibrated display's file keeps of its calibration, which is no value of the display."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from squeezefilm.core.calibration_record import (
    CalibrationRecord,
    ComparedAnswer,
    JointSpread,
    UsedRecording,
)
from squeezefilm.core.config.load import load_text, written_values
from squeezefilm.core.config.schema import text_of
from squeezefilm.core.errors import InputError
from squeezefilm.design.analysis.report.rows import display_values
from squeezefilm.lab.designing.form import edited, form
from squeezefilm.lab.designing.numbers import calibration_of
from squeezefilm.physics.display import Display, load_display

STATOR = "biet2008-stator"
FRICTION = ComparedAnswer(
    "relative friction at 1 µm", "0.62", 0.05, (0.3, 0.9, 1.4), (0.9, 1.0, 1.1), "b.csv", 0.62, 1e-6
)
RECORD = CalibrationRecord(
    "2026-11-20",
    "0.2.0",
    True,
    ("µ′/µ = 0.40.",),
    (UsedRecording("a.csv", "impedance", who='A. "B"', sha256="ab12"),),
    (
        ComparedAnswer("resonance frequency", "40.4 kHz", 1e-4, (), (0.999, 1.0, 1.001), "a.csv"),
        ComparedAnswer("amplitude per volt", "14 nm/V", 0.01, recording="a.csv"),
        FRICTION,
    ),
)


def calibrated() -> Display:
    joint = JointSpread(("finger.normal_force",), draws=((0.2,), (0.7,)))
    return dataclasses.replace(load_display(STATOR), calibration=RECORD, joint=joint)


def text() -> str:
    display = calibrated()
    return text_of(display, display.provenance)


def test_it_is_said_in_a_sentence() -> None:
    assert RECORD.sentence == (
        "Calibrated on 2026-11-20 from 3 measured numbers of 1 recording. The model explains them."
    )
    bad = dataclasses.replace(RECORD, fits=False, recordings=(), compared=(FRICTION,))
    assert bad.sentence == (
        "Calibrated on 2026-11-20 from 1 measured number. The model does NOT explain them."
    )


@pytest.mark.parametrize("ends", [(0.9, 1.0), (1.1, 1.0, 0.9), (-0.1, 0.0, 0.1)])
def test_ends_that_are_no_interval_are_refused(ends: tuple[float, ...]) -> None:
    with pytest.raises(InputError):
        ComparedAnswer("mass", "1 kg", 0.1, before=ends)


def test_a_file_gives_it_back() -> None:
    read = load_text(Display, text())
    assert read.calibration == RECORD
    assert read == calibrated()


def test_what_a_calibration_found_is_no_value_that_needs_a_source(tmp_path: Path) -> None:
    plain = load_display(STATOR)
    read = load_text(Display, text())
    assert set(read.provenance) == set(plain.provenance)
    assert {one.path for one in display_values(read)} == {one.path for one in display_values(plain)}
    shown = [".".join(map(str, path)) for path, *_ in written_values(Display, text())]
    assert not any(path.startswith(("joint", "calibration")) for path in shown)
    assert "finger.normal_force" in shown


def test_the_lab_opens_it_and_an_edit_keeps_it() -> None:
    assert not any(row["path"].startswith(("joint", "calibration")) for row in form(text()))
    assert form(text()) == form(text_of(load_display(STATOR), load_display(STATOR).provenance))
    changed = load_text(Display, edited(text(), "finger.normal_force", "0.4 N"))
    assert changed.finger.normal_force == 0.4
    assert changed.calibration == RECORD


def test_the_lab_is_given_the_record_and_the_points_of_its_charts() -> None:
    assert calibration_of(load_display(STATOR)) is None
    found = calibration_of(calibrated())
    assert found is not None
    assert found["sentence"] == RECORD.sentence
    assert [one["said"] for one in found["compared"]] == [one.said for one in RECORD.compared]
    (response,) = found["responses"]
    assert response["frequency_Hz"] == pytest.approx([40.4e3, 40.4e3 * 0.999, 40.4e3 * 1.001])
    assert response["amplitude_per_volt_m_per_V"] == [pytest.approx(14e-9), None, None]
    (friction,) = found["frictions"]
    assert friction["vibration_amplitude_m"] == 1e-6
    assert friction["relative_friction"] == pytest.approx([0.62, 0.558, 0.682])
    assert friction["standard_error"] == pytest.approx(0.031)
    odd = (dataclasses.replace(RECORD.compared[0], measured="some kHz"), *RECORD.compared[1:])
    changed = dataclasses.replace(
        calibrated(), calibration=dataclasses.replace(RECORD, compared=odd)
    )
    again = calibration_of(changed)
    assert again is not None
    assert again["responses"] == []
