"""Tables of a study's file, and what they may hold: checked once, so that all else may rely on it.

A file may come from elsewhere, or be damaged. Identifiers and the names of traces go into names
of files and are searched for byte by byte, so nothing but what this program makes is let in.
"""

from __future__ import annotations

import json
import math
import re
import sqlite3
from collections.abc import Callable, Iterable, Iterator
from datetime import datetime
from typing import TYPE_CHECKING, Any

from squeezefilm.core.errors import InputError
from squeezefilm.core.regular_file import parsed_json

if TYPE_CHECKING:
    from squeezefilm.study.design.study_design import StudyDesign

APPLICATION_ID = 0x73_66_73_74
"""Marks the file as a study of squeezefilm in SQLite's header ("sfst")."""
VERSION = 2
"""Version of the tables in SQLite's header: 1, without `set_aside`, is brought up to date when it
is opened; another one is refused."""

SCHEMA = f"""
PRAGMA application_id = {APPLICATION_ID};
PRAGMA user_version = {VERSION};

CREATE TABLE study (
    uuid TEXT PRIMARY KEY,
    name TEXT NOT NULL,
    design TEXT NOT NULL,              -- the whole design, as TOML
    design_sha256 TEXT NOT NULL,
    seed INTEGER NOT NULL,
    station INTEGER NOT NULL,          -- participants' numbers are station + k * stations
    stations INTEGER NOT NULL,
    squeezefilm_version TEXT NOT NULL,
    created_utc TEXT NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE participant (
    uuid TEXT PRIMARY KEY,             -- a random pseudonym
    number INTEGER NOT NULL,           -- chooses the balanced order
    squeezefilm_version TEXT NOT NULL, -- which planned the trials
    enrolled_utc TEXT NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE trial (
    uuid TEXT PRIMARY KEY,             -- the token an answer is handed in with
    participant TEXT NOT NULL REFERENCES participant (uuid),
    number INTEGER NOT NULL,
    display TEXT NOT NULL,
    block INTEGER NOT NULL,
    phase TEXT NOT NULL,
    stimuli TEXT NOT NULL,             -- JSON list
    alternatives TEXT NOT NULL,        -- JSON list
    answer TEXT NOT NULL,
    adaptive TEXT NOT NULL,
    reference_first INTEGER NOT NULL,
    pause_s REAL NOT NULL,
    seed INTEGER NOT NULL,
    UNIQUE (participant, number)
) STRICT, WITHOUT ROWID;

CREATE TABLE session (
    uuid TEXT PRIMARY KEY,
    participant TEXT NOT NULL REFERENCES participant (uuid),
    display TEXT NOT NULL,
    conditions TEXT NOT NULL,          -- JSON: room, humidity, skin, finger, noise, consent
    exposure TEXT NOT NULL,            -- JSON: airborne ultrasound, as acknowledged
    device TEXT NOT NULL,
    device_sha256 TEXT NOT NULL,
    calibration_sha256 TEXT NOT NULL,
    squeezefilm_version TEXT NOT NULL,
    started_utc TEXT NOT NULL,
    started_monotonic_s REAL NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE verification (
    uuid TEXT PRIMARY KEY,
    session TEXT REFERENCES session (uuid), -- NULL where it kept a session from starting
    moment TEXT NOT NULL,                   -- before or after
    passed INTEGER NOT NULL,
    result TEXT NOT NULL,                   -- JSON
    made_utc TEXT NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE presentation (
    uuid TEXT PRIMARY KEY,
    trial TEXT NOT NULL REFERENCES trial (uuid),
    session TEXT NOT NULL REFERENCES session (uuid),
    presented_utc TEXT NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE response (
    trial TEXT PRIMARY KEY REFERENCES trial (uuid),
    session TEXT NOT NULL REFERENCES session (uuid),
    stimuli TEXT NOT NULL,             -- JSON list of what was really presented
    intensity REAL,                    -- an adaptive series' difference from the reference
    choice TEXT NOT NULL,
    estimate REAL,
    correct INTEGER,
    response_time_s REAL,
    started_monotonic_s REAL NOT NULL,
    ended_monotonic_s REAL NOT NULL,
    started_utc TEXT NOT NULL,
    ended_utc TEXT NOT NULL,
    path_length_m REAL,
    mean_speed_m_per_s REAL,
    mean_normal_force_N REAL,
    traces TEXT NOT NULL,              -- JSON list of files' names beside the study's
    seed INTEGER NOT NULL,
    squeezefilm_version TEXT NOT NULL,
    device_sha256 TEXT NOT NULL,
    calibration_sha256 TEXT NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE set_aside (
    trial TEXT PRIMARY KEY REFERENCES trial (uuid), -- its answer, if any, counts no more
    session TEXT NOT NULL REFERENCES session (uuid),
    reason TEXT NOT NULL,
    again TEXT NOT NULL REFERENCES trial (uuid),    -- asked in its place
    made_utc TEXT NOT NULL
) STRICT, WITHOUT ROWID;

CREATE INDEX trial_of ON trial (participant, number);
CREATE INDEX presentation_of ON presentation (trial);
CREATE INDEX session_of ON session (participant);
"""

TABLES = (
    "participant",
    "trial",
    "session",
    "verification",
    "presentation",
    "response",
    "set_aside",
)
"""Tables that merge from other stations, each table after those it refers to. Keys come first."""

UPGRADE_1 = next(part for part in SCHEMA.split(";") if "CREATE TABLE set_aside" in part)
"""Statement that gives a file of version 1 what it lacks."""

_IDENTIFIER = re.compile(r"[0-9a-f-]{16,36}")
_TRACE = re.compile(r"[0-9a-f]{32}\.(csv|sqft)")
_HALF_WRITTEN = re.compile(rf"\.{_TRACE.pattern}\.[a-z0-9_]+")
_PHASES = ("familiarisation", "practice", "main", "catch")
_PLAIN = (str, int, float, bool, type(None))
_KINDS: dict[str, type] = {"TEXT": str, "INTEGER": int, "REAL": float}

Check = Callable[[Any], bool]
Rows = Callable[[str], list[dict[str, Any]]]


def require_identifier(text: str) -> None:
    """Refuse what is no pseudonym or identifier that this program made. Raises `InputError`."""
    if not _IDENTIFIER.fullmatch(text):
        raise InputError(
            f"'{text[:80]}' is no participant's pseudonym: that is 16 digits and letters from a "
            "to f; `study status` lists them"
        )


def is_trace(name: str) -> bool:
    """True where a file among the traces has a name that this program gave, half-written or not."""
    return bool(_TRACE.fullmatch(name) or _HALF_WRITTEN.fullmatch(name))


def problems(rows: Rows, design: Callable[[], StudyDesign]) -> Iterator[str]:
    """Faults of a file's tables or rows: table, row and column.

    `rows` asks the file, `design` reads its design once the study's own row is known to be good.
    """
    with sqlite3.connect(":memory:") as reference:
        reference.row_factory = sqlite3.Row
        reference.executescript(SCHEMA)
        wanted = {name: _shape(reference.execute, name) for name in ("study", *TABLES)}
    reference.close()
    for name in wanted:
        if _shape(rows, name) != wanted[name]:
            yield f"the table {name} has other columns"
            return
    for row in rows("SELECT name FROM sqlite_schema WHERE type IN ('trigger', 'view')"):
        yield f"{row['name']} is a trigger or a view, and a study has none"
    for row in rows("PRAGMA foreign_key_check"):
        yield f"a row of {row['table']} belongs to one of {row['parent']} that is gone"
    studies = rows("SELECT * FROM study")
    if len(studies) != 1:
        yield f"it holds {len(studies)} studies instead of one"
        return
    yield from _row_problems("study", wanted["study"], studies, _CHECKS)
    checks = _CHECKS | {
        "display": lambda display: display in design().displays,
        "adaptive": lambda text: not text or text in [series.name for series in design().adaptive],
    }
    for table in TABLES:
        yield from _row_problems(table, wanted[table], rows(f"SELECT * FROM {table}"), checks)
    yield from _trial_problems(rows, design())


Shape = dict[str, tuple[type, bool]]


def _shape(execute: Callable[[str], Iterable[Any]], table: str) -> Shape:
    """Columns of a table: the type of their values, and whether they may be NULL."""
    columns = execute(f"PRAGMA table_info({table})")
    return {
        column["name"]: (_KINDS.get(column["type"], bytes), not (column["notnull"] or column["pk"]))
        for column in columns
    }


def _row_problems(
    table: str, shape: Shape, rows: list[dict[str, Any]], checks: dict[str, Check]
) -> Iterator[str]:
    key = next(iter(shape))
    for row in rows:
        for column, (kind, may_be_empty) in shape.items():
            value = row[column]
            if value is None and may_be_empty:
                continue
            holds = isinstance(value, kind) and (
                not isinstance(value, float) or math.isfinite(value)
            )
            if not holds or (column in checks and not checks[column](value)):
                yield f"{table} {row[key]!r:.40} has {column} = {value!r:.60}"


def _trial_problems(rows: Rows, design: StudyDesign) -> Iterator[str]:
    """Problems that no column shows alone: of answers to their trials, and trials of a design."""
    gratings = [alternative.name for alternative in design.alternatives]
    stimuli = [stimulus.name for stimulus in design.stimuli]
    catches = [trial.stimulus.name for trial in design.catch]
    for row in rows(
        "SELECT t.*, r.trial AS answered, r.stimuli AS felt, r.choice, r.intensity, r.estimate "
        "FROM trial t LEFT JOIN response r ON r.trial = t.uuid"
    ):
        names, offered = json.loads(row["stimuli"]), json.loads(row["alternatives"])
        known = {
            "familiarisation": gratings or stimuli,
            "catch": stimuli + catches,
        }.get(row["phase"], stimuli)
        place = f"trial {row['uuid']}"
        if bool(names) == bool(row["adaptive"]) or not set(names) <= set(known):
            yield f"{place} presents {names!r:.60}, which its design does not"
        if not set(offered) <= set(design.answers):
            yield f"{place} offers {offered!r:.60}, which its design does not"
        if row["answered"] is None:
            continue
        felt = json.loads(row["felt"])
        if not felt or (names and felt != names):
            yield f"the answer to {place} is to {felt!r:.60} instead of {names!r:.60}"
        if row["adaptive"] and row["intensity"] is None:
            yield f"the answer to {place} has no intensity"
        if offered and row["choice"] not in offered:
            yield f"the answer to {place} is {row['choice']!r:.60}, which was not offered"


def _json(text: str) -> Any:
    try:
        return parsed_json(text)
    except ValueError:
        # No JSON has this type, so that no check holds for it.
        return ...


def _texts(text: str) -> bool:
    found = _json(text)
    return isinstance(found, list) and all(isinstance(item, str) for item in found)


def _fields(text: str) -> bool:
    """True where a text is an object of plain values."""
    found = _json(text)
    return isinstance(found, dict) and all(isinstance(value, _PLAIN) for value in found.values())


def _verification(text: str) -> bool:
    found = _json(text)
    wanted = {"measurable", "amplitude_m", "resonance_frequency_Hz"}
    return (
        isinstance(found, dict)
        and wanted <= found.keys()
        and all(isinstance(found[key], _PLAIN) for key in wanted)
    )


def _moment(text: str) -> bool:
    try:
        return datetime.fromisoformat(text).utcoffset() is not None
    except ValueError:
        return False


def _not_negative(value: float) -> bool:
    return value >= 0


def _identifier(text: str) -> bool:
    return bool(_IDENTIFIER.fullmatch(text))


_CHECKS: dict[str, Check] = {
    "uuid": _identifier,
    "participant": _identifier,
    "seed": lambda number: 0 <= number <= 2**53,
    "stations": lambda number: number >= 1,
    "station": _not_negative,
    "number": _not_negative,
    "phase": lambda phase: phase in _PHASES,
    "stimuli": _texts,
    "alternatives": _texts,
    "pause_s": _not_negative,
    "conditions": _fields,
    "exposure": lambda text: _json(text) is None or _fields(text),
    "moment": lambda moment: moment in ("before", "after"),
    "result": _verification,
    "traces": lambda text: _texts(text) and all(map(_TRACE.fullmatch, json.loads(text))),
    "correct": lambda flag: flag in (0, 1),
    "response_time_s": _not_negative,
    **dict.fromkeys(
        ("created_utc", "enrolled_utc", "started_utc", "made_utc", "presented_utc", "ended_utc"),
        _moment,
    ),
}
"""Conditions on the columns, in whichever table they are."""
