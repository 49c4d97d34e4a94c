"""Sessions: a participant sits down at a verified device, and the device is verified again.

`SessionConditions` is what is written down before one starts: room, skin, finger, noise, consent;
`Exposure` the airborne ultrasound that people must have acknowledged.

A session does not start without consent, without the airborne ultrasound acknowledged, or with a
device that is off.
"""

from __future__ import annotations

import json
import time
import uuid
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Literal

from squeezefilm import __version__
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import to_json
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.sound import EAR_DISTANCE, SoundField
from squeezefilm.study.conduct.again import COUNTED, restart_block
from squeezefilm.study.conduct.study_device import DeviceVerification, StudyDevice
from squeezefilm.study.record.store import Row, StudyStore, insert, utc_now
from squeezefilm.study.record.tables import PLACED, SIMULATED_NOTE

_LONGEST_TEXT = 200


@si.checked_numbers
@dataclass(frozen=True)
class SessionConditions:
    """The conditions of one sitting. What was not measured stays None; nothing is guessed.

    No field asks for anything that names a person, and none must be filled with it: these texts
    are exported.

    Args:
        consent: whether the participant consented; a session does not start without.
        consent_form: which text they consented to, like "v3, 2026-10".
        room: what matters of the place, like "anechoic chamber"; not an address.
        temperature: of the room (K).
        relative_humidity: of the room (1).
        skin_moisture: as the instrument reads it, and `skin_moisture_method` which that is.
        hand, finger: that explore.
        finger_orientation: angle of the finger's axis from the stroke (rad); the source paper found
            the felt intensity to depend on it, so keep it the same.
        normal_force_asked: what participants were asked to press with (N).
        masking_noise: what they heard, like "pink noise, 65 dB(A), headphones"; empty for none.
        note: anything else, without names.

    Raises:
        InputError: a value outside its range or a text of more than 200 characters.
    """

    consent: bool
    consent_form: str = ""
    room: str = ""
    temperature: Annotated[si.AbsoluteKelvin, si.AtLeast(253), si.AtMost(333)] | None = None
    relative_humidity: Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(1)] | None = None
    skin_moisture: Annotated[si.Dimensionless, si.AtLeast(0), si.AtMost(1e6)] | None = None
    skin_moisture_method: str = ""
    hand: Literal["", "left", "right"] = ""
    finger: Literal["", "thumb", "index", "middle", "ring", "little"] = ""
    finger_orientation: Annotated[si.Radian, si.AtLeast(-6.3), si.AtMost(6.3)] | None = None
    normal_force_asked: Annotated[si.Newton, si.AtLeast(0), si.AtMost(50)] | None = None
    masking_noise: str = ""
    note: str = ""

    def __post_init__(self) -> None:
        for name in ("consent_form", "room", "skin_moisture_method", "masking_noise", "note"):
            if len(getattr(self, name)) > _LONGEST_TEXT:
                raise InputError(
                    f"{name} has {len(getattr(self, name))} characters; at most {_LONGEST_TEXT}",
                    quantity=name,
                )
        if self.skin_moisture is not None and not self.skin_moisture_method:
            raise InputError(
                "skin_moisture is given without skin_moisture_method; name the instrument and its "
                "unit, like 'Corneometer CM 825, arbitrary units'",
                quantity="skin_moisture_method",
            )

    def require_consent(self) -> None:
        """Refuse to go on without consent. Raises `InputError`."""
        if not self.consent:
            raise InputError(
                "consent = false: a session starts only after the participant has consented; "
                "record it with consent = true",
                quantity="consent",
            )


@dataclass(frozen=True)
class Exposure:
    """The strongest level a session can bring to a head, and what it is compared with.

    `level_dB` is the sound pressure level (re 20 µPa) in the strongest direction at `distance`,
    for the whole `duration` at the display's voltage: an upper estimate, since stimuli pause.
    `guidance_dB` is the public guidance for the frequency, None where there is none.
    """

    display: str
    frequency: si.Hertz
    distance: si.Metre
    level_dB: float
    duration: si.Second
    guidance_dB: float | None
    guidance: str
    model: str

    @property
    def above_guidance_dB(self) -> si.Dimensionless | None:
        """Excess of the level over the guidance (dB); None where there is none."""
        return None if self.guidance_dB is None else self.level_dB - self.guidance_dB

    @property
    def statement(self) -> str:
        """Statement that the experimenter acknowledges, in two sentences."""
        said = (
            f"Airborne ultrasound of {self.display}: up to {self.level_dB:.0f} dB at "
            f"{si.format_quantity(self.distance, si.Unit('m'))}, "
            f"{si.format_quantity(self.frequency, si.Unit('Hz'), 3)}, for about "
            f"{self.duration / 60:.0f} min ({self.model})."
        )
        above = self.above_guidance_dB
        if above is None:
            return f"{said} There is no published guidance for this frequency."
        word = f"{above:.0f} dB above" if above > 0 else f"{-above:.0f} dB below"
        return f"{said} That is {word} the guidance for the public, {self.guidance}."


def exposure(
    display: Display,
    duration: si.Second,
    *,
    progress: Callable[[str], None] | None = None,
) -> Exposure:
    """The exposure of a session of `duration` (s) on a display at its own voltage.

    The plate or ring is solved and its field searched over all directions (`physics.plate.sound`),
    which takes seconds. Raises what `solve_plate` raises.
    """
    from squeezefilm.design.plate.command import solve_plate

    field = solve_plate(display, points=41, progress=progress).sound
    return exposure_of(display.name, field, duration)


def exposure_of(display: str, field: SoundField, duration: si.Second) -> Exposure:
    """The exposure that a computed sound field means at `EAR_DISTANCE`, which is among its own."""
    level = field.sound_pressure_level_dB[field.distances.index(EAR_DISTANCE)]
    guidance = field.guidance
    return Exposure(
        display=display,
        frequency=field.frequency,
        distance=EAR_DISTANCE,
        level_dB=float(level),
        duration=duration,
        guidance_dB=None if guidance is None else guidance.level_dB,
        guidance="" if guidance is None else f"{guidance.source} ({guidance.evidence})",
        model=f"estimated, {field.model}",
    )


def display_wanted(store: StudyStore, participant: str) -> str | None:
    """The display of a participant's next trial; None if all are answered."""
    store.require_participant(participant)
    row = next_planned(store, participant)
    return None if row is None else str(row["display"])


def next_planned(store: StudyStore, participant: str) -> Row | None:
    """The row of a participant's next trial without an answer, with its `presentations` so far.

    Trials come as `PLACED` says.
    """
    rows = store.rows(
        f"WITH mine AS ({PLACED} WHERE participant = ?) "
        "SELECT t.*, (SELECT count(*) FROM presentation p WHERE p.trial = t.uuid) AS presentations "
        "FROM mine t LEFT JOIN response r ON r.trial = t.uuid "
        f"WHERE r.trial IS NULL AND {COUNTED} ORDER BY t.begun, t.number LIMIT 1",
        [participant],
    )
    return rows[0] if rows else None


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
    planned = next_planned(store, participant)
    # Simulated people forget nothing while they are away.
    if planned is not None and conditions.note != SIMULATED_NOTE:
        restart_block(store, participant, session, planned)
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
            "Show it and acknowledge it (acknowledge_ultrasound), or lower voltage or duration"
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
