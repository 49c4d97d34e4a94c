from __future__ import annotations

import contextlib
import os
from pathlib import Path

import optuna
import pytest
from optuna.storages import JournalStorage
from optuna.storages.journal import JournalFileBackend

import squeezefilm.design.search.journal
from squeezefilm.core.errors import SqueezefilmWarning
from squeezefilm.design.search.journal import journal, usable_journal


def test_optuna_reads_what_was_written_and_goes_on(tmp_path: Path) -> None:
    """Both ways: the file is Optuna's own."""
    file = tmp_path / "journal.log"
    ours = optuna.create_study(study_name="a", storage=journal(file))
    ours.add_trial(_trial(0.25))
    theirs = optuna.load_study(
        study_name="a", storage=JournalStorage(JournalFileBackend(str(file)))
    )
    theirs.add_trial(_trial(0.5))
    again = optuna.load_study(study_name="a", storage=journal(file))
    assert [one.params["x"] for one in again.trials] == [0.25, 0.5]
    assert again.best_value == 1.25


def test_a_line_that_was_cut_off_costs_itself_only(tmp_path: Path) -> None:
    """As by a computer that lost its power: some of the bytes, or zeros in their place."""
    file = tmp_path / "journal.log"
    ours = optuna.create_study(study_name="a", storage=journal(file))
    ours.add_trial(_trial(0.25))
    before = file.read_bytes()
    ours.add_trial(_trial(0.5))
    cut = file.read_bytes()[len(before) :][:20]
    for rest in (cut, cut[:1], bytes(30)):
        file.write_bytes(before + rest)
        again = optuna.load_study(study_name="a", storage=journal(file))
        assert [one.params["x"] for one in again.trials] == [0.25]
        again.add_trial(_trial(0.75))
        more = optuna.load_study(study_name="a", storage=journal(file))
        assert [one.params["x"] for one in more.trials] == [0.25, 0.75]


def _damaged(data: bytes) -> list[bytes]:
    """A journal after accidents: a changed byte, a line of somebody else's, zeros."""
    lines = data.splitlines(keepends=True)
    changed = bytearray(data)
    changed[len(data) // 2] ^= 4
    return [
        bytes(changed),
        lines[0] + b"[" * 200_000 + b"\n" + b"".join(lines[1:]),
        b"\0" * 500 + b"\n",
    ]


@pytest.mark.parametrize("number", range(3))
def test_a_damaged_journal_is_set_aside_and_begun_anew(number: int, tmp_path: Path) -> None:
    file = tmp_path / "journal.log"
    optuna.create_study(study_name="a", storage=journal(file)).add_trial(_trial(0.25))
    damaged = _damaged(file.read_bytes())[number]
    file.write_bytes(damaged)
    with pytest.warns(SqueezefilmWarning, match="set aside as journal.log.damaged"):
        storage, is_rebuilt = usable_journal(file)
    assert is_rebuilt
    optuna.create_study(study_name="a", storage=storage).add_trial(_trial(0.5))
    storage, is_rebuilt = usable_journal(file)
    assert not is_rebuilt
    assert [one.params["x"] for one in optuna.load_study(study_name="a", storage=storage).trials]
    assert (tmp_path / "journal.log.damaged").read_bytes() == damaged


@pytest.mark.skipif(os.name == "nt", reason="no pipes with names")
def test_a_pipe_or_a_device_in_its_place_is_set_aside(tmp_path: Path) -> None:
    file = tmp_path / "journal.log"
    for make in (os.mkfifo, lambda path: path.symlink_to("/dev/zero"), Path.mkdir):
        make(file)
        with pytest.warns(SqueezefilmWarning, match="set aside"):
            usable_journal(file)
        file.unlink()


def _trial(x: float) -> optuna.trial.FrozenTrial:
    among = {"x": optuna.distributions.FloatDistribution(0.0, 1.0)}
    return optuna.trial.create_trial(params={"x": x}, distributions=among, value=1 + x)


@pytest.mark.parametrize("kind", ["file", "link", "link that leads nowhere"])
def test_a_lock_that_a_killed_search_left_is_said_and_taken_away(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(squeezefilm.design.search.journal, "_LOCK_STAYS", 3)
    file, lock = tmp_path / "journal.log", tmp_path / "journal.log.lock"
    if kind == "file":
        lock.touch()
    else:
        # Optuna's link leads to the path as it was given: nowhere, where that was relative.
        lock.symlink_to(file if kind == "link" else Path("search/journal.log"))
    says_so = pytest.warns(SqueezefilmWarning, match="journal.log.lock is there: .* killed left it")
    with contextlib.nullcontext() if kind.endswith("nowhere") else says_so:
        storage, is_rebuilt = usable_journal(file)
    assert not is_rebuilt
    assert not os.path.lexists(lock)
    study = optuna.create_study(study_name="a", storage=storage)
    study.add_trial(_trial(0.25))
