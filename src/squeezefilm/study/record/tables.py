"""A study's answers and sessions as tables, a row per trial or sitting, and as CSV that a
spreadsheet may open.

A text cell that a spreadsheet would take for a formula is written with an apostrophe before it
(OWASP, "CSV Injection"); numbers are written as numbers, the negative ones too.
"""

from __future__ import annotations

import csv
import functools
import io
import itertools
import json
import math
import unicodedata
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.physics.perception.stimuli import Grating, Stimulus
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.record.exploration import measures
from squeezefilm.study.record.store import StudyStore


@dataclass(frozen=True)
class Column:
    """A column: name with its unit, what it holds, its unit, and its kind."""

    name: str
    description: str
    unit: str = ""
    kind: Literal["text", "number", "whole", "truth"] = "text"


SURFACES = (
    "stimulus",
    "second_stimulus",
    "third_stimulus",
    "fourth_stimulus",
    "fifth_stimulus",
)
"""Columns with the names of what a trial presented, in its order."""


def _of_surface(prefix: str) -> tuple[Column, ...]:
    """Columns of one of the surfaces of a trial."""
    return (
        Column(prefix, "Name of the surface that was presented then; empty where there was none"),
        Column(f"{prefix}_period_m", "Its spatial period, groove plus ridge", "m", "number"),
        Column(f"{prefix}_friction_depth", "Its change of relative friction", "", "number"),
        Column(f"{prefix}_second_period_m", "Of a grating across it, if any", "m", "number"),
        Column(f"{prefix}_surface", "What kind of surface it is, in words"),
        Column(f"{prefix}_surface_sha256", "Hash of the surface, its files and pictures read"),
    )


COLUMNS = (
    Column("participant_id", "Random pseudonym of the participant"),
    Column("participant_number", "Which of the balanced orders they had, from 0", kind="whole"),
    Column("session_id", "Random identifier of the sitting"),
    Column("display", "Display that presented the stimuli"),
    Column("trial", "Number of the trial within the participant, from 1", kind="whole"),
    Column("block", "Number of the block within the display, 0 before the first", kind="whole"),
    Column("phase", "familiarisation, practice, main or catch"),
    Column("task", "Task of the design"),
    *(column for surface in SURFACES for column in _of_surface(surface)),
    Column("adaptive_series", "Adaptive series that chose the comparison, if any"),
    Column(
        "intensity", "Its difference from the reference, in parts of the reference", "", "number"
    ),
    Column("answer", "What was right to answer; empty where nothing is"),
    Column("choice", "What the participant answered"),
    Column("estimate", "Number the participant gave", "", "number"),
    Column("correct", "Whether the answer was right", kind="truth"),
    Column("response_time_s", "From when an answer could be given", "s", "number"),
    Column("path_length_m", "Way of the finger during the trial", "m", "number"),
    Column("mean_speed_m_per_s", "Its mean speed", "m/s", "number"),
    Column("mean_normal_force_N", "Its mean normal force", "N", "number"),
    Column("peak_speed_m_per_s", "Greatest speed between two samples of its path", "m/s", "number"),
    Column("time_in_touch_s", "How long the finger touched", "s", "number"),
    Column("passes", "Straight stretches one way, of 4 mm or more", "", "number"),
    Column("along_x_share", "Share of their way along x more than along y", "", "number"),
    Column("coverage", "Share of the face's cells of 5 mm that it came over", "", "number"),
    Column("set_aside", "Why the answer does not count and the trial was asked again; else empty"),
    Column("presentations", "How often the trial was presented until answered", kind="whole"),
    Column("started_utc", "Wall clock when it began (UTC)"),
    Column("ended_utc", "Wall clock when it was answered (UTC)"),
    Column("started_monotonic_s", "The station's monotonic clock when it began", "s", "number"),
    Column("ended_monotonic_s", "The same when it was answered", "s", "number"),
    Column("traces", "Files of the finger's path, separated by blanks"),
    Column("seed", "Seed of what was random in the presentation", kind="whole"),
    Column("squeezefilm_version", "Version of the program that recorded it"),
    Column("device_sha256", "Hash of the display's description"),
    Column("calibration_sha256", "Hash of its calibration"),
)
"""Columns of exports, in this order."""

_USUAL = 3
"""Surfaces whose columns every export has; those of more are of tasks that present so many."""


def trial_columns(design: StudyDesign) -> tuple[Column, ...]:
    """Columns of a design's trials: `COLUMNS` without those of surfaces that it never presents."""
    never = SURFACES[max(_USUAL, design.described.surfaces) :]
    return tuple(column for column in COLUMNS if not never or not column.name.startswith(never))


PLACED = "SELECT *, min(number) OVER (PARTITION BY participant, display, block) AS begun FROM trial"
"""Trials, which come in the order of `begun, number`: block by block as they begin, and within one
by number, so that what is asked again, with a late number, comes at the end of its block."""

_QUERY = f"""
WITH placed AS ({PLACED})
SELECT r.*, p.uuid AS participant_id, p.number AS participant_number, r.session AS session_id,
    coalesce(a.reason, '') AS set_aside,
    t.display, t.number AS trial, t.block, t.phase, t.adaptive AS adaptive_series, t.answer,
    (SELECT count(*) FROM presentation s WHERE s.trial = t.uuid) AS presentations
FROM response r JOIN placed t ON t.uuid = r.trial JOIN participant p ON p.uuid = t.participant
LEFT JOIN set_aside a ON a.trial = t.uuid
ORDER BY p.number, p.uuid, t.begun, t.number
"""

Cell = str | float | int | bool | None


def trial_table(store: StudyStore) -> list[dict[str, Cell]]:
    """Every answered trial, in the order of participants and trials; keys as in `trial_columns`.

    Trials without an answer are not in it. Raises `RecordError` if the file cannot be read.
    """
    design = store.design
    rows: list[dict[str, Cell]] = []
    columns = trial_columns(design)
    cells = functools.cache(surface_cells)
    for row in store.rows(_QUERY):
        names = json.loads(row.pop("stimuli"))
        row["task"] = design.task
        traces = json.loads(row["traces"])
        row |= measures(store, row["display"], traces)
        row["traces"] = " ".join(traces)
        row["correct"] = None if row["correct"] is None else bool(row["correct"])
        row |= surface_columns(design, names, row, cells)
        rows.append({column.name: row[column.name] for column in columns})
    return rows


SurfaceCells = Callable[[Stimulus | Grating | None], dict[str, Cell]]


def surface_columns(
    design: StudyDesign,
    names: Sequence[str],
    row: Mapping[str, Any],
    cells: SurfaceCells,
) -> dict[str, Cell]:
    """Columns of every place in `SURFACES`, for a trial that presented the surfaces `names`;
    `cells` is `surface_cells`, or a cached form of it."""
    gratings = {}
    if row["phase"] == "familiarisation":
        gratings = {alternative.name: alternative for alternative in design.alternatives}
    found: dict[str, Cell] = {}
    for prefix, name in itertools.zip_longest(SURFACES, names, fillvalue=""):
        surface = gratings.get(name) or (presented(design, name, row) if name else None)
        found[prefix] = name
        found |= {f"{prefix}_{key}": value for key, value in cells(surface).items()}
    return found


def is_chosen(design: StudyDesign, name: str, row: Mapping[str, Any]) -> bool:
    """True where the surface of that name in a row is what an adaptive series chose."""
    return bool(row["adaptive_series"]) and name != design.reference


def presented(design: StudyDesign, name: str, row: Mapping[str, Any]) -> Stimulus:
    """The surface of that name in a row: the design's own, or what an adaptive series chose beside
    the reference, by its intensity. Raises `InputError` where there is none."""
    if not is_chosen(design, name, row):
        return design.stimulus(name)
    series = design.series(row["adaptive_series"])
    if not math.isfinite(row["intensity"]):
        raise InputError("say how much more than the reference it had", quantity="intensity")
    return design.comparison(series, row["intensity"])


def surface_cells(surface: Stimulus | Grating | None) -> dict[str, Cell]:
    """Periods (m), change of friction (1), kind and hash of a surface, by the ends of columns.

    Of a texture whose file cannot be read the hash is empty.
    """
    if not isinstance(surface, Stimulus):
        real = surface is not None
        return {
            "period_m": surface.period if surface is not None else None,
            "friction_depth": None,
            "second_period_m": None,
            "surface": "real grating" if real else "",
            "surface_sha256": "",
        }
    try:
        identity = surface.surface_sha256
    except ConfigError:
        identity = ""
    return {
        "period_m": known(surface.period),
        "friction_depth": known(surface.amount("friction_depth")),
        "second_period_m": known(surface.second_period),
        "surface": surface.kind,
        "surface_sha256": identity,
    }


def known(value: float) -> float | None:
    """A number as tables have it: NaN and infinite ones are none."""
    return value if math.isfinite(value) else None


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
"""Columns of sessions in every export, in this order."""


def session_table(store: StudyStore) -> list[dict[str, Cell]]:
    """Every session, in the order of participants and of time; keys as in `SESSION_COLUMNS`.

    A verification that could not measure anything is neither true nor false.
    """
    sessions = store.rows(
        "SELECT s.*, s.participant AS participant_id, s.uuid AS session_id FROM session s "
        "JOIN participant p ON p.uuid = s.participant ORDER BY p.number, p.uuid, s.started_utc"
    )
    rows: list[dict[str, Cell]] = []
    for row in sessions:
        cells: dict[str, Cell] = {**json.loads(row["conditions"]), **row}
        exposure = json.loads(row["exposure"]) or {}
        cells |= {f"ultrasound_{key}": value for key, value in exposure.items()}
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
        rows.append({column.name: cells.get(column.name) for column in SESSION_COLUMNS})
    return rows


SIMULATED = "simulated participants"
SIMULATED_NOTE = "simulated participant"
"""The note of a session that no person sat in."""


def origin_of(store: StudyStore) -> str:
    """Label of results: people, simulated, both mixed, or nobody."""
    notes = [json.loads(row["conditions"]) for row in store.rows("SELECT conditions FROM session")]
    simulated = [note.get("note") == SIMULATED_NOTE for note in notes]
    if not simulated:
        return "nobody"
    if all(simulated):
        return SIMULATED
    return "people and simulated participants, mixed" if any(simulated) else "people"


def guarded(text: str) -> str:
    """A text cell that no spreadsheet takes for a formula; `unguarded` gives it back.

    Guarded is what begins, after blanks, with = + - @ or their full-width forms, what begins with
    a tab or a line's end, and what begins with an apostrophe already. NUL is left out.
    """
    text = text.replace("\x00", "")
    begin = unicodedata.normalize("NFKC", text).lstrip()[:1]
    risky = (begin and begin in "=+-@") or text[:1] in ("\t", "\r", "\n", "'")
    return f"'{text}" if risky and text else text


def unguarded(text: str) -> str:
    """The text that `guarded` was given."""
    return text[1:] if text.startswith("'") else text


def csv_text(rows: Sequence[dict[str, Cell]], columns: Sequence[Column]) -> str:
    """CSV as RFC 4180 has it: comma, CR LF, one header line.

    Numbers read back as the same float, nothing is an empty cell, a truth is true or false, and
    text is guarded against formulas.
    """
    stream = io.StringIO()
    # With a bare LF, Python before 3.13 leaves a CR within a cell unquoted.
    writer = csv.writer(stream, lineterminator="\r\n")
    writer.writerow([column.name for column in columns])
    for row in rows:
        writer.writerow([cell_text(row[column.name]) for column in columns])
    return stream.getvalue()


def cell_text(value: Cell) -> str:
    """A cell as text, guarded if it is text."""
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return guarded(value)
    return repr(value)
