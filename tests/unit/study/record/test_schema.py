"""A study's file with anything in it: one of our errors, or it works, and nothing goes outside."""

from __future__ import annotations

import json
import random
import sqlite3
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest

from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.study.conduct.sessions import display_wanted
from squeezefilm.study.conduct.study_device import NoDevice
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.record.deletion import delete_participant
from squeezefilm.study.record.exports import FORMATS, export_study
from squeezefilm.study.record.merge import merge
from squeezefilm.study.record.schema import TABLES, is_trace, require_identifier
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.tasks.analyze import analyze_study

from ..scripted import Bench, Script, gratings, run_through, session, staircase

ODD = (
    "", "x", "../../escaped", "/escaped", "a\x00b", "\udcff", "é" * 300, "=1+1", "nan", "NaN",
    "null", "[]", "{}", "[null]", "[[]]", '[{"a": 1}]', '["../../escaped.txt"]', '["..", "."]',
    '["nul.csv"]', "[" * 50_000, "1" * 5000, '{"measurable": true}', '{"a": [1]}', '"text"', "1",
    "2026-01-01", "2026-99-99T00:00:00+00:00", b"\x00\xff", b"", -1, 0, 1, 2, 2**62, -(2**62), 0.5,
    float("inf"), -float("inf"), 1e308, None, "main", "catch", "familiarisation", "before",
    "0123456789abcdef", '["2 mm"]', '["2 mm", "4 mm"]', '["4 mm", "4 mm"]',
)  # fmt: skip


def _use(path: Path, other: Path) -> None:
    """All that reads a file, each on its own: what one refuses the next may take."""
    with StudyStore.open(path) as store:
        people = [one["uuid"] for one in store.participants()]
        work: list[Callable[[], object]] = [
            lambda: store.study["name"],
            store.back_up,
            *(lambda format=format: export_study(store, format) for format in FORMATS),
            *(lambda who=who: conduct(session(store, who), Bench(), Script()) for who in people),
            lambda: analyze_study(store, resamples=2),
            lambda: merge(store, other),
            store.enrol,
            lambda: delete_participant(store, people[0] if people else "0" * 16),
        ]
        for one in work:
            try:
                one()
            except SqueezefilmError:
                continue
    with StudyStore.open(other) as store:
        try:
            merge(store, path)
        except SqueezefilmError:
            return


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


def _mutated(path: Path, data: bytes, seed: int) -> str:
    """One value of one row is another; the types of SQLite's tables are out of the way."""
    choose = random.Random(seed)
    path.write_bytes(data)
    connection = sqlite3.connect(path, isolation_level=None)
    connection.execute("PRAGMA writable_schema = ON")
    connection.execute("UPDATE sqlite_schema SET sql = replace(sql, 'STRICT, ', '')")
    connection.execute(f"PRAGMA schema_version = {1000 + seed}")
    connection.close()
    connection = sqlite3.connect(path, isolation_level=None)
    # Nothing was set aside in these studies.
    table = choose.choice(("study", *TABLES[:-1]))
    columns = connection.execute(f"PRAGMA table_info({table})").fetchall()
    key, column = columns[0][1], choose.choice(columns)[1]
    keys = [row[0] for row in connection.execute(f"SELECT {key} FROM {table} ORDER BY {key}")]
    value = choose.choice(ODD)
    if isinstance(value, str):
        stored: object = value.encode("utf-8", "surrogateescape")
        set_to = "CAST(? AS TEXT)"
    else:
        stored, set_to = value, "?"
    try:
        connection.execute(
            f"UPDATE {table} SET {column} = {set_to} WHERE {key} = ?", (stored, choose.choice(keys))
        )
    except sqlite3.IntegrityError:
        # A NULL or a doubled key, which the file itself keeps out.
        value = "not taken"
    connection.close()
    return f"{table}.{column} = {value!r:.40}"


def _explored(tmp_path: Path, seeds: range) -> None:
    inner = tmp_path / "deep" / "inside"
    inner.mkdir(parents=True)
    kinds = [_made(inner, adaptive) for adaptive in (False, True)]
    others = []
    for number, design in enumerate((gratings(1), staircase(4))):
        run_through(inner / f"other{number}.sqlite", design, people=1).close()
        others.append((inner / f"other{number}.sqlite").read_bytes())
    outcomes: Counter[str] = Counter()
    for seed in seeds:
        folder = inner / str(seed)
        folder.mkdir()
        path, other = folder / "study.sqlite", folder / "other.sqlite"
        other.write_bytes(others[seed % 2])
        what = _mutated(path, kinds[seed % 2], seed)
        try:
            _use(path, other)
            outcomes["taken"] += 1
        except SqueezefilmError:
            outcomes["refused"] += 1
        except BaseException as error:
            raise AssertionError(f"seed {seed}: {what}") from error
        outside = [one.name for one in tmp_path.rglob("*escaped*")]
        assert not outside, f"seed {seed}: {what} wrote {outside}"
    print(f"\n{len(seeds)} files from seed {seeds.start}: {dict(outcomes)}")
    assert outcomes["refused"] > outcomes["taken"] / 5


def test_a_value_of_any_kind_anywhere_is_one_of_our_errors_or_works(tmp_path: Path) -> None:
    _explored(tmp_path, range(3))


@pytest.mark.nightly
def test_500_values_anywhere(tmp_path: Path) -> None:
    _explored(tmp_path, range(3, 503))


def _torn(tmp_path: Path, seeds: range) -> None:
    (tmp_path / "made").mkdir()
    data = _made(tmp_path / "made", adaptive=False)
    other = tmp_path / "other.sqlite"
    run_through(other, gratings(1), people=1).close()
    for seed in seeds:
        choose = random.Random(seed)
        torn = bytearray(data)
        for _ in range(choose.choice((1, 1, 30, 1000))):
            torn[choose.randrange(len(torn))] = choose.randrange(256)
        if choose.random() < 0.2:
            del torn[choose.randrange(len(torn)) :]
        folder = tmp_path / str(seed)
        folder.mkdir()
        (folder / "study.sqlite").write_bytes(torn)
        try:
            _use(folder / "study.sqlite", other)
        except SqueezefilmError:
            continue
        except BaseException as error:
            raise AssertionError(f"seed {seed}") from error


def test_a_torn_file_is_one_of_our_errors_or_works(tmp_path: Path) -> None:
    _torn(tmp_path, range(3))


@pytest.mark.nightly
def test_300_torn_files(tmp_path: Path) -> None:
    _torn(tmp_path, range(3, 303))


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
    ("UPDATE study SET seed = -1", "study .* has seed = -1"),
    ("UPDATE study SET seed = 9007199254740993", "has seed = 9007199254740993"),
    ("UPDATE study SET stations = 0", "has stations = 0"),
    ("UPDATE study SET station = -1", "has station = -1"),
    ("UPDATE study SET created_utc = '2026-01-01T00:00:00'", "has created_utc"),
    ("UPDATE study SET uuid = '0123456789abcde'", "has uuid"),
    ("UPDATE participant SET number = -1", "participant .* has number = -1"),
    ("UPDATE participant SET enrolled_utc = 'today'", "has enrolled_utc = 'today'"),
    ("UPDATE trial SET number = -1 WHERE number = 1", "trial .* has number = -1"),
    ("UPDATE trial SET display = 'glass'", "has display = 'glass'"),
    ("UPDATE trial SET phase = 'last'", "has phase = 'last'"),
    ("UPDATE trial SET stimuli = '{}'", "has stimuli = '{}'"),
    ("UPDATE trial SET stimuli = '[1]'", r"has stimuli = '\[1\]'"),
    ("UPDATE trial SET stimuli = '['", r"has stimuli = '\['"),
    ("UPDATE trial SET alternatives = '[null]'", "has alternatives"),
    ("UPDATE trial SET adaptive = 'stairs'", "has adaptive = 'stairs'"),
    ("UPDATE trial SET pause_s = -0.1", "has pause_s = -0.1"),
    ("UPDATE trial SET pause_s = 9e999", "has pause_s = inf"),
    ("UPDATE trial SET seed = -1", "has seed = -1"),
    ("UPDATE session SET conditions = '{\"a\": [1]}'", "session .* has conditions"),
    ("UPDATE session SET conditions = 'null'", "has conditions = 'null'"),
    ("UPDATE session SET exposure = '[]'", "has exposure"),
    ("UPDATE session SET started_utc = ''", "has started_utc"),
    ("UPDATE verification SET moment = 'meanwhile'", "has moment = 'meanwhile'"),
    ("UPDATE verification SET result = '{\"measurable\": true}'", "has result"),
    ("UPDATE verification SET result = 'null'", "has result = 'null'"),
    ("UPDATE verification SET result = '{\"measurable\": true, \"amplitude_m\": [1], "
     "\"resonance_frequency_Hz\": 1}'", "has result"),
    ("UPDATE presentation SET presented_utc = 'x'", "presentation .* has presented_utc"),
    ("UPDATE response SET traces = '[\"../../escaped\"]'", "response .* has traces"),
    ("UPDATE response SET correct = 2", "has correct = 2"),
    ("UPDATE response SET response_time_s = -1.0", "has response_time_s = -1.0"),
    # What no column shows alone.
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


def test_what_may_be_left_open_is_taken(tmp_path: Path) -> None:
    """The ends of what is written: the highest seed, no exposure or an object of plain values."""
    path = tmp_path / "study.sqlite"
    path.write_bytes(_made(tmp_path, adaptive=False))
    exposure = json.dumps({"acknowledged": True, "level_dB": 124.0, "guidance_dB": None, "n": 1})
    for statement in (
        f"UPDATE study SET seed = {2**53}",
        "UPDATE study SET seed = 0",
        "UPDATE session SET exposure = 'null'",
        f"UPDATE session SET exposure = '{exposure}'",
        "UPDATE response SET correct = 0",
        "UPDATE response SET correct = NULL, response_time_s = NULL",
        "UPDATE response SET response_time_s = 0.0",
        f'UPDATE response SET traces = \'["{"0af9" * 8}.csv", "{"0af9" * 8}.sqft"]\'',
        "UPDATE trial SET pause_s = 0.0",
        "UPDATE verification SET session = NULL, moment = 'after'",
    ):
        connection = sqlite3.connect(path, isolation_level=None)
        connection.execute(statement)
        connection.close()
        StudyStore.open(path).close()


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
