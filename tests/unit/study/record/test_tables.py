"""A row per sitting: its conditions, what was heard of it, and the device before and after."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from squeezefilm.study.conduct.run import StudyRun
from squeezefilm.study.conduct.sessions import SessionConditions, begin_session, end_session
from squeezefilm.study.conduct.study_device import NoDevice
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import SESSION_COLUMNS, session_table

from ..scripted import LOUD, Bench, Script, gratings

CONDITIONS = SessionConditions(
    consent=True, consent_form="v3", room="quiet", temperature=295.0, relative_humidity=0.4,
    skin_moisture=51.0, skin_moisture_method="corneometer", hand="left", finger="index",
    finger_orientation=0.5, normal_force_asked=0.7, masking_noise="pink", note="none",
)  # fmt: skip


@pytest.fixture
def store(tmp_path: Path) -> Iterator[StudyStore]:
    """Two people: one with a device, loud; one without either."""
    found = StudyStore.create(tmp_path / "study.sqlite", gratings(), 7)
    for device, conditions, heard in (
        (Bench(), CONDITIONS, LOUD),
        (NoDevice(), SessionConditions(consent=True), None),
    ):
        begun = begin_session(
            found, found.enrol(), device, conditions, heard, acknowledged=heard is not None
        )
        if isinstance(device, Bench):
            # Weaker within what is allowed, to tell the two verifications apart.
            device.amplitude, device.resonance = 1.99e-6, 30.49e3
        conduct(StudyRun(found, begun), device, Script())
        end_session(found, begun, device)
    yield found
    found.close()


def test_a_sitting_with_a_device_says_everything(store: StudyStore) -> None:
    row, _ = session_table(store)
    people = [one["uuid"] for one in store.participants()]
    session = store.rows("SELECT * FROM session WHERE participant = ?", [people[0]])[0]
    assert row == {
        "participant_id": people[0], "session_id": session["uuid"], "display": "biet2008-plate",
        "started_utc": session["started_utc"], "device": "bench", "device_sha256": "d" * 64,
        "calibration_sha256": "c" * 64, "squeezefilm_version": session["squeezefilm_version"],
        "consent": True, "consent_form": "v3", "room": "quiet", "temperature_K": 295.0,
        "relative_humidity": 0.4, "skin_moisture": 51.0, "skin_moisture_method": "corneometer",
        "hand": "left", "finger": "index", "finger_orientation_rad": 0.5,
        "normal_force_asked_N": 0.7, "masking_noise": "pink", "note": "none",
        "ultrasound_level_dB": 124.0, "ultrasound_distance_m": 0.5,
        "ultrasound_frequency_Hz": 33e3, "ultrasound_duration_s": 1200.0,
        "ultrasound_guidance_dB": 100.0, "ultrasound_acknowledged": True,
        "verified_before": True, "amplitude_before_m": 2e-6,
        "resonance_frequency_before_Hz": 30.5e3,
        "verified_after": True, "amplitude_after_m": 1.99e-6,
        "resonance_frequency_after_Hz": 30.49e3,
    }  # fmt: skip
    assert list(row) == [column.name for column in SESSION_COLUMNS]


def test_without_a_device_nothing_is_heard_and_nothing_verified(store: StudyStore) -> None:
    _, row = session_table(store)
    assert row["consent"] is True
    assert row["device"] == "none"
    for name, value in row.items():
        if name.startswith(("ultrasound", "verified", "amplitude", "resonance", "temperature")):
            assert value is None, name


def test_a_failed_verification_is_false(store: StudyStore) -> None:
    device = Bench()
    begun = begin_session(store, store.enrol(), device, CONDITIONS, LOUD, acknowledged=True)
    device.amplitude = 1e-6
    assert session_table(store)[2]["verified_after"] is None
    end_session(store, begun, device)
    row = session_table(store)[2]
    assert (row["verified_before"], row["verified_after"]) == (True, False)
    assert row["amplitude_after_m"] == 1e-6


def test_every_column_says_its_unit_and_kind() -> None:
    names = [column.name for column in SESSION_COLUMNS]
    assert len(set(names)) == len(names) == 33
    for column in SESSION_COLUMNS:
        assert column.description
        if column.unit:
            assert column.name.endswith(f"_{column.unit}")
            assert column.kind == "number"
    truths = {column.name for column in SESSION_COLUMNS if column.kind == "truth"}
    assert truths == {"consent", "ultrasound_acknowledged", "verified_before", "verified_after"}
