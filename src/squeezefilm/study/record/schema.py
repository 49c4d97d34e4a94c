"""Tables of a study's file, and what they may hold: checked once, so that all else may rely on it.

A file may come from elsewhere, or have been edited. Identifiers and the names of traces go into
names of files, so nothing but what this program makes is let in. SQLite itself keeps the types.
"""

from __future__ import annotations

import contextlib
import json
import re
import sqlite3
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from squeezefilm.core.errors import InputError
from squeezefilm.core.regular_file import parsed_json

if TYPE_CHECKING:
    from squeezefilm.study.design.study_design import StudyDesign

APPLICATION_ID = 0x73_66_73_74
"""Marks the file as a study of squeezefilm in SQLite's header ("sfst")."""
VERSION = 2
"""Version of the tables in SQLite's header; a file of another one is refused."""

SCHEMA = """
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

_IDENTIFIER = re.compile(r"[0-9a-f-]{16,36}")
_TRACE = re.compile(r"[0-9a-f]{32}\.(csv|sqft)")
_HALF_WRITTEN = re.compile(rf"\.{_TRACE.pattern}\.[a-z0-9_]+")
_PHASES = ("familiarisation", "practice", "main", "catch")

Check = Callable[[str], bool]
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
    with contextlib.closing(sqlite3.connect(":memory:")) as reference:
        reference.row_factory = sqlite3.Row
        reference.executescript(SCHEMA)
        for name in ("study", *TABLES):
            columns = f"PRAGMA table_info({name})"
            if rows(columns) != [dict(row) for row in reference.execute(columns)]:
                yield f"the table {name} has other columns"
                return
    for row in rows("SELECT name FROM sqlite_schema WHERE type IN ('trigger', 'view')"):
        yield f"{row['name']} is a trigger or a view, and a study has none"
    for row in rows("PRAGMA foreign_key_check"):
        yield f"a row of {row['table']} belongs to one of {row['parent']} that is gone"
    studies = rows("SELECT uuid FROM study")
    if len(studies) != 1:
        yield f"it holds {len(studies)} studies instead of one"
        return
    for table, checks in _CHECKS.items():
        for row in rows(f"SELECT {', '.join(checks)} FROM {table}"):
            for column, holds in checks.items():
                if not holds(row[column]):
                    yield f"{table} has {column} = {row[column]!r:.60}"
    yield from _trial_problems(rows, design())


def _trial_problems(rows: Rows, design: StudyDesign) -> Iterator[str]:
    """Problems that no column shows alone: of answers to their trials, and trials of a design."""
    gratings = [alternative.name for alternative in design.alternatives]
    stimuli = [stimulus.name for stimulus in design.stimuli]
    catches = [trial.stimulus.name for trial in design.catch]
    displays, series = design.displays, ("", *(one.name for one in design.adaptive))
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
        for what, of, named in (("on", displays, "display"), ("of", series, "adaptive")):
            if row[named] not in of:
                yield f"{place} is {what} {row[named]!r:.40}, which its design does not have"
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


def _texts(text: str) -> bool:
    try:
        found = parsed_json(text)
    except ValueError:
        return False
    return isinstance(found, list) and all(isinstance(item, str) for item in found)


def _traces(text: str) -> bool:
    return _texts(text) and all(_TRACE.fullmatch(name) for name in json.loads(text))


def _identifier(text: str) -> bool:
    return bool(_IDENTIFIER.fullmatch(text))


_CHECKS: dict[str, dict[str, Check]] = {
    **{
        name: {"uuid": _identifier}
        for name in ("study", "participant", "session", "verification", "presentation")
    },
    "trial": {
        "uuid": _identifier,
        "phase": _PHASES.__contains__,
        "stimuli": _texts,
        "alternatives": _texts,
    },
    "response": {"stimuli": _texts, "traces": _traces},
}
"""Conditions on columns, by table."""
