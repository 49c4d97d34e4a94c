"""A study's sessions as one table, a row per sitting: conditions, exposure, verification."""

from __future__ import annotations

import json

from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.trial_table import Cell, Column

SESSION_COLUMNS = (
    Column("participant_id", "Random pseudonym of the participant"),
    Column("session_id", "Random identifier of the sitting"),
    Column("display", "Display that presented the stimuli"),
    Column("started_utc", "Wall clock when it began (UTC)"),
    Column("device", "Device that was driven, or none"),
    Column("device_sha256", "Hash of the display's description"),
    Column("calibration_sha256", "Hash of its calibration"),
    Column("squeezefilm_version", "Version of the program"),
    Column("consent", "Whether the participant consented", kind="truth"),
    Column("consent_form", "Which text they consented to"),
    Column("room", "What matters of the room"),
    Column("temperature_K", "Of the room", "K", "number"),
    Column("relative_humidity", "Of the room, from 0 to 1", "", "number"),
    Column("skin_moisture", "As the instrument reads it", "", "number"),
    Column("skin_moisture_method", "Instrument and its unit"),
    Column("hand", "That explored"),
    Column("finger", "That explored"),
    Column("finger_orientation_rad", "Angle of the finger from the stroke", "rad", "number"),
    Column("normal_force_asked_N", "Force participants were asked to press with", "N", "number"),
    Column("masking_noise", "What participants heard"),
    Column("note", "Anything else"),
    Column("ultrasound_level_dB", "Estimated airborne sound pressure level", "dB", "number"),
    Column("ultrasound_distance_m", "Distance from the plate it is estimated for", "m", "number"),
    Column("ultrasound_frequency_Hz", "Its frequency", "Hz", "number"),
    Column("ultrasound_duration_s", "How long at most", "s", "number"),
    Column("ultrasound_guidance_dB", "Public guidance it was compared with", "dB", "number"),
    Column("ultrasound_acknowledged", "Whether it was acknowledged", kind="truth"),
    *(
        column
        for moment in ("before", "after")
        for column in (
            Column(f"verified_{moment}", f"Whether the device was in order {moment}", kind="truth"),
            Column(f"amplitude_{moment}_m", f"Vibration amplitude {moment}", "m", "number"),
            Column(f"resonance_frequency_{moment}_Hz", f"Resonance {moment}", "Hz", "number"),
        )
    ),
)
"""What every export says of sessions, in this order."""


def session_table(store: StudyStore) -> list[dict[str, Cell]]:
    """Every session, in the order of participants and of time; keys as in `SESSION_COLUMNS`.

    A verification that could not measure anything is neither true nor false.
    """
    sessions = store.rows(
        "SELECT s.*, s.participant AS participant_id, s.uuid AS session_id FROM session s "
        "JOIN participant p ON p.uuid = s.participant ORDER BY p.number, p.uuid, s.started_utc"
    )
    found: list[dict[str, Cell]] = []
    for row in sessions:
        cells: dict[str, Cell] = {**json.loads(row["conditions"]), **row}
        exposure = json.loads(row["exposure"]) or {}
        for ours, theirs in (
            ("level_dB", "level_dB"),
            ("distance_m", "distance_m"),
            ("frequency_Hz", "frequency_Hz"),
            ("duration_s", "duration_s"),
            ("guidance_dB", "guidance_dB"),
            ("acknowledged", "acknowledged"),
        ):
            cells[f"ultrasound_{ours}"] = exposure.get(theirs)
        made = store.rows(
            "SELECT moment, result, passed FROM verification WHERE session = ? ORDER BY made_utc, "
            "moment DESC",
            [row["uuid"]],
        )
        for one in made:
            result, moment = json.loads(one["result"]), one["moment"]
            cells[f"verified_{moment}"] = bool(one["passed"]) if result["measurable"] else None
            cells[f"amplitude_{moment}_m"] = result["amplitude_m"]
            key = f"resonance_frequency_{moment}_Hz"
            cells[key] = result["resonance_frequency_Hz"]
        found.append({column.name: cells.get(column.name) for column in SESSION_COLUMNS})
    return found
