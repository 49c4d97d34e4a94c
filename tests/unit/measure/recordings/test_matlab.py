"""MATLAB files: arrays, complex ones, structures; version 7.3 and damage refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.io import savemat

from squeezefilm.core.errors import ConfigError
from squeezefilm.measure.recordings import kinds
from squeezefilm.measure.recordings.files.scipy_files import read_matlab
from squeezefilm.measure.recordings.read import check_recording

F = np.linspace(29e3, 31e3, 41)
H = 1e-7 / (1 - (F / 30e3) ** 2 + 1j * F / 30e3 / 60)
RESPONSE = """\
kind = "frequency response"
[columns]
frequency = { column = "f", unit = "Hz" }
displacement = { column = "H real", unit = "m/V" }
displacement_imaginary = { column = "H imaginary", unit = "m/V" }
"""


@pytest.mark.parametrize("nested", [False, True])
def test_variables_and_those_of_a_structure_are_columns(nested: bool, tmp_path: Path) -> None:
    inside = {"f": F, "H": H, "date": "today", "fs": 1.0, "other": np.arange(7.0)}
    path = tmp_path / "a.mat"
    savemat(path, {"data": inside} if nested else inside)
    path.with_suffix(".toml").write_text(RESPONSE, encoding="utf-8")
    found = check_recording(path)
    assert isinstance(found.recording, kinds.FrequencyResponse)
    assert np.allclose(found.recording.displacement_per_volt, H)
    assert ("of the file", "variables of another length were left out: other") in found.facts


def test_a_matrix_is_its_columns(tmp_path: Path) -> None:
    savemat(tmp_path / "a.mat", {"data": np.stack([F, F**2], axis=1)})
    table = read_matlab(tmp_path / "a.mat")
    assert table.names == ("data 1", "data 2")
    assert np.array_equal(table.values[:, 1], F**2)


def test_what_cannot_be_read_is_refused_with_what_to_do(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    path.write_bytes(b"MATLAB 7.3 MAT-file, Platform".ljust(600))
    with pytest.raises(ConfigError, match=r"save\('a.mat', '-struct', 'S', '-v7'\)"):
        read_matlab(path)
    path.write_bytes(b"nothing of the kind")
    with pytest.raises(ConfigError, match="cannot be read as a MATLAB file"):
        read_matlab(path)
    savemat(path, {"name": "words", "one": 1.0})
    with pytest.raises(ConfigError, match="it holds: name, one"):
        read_matlab(path)
    savemat(path, {"f": F, "H": np.where(F > 30e3, np.nan, F)})
    with pytest.raises(ConfigError, match="value 22: nan is no finite number") as caught:
        read_matlab(path)
    assert caught.value.column == 2


@given(at=st.integers(0, 1000))
def test_a_file_cut_anywhere_is_refused_or_read(
    at: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.mktemp("cut") / "a.mat"
    savemat(path, {"f": F, "H": F**2})
    data = path.read_bytes()
    path.write_bytes(data[: at * len(data) // 1000])
    try:
        table = read_matlab(path)
    except ConfigError:
        return
    assert table.values.shape[0] == 41
    assert set(table.names) <= {"f", "H"}
