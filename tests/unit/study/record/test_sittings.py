"""Sittings: shared by two labs, kept on a full disk, and forgotten without a byte left."""

from __future__ import annotations

import errno
import json
import os
import threading
from pathlib import Path
from typing import NoReturn

import pytest

from squeezefilm.core.errors import InputError, RecordError
from squeezefilm.lab.studying.studies import PrepareSitting, Studies
from squeezefilm.study.record import sittings as sittings_module
from squeezefilm.study.record.sittings import FILE, MOST_SITTINGS, Sittings

WHO = "0123456789abcdef"


def _new(sittings: Sittings, participant: str = WHO, study: str = "s") -> str:
    return sittings.new(study=study, participant=participant, device="none", consent_text="c").id


def _full(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> NoReturn:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", refuse)


def test_two_labs_keep_each_others_sittings(tmp_path: Path) -> None:
    first, second = Sittings(tmp_path / FILE), Sittings(tmp_path / FILE)
    ids = [_new((first, second)[k % 2], f"{k:016x}") for k in range(10)]
    for lab in (first, second, Sittings(tmp_path / FILE)):
        assert [one.id for one in lab.of_study("s")] == ids
    second.change(ids[0], session="begun")
    assert first.get(ids[0]).session == "begun"
    first.change(ids[1], ended=True)
    assert not second.is_open(ids[1])


@pytest.mark.skipif(os.name == "nt", reason="Windows has no lock on a folder")
def test_at_once_no_sitting_is_lost(tmp_path: Path) -> None:
    labs = [Sittings(tmp_path / FILE) for _ in range(4)]
    threads = [
        threading.Thread(target=lambda k=k: [_new(labs[k], f"{k}{n:015x}") for n in range(5)])
        for k in range(4)
    ]
    for one in threads:
        one.start()
    for one in threads:
        one.join()
    assert len(Sittings(tmp_path / FILE).of_study("s")) == 20


@pytest.mark.skipif(os.name == "nt", reason="Windows has no lock on a folder")
def test_who_keeps_the_lock_is_not_waited_for_for_ever(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import fcntl

    sittings = Sittings(tmp_path / FILE)
    monkeypatch.setattr(sittings_module, "_PATIENCE", 0.02)
    handle = os.open(tmp_path, os.O_RDONLY)
    fcntl.flock(handle, fcntl.LOCK_EX)
    with pytest.raises(RecordError, match="another program has kept the sittings"):
        _new(sittings)
    os.close(handle)
    assert _new(sittings)


def test_a_full_disk_ends_no_sitting_that_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    studies = Studies(tmp_path)
    studies.create("biet2008-gratings", "one", 7)
    studies.enrol("one")
    (who,) = studies.store("one").participants()
    asked = PrepareSitting(
        id=1,
        type="prepare sitting",
        study="one",
        participant=who["uuid"],
        device="none",
        consent="You may stop at any time.",
    )
    running = studies.prepare(asked)["sitting"]
    with monkeypatch.context() as patched:
        _full(patched)
        for attempt in (
            lambda: studies.prepare(asked),
            lambda: studies.sittings.change(running, ended=True),
        ):
            with pytest.raises(InputError, match="No space left on device"):
                attempt()
    assert studies.sittings.is_open(running)
    assert [one.id for one in studies.sittings.of_study("one")] == [running]
    again = studies.prepare(asked)["sitting"]
    assert not studies.sittings.is_open(running)
    assert studies.sittings.is_open(again)
    studies.close()


def test_old_sittings_make_room_those_that_ended_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sittings_module, "MOST_SITTINGS", 3)
    sittings = Sittings(tmp_path / FILE)
    ids = [_new(sittings, f"{k:016x}") for k in range(3)]
    sittings.change(ids[1], ended=True)
    ids += [_new(sittings, "f" * 16)]
    assert [one.id for one in sittings.of_study("s")] == [ids[0], ids[2], ids[3]]
    assert MOST_SITTINGS == 500


@pytest.mark.parametrize(
    "text",
    ["", "{", "[1]", "null", '[{"id": 1}]', "[" * 100_000, "\udcff", '[{"id": "a", "odd": 1}]',
     '[{"id": 1, "study": "s", "participant": "p", "device": "d", "consent_text": "c"}]'],
)  # fmt: skip
def test_a_damaged_file_is_one_message(tmp_path: Path, text: str) -> None:
    (tmp_path / FILE).write_bytes(text.encode("utf-8", "surrogateescape"))
    with pytest.raises(InputError, match=r"is damaged .* move it away: no answer is lost"):
        Sittings(tmp_path / FILE)


def test_who_is_forgotten_is_overwritten(tmp_path: Path) -> None:
    sittings = Sittings(tmp_path / FILE)
    _new(sittings)
    other = _new(sittings, "f" * 16)
    old = (tmp_path / FILE).open("rb")
    (tmp_path / f".{FILE}.k1ll3d_x").write_text(WHO)
    assert Sittings(tmp_path / FILE).forget(WHO) == 1
    # What the file was before is zeros; what a killed program left is gone.
    assert set(old.read()) == {0}
    old.close()
    assert [one.name for one in tmp_path.iterdir()] == [FILE]
    assert [one["id"] for one in json.loads((tmp_path / FILE).read_text())] == [other]
    assert [one.id for one in sittings.of_study("s")] == [other]
    assert Sittings(tmp_path / "elsewhere" / FILE).forget(WHO) == 0
    assert not (tmp_path / "elsewhere").exists()


def test_texts_are_written_as_they_were_typed(tmp_path: Path) -> None:
    sittings = Sittings(tmp_path / FILE)
    sittings.new(study="Übung", participant=WHO, device="none", consent_text="c")
    assert "Übung" in (tmp_path / FILE).read_text(encoding="utf-8")
    assert [one.study for one in Sittings(tmp_path / FILE).of_study("Übung")] == ["Übung"]
