"""A study as a BIDS dataset: its files, columns and words, and cells that TSV cannot hold."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from squeezefilm import __version__
from squeezefilm.study.conduct.run import StudyRun
from squeezefilm.study.conduct.sessions import SessionConditions, begin_session
from squeezefilm.study.conduct.study_device import NoDevice
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.record.exports import bids as dataset
from squeezefilm.study.record.exports import description, readme
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import COLUMNS, SESSION_COLUMNS, trial_table

from ..scripted import Script, gratings

DESIGN = dataclasses.replace(gratings(1), title="Gerät")
ROOMS = ("a\tb\nc  d", "  ")


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[StudyStore]:
    """Two people in rooms whose names TSV cannot hold as they are."""
    path = tmp_path_factory.mktemp("study") / "study.sqlite"
    with StudyStore.create(path, DESIGN, 7) as found:
        for room in ROOMS:
            conditions = SessionConditions(consent=True, room=room)
            who = found.enrol()
            begun = begin_session(found, who, NoDevice(), conditions, None, acknowledged=False)
            conduct(StudyRun(found, begun), NoDevice(), Script())
        yield found


@pytest.fixture(scope="module")
def files(store: StudyStore) -> dict[str, str]:
    return dataset(store)


def table(text: str) -> list[dict[str, str]]:
    assert text.endswith("\n")
    names, *rows = (line.split("\t") for line in text[:-1].split("\n"))
    return [dict(zip(names, row, strict=True)) for row in rows]


def people(store: StudyStore) -> list[str]:
    return [str(one["uuid"]) for one in store.participants()]


def test_each_person_has_trials_and_sittings(store: StudyStore, files: dict[str, str]) -> None:
    own = [
        f"sub-{one}/beh/sub-{one}_task-{task}_beh.tsv"
        for one in people(store)
        for task in ("matchtosample", "sittings")
    ]
    assert sorted(files) == sorted([
        "dataset_description.json", "README", "CHANGES", "participants.tsv", "participants.json",
        "task-matchtosample_beh.json", "task-sittings_beh.json", *own,
    ])  # fmt: skip
    assert table(files["participants.tsv"]) == [
        {"participant_id": f"sub-{one}", "participant_number": str(number)}
        for number, one in enumerate(people(store))
    ]
    recorded = trial_table(store)
    for place, one in enumerate(people(store)):
        trials, sittings = (table(files[name]) for name in own[2 * place : 2 * place + 2])
        mine = [row for row in recorded if row["participant_id"] == one]
        assert len(trials) == len(mine) == 6
        assert [row["sitting_id"] for row in trials] == [row["session_id"] for row in mine]
        assert [int(row["trial"]) for row in trials] == [row["trial"] for row in mine]
        assert [row["sitting_id"] for row in sittings] == [trials[0]["sitting_id"]]
        assert sittings[0]["room"] == ("a b c d", "n/a")[place]
        assert sittings[0]["temperature_K"] == "n/a"
        assert sittings[0]["consent"] == "true"


def _says(columns: Any, leave: str) -> dict[str, Any]:
    """What a sidecar says of columns: sessions by the name that BIDS leaves us."""
    return {
        one.name.replace("session_id", "sitting_id"): {"Description": one.description}
        | ({"Units": one.unit} if one.unit else {})
        for one in columns
        if not one.name.startswith(leave)
    }


def test_sidecars_describe_the_columns_of_their_tables(
    store: StudyStore, files: dict[str, str]
) -> None:
    trials = json.loads(files["task-matchtosample_beh.json"])
    assert trials == {
        "TaskName": "matchtosample",
        "TaskDescription": description(store),
        "Instructions": DESIGN.spoken_question,
        **_says(COLUMNS, "participant_"),
    }
    assert trials["path_length_m"] == {
        "Description": "Way of the finger during the trial", "Units": "m",
    }  # fmt: skip
    sittings = json.loads(files["task-sittings_beh.json"])
    assert sittings == {
        "TaskName": "sittings",
        "TaskDescription": "Conditions, airborne ultrasound and the device's state, by sitting",
        **_says(SESSION_COLUMNS, "participant_id"),
    }
    who = people(store)[0]
    for task, said in (("matchtosample", trials), ("sittings", sittings)):
        columns = table(files[f"sub-{who}/beh/sub-{who}_task-{task}_beh.tsv"])[0]
        assert list(columns) == [name for name in said if name[0].islower()]
    assert json.loads(files["participants.json"]) == {
        "participant_number": {"Description": "Which of the balanced orders they had, from 0"}
    }


def test_the_dataset_says_what_it_is(store: StudyStore, files: dict[str, str]) -> None:
    text = files["dataset_description.json"]
    assert text.startswith('{\n  "Name": "Gerät",\n')
    assert text.endswith("}\n")
    assert json.loads(text) == {
        "Name": "Gerät",
        "BIDSVersion": "1.10.0",
        "DatasetType": "raw",
        "GeneratedBy": [{"Name": "squeezefilm", "Version": __version__}],
    }
    assert files["README"] == f"{readme(store, 'BIDS')}\n{description(store)}\n"
    day = str(store.study["created_utc"])[:10]
    assert files["CHANGES"] == f"1.0.0 {day}\n  - Exported by squeezefilm.\n"
    assert len(day.split("-")) == 3


def test_a_study_of_nobody_has_its_frame(tmp_path: Path) -> None:
    plain = dataclasses.replace(DESIGN, title="")
    with StudyStore.create(tmp_path / "study.sqlite", plain, 7) as store:
        files = dataset(store)
    assert json.loads(files["dataset_description.json"])["Name"] == "small"
    assert files["participants.tsv"] == "participant_id\tparticipant_number\n"
    assert not [name for name in files if name.startswith("sub-")]
