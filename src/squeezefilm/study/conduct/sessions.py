"""Sessions: a participant sits down at a verified device, and the device is verified again.

A session does not start without consent, without the airborne ultrasound acknowledged, or with a
device that is off.
"""

from __future__ import annotations

import json
import time
import uuid
from collections.abc import Callable

from squeezefilm import __version__
from squeezefilm.errors import InputError
from squeezefilm.results import to_json
from squeezefilm.study.conduct.exposure import Exposure
from squeezefilm.study.conduct.session_conditions import SessionConditions
from squeezefilm.study.conduct.study_device import DeviceVerification, StudyDevice
from squeezefilm.study.record.store import StudyStore, insert, utc_now


def display_wanted(store: StudyStore, participant: str) -> str | None:
    """The display of a participant's next trial; None if all are answered."""
    store.require_participant(participant)
    found = store.rows(
        "SELECT t.display FROM trial t LEFT JOIN response r ON r.trial = t.uuid "
        "WHERE t.participant = ? AND r.trial IS NULL ORDER BY t.number LIMIT 1",
        [participant],
    )
    return found[0]["display"] if found else None


def begin_session(
    store: StudyStore,
    participant: str,
    device: StudyDevice,
    conditions: SessionConditions,
    exposure: Exposure | None,
    *,
    acknowledged: bool,
    clock: Callable[[], float] = time.monotonic,
) -> str:
    """Start a session on the display that the participant's next trial needs. Returns its id.

    Args:
        store: the study.
        participant: a pseudonym that `enrol` gave.
        device: verified here; the measurement is recorded even if it is off.
        conditions: of the sitting.
        exposure: to airborne ultrasound; None only where no device is driven.
        acknowledged: whether `exposure.statement` was shown and acknowledged.
        clock: monotonic (s).

    Raises:
        InputError: no consent, an exposure that was not acknowledged, nothing left to do, or a
            device that is out of tolerance, with what was measured and what to do.
        RecordError: nothing was written.
    """
    display = display_wanted(store, participant)
    if display is None:
        raise InputError(f"participant {participant} has answered every trial; enrol another")
    conditions.require_consent()
    identity = device.identity()
    _require_acknowledged(exposure, acknowledged, driven=identity.name != "none")
    verification = device.verify_device()
    if not verification.passed:
        store.add("verification", _verification_row(None, "before", verification))
        raise InputError(
            "the device is off, and the session was not started: "
            f"{'; '.join(verification.problems)}. Let it warm up, clean and re-tune it, or "
            "calibrate it anew, then try again"
        )
    session = str(uuid.uuid4())
    row = {
        "uuid": session,
        "participant": participant,
        "display": display,
        "conditions": json.dumps(to_json(conditions)),
        "exposure": json.dumps(
            None if exposure is None else {**to_json(exposure), "acknowledged": True}
        ),
        "device": identity.name,
        "device_sha256": identity.device_sha256,
        "calibration_sha256": identity.calibration_sha256,
        "squeezefilm_version": __version__,
        "started_utc": utc_now(),
        "started_monotonic_s": clock(),
    }
    with store.transaction() as write:
        insert(write, "session", row)
        insert(write, "verification", _verification_row(session, "before", verification))
    return session


def _require_acknowledged(exposure: Exposure | None, acknowledged: bool, driven: bool) -> None:
    """Refuse a driven device whose exposure is not known, and one that was not acknowledged."""
    if exposure is None and driven:
        raise InputError(
            "the exposure to airborne ultrasound was not computed; a session with a device needs it"
        )
    if exposure is not None and not acknowledged:
        raise InputError(
            f"the exposure to airborne ultrasound was not acknowledged. {exposure.statement} "
            "Show it and acknowledge it (--acknowledge-ultrasound), or lower voltage or duration"
        )


def end_session(store: StudyStore, session: str, device: StudyDevice) -> DeviceVerification:
    """Verify the device after a session and record it, whether or not it is off.

    The caller shows `problems`: trials since the verification before may have been presented
    wrongly. Raises `InputError` for a session that is not there, `RecordError` if it cannot be
    written.
    """
    if not store.rows("SELECT uuid FROM session WHERE uuid = ?", [session]):
        raise InputError(f"there is no session {session} in {store.path}")
    verification = device.verify_device()
    store.add("verification", _verification_row(session, "after", verification))
    return verification


def _verification_row(
    session: str | None, moment: str, verification: DeviceVerification
) -> dict[str, object]:
    return {
        "uuid": str(uuid.uuid4()),
        "session": session,
        "moment": moment,
        "passed": int(verification.passed),
        "result": json.dumps({**to_json(verification), "problems": to_json(verification.problems)}),
        "made_utc": utc_now(),
    }
