"""What is compiled is kept on disk, and compiled again when something that it took has changed."""

from __future__ import annotations

import inspect
import logging
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from squeezefilm.core.compiled import announce, compiled
from squeezefilm.physics.film.periodic.batch import solve_films

KERNEL = """
from squeezefilm.core.compiled import compiled
import constants as at
from {records} import Pair
from helper import STEP, twice

@compiled(error_model="numpy")
def total(pair: Pair) -> float:
    return twice(pair.one) + STEP * pair.two + at.SHIFT
"""
HELPER = """
from squeezefilm.core.compiled import compiled
STEP = {step}

@compiled()
def twice(value: float) -> float:
    return {factor} * value
"""
RECORD = """
from typing import NamedTuple

class Pair(NamedTuple):
    {first}: float
    {second}: float
"""
RUN = """
import sys
from kernel import Pair, total
value = total(Pair(one=1.0, two=10.0))
print(value, sum(total.stats.cache_hits.values()))
"""


def answer(
    folder: Path,
    records: str = "records",
    step: int = 1,
    factor: int = 2,
    shift: float = 0.0,
    fields: tuple[str, str] = ("one", "two"),
) -> str:
    """What a new process finds, and how often it took what is on disk."""
    files = {
        "kernel.py": KERNEL.format(records=records),
        "helper.py": HELPER.format(step=step, factor=factor),
        "constants.py": f"SHIFT = {shift}\n",
        f"{records}.py": RECORD.format(first=fields[0], second=fields[1]),
    }
    for old in folder.glob("*.py"):
        if old.name not in files:
            old.unlink()
    for name, text in files.items():
        if not (folder / name).exists() or (folder / name).read_text() != text:
            (folder / name).write_text(text)
    done = subprocess.run(
        [sys.executable, "-c", RUN],
        cwd=folder,
        env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@pytest.mark.slow
def test_a_cache_is_used_until_something_changes(tmp_path: Path) -> None:
    assert answer(tmp_path) == "12.0 0"
    assert answer(tmp_path) == "12.0 1", "nothing changed and it was compiled again"
    # In another file than the kernel's own: a constant, and a function that was compiled in.
    assert answer(tmp_path, step=3) == "32.0 0"
    assert answer(tmp_path, step=3, factor=5) == "35.0 0"
    # A record that moved: what is on disk names a module that is no longer there.
    assert answer(tmp_path, "elsewhere", step=3, factor=5) == "35.0 0"
    assert answer(tmp_path, "elsewhere", step=3, factor=5) == "35.0 1"


@pytest.mark.slow
def test_a_constant_of_a_module_and_a_records_fields_are_asked_too(tmp_path: Path) -> None:
    assert answer(tmp_path) == "12.0 0"
    # Read as `at.SHIFT`, in a file of which no function is called.
    assert answer(tmp_path, shift=100.0) == "112.0 0"
    # The record is an argument; its fields changed their places.
    assert answer(tmp_path, shift=100.0, fields=("two", "one")) == "112.0 0"
    assert answer(tmp_path, shift=100.0, fields=("two", "one")) == "112.0 1"


@pytest.mark.slow
def test_a_cache_that_was_damaged_is_made_again(tmp_path: Path) -> None:
    assert answer(tmp_path) == "12.0 0"
    for pattern in ("total-*.nbi", "total-*.nbc"):
        (file,) = (tmp_path / "__pycache__").glob(f"*{pattern}")
        file.write_bytes(file.read_bytes()[:100])
        assert answer(tmp_path) == "12.0 0"
        assert answer(tmp_path) == "12.0 1"


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="of POSIX's modes")
def test_code_is_not_read_from_where_others_can_write(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shared = tmp_path / "shared"
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(shared))
    assert answer(tmp_path) == "12.0 0"
    assert answer(tmp_path) == "12.0 1"
    shared.chmod(0o777)
    assert answer(tmp_path) == "12.0 0"
    shared.chmod(0o755)
    assert answer(tmp_path) == "12.0 1"


def test_options_are_numbas() -> None:
    @compiled(error_model="numpy")
    def ratio(one: float, other: float) -> float:
        return one / other

    @compiled()
    def strict(one: float, other: float) -> float:
        return one / other

    assert ratio(1.0, 0.0) == float("inf")
    with pytest.raises(ZeroDivisionError):
        strict(1.0, 0.0)


def test_the_first_compile_is_announced(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    dispatcher = SimpleNamespace(
        stats=SimpleNamespace(cache_path=str(tmp_path)),
        py_func=inspect.unwrap(solve_films),
        __name__="solve_rows",
    )
    with caplog.at_level(logging.INFO, logger="squeezefilm"):
        announce.__wrapped__(dispatcher, "film solver", 20)
    assert "compiling the film solver" in caplog.text
    caplog.clear()
    (tmp_path / "batch.solve_films-1.py311.nbi").touch()
    with caplog.at_level(logging.INFO, logger="squeezefilm"):
        announce.__wrapped__(dispatcher, "film solver", 20)
    assert caplog.text == ""
