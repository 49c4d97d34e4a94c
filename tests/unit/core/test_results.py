"""Saving results: whole or not at all."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.quantities import Hertz, MetreArray
from squeezefilm.core.results import stamp, to_json, write_whole


@dataclass(frozen=True)
class _Sample:
    frequency: Hertz
    position: MetreArray
    note: str
    missing: Hertz | None = None


def test_keys_carry_units_and_values_are_plain() -> None:
    value = _Sample(1.5, np.array([1.0, np.nan]), "x")
    assert to_json(value) == {
        "frequency_Hz": 1.5,
        "position_m": [1.0, None],
        "note": "x",
        "missing_Hz": None,
    }
    assert to_json({"z": 1 + 2j, "b": np.True_, "i": np.int64(3)}) == {
        "z": [1.0, 2.0],
        "b": True,
        "i": 3,
    }
    with pytest.raises(TypeError):
        to_json(object())


def test_a_failed_write_keeps_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "a" / "result.json"
    write_whole(file, "old")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("squeezefilm.core.results.os.fsync", full)
    with pytest.raises(InputError, match="No space left"):
        write_whole(file, "new")
    assert file.read_text() == "old"
    assert [path.name for path in file.parent.iterdir()] == ["result.json"]


def test_a_folder_that_is_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("mine")
    with pytest.raises(InputError, match="choose another folder"):
        write_whole(tmp_path / "taken" / "result.json", "{}")


def test_the_stamp_names_version_hash_seed_and_time() -> None:
    mark = stamp({"a": 1.0}, seed=3)
    assert set(mark) == {"squeezefilm_version", "config_sha256", "seed", "created_utc"}
    assert mark["created_utc"].endswith("+00:00")
