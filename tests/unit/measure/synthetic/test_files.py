"""The files of a made-up bench on a disk that is full: whole or not there, and gone on with."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NoReturn

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.measure.synthetic import files
from squeezefilm.measure.synthetic.files import write_synthetic_bench


def _bench(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Three recordings of a column each, in place of those that take seconds."""
    column = files._Column("frequency", "Hz", np.arange(40.0))
    monkeypatch.setattr(files, "_file", lambda _: files._File("impedance", [column], []))
    monkeypatch.setattr(files, "_toml", lambda *_: 'kind = "impedance"\n')
    return SimpleNamespace(recordings={name: SimpleNamespace(told=None) for name in "abc"})


def test_a_full_disk_is_told_with_the_file_and_the_next_call_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench, sync, calls = _bench(monkeypatch), os.fsync, []

    def full(handle: int) -> None:
        calls.append(handle)
        if len(calls) > 4:
            refuse()
        sync(handle)

    def refuse() -> NoReturn:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as disk:
        disk.setattr(os, "fsync", full)
        with pytest.raises(InputError, match=r"cannot write .*b\.csv: No space left"):
            write_synthetic_bench(tmp_path, bench)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv", "a.toml"]
    paths = write_synthetic_bench(tmp_path, bench)
    assert [path.name for path in paths] == ["a.csv", "b.csv", "c.csv"]
    assert write_synthetic_bench(tmp_path, bench) == paths


def test_a_file_of_somebody_else_is_never_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "b.toml").write_text("mine")
    with pytest.raises(InputError, match=r"has another b\.toml already"):
        write_synthetic_bench(tmp_path, _bench(monkeypatch))
    assert [path.name for path in tmp_path.iterdir()] == ["b.toml"]
