"""Columns that make no recording of their kind: refused with what is missing or cannot be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.unit.measure.recordings.bench_files import text, written

from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.measure.recordings.read import check_folder, check_recording

F = np.linspace(29e3, 31e3, 12)
ONES = np.ones(12)
UNITS = {
    "f": ("frequency", "Hz"), "g": ("gain", "1"), "p": ("phase", "deg"), "r": ("resistance", "ohm"),
    "x": ("reactance", "ohm"), "u": ("voltage", "V"), "w": ("displacement", "um"),
    "wi": ("displacement_imaginary", "um"), "v": ("velocity", "mm/s"), "at": ("position", "m"),
    "px": ("x", "m"), "py": ("y", "m"), "z": ("magnitude", "ohm"), "b": ("susceptance", "S"),
}  # fmt: skip


def described(kind: str, names: str, more: str = "") -> str:
    """The description of a file whose columns have these names."""
    columns = [
        f'{quantity} = {{ column = "{name}", unit = "{unit}"{given(quantity)} }}'
        for name in names.split()
        for quantity, unit in [UNITS[name]]
    ]
    return "\n".join([f'kind = "{kind}"', 'name = "made up"', more, "[columns]", *columns, ""])


def given(quantity: str) -> str:
    amplitudes = ("displacement", "displacement_imaginary", "velocity", "voltage")
    return ', given_as = "zero-to-peak"' if quantity in amplitudes else ""


REFUSED = {
    "an impedance of zero": (
        described("impedance", "f r x"), ("f r x", (F, 0 * F, 0 * F)), "an impedance of zero",
    ),
    "no size of an impedance": (
        described("impedance", "f p"), ("f p", (F, ONES)), "one pair must be named of an impedance",
    ),
    "a gain without a shunt": (
        described("impedance", "f g p"), ("f g p", (F, ONES, ONES)), "with the resistor that it",
    ),
    "a response without a phase": (
        described("frequency response", "f w u"), ("f w u", (F, ONES, ONES)), "a response to a",
    ),
    "a response to no voltage": (
        described("frequency response", "f w p u"),
        ("f w p u", (F, ONES, ONES, np.where(np.arange(12) == 4, 0.0, 1.0))),
        "nothing responds to no voltage",
    ),
    "a response of nothing": (
        described("frequency response", "f p u"), ("f p u", (F, ONES, ONES)),
        "displacement or velocity is needed",
    ),
    "a response of both": (
        described("frequency response", "f w v p u"), ("f w v p u", (F, *(ONES,) * 4)),
        "displacement and velocity are both named",
    ),
    "phase and imaginary part": (
        described("frequency response", "f w wi p u"), ("f w wi p u", (F, *(ONES,) * 4)),
        "phase and imaginary part are both named",
    ),
    "a response without a voltage": (
        described("frequency response", "f w p"), ("f w p", (F, ONES, ONES)), "voltage is needed",
    ),
    "a response without frequencies": (
        described("frequency response", "w p u"), ("w p u", (1e-6 * F, ONES, ONES)), "it is needed",
    ),
    "a place twice on a line": (
        described("line scan", "at w", 'frequency = "30 kHz"'),
        ("at w", (np.append(np.arange(11), 3) * 1e-3, ONES)), "have one place",
    ),
    "a place twice on a face": (
        described("grid scan", "px py w", 'frequency = "30 kHz"'),
        ("px py w", (np.append(np.arange(11), 3) * 1e-3, 1e-3 * ONES, ONES)), "have one place",
    ),
    "sweeps without a voltage": (
        described("voltage sweeps", "f w p"), ("f w p", (F, ONES, ONES)),
        "sweeps at several voltages are told apart by it",
    ),
    "a sweep of two rows": (
        described("voltage sweeps", "f w p u"),
        ("f w p u", (F, ONES, ONES, np.where(np.arange(12) < 10, 1.0, 2.0))),
        "a sweep begins here that has fewer than three rows",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_columns_that_make_no_recording_are_refused(what: str, tmp_path: Path) -> None:
    description, (names, columns), says = REFUSED[what]
    data = text(names.replace(" ", ","), columns)
    with pytest.raises(ConfigError) as caught:
        check_recording(written(tmp_path, data, description))
    assert says in str(caught.value)


def test_a_file_that_says_not_what_its_columns_hold_asks_for_that(tmp_path: Path) -> None:
    description = 'kind = "impedance"\nname = "made up"\n'
    with pytest.raises(ConfigError, match=r"\[columns\] is missing.*frequency = \{ column = 1"):
        check_recording(written(tmp_path, text("a,b,c", (F, ONES, ONES)), description))


def test_a_spreadsheet_and_a_file_for_a_folder_are_told(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="is a spreadsheet; save its table as CSV"):
        check_recording(written(tmp_path, "x", described("impedance", "f r x"), name="a.xlsx"))
    with pytest.raises(InputError, match="is no folder; give one with recordings in it"):
        check_folder(tmp_path / "a.xlsx")
