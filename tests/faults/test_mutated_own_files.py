"""A standing gate: the program's own files after accidents and attacks are used, or refused with a
typed message, within a second or two; and their folders are usable afterwards.

`make test` tries a few accidents of each kind of file, `make nightly` 200.
"""

from __future__ import annotations

import contextlib
import os
import random
import shutil
import signal
import time
import warnings
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.faults.mutations import damage_file
from tests.faults.own_files import OWN_FILES, OwnFile

from squeezefilm.core.errors import SqueezefilmError, SqueezefilmWarning

if os.name != "posix":
    pytest.skip("pipes and alarms of POSIX", allow_module_level=True)

HUNG = 60.0
"""A use that takes so long (s) hangs: each takes far less than a second."""


@contextlib.contextmanager
def _no_hang() -> Iterator[None]:
    def hung(*_: object) -> None:
        raise AssertionError(f"it hangs: {HUNG:g} s have passed")

    before = signal.signal(signal.SIGALRM, hung)
    signal.setitimer(signal.ITIMER_REAL, HUNG)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def _used(kind: OwnFile, folder: Path) -> str:
    """Use a folder; the message where it was refused. Anything untyped comes out of here."""
    with _no_hang(), warnings.catch_warnings():
        warnings.simplefilter("ignore", SqueezefilmWarning)
        try:
            kind.use(folder)
        except SqueezefilmError as error:
            return str(error) or type(error).__name__
    return ""


def _tried(kind: OwnFile, count: int, seed: int, tmp_path: Path) -> None:
    whole = tmp_path / "whole"
    whole.mkdir()
    kind.make(whole)
    (place,) = (path.relative_to(whole) for path in whole.glob(kind.file))
    assert _used(kind, _copy(whole, tmp_path / "sound")) == ""
    for number in range(count):
        chance = random.Random(f"{seed} {kind.name} {number}")
        folder = _copy(whole, tmp_path / f"{number}")
        file = folder / place
        which = f"seed {seed}, {kind.name} {number} ({damage_file(file, chance)})"
        try:
            message = _used(kind, folder)
            if message:
                # It says which file or folder, and once that is as it was all goes on.
                named = (file.name, file.stem, str(file.parent))
                assert any(name in message for name in named), f"{which}: {message}"
                _put_back(file, whole / place, tmp_path / f"{number}.away")
            again = _used(kind, folder)
        except BaseException as error:
            error.add_note(which)
            raise
        assert again == "", f"{which}: {message}; and again: {again}"
        shutil.rmtree(folder)


def _copy(whole: Path, folder: Path) -> Path:
    shutil.copytree(whole, folder)
    return folder


def _put_back(file: Path, sound: Path, away: Path) -> None:
    """Move what lies there out of the folder, and put the last good copy in its place."""
    if os.path.lexists(file):
        file.rename(away)
    shutil.copy(sound, file)


@pytest.mark.parametrize("kind", OWN_FILES, ids=lambda kind: kind.name)
def test_a_few_accidents_to_each_kind_of_file(kind: OwnFile, tmp_path: Path) -> None:
    _tried(kind, 2, 41, tmp_path)


@pytest.mark.nightly
@pytest.mark.parametrize("kind", OWN_FILES, ids=lambda kind: kind.name)
def test_two_hundred_accidents_to_each_kind_of_file(kind: OwnFile, tmp_path: Path) -> None:
    seed = int(time.time())
    print(f"seed {seed}")
    _tried(kind, 200, seed, tmp_path)
