"""A study's answers as one table, a row per trial, and as CSV that a spreadsheet may open.

A text cell that a spreadsheet would take for a formula is written with an apostrophe before it
(OWASP, "CSV Injection"); numbers are written as numbers, the negative ones too.
"""

from __future__ import annotations

import csv
import io
import json
import math
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

from squeezefilm.study.record.store import StudyStore


@dataclass(frozen=True)
class Column:
    """One column: name with its unit, what it holds, its unit in words of BIDS, and its kind."""

    name: str
    description: str
    unit: str = ""
    kind: Literal["text", "number", "whole", "truth"] = "text"


COLUMNS = (
    Column("participant_id", "Random pseudonym of the participant"),
    Column("participant_number", "Which of the balanced orders they had, from 0", kind="whole"),
    Column("session_id", "Random identifier of the sitting"),
    Column("display", "Display that presented the stimuli"),
    Column("trial", "Number of the trial within the participant, from 1", kind="whole"),
    Column("block", "Number of the block within the display, 0 before the first", kind="whole"),
    Column("phase", "familiarisation, practice, main or catch"),
    Column("task", "Task of the design"),
    Column("stimulus", "Name of the stimulus, or of the first of two"),
    Column("stimulus_period_m", "Its spatial period, groove plus ridge", "m", "number"),
    Column("stimulus_friction_depth", "Its change of relative friction", "", "number"),
    Column("second_stimulus", "Name of the second stimulus, if there are two"),
    Column("second_stimulus_period_m", "Its spatial period, groove plus ridge", "m", "number"),
    Column("second_stimulus_friction_depth", "Its change of relative friction", "", "number"),
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
"""What every export holds, in this order."""

_QUERY = """
SELECT p.uuid AS participant_id, p.number AS participant_number, r.session AS session_id,
    t.display, t.number AS trial, t.block, t.phase, r.stimuli, t.adaptive AS adaptive_series,
    r.intensity, t.answer, r.choice, r.estimate, r.correct, r.response_time_s, r.path_length_m,
    r.mean_speed_m_per_s, r.mean_normal_force_N,
    (SELECT count(*) FROM presentation s WHERE s.trial = t.uuid) AS presentations,
    r.started_utc, r.ended_utc, r.started_monotonic_s, r.ended_monotonic_s, r.traces, r.seed,
    r.squeezefilm_version, r.device_sha256, r.calibration_sha256
FROM response r JOIN trial t ON t.uuid = r.trial JOIN participant p ON p.uuid = t.participant
ORDER BY p.number, p.uuid, t.number
"""

Cell = str | float | int | bool | None


def trial_table(store: StudyStore) -> list[dict[str, Cell]]:
    """Every answered trial, in the order of participants and trials; keys as in `COLUMNS`.

    Trials without an answer are not in it. Raises `RecordError` if the file cannot be read.
    """
    design = store.design
    gratings = {one.name: one for one in design.alternatives}
    stimuli = {one.name: one for one in design.stimuli}
    stimuli |= {one.stimulus.name: one.stimulus for one in design.catch}
    found: list[dict[str, Cell]] = []
    for row in store.rows(_QUERY):
        names = json.loads(row.pop("stimuli"))
        row["task"] = design.task
        row["traces"] = " ".join(json.loads(row["traces"]))
        row["correct"] = None if row["correct"] is None else bool(row["correct"])
        for prefix, name in zip(("stimulus", "second_stimulus"), (*names, None), strict=False):
            row[prefix] = name or ""
            felt = row["phase"] == "familiarisation" and gratings
            one: Any = (gratings if felt else stimuli).get(name)
            if name is not None and one is None and row["adaptive_series"]:
                series = next(s for s in design.adaptive if s.name == row["adaptive_series"])
                one = design.comparison(series, row["intensity"])
            row[f"{prefix}_period_m"] = None if one is None else one.period
            row[f"{prefix}_friction_depth"] = getattr(one, "friction_depth", None)
        if len(names) < 2:
            row.update(
                second_stimulus="",
                second_stimulus_period_m=None,
                second_stimulus_friction_depth=None,
            )
        found.append({column.name: row[column.name] for column in COLUMNS})
    return found


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


def csv_text(rows: Sequence[dict[str, Cell]], columns: Sequence[Column] = COLUMNS) -> str:
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


def cell_text(value: Cell, missing: str = "") -> str:
    """One cell as text, guarded if it is text."""
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return missing
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return guarded(value) if value else missing
    return repr(value)
