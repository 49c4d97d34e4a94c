PRAGMA application_id = 1936094068;
PRAGMA user_version = 1;
BEGIN TRANSACTION;
CREATE TABLE participant (
    uuid TEXT PRIMARY KEY,             -- a random pseudonym
    number INTEGER NOT NULL,           -- chooses the balanced order
    squeezefilm_version TEXT NOT NULL, -- which planned the trials
    enrolled_utc TEXT NOT NULL
) STRICT, WITHOUT ROWID;
INSERT INTO "participant" VALUES('52a95791154444a6',0,'0.1.0','2026-11-22T02:25:15.567+00:00');
CREATE TABLE presentation (
    uuid TEXT PRIMARY KEY,
    trial TEXT NOT NULL REFERENCES trial (uuid),
    session TEXT NOT NULL REFERENCES session (uuid),
    presented_utc TEXT NOT NULL
) STRICT, WITHOUT ROWID;
INSERT INTO "presentation" VALUES('4a373432-ca23-47be-beca-89e03b54dfa6','30aef980-675f-4ab4-8cf4-2c72d3786a39','79c41077-4616-4b4e-846d-b11df774343b','2026-11-22T02:25:15.595+00:00');
INSERT INTO "presentation" VALUES('5d3c60df-1dcd-437b-b9a6-dc25a68863fe','be92e3cf-b8b0-4912-b733-ea975e97038a','79c41077-4616-4b4e-846d-b11df774343b','2026-11-22T02:25:15.605+00:00');
INSERT INTO "presentation" VALUES('73d25382-75a0-452e-9798-cfc4ae05495f','05bf1502-84e5-4dfe-b08b-1bc9c0ecc72d','79c41077-4616-4b4e-846d-b11df774343b','2026-11-22T02:25:15.590+00:00');
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
INSERT INTO "response" VALUES('05bf1502-84e5-4dfe-b08b-1bc9c0ecc72d','79c41077-4616-4b4e-846d-b11df774343b','["2 mm"]',NULL,'',NULL,NULL,NULL,1.0,2.0,'2026-11-22T02:25:15.591+00:00','2026-11-22T02:25:15.591+00:00',NULL,NULL,NULL,'[]',4563595124054045,'0.1.0','','');
INSERT INTO "response" VALUES('30aef980-675f-4ab4-8cf4-2c72d3786a39','79c41077-4616-4b4e-846d-b11df774343b','["8 mm"]',NULL,'',NULL,NULL,NULL,1.0,2.0,'2026-11-22T02:25:15.601+00:00','2026-11-22T02:25:15.601+00:00',NULL,NULL,NULL,'[]',7866186660716219,'0.1.0','','');
INSERT INTO "response" VALUES('be92e3cf-b8b0-4912-b733-ea975e97038a','79c41077-4616-4b4e-846d-b11df774343b','["2 mm"]',NULL,'2 mm',NULL,1,NULL,1.0,2.0,'2026-11-22T02:25:15.605+00:00','2026-11-22T02:25:15.606+00:00',NULL,NULL,NULL,'[]',4245655348464672,'0.1.0','','');
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
INSERT INTO "session" VALUES('79c41077-4616-4b4e-846d-b11df774343b','52a95791154444a6','biet2008-plate','{"consent": true, "consent_form": "", "room": "quiet room", "temperature_K": null, "relative_humidity": null, "skin_moisture": null, "skin_moisture_method": "", "hand": "", "finger": "", "finger_orientation_rad": null, "normal_force_asked_N": null, "masking_noise": "", "note": ""}','null','none','','','0.1.0','2026-11-22T02:25:15.580+00:00',2738.443623615);
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
INSERT INTO "study" VALUES('be117cb6-e01d-4a99-a127-015c6ea98381','small','name = "small"
title = "Small"
displays = ["biet2008-plate"]
task = "match-to-sample"
familiarisation = 1
repetitions = 2

[[stimuli]]
name = "2 mm"
spatial_period = "2 mm"
period_means = "period"

[[stimuli]]
name = "8 mm"
spatial_period = "8 mm"
period_means = "period"

[[alternatives]]
name = "2 mm"
spatial_period = "2 mm"
period_means = "period"

[[alternatives]]
name = "8 mm"
spatial_period = "8 mm"
period_means = "period"
','99c472bd4cef516cfc6f05932512345a7b18b6757479433f099ce7839b93f5a5',7,0,1,'0.1.0','2026-11-22T02:25:15.426+00:00');
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
INSERT INTO "trial" VALUES('05bf1502-84e5-4dfe-b08b-1bc9c0ecc72d','52a95791154444a6',1,'biet2008-plate',0,'familiarisation','["2 mm"]','[]','','',0,0.0,4563595124054045);
INSERT INTO "trial" VALUES('30aef980-675f-4ab4-8cf4-2c72d3786a39','52a95791154444a6',2,'biet2008-plate',0,'familiarisation','["8 mm"]','[]','','',0,0.0,7866186660716219);
INSERT INTO "trial" VALUES('4c03cb66-2467-41f2-9fe5-6bf90a98f523','52a95791154444a6',4,'biet2008-plate',1,'main','["8 mm"]','["2 mm", "8 mm"]','8 mm','',0,0.0,5967478569694338);
INSERT INTO "trial" VALUES('7eba8471-290e-4af9-842e-ccbce2eb92ef','52a95791154444a6',6,'biet2008-plate',1,'main','["2 mm"]','["2 mm", "8 mm"]','2 mm','',0,0.0,8209960452398566);
INSERT INTO "trial" VALUES('be92e3cf-b8b0-4912-b733-ea975e97038a','52a95791154444a6',3,'biet2008-plate',1,'main','["2 mm"]','["2 mm", "8 mm"]','2 mm','',0,0.0,4245655348464672);
INSERT INTO "trial" VALUES('e1468a2f-3124-4be9-a715-b427b6a62570','52a95791154444a6',5,'biet2008-plate',1,'main','["8 mm"]','["2 mm", "8 mm"]','8 mm','',0,0.0,7540456384643997);
CREATE TABLE verification (
    uuid TEXT PRIMARY KEY,
    session TEXT REFERENCES session (uuid), -- NULL where it kept a session from starting
    moment TEXT NOT NULL,                   -- before or after
    passed INTEGER NOT NULL,
    result TEXT NOT NULL,                   -- JSON
    made_utc TEXT NOT NULL
) STRICT, WITHOUT ROWID;
INSERT INTO "verification" VALUES('4c9c5761-886a-49d6-bab9-655dc131e74f','79c41077-4616-4b4e-846d-b11df774343b','before',1,'{"amplitude_m": null, "expected_amplitude_m": null, "resonance_frequency_Hz": null, "expected_resonance_frequency_Hz": null, "amplitude_tolerance": 0.1, "resonance_tolerance": 0.01, "measurable": false, "remark": "no device: nothing was verified", "problems": []}','2026-11-22T02:25:15.589+00:00');
CREATE INDEX trial_of ON trial (participant, number);
CREATE INDEX presentation_of ON presentation (trial);
CREATE INDEX session_of ON session (participant);
COMMIT;
