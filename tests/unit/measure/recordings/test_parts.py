"""The steps between a file and a recording, each by itself."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.unit.measure.recordings.bench_files import export_4294a, impedance_text, written

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError
from squeezefilm.measure.recordings import kinds
from squeezefilm.measure.recordings.assembled import assembled
from squeezefilm.measure.recordings.described import CONVENTIONS
from squeezefilm.measure.recordings.description import KINDS, load_description
from squeezefilm.measure.recordings.doubts import doubts_of
from squeezefilm.measure.recordings.files.analysers import is_4294a, read_4294a
from squeezefilm.measure.recordings.files.raw_table import RawTable
from squeezefilm.measure.recordings.files.text_table import decoded, read_text_table
from squeezefilm.measure.recordings.motions import motion_of, moved_quantity
from squeezefilm.measure.recordings.quantities_read import (
    QUANTITIES,
    Reading,
    both_rows,
    quantity,
    require_rising,
    rising_order,
    words,
)

LINE = """\
kind = "line scan"
frequency = "30 kHz"
[columns]
position = { column = 1, unit = "mm" }
velocity = { column = 2, unit = "V", scale = "50 mm/s/V", given_as = "rms" }
"""


def reading(folder: Path, rows: str = "0,1\n1,2\n2,-2\n") -> Reading:
    """A line scan of velocity as it is taken apart."""
    path = written(folder, f"x,v\n{rows}", LINE)
    description = load_description(path.with_suffix(".toml"))
    table = read_text_table(path, description.said)
    return Reading(description, table, description.said.columns)  # type: ignore[attr-defined]


def test_columns_are_found_by_number_by_name_and_without_their_unit() -> None:
    table = RawTable(Path("a"), "text", ("f (Hz)", "Z [ohm]", "Z"), np.ones((3, 3)))
    assert [table.index(one) for one in (1, 3, 4, "F (hz)", "f", "Z", "nothing")] == [
        0, 2, None, 0, 0, 2, None,
    ]  # fmt: skip
    assert [table.unit_in_name(k) for k in range(3)] == ["Hz", "ohm", None]
    assert str(table.error("no", 1, 0)) == "a, column 1: value 2: no"
    named = RawTable(Path("a"), "text", ("theta (steps)",), np.ones((1, 1)), np.array([7]))
    assert named.unit_in_name(0) is None
    assert str(named.error("no", 0, 0)) == "a, line 7, column 1: no"


def test_units_scales_and_conventions_make_si_and_zero_to_peak(tmp_path: Path) -> None:
    found = reading(tmp_path)
    assert moved_quantity(found) == "velocity"
    speed = np.array([1, 2, -2]) * 0.05 * 2**0.5
    moved = motion_of(found, 30e3, amplitude=True)
    assert np.allclose(moved, speed / (2j * np.pi * 30e3))
    assert ("velocity", "-141.4 mm/s to 141.4 mm/s, from column 2 'v' in V times 50 mm/s/V, given "
            "as rms") in found.facts  # fmt: skip
    recording, _ = assembled(found.description, found.table)
    assert isinstance(recording, kinds.LineScan)
    assert np.allclose(recording.displacement, moved)
    assert CONVENTIONS == {"zero-to-peak": 1, "peak-to-peak": 0.5, "rms": 2**0.5}


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("50 mm/s/V", "fifty", "'fifty' is no scale"),
        ("50 mm/s/V", "50 mm/V", "V times 50 mm/V is no unit of a velocity"),
        ("50 mm/s/V", "50 km/s/V", "cannot be right; up to 200 m/s are believed"),
        (', given_as = "rms"', "", "it must be said how the amplitude of the velocity is given"),
        ("velocity =", 'displacement = { column = 2, unit = "m" }\nvelocity =', "both named"),
    ],
)
def test_what_does_not_fit_is_refused(old: str, new: str, says: str, tmp_path: Path) -> None:
    path = written(tmp_path, "x,v\n0,1\n1,2\n2,-2\n", LINE.replace(old, new))
    description = load_description(path.with_suffix(".toml"))
    with pytest.raises(ConfigError) as caught:
        assembled(description, read_text_table(path, description.said))
    assert says in str(caught.value)


def test_rows_rise_or_are_turned_around(tmp_path: Path) -> None:
    found = reading(tmp_path)
    falling = np.array([3.0, 2.0, 1.0])
    assert rising_order(found, "position", falling) == slice(None, None, -1)
    assert rising_order(found, "position", falling[::-1]) == slice(None)
    with pytest.raises(ConfigError, match="must rise from row to row"):
        require_rising(found, "position", falling)
    assert both_rows(found, 0, 2) == "lines 2 and 4"


def test_quantities_are_told_as_people_read_them() -> None:
    assert quantity(2e-6, si.Unit("m")) == "2 µm"
    assert quantity(14935.0, si.Unit("ohm")) == "14.94 kohm"
    assert quantity(0.2, si.Unit("1")) == "0.2"
    assert words("normal_force") == "normal force"
    assert {"frequency", "spread"} < set(QUANTITIES)


def test_every_kind_may_be_doubted() -> None:
    f = np.linspace(29e3, 31e3, 5)
    few = doubts_of(kinds.ImpedanceSweep(f, (1e-6 + 1e-3j) * np.ones(5)))
    assert few == ("5 points are few for a resonance; sweep more finely",)
    assert len(KINDS) == 12
    f = np.linspace(29e3, 31e3, 51)
    h = 1e-7 / (1 - (f / 30e3) ** 2 + 1j * f / 30e3 / 60)
    assert doubts_of(kinds.FrequencyResponse(f, h)) == ()
    (rising,) = doubts_of(kinds.FrequencyResponse(f, np.conj(h)))
    assert "the sign of the phase may be the other one" in rising
    right, wrong = (kinds.FrequencyResponse(f, y, voltage=2.0) for y in (h, np.conj(h)))
    second, alike = doubts_of(kinds.VoltageSweeps((right, wrong), ("up", "down")))
    assert second == f"sweep 2: {rising}"
    assert alike.startswith("all sweeps are at one voltage")


def test_an_export_is_known_by_its_head(tmp_path: Path) -> None:
    path = written(tmp_path, export_4294a(), "", "a.txt")
    other = written(tmp_path, impedance_text())
    assert (is_4294a(path), is_4294a(other), is_4294a(tmp_path)) == (True, False, False)
    assert read_4294a(path).names == ("Frequency", "A real", "A imaginary", "B real", "B imaginary")
    assert decoded(other)[1] == []
