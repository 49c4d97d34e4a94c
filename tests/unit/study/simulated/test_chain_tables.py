"""What every finger gets: read where it is kept, computed where it is not, the same."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.kept.store import CACHE_VARIABLE
from squeezefilm.physics.perception.observer import Observer, load_observer
from squeezefilm.physics.perception.senses import Candidates
from squeezefilm.study.design.study_design import StudyDesign, load_design
from squeezefilm.study.simulated import chain_tables as felt
from squeezefilm.study.simulated.chain_tables import ChainTables, chain_tables


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Nothing is kept, here or on disk."""
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    monkeypatch.setattr(felt, "_REMEMBERED", {})
    return tmp_path


@pytest.fixture
def small() -> tuple[StudyDesign, Observer]:
    """Two displays, two stimuli and answers, two fingers."""
    design = load_design("biet2008-gratings")
    names = ("4 mm", "8 mm")
    design = dataclasses.replace(
        design,
        stimuli=tuple(one for one in design.stimuli if one.name in names),
        alternatives=tuple(one for one in design.alternatives if one.name in names),
    )
    return design, dataclasses.replace(load_observer("fingertip"), finger_classes=2)


def numbers(found: ChainTables) -> list[Any]:
    """All that tables hold."""
    return [found.virtual.period, found.virtual.d_prime, found.real.period, found.real.d_prime]


@pytest.mark.slow
def test_computed_and_read_from_disk_are_the_same(
    small: tuple[StudyDesign, Observer], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    computed = numbers(chain_tables(*small))
    # Two displays of two stimuli and two real gratings, each under two fingers.
    assert len(list((folder / "percepts").iterdir())) == 12
    monkeypatch.setattr(felt, "_REMEMBERED", {})

    def none(*_: Any) -> None:
        raise AssertionError("all is on disk")

    with monkeypatch.context() as patched:
        patched.setattr(felt, "percept", none)
        patched.setattr(felt, "grating_percept", none)
        read = numbers(chain_tables(*small))
    for a, b in zip(computed, read, strict=True):
        np.testing.assert_array_equal(a, b)


def test_what_is_remembered_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(felt, "_MOST_REMEMBERED", 3)
    felt_of = {}
    for grating in load_design("biet2008-gratings").alternatives:
        made = Candidates(np.zeros(1), np.zeros(1))
        felt_of[grating.name] = felt._known(felt.felt_really, grating, (), lambda made=made: made)
    assert len(felt_of) == 5
    assert list(felt._REMEMBERED.values()) == list(felt_of.values())[2:]


@pytest.mark.slow
def test_what_was_felt_before_needs_no_plate_no_loop_and_no_statistics(
    small: tuple[StudyDesign, Observer],
) -> None:
    chain_tables(*small)
    code = (
        "import dataclasses, sys\n"
        "from squeezefilm.physics.perception.observer import load_observer\n"
        "from squeezefilm.study.design.study_design import load_design\n"
        "from squeezefilm.study.simulated.answers import simulate_participants\n"
        "d = load_design('biet2008-gratings')\n"
        "names = ('4 mm', '8 mm')\n"
        "keep = lambda many: tuple(one for one in many if one.name in names)\n"
        "d = dataclasses.replace(d, stimuli=keep(d.stimuli), alternatives=keep(d.alternatives))\n"
        "o = dataclasses.replace(load_observer('fingertip'), finger_classes=2)\n"
        "simulate_participants(d, o, 12, 7)\n"
        "heavy = {'numba', 'scipy.stats', 'scipy.interpolate', 'matplotlib'} & set(sys.modules)\n"
        "assert not heavy, heavy"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_displays_are_under_the_finger_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    fingers: list[str] = []

    def asked(_how: Any, _stimulus: Any, display: Any, *_: Any) -> Any:
        fingers.append(display.whose_finger)
        raise InputError("nothing more is asked")

    monkeypatch.setattr(felt, "felt_virtually", asked)
    with pytest.raises(InputError, match="nothing more"):
        chain_tables(load_design("biet2008-gratings"), load_observer(), finger="mean")
    assert fingers
    assert all(finger.startswith("the mean of people") for finger in fingers)
