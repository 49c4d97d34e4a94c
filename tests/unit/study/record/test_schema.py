"""A study's file with anything in it: one of our errors, or it works, and nothing goes outside."""

from __future__ import annotations

import sqlite3
from pathlib import Path

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.study.conduct.sessions import display_wanted
from squeezefilm.study.conduct.study_device import NoDevice
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.record.schema import is_trace, require_identifier
from squeezefilm.study.record.store import StudyStore

from ..scripted import Script, gratings, session, staircase


def _made(folder: Path, adaptive: bool) -> bytes:
    path = folder / "made.sqlite"
    design = staircase(4) if adaptive else gratings(1)
    with StudyStore.create(path, design, 7) as store:
        for most in (2, 20):
            who = store.enrol()
            try:
                conduct(session(store, who), NoDevice(), Script(most=most))
            except KeyboardInterrupt:
                assert display_wanted(store, who)
    data = path.read_bytes()
    path.unlink()
    return data


def test_a_file_with_triggers_or_other_tables_is_refused(tmp_path: Path) -> None:
    for name, statement, says in (
        ("a", "CREATE TRIGGER t AFTER INSERT ON response BEGIN DELETE FROM trial; END", "trigger"),
        ("b", "CREATE VIEW v AS SELECT * FROM trial", "a view"),
        ("c", "ALTER TABLE response ADD COLUMN more TEXT", "other columns"),
        ("d", "DELETE FROM study", "0 studies"),
    ):
        path = tmp_path / f"{name}.sqlite"
        StudyStore.create(path, gratings(), 7).close()
        connection = sqlite3.connect(path, isolation_level=None)
        connection.execute(statement)
        connection.close()
        with pytest.raises(InputError, match=f"damaged or was not written by this .*{says}"):
            StudyStore.open(path)


# One value that this program never writes, and what is said of it. Each stands alone.
WRONG = (
    ("UPDATE study SET uuid = '0123456789abcde'", "study has uuid"),
    ("UPDATE trial SET phase = 'last'", "trial has phase = 'last'"),
    ("UPDATE trial SET stimuli = '{}'", "has stimuli = '{}'"),
    ("UPDATE trial SET stimuli = '[1]'", r"has stimuli = '\[1\]'"),
    ("UPDATE trial SET stimuli = '['", r"has stimuli = '\['"),
    ("UPDATE trial SET alternatives = '[null]'", "has alternatives"),
    ("UPDATE response SET traces = '[\"../../escaped\"]'", "response has traces"),
    # What no column shows alone.
    ("UPDATE trial SET display = 'glass'", "is on 'glass', which its design does not have"),
    ("UPDATE trial SET adaptive = 'stairs'", "is of 'stairs', which its design does not have"),
    ("UPDATE trial SET stimuli = '[\"9 mm\"]' WHERE phase = 'main'", "which its design does not"),
    ("UPDATE trial SET stimuli = '[]' WHERE number = 3", "presents .*which its design does not"),
    ("UPDATE trial SET alternatives = '[\"9 mm\"]'", "offers .*which its design does not"),
    ("UPDATE response SET stimuli = '[\"8 mm\", \"2 mm\"]'", "instead of"),
    ("UPDATE response SET stimuli = '[]'", r"is to \[\] instead of"),
    ("UPDATE response SET choice = '9 mm'", "is '9 mm', which was not offered"),
    ("DELETE FROM participant", r"a row of \w+ belongs to one of participant that is gone"),
)  # fmt: skip


def test_each_value_that_was_never_written_is_named(tmp_path: Path) -> None:
    data = _made(tmp_path, adaptive=False)
    path = tmp_path / "study.sqlite"
    path.write_bytes(data)
    StudyStore.open(path).close()
    for statement, says in WRONG:
        path.write_bytes(data)
        connection = sqlite3.connect(path, isolation_level=None)
        connection.execute(statement)
        connection.close()
        with pytest.raises(InputError, match=f"damaged or was not written by this .*{says}"):
            StudyStore.open(path)


def test_an_adaptive_answer_has_its_intensity(tmp_path: Path) -> None:
    path = tmp_path / "study.sqlite"
    path.write_bytes(_made(tmp_path, adaptive=True))
    StudyStore.open(path).close()
    connection = sqlite3.connect(path, isolation_level=None)
    connection.execute("UPDATE response SET intensity = NULL")
    connection.close()
    with pytest.raises(InputError, match="has no intensity"):
        StudyStore.open(path)


def test_names_of_traces_are_known_half_written_or_not() -> None:
    name = "0af9" * 8
    for ours in (f"{name}.csv", f"{name}.sqft", f".{name}.sqft.k2_x"):
        assert is_trace(ours)
    for other in (f"{name}.txt", f"{name[:-1]}.csv", f".{name}.sqft", f"x{name}.csv",
                  f"{name}.csv~", f".{name}.csv.K"):  # fmt: skip
        assert not is_trace(other)


def test_a_pseudonym_is_of_16_to_36_digits_and_letters() -> None:
    for fine in ("0123456789abcdef", "a" * 36, "01234567-89ab-cdef"):
        require_identifier(fine)
    for none in ("0123456789abcde", "a" * 37, "0123456789abcdeg", "0123456789abcdef\n", ""):
        with pytest.raises(InputError, match="is no participant's pseudonym"):
            require_identifier(none)
    with pytest.raises(InputError, match=f"^'{'x' * 80}' is"):
        require_identifier("x" * 90)
