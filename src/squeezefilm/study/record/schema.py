"""The tables of a study's file. Rows are only ever added, so that files of stations merge.

Every row has a random identifier; nothing identifies a person, a machine's address or a program.
Times of the wall are UTC; monotonic times are seconds of the machine's own clock, good for
differences within one session only.
"""

from __future__ import annotations

APPLICATION_ID = 0x73_66_73_74
"""Marks the file as a study of squeezefilm in SQLite's header ("sfst")."""
VERSION = 2
"""Version of the tables in SQLite's header: 1, without `set_aside`, is brought up to date when it
is opened; another one is refused."""

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
