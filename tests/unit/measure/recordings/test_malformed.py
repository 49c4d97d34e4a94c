"""Damaged files: each is refused with its line and column, or read with a doubt; nothing else
comes."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.faults.mutations import mutated
from tests.unit.measure.recordings.bench_files import (
    IMPEDANCE,
    export_4294a,
    impedance_text,
    resonator,
    text,
    written,
)

from squeezefilm.core.errors import ConfigError
from squeezefilm.measure.recordings.read import check_recording

GOOD = impedance_text()
ROWS = GOOD.count("\n") - 1


def line(number: int, new: str, good: str = GOOD) -> str:
    """A good file with another text in a line."""
    lines = good.split("\n")
    lines[number - 1] = new
    return "\n".join(lines)


def cell(number: int, column: int, new: str) -> str:
    """A good file with another text in a cell."""
    cells = GOOD.split("\n")[number - 1].split(",")
    cells[column - 1] = new
    return line(number, ",".join(cells))


def swapped(good: str = GOOD) -> str:
    """The first two columns of numbers in each other's place, the header as it was."""
    head, *rows = good.strip().split("\n")
    mixed = [",".join((b, a, c)) for a, b, c in (row.split(",") for row in rows)]
    return "\n".join([head, *mixed, ""])


# What was done to the file, and where and how the message says it.
REFUSED = {
    "cut within a row": (GOOD[: GOOD.rindex(",")], 42, 2, "the file ends within a row"),
    "a row without its last cell": (line(9, "29350,4000"), 9, 2, "has 2 cells where the rows"),
    "a row with a cell too many": (line(9, "1,2,3,4"), 9, 4, "has 4 cells where the rows"),
    "NaN": (cell(7, 3, "NaN"), 7, 3, "nan is no finite number"),
    "an empty cell": (cell(7, 2, ""), 7, 2, "the cell is empty"),
    "overflow of the instrument": (cell(5, 2, "OVLD"), 5, 2, "'OVLD' is no number"),
    "infinity": (cell(5, 2, "inf"), 5, 2, "inf is no finite number"),
    "one decimal comma": (line(6, '29200,"3,5",-80'), 6, 2, "decimals after ','"),
    "a damaged first row": (cell(2, 2, "x12"), 2, 2, "'x12' stands beside a number"),
    "a frequency that falls back": (cell(20, 1, "29000"), 20, 1, "must rise from row to row"),
    "a row twice": (line(9, GOOD.split("\n")[7]), 9, 1, "stands twice, in lines 8 and 9"),
    "columns swapped": (swapped(), 3, 1, "column 2 'Z (ohm)' does: are columns swapped"),
    "hertz that are megahertz": (
        GOOD.replace("f (Hz)", "f").replace("29000,", "29000000000000,"), 2, 1, "cannot be right",
    ),
    "a magnitude of zero": (cell(4, 2, "0"), 4, 2, "0 ohm cannot be right"),
    "a negative magnitude": (cell(4, 2, "-5"), 4, 2, "-5 ohm cannot be right"),
    "a NUL": (cell(4, 2, "\0"), None, None, "holds bytes that no text has"),
    "no numbers": ("nothing\nhere\n", 1, None, "holds no line with two numbers"),
    "nothing": ("", None, None, "holds no line with two numbers"),
    "a header only": (GOOD.split("\n")[0], 1, None, "holds no line with two numbers"),
    "two rows": ("\n".join(GOOD.split("\n")[:3]) + "\n", None, None, "has 2 rows, too few"),
}  # fmt: skip


@pytest.mark.parametrize("damage", REFUSED)
def test_a_damaged_file_is_refused_where_it_is_damaged(damage: str, tmp_path: Path) -> None:
    data, at, column, says = REFUSED[damage]
    with pytest.raises(ConfigError) as caught:
        check_recording(written(tmp_path, data))
    assert says in str(caught.value)
    assert (caught.value.line, caught.value.column) == (at, column)
    assert str(tmp_path / "a.csv") in str(caught.value)


def test_decimal_commas_are_read_and_a_mixture_is_refused(tmp_path: Path) -> None:
    good = check_recording(written(tmp_path, GOOD))
    commas = impedance_text(";").replace(".", ",")
    read = check_recording(written(tmp_path, commas, name="b.csv"))
    assert np.array_equal(read.recording.admittance, good.recording.admittance)
    assert ("read as", "text, semicolons between the columns, decimals after a comma") in read.facts
    mixed = commas.replace("29050;", "29050,0;").replace("29100;", "29100.0;")
    with pytest.raises(ConfigError, match="write all of them alike") as caught:
        check_recording(written(tmp_path, mixed, name="c.csv"))
    assert (caught.value.line, caught.value.column) == (4, 1)


def test_commas_for_decimals_and_between_columns_are_refused(tmp_path: Path) -> None:
    data = "f,Z,theta\n" + "".join(f"29{k:03d},5,40{k:02d},25,-80,5\n" for k in range(10))
    with pytest.raises(ConfigError, match="cannot be told apart") as caught:
        check_recording(written(tmp_path, data))
    assert caught.value.line == 2


def test_a_unit_other_than_the_file_s_own_is_refused_with_both(tmp_path: Path) -> None:
    told = IMPEDANCE.replace('"Hz"', '"kHz"')
    with pytest.raises(
        ConfigError, match=r"the description says kHz, and the file \(line 1\)"
    ) as e:
        check_recording(written(tmp_path, GOOD, told))
    assert (e.value.line, e.value.key) == (4, "columns.frequency.unit")


DESCRIPTIONS = {
    "an unknown kind": ('"impedance"', '"impedence"', "Did you mean 'impedance'", "kind"),
    "a kind that is a list": ('"impedance"', '["impedance"]', "is not known", "kind"),
    "an unknown key": ("name =", "nmae =", "unknown key 'nmae'. Did you mean 'name'", "nmae"),
    "an unknown quantity": ("phase =", "phse =", "Did you mean 'phase'", "columns.phse"),
    "no such column": ('"theta"', '"thta"', "Did you mean 'theta'", "columns.phase.column"),
    "no such number": ('"theta"', "4", "the file has no column 4", "columns.phase.column"),
    "another dimension": ('"deg"', '"mm"', "mm is no unit of a phase", "columns.phase.unit"),
    "decibels": ('"ohm"', '"dB"', "does not say what 0 dB stands for", "columns.magnitude.unit"),
    "decibels of a phase": ('"deg"', '"dB re 1 rad"', "no amplitude here", "columns.phase.unit"),
    "half a pair": ("magnitude = {", "# {", "one pair must be named", "columns"),
    "a convention where none is": (
        '"ohm"', '"ohm", given_as = "rms"', "is no amplitude; delete it",
        "columns.magnitude.given_as",
    ),
    "other points": ("name =", "points = 801 #", "and the file has 41 rows", "points"),
    "a header below": ("name =", "header = 5 #", "the first row of numbers stands in line 2", None),
}  # fmt: skip


@pytest.mark.parametrize("slip", DESCRIPTIONS)
def test_a_slip_in_the_description_is_refused_at_its_key(slip: str, tmp_path: Path) -> None:
    old, new, says, key = DESCRIPTIONS[slip]
    with pytest.raises(ConfigError) as caught:
        check_recording(written(tmp_path, GOOD, IMPEDANCE.replace(old, new)))
    assert says in str(caught.value)
    assert caught.value.key == key


def test_a_file_without_a_description_says_what_to_write(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"write a\.toml beside it") as caught:
        check_recording(written(tmp_path, GOOD, ""))
    assert "1 'f (Hz)', 2 'Z (ohm)', 3 'theta (deg)'" in str(caught.value)


def test_other_encodings_and_notations_are_read(tmp_path: Path) -> None:
    good = check_recording(written(tmp_path, GOOD)).recording.admittance
    named = GOOD.replace("theta (deg)", "theta (°)")
    head = "an analyser\n\n# a comment\n"
    lines = GOOD.strip().split("\n")
    for number, data in enumerate(
        (
            "\ufeff" + GOOD,
            named.encode("latin-1"),
            GOOD.encode("utf-16"),
            GOOD.replace("\n", "\r\n"),
            head + GOOD,
            GOOD.rstrip("\n"),
            "".join(f"{one},\n" for one in lines),
            "# " + GOOD.replace(",", "\t"),
            "f,Z,theta\nHz,ohm,deg\n" + "\n".join(lines[1:]),
            GOOD.replace(",", "  ").replace("f (Hz)", '"f (Hz)"').replace("Z (ohm)", '"Z (ohm)"')
            .replace("theta (deg)", '"theta (deg)"'),
        )
    ):  # fmt: skip
        encoded = data if isinstance(data, bytes) else data.encode()
        found = check_recording(written(tmp_path, encoded, name=f"n{number}.csv"))
        assert np.array_equal(found.recording.admittance, good), number
    latin = check_recording(tmp_path / "n1.csv")
    assert any("Latin-1" in how for _, how in latin.facts)


@given(at=st.integers(0, len(GOOD)))
def test_a_file_cut_anywhere_is_read_to_where_it_goes_or_refused(
    at: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    cut = GOOD[:at]
    rows = [row for row in cut.split("\n")[1:] if row]
    try:
        found = check_recording(written(tmp_path_factory.mktemp("cut"), cut))
    except ConfigError:
        return
    assert found.points == len(rows)
    whole = GOOD.split("\n")[1 : len(rows) + 1]
    if rows != whole and len(rows[-1]) < min(map(len, whole)):
        assert any("cut short" in doubt for doubt in found.doubts)


@given(at=st.integers(0, len(export_4294a()) - 1))
def test_an_export_cut_anywhere_is_refused(
    at: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    data = export_4294a()
    try:
        found = check_recording(written(tmp_path_factory.mktemp("cut"), data[:at], "", "a.txt"))
    except ConfigError:
        return
    # Only digits of the very last number may be lost without a trace in the count.
    assert found.points == 41
    assert "\n" not in data[at:].rstrip("\n")


def test_an_export_says_itself_what_it_holds(tmp_path: Path) -> None:
    found = check_recording(written(tmp_path, export_4294a(), "", "a.txt"))
    f, z = resonator()
    assert found.kind == "impedance"
    assert np.allclose(found.recording.frequency, f)
    assert np.allclose(1 / found.recording.admittance, z, rtol=1e-6)
    assert found.doubts == ()
    damaged = export_4294a().replace("NUMBER of POINTS: 41", "NUMBER of POINTS: 42")
    with pytest.raises(ConfigError, match="trace A has 41 points, and the head says 42"):
        check_recording(written(tmp_path, damaged, "", "b.txt"))
    other = export_4294a().replace("IMPEDANCE MAG PHASE (DEG)", "IMPEDANCE MAG Q")
    with pytest.raises(ConfigError, match="nothing says for sure"):
        check_recording(written(tmp_path, other, "", "c.txt"))


def test_a_phase_off_by_180_degrees_is_noticed_and_turned_only_on_request(tmp_path: Path) -> None:
    f, z = resonator()
    turned = text("f,Z,theta", (f, np.abs(z), np.degrees(np.angle(z)) + 180))
    found = check_recording(written(tmp_path, turned))
    assert "phase that is off by 180 deg" in found.doubts[0]
    assert np.allclose(found.recording.admittance, -1 / z)
    asked = IMPEDANCE.replace("[columns]", 'correct = "phase 180 deg"\n[columns]')
    mended = check_recording(written(tmp_path, turned, asked, "b.csv"))
    assert np.allclose(mended.recording.admittance, 1 / z)
    assert mended.doubts == ()
    assert ("corrected", "the phase by 180 deg, as the description asks") in mended.facts


def test_a_phase_of_the_other_sign_is_noticed_and_turned_only_on_request(tmp_path: Path) -> None:
    f, z = resonator()
    data = text("f,Z,theta", (f, np.abs(z), -np.degrees(np.angle(z))))
    found = check_recording(written(tmp_path, data))
    assert "the sign of the phase may be the other one" in found.doubts[0]
    asked = IMPEDANCE.replace("[columns]", 'correct = "phase sign"\n[columns]')
    mended = check_recording(written(tmp_path, data, asked, "b.csv"))
    assert np.allclose(mended.recording.admittance, 1 / z)


def test_a_downward_sweep_is_turned_around_and_said(tmp_path: Path) -> None:
    head, *rows = GOOD.strip().split("\n")
    found = check_recording(written(tmp_path, "\n".join([head, *rows[::-1], ""])))
    good = check_recording(written(tmp_path, GOOD, name="b.csv"))
    assert np.array_equal(found.recording.admittance, good.recording.admittance)
    assert ("frequency", "swept downwards; the rows were turned around") in found.facts


def test_missing_points_are_doubted(tmp_path: Path) -> None:
    lines = GOOD.split("\n")
    found = check_recording(written(tmp_path, "\n".join(lines[:15] + lines[17:])))
    assert any("points are missing between 29.65 kHz" in doubt for doubt in found.doubts)


def test_a_quoted_text_longer_than_any_cell_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError):
        check_recording(written(tmp_path, line(9, '{"a":' * 40_000)))


@given(seed=st.integers(0, 10**9), of_data=st.booleans())
def test_accidents_in_data_or_description_are_refused_or_read(
    seed: int, of_data: bool, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = written(tmp_path_factory.mktemp("accident"), GOOD)
    hit = path if of_data else path.with_suffix(".toml")
    hit.write_bytes(mutated(hit.read_text(encoding="utf-8"), random.Random(seed)))
    try:
        found = check_recording(path)
    except ConfigError:
        return
    assert np.all(np.isfinite(found.recording.admittance))
