"""CSV and Psych-DS: what others read, and what their validators say."""

from __future__ import annotations

import csv
import io
import json
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from squeezefilm.core.errors import InputError
from squeezefilm.study.conduct.run import StudyRun
from squeezefilm.study.conduct.sessions import SessionConditions, begin_session
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.record.exports import export_study, exported_folders
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import (
    Column,
    cell_text,
    csv_text,
    guarded,
    trial_columns,
    trial_table,
    unguarded,
)

from .scripted import LOUD, Bench, Script, gratings, run_through, staircase


@pytest.fixture
def store(tmp_path: Path) -> Iterator[StudyStore]:
    """Two people, one with a formula where a room should be."""
    found = StudyStore.create(tmp_path / "study.sqlite", gratings(), 7)
    for _ in range(2):
        device = Bench()
        conditions = SessionConditions(consent=True, room='=HYPERLINK("x")')
        begun = begin_session(found, found.enrol(), device, conditions, LOUD, acknowledged=True)
        conduct(StudyRun(found, begun), device, Script())
    yield found
    found.close()


@given(st.text())
def test_no_text_becomes_a_formula_and_every_text_comes_back(text: str) -> None:
    text = text.replace("\x00", "")
    cell = guarded(text)
    assert unguarded(cell) == text
    assert cell.lstrip()[:1] not in ("=", "+", "-", "@", "＝", "＋", "－", "＠")
    assert cell[:1] not in ("\t", "\r", "\n")
    written = csv_text([{"a": text, "b": 1}], [Column("a", ""), Column("b", "")])
    _, row = csv.reader(io.StringIO(written, newline=""))
    assert row == [cell, "1"]


@pytest.mark.parametrize("text", ["=1+1", "+1", "-1", "@x", "\t=1", "\r1", " =1", "'x", "＝1"])
def test_formulas_are_guarded(text: str) -> None:
    assert guarded(text) == f"'{text}"


@given(st.floats(allow_nan=False, allow_infinity=False) | st.integers())
def test_numbers_stay_numbers(value: float) -> None:
    assert type(value)(cell_text(value)) == value


def test_a_row_a_trial_with_numbers_as_numbers(store: StudyStore) -> None:
    rows = list(
        csv.DictReader(io.StringIO(csv_text(trial_table(store), trial_columns(store.design))))
    )
    assert len(rows) == 18
    assert list(rows[0]) == [column.name for column in trial_columns(store.design)]
    main = [row for row in rows if row["phase"] == "main"]
    assert {row["correct"] for row in main} <= {"true", "false"}
    assert {float(row["stimulus_period_m"]) for row in main} == {2e-3, 4e-3, 8e-3}
    assert {float(row["stimulus_friction_depth"]) for row in main} == {1.0 - 0.7}
    felt = [row for row in rows if row["phase"] == "familiarisation"]
    assert {row["stimulus_friction_depth"] for row in felt} == {""}
    assert {float(row["mean_speed_m_per_s"]) for row in main} == {0.086}


def test_an_adaptive_comparison_has_its_period(tmp_path: Path) -> None:
    with run_through(tmp_path / "a.sqlite", staircase(6), people=1) as store:
        rows = trial_table(store)
    for row in rows:
        ends = sorted(float(row[key]) for key in ("stimulus_period_m", "second_stimulus_period_m"))
        assert ends[0] == 4e-3
        assert ends[1] == pytest.approx(4e-3 * (1 + float(row["intensity"])))
        assert row["correct"] == (row["choice"] == row["answer"])


def test_psych_ds_says_of_every_column_what_it_is(store: StudyStore) -> None:
    folder = export_study(store, "psych-ds")
    about = json.loads((folder / "dataset_description.json").read_text())
    assert about["@context"] == "https://schema.org"
    assert about["@type"] == "Dataset"
    assert about["name"]
    assert about["description"]
    described = {one["name"] for one in about["variableMeasured"]}
    data = sorted((folder / "data").glob("*.csv"))
    assert len(data) == 2
    columns: set[str] = set()
    for path in data:
        parts = path.stem.split("_")
        assert parts[-1] == "data"
        for part in parts[:-1]:
            key, value = part.split("-")
            assert key.isalpha()
            assert key.islower()
            assert value.isalnum()
        rows = list(csv.reader(io.StringIO(path.read_text(encoding="utf-8"))))
        assert len({len(row) for row in rows}) == 1
        sidecar = json.loads(path.with_suffix(".json").read_text())
        assert [one["name"] for one in sidecar["variableMeasured"]] == rows[0]
        columns |= set(rows[0])
        assert "=HYPERLINK" not in {cell[:10] for row in rows for cell in row}
    assert columns == described


def _validated(program: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    found = shutil.which(program)
    if found is None:
        pytest.skip(f"{program} is not installed; it is an oracle, not a dependency")
    return subprocess.run([found, *arguments], capture_output=True, text=True, check=False)


def test_psych_ds_validator(store: StudyStore) -> None:
    folder = export_study(store, "psych-ds")
    done = _validated("psychds-validator", str(folder))
    assert done.returncode == 0, done.stdout + done.stderr


def test_an_export_is_replaced_and_other_peoples_files_are_not(
    store: StudyStore, tmp_path: Path
) -> None:
    target = tmp_path / "out"
    export_study(store, "csv", target)
    (target / "small_trials.csv").write_text("spoilt")
    (target / ".small_trials.csv.abc").write_text("half")
    export_study(store, "psych-ds", target)
    assert (target / "data").is_dir()
    assert not (target / "small_trials.csv").exists()
    assert not (target / ".small_trials.csv.abc").exists()
    assert exported_folders(store) == [("psych-ds", target.resolve())]
    (target / "mine.txt").write_text("mine")
    with pytest.raises(InputError, match=r"mine\.txt"):
        export_study(store, "csv", target)
    assert (target / "mine.txt").read_text() == "mine"
    with pytest.raises(InputError, match="not known"):
        export_study(store, "excel")  # type: ignore[arg-type]


def test_a_link_among_an_exports_files_is_left(store: StudyStore, tmp_path: Path) -> None:
    target = tmp_path / "precious.txt"
    target.write_text("precious")
    folder = export_study(store, "psych-ds")
    (folder / "README.md").unlink()
    (folder / "README.md").symlink_to(target)
    with pytest.raises(InputError, match=r"has files of its own \(README\.md\)"):
        export_study(store, "psych-ds")
    (folder / "README.md").unlink()
    (folder / "data").rename(tmp_path / "data")
    (folder / "data").symlink_to(tmp_path / "data")
    with pytest.raises(InputError, match=r"has files of its own \(data\)"):
        export_study(store, "psych-ds")
    assert target.read_text() == "precious"
    assert all(one.stat().st_size for one in (tmp_path / "data").iterdir())


@pytest.mark.parametrize("mark", ["", "{", "[]", '{"files": 1}', "[" * 100_000])
def test_a_damaged_mark_is_one_message(store: StudyStore, mark: str) -> None:
    folder = export_study(store, "csv")
    (folder / ".squeezefilm-export.json").write_text(mark)
    with pytest.raises(InputError, match="remove this export by hand"):
        export_study(store, "csv")


def test_an_export_whose_mark_a_full_disk_left_half_erased_is_made_again(store: StudyStore) -> None:
    folder = export_study(store, "csv")
    mark = folder / ".squeezefilm-export.json"
    content = mark.read_text()
    for path in folder.iterdir():
        if path != mark:
            path.unlink()
    mark.write_text("\0" * 8 + content[8:])
    export_study(store, "csv")
    assert mark.read_text() == content


def test_no_cell_of_any_export_is_a_formula(tmp_path: Path) -> None:
    from squeezefilm.physics.perception.stimuli import Grating, Stimulus
    from squeezefilm.study.design.study_design import StudyDesign
    from squeezefilm.study.record.exports import FORMATS

    evil = "cmd|' /C calc'!A0"
    # Names of stimuli are printable; texts of a sitting are any.
    names = {f"{begin}{evil}": (k + 1) * 1e-3 for k, begin in enumerate(("=", "+", "-", "@", "＝"))}
    design = StudyDesign(
        name="small",
        title=f"={evil}",
        displays=("biet2008-plate",),
        task="match-to-sample",
        stimuli=tuple(Stimulus(name, at, "period") for name, at in names.items()),
        alternatives=tuple(Grating(name, at, "period") for name, at in names.items()),
        note=f"={evil}",
    )
    texts = ("room", "note", "masking_noise", "skin_moisture_method", "consent_form")
    begins = ("\t", "\r", "\n=", " =", "'=")
    written = {name: f"{begin}{evil}" for name, begin in zip(texts, begins, strict=True)}
    conditions = SessionConditions(consent=True, finger_orientation=-0.5, **written)
    with StudyStore.create(tmp_path / "study.sqlite", design, 7) as found:
        device = Bench()
        begun = begin_session(found, found.enrol(), device, conditions, LOUD, acknowledged=True)
        conduct(StudyRun(found, begun), device, Script())
        folders = [export_study(found, format) for format in FORMATS]
    negative = 0
    for path in (one for folder in folders for one in folder.rglob("*.[ct]sv")):
        kind = "excel" if path.suffix == ".csv" else "excel-tab"
        for row in csv.reader(io.StringIO(path.read_bytes().decode(), newline=""), kind):
            for cell in row:
                # A number may begin with its sign, and stays one; nothing else may.
                if cell.lstrip()[:1] in ("=", "+", "-", "@", "＝") or cell[:1] in (
                    "\t",
                    "\r",
                    "\n",
                ):
                    assert float(cell) == -0.5
                    negative += 1
    assert negative == 2
