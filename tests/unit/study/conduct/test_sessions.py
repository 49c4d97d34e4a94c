"""No session without consent, an acknowledged exposure and a device in order."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path

import pytest

from squeezefilm.core import config
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.physics.plate.sound import SoundField, exposure_guidance
from squeezefilm.study.conduct.sessions import (
    SessionConditions,
    begin_session,
    end_session,
    exposure_of,
)
from squeezefilm.study.conduct.study_device import DeviceVerification, NoDevice
from squeezefilm.study.record.store import StudyStore

from ..scripted import CONSENT, LOUD, Bench, gratings


def test_a_device_in_order_is_recorded_before_and_after(tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "a.sqlite", gratings(), 7) as store:
        device = Bench()
        begun = begin_session(store, store.enrol(), device, CONSENT, LOUD, acknowledged=True)
        device.amplitude = 1.5e-6
        after = end_session(store, begun, device)
        assert "amplitude is 1.5 µm" in after.problems[0]
        rows = store.rows("SELECT * FROM verification ORDER BY moment DESC")
        assert [(r["moment"], r["passed"], r["session"]) for r in rows] == [
            ("before", 1, begun),
            ("after", 0, begun),
        ]
        assert json.loads(rows[0]["result"])["resonance_frequency_Hz"] == 30.5e3
        row = store.rows("SELECT * FROM session")[0]
        assert row["device_sha256"] == "d" * 64
        assert row["calibration_sha256"] == "c" * 64
        assert json.loads(row["exposure"])["acknowledged"] is True
        assert json.loads(row["exposure"])["level_dB"] == 124.0
        with pytest.raises(InputError, match="no session"):
            end_session(store, "nonsense", device)


@pytest.mark.parametrize(
    ("amplitude", "resonance", "says"),
    [
        (1.7e-6, 30.5e3, "amplitude is 1.7 µm"),
        (2.3e-6, 30.5e3, "amplitude is 2.3 µm"),
        (2e-6, 31.0e3, "resonance is 31 kHz"),
        (math.nan, 30.5e3, "amplitude is nan"),
    ],
)
def test_a_device_that_is_off_starts_no_session(
    amplitude: float, resonance: float, says: str, tmp_path: Path
) -> None:
    with StudyStore.create(tmp_path / "a.sqlite", gratings(), 7) as store:
        who, device = store.enrol(), Bench(amplitude, resonance)
        with pytest.raises(InputError, match=says) as refused:
            begin_session(store, who, device, CONSENT, LOUD, acknowledged=True)
        assert "within" in str(refused.value)
        assert "calibrate" in str(refused.value)
        assert store.rows("SELECT * FROM session") == []
        (row,) = store.rows("SELECT * FROM verification")
        assert (row["passed"], row["session"]) == (0, None)


def test_no_session_without_consent_or_acknowledgement(tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "a.sqlite", gratings(), 7) as store:
        who = store.enrol()
        with pytest.raises(InputError, match="consent"):
            begin_session(
                store, who, Bench(), SessionConditions(consent=False), LOUD, acknowledged=True
            )
        with pytest.raises(InputError, match=r"not acknowledged.*124 dB.*24 dB above"):
            begin_session(store, who, Bench(), CONSENT, LOUD, acknowledged=False)
        with pytest.raises(InputError, match="was not computed"):
            begin_session(store, who, Bench(), CONSENT, None, acknowledged=True)
        with pytest.raises(InputError, match="no participant"):
            begin_session(store, "nobody", NoDevice(), CONSENT, None, acknowledged=False)
        assert store.rows("SELECT * FROM session") == []


def test_a_device_that_cannot_be_measured_is_neither_in_order_nor_off() -> None:
    found = NoDevice().verify_device()
    assert found.problems == ()
    assert not found.measurable
    assert "nothing was verified" in found.remark
    with pytest.raises(InputError, match="expected_amplitude"):
        DeviceVerification(2e-6, math.nan, 30e3, 30e3)


def test_the_level_at_an_ear_is_held_against_the_guidance() -> None:
    field = SoundField(
        frequency=33e3,
        distances=(0.5, 1.0),
        sound_pressure_level_dB=(124.0, 118.0),
        guidance=exposure_guidance(33e3),
    )
    near = exposure_of("d", field, 600.0)
    assert near.level_dB == 124.0
    assert near.above_guidance_dB == pytest.approx(near.level_dB - 100)
    assert "24 dB above" in near.statement
    assert "10 min" in near.statement
    assert "to be checked" in near.statement


def test_conditions_are_read_from_a_file_with_units() -> None:
    text = """
    consent = true
    temperature = "295 K"
    relative_humidity = "45 %"
    finger_orientation = "90 deg"
    masking_noise = "pink noise, 65 dB(A)"
    """
    found = config.load_text(SessionConditions, text)
    assert found.finger_orientation == pytest.approx(math.pi / 2)
    assert found.relative_humidity == pytest.approx(0.45)
    for more, says in (
        ("skin_moisture = 40", "instrument"),
        ('temperature_ = "295 K"', "Did you mean"),
        (f'note = "{"x" * 201}"', "at most 200"),
    ):
        with pytest.raises(ConfigError, match=says):
            config.load_text(SessionConditions, f"consent = true\n{more}")


def test_a_tolerance_is_a_share_and_expectations_are_above_nothing() -> None:
    fine = DeviceVerification(2e-6, 2e-6, 30e3, 30e3)
    for field in ("amplitude_tolerance", "resonance_tolerance"):
        for wrong in (0.0, 1.0):
            with pytest.raises(InputError, match=field):
                dataclasses.replace(fine, **{field: wrong})
    for field in ("expected_amplitude", "expected_resonance_frequency"):
        with pytest.raises(InputError, match=field):
            dataclasses.replace(fine, **{field: 0.0})
    # At the very end of the tolerance all is well, on either side.
    ends = DeviceVerification(1.5, 1.0, 0.5, 1.0, 0.5, 0.5)
    assert ends.passed
    assert dataclasses.replace(ends, amplitude=0.5, resonance_frequency=1.5).passed
    assert len(dataclasses.replace(ends, amplitude=0.49, resonance_frequency=1.51).problems) == 2
    assert (fine.amplitude_tolerance, fine.resonance_tolerance) == (0.1, 0.01)
    # What was never measurable may hold anything.
    assert DeviceVerification(measurable=False).passed
