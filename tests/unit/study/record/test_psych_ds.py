"""A study as a Psych-DS dataset: its files, what describes them, and the words in them."""

from __future__ import annotations

import csv
import dataclasses
import io
import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from squeezefilm import __version__
from squeezefilm.study.record.exports import description, keyword, readme
from squeezefilm.study.record.exports import psych_ds as dataset
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import SESSION_COLUMNS, trial_columns

from ..scripted import gratings, run_through

DESIGN = dataclasses.replace(gratings(1), name="small-2", title="Gerät", note="Assumed.")


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[StudyStore]:
    with run_through(tmp_path_factory.mktemp("study") / "study.sqlite", DESIGN) as found:
        yield found


def test_a_keyword_is_letters_and_digits() -> None:
    assert keyword("match-to_sample 2 Gerät²") == "matchtosample2Gert"


def test_the_files_of_the_dataset(store: StudyStore) -> None:
    files = dataset(store)
    trials, sessions = "data/study-small2_task-matchtosample", "data/study-small2_task-sessions"
    assert sorted(files) == sorted([
        "dataset_description.json", "README.md", "CHANGES.md", f"{trials}_data.csv",
        f"{trials}_data.json", f"{sessions}_data.csv", f"{sessions}_data.json",
        "materials/design.toml",
    ])  # fmt: skip
    assert files["CHANGES.md"] == f"Exported by squeezefilm {__version__}.\n"
    assert files["materials/design.toml"] == store.study["design"]
    assert files["README.md"] == readme(store)
    # Two people feel three gratings without an answer and answer three.
    assert len(list(csv.reader(io.StringIO(files[f"{trials}_data.csv"])))) == 1 + 2 * 6
    rows = list(csv.DictReader(io.StringIO(files[f"{sessions}_data.csv"])))
    assert len(rows) == 2
    assert list(rows[0]) == [column.name for column in SESSION_COLUMNS]
    for name, columns in ((trials, trial_columns(store.design)), (sessions, SESSION_COLUMNS)):
        beside = json.loads(files[f"{name}_data.json"])
        assert list(beside) == ["variableMeasured"]
        assert [one["name"] for one in beside["variableMeasured"]] == [c.name for c in columns]


def test_the_description_has_every_column_once(store: StudyStore) -> None:
    text = dataset(store)["dataset_description.json"]
    assert "Gerät" in text
    assert text.endswith("\n}\n")
    assert '\n  "@type": "Dataset",' in text
    about = json.loads(text)
    variables = {one["name"]: one for one in about.pop("variableMeasured")}
    assert set(variables) == {
        column.name for column in (*trial_columns(store.design), *SESSION_COLUMNS)
    }
    assert variables["stimulus_period_m"] == {
        "@type": "PropertyValue", "name": "stimulus_period_m",
        "description": "Its spatial period, groove plus ridge (number)", "unitText": "m",
    }  # fmt: skip
    assert variables["trial"]["description"].endswith("(whole number)")
    assert variables["correct"]["description"] == "Whether the answer was right (true or false)"
    assert variables["room"]["description"] == "What matters of the room (text)"
    assert "unitText" not in variables["room"]
    assert about == {
        "@context": "https://schema.org",
        "@type": "Dataset",
        "name": "Gerät",
        "description": description(store),
        "keywords": [
            "tactile perception", "friction modulation", "psychophysics", "match-to-sample",
        ],
    }  # fmt: skip


def test_the_study_is_described_in_one_paragraph(store: StudyStore) -> None:
    sha = store.study["design_sha256"][:12]
    said = (
        f"Gerät: match-to-sample on biet2008-plate, 2 participants; design {sha}, seed 7, recorded "
        f"with squeezefilm {__version__}. Assumed."
    )
    assert description(store) == said
    text = readme(store)
    assert text.startswith(
        f"# Gerät\n\n{said}\n\nQuestion: {DESIGN.spoken_question}\n\nThis is a P"
    )
    assert text.endswith("formula: leave out that apostrophe.\n")


def test_a_study_without_a_title_goes_by_its_name(tmp_path: Path) -> None:
    plain = dataclasses.replace(DESIGN, title="", note="", displays=("biet2008-plate", "other"))
    with StudyStore.create(tmp_path / "study.sqlite", plain, 8) as store:
        said = description(store)
        assert said.startswith(
            "small-2: match-to-sample on biet2008-plate, other, 0 participants; "
        )
        assert said.endswith(f"seed 8, recorded with squeezefilm {__version__}.")
        assert json.loads(dataset(store)["dataset_description.json"])["name"] == "small-2"
        assert readme(store).startswith("# small-2\n")
