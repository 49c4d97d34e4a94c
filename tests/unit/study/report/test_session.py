"""A session held here: the study's file it makes, whom it asks, and how it goes on."""

from __future__ import annotations

import io
import sys
from pathlib import Path

import pytest

from squeezefilm.core.config.schema import text_of
from squeezefilm.core.errors import InputError
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.report.terminal import run_study

from ...study.scripted import Script, gratings, magnitudes


def saved(folder: Path, design: StudyDesign) -> Path:
    """The design's file."""
    path = folder / f"{design.name}.toml"
    path.write_text(text_of(design), encoding="utf-8")
    return path


def test_somebody_new_is_asked_everything(tmp_path: Path) -> None:
    script, told = Script(), list[str]()
    store = tmp_path / "a.sqlite"
    ended = run_study(
        saved(tmp_path, gratings()), store, examiner=script, consent=True, tell=told.append
    )
    # One round of three to feel, and two of each of three to answer.
    assert ended == "9 trials on biet2008-plate recorded"
    assert len(script.told) == 9
    with StudyStore.open(store) as found:
        (person,) = found.participants()
        assert (person["answered"], person["planned"]) == (9, 9)
        assert [found.study[key] for key in ("seed", "station", "stations")] == [0, 0, 1]
    assert told[0].startswith("This terminal tells which surface to present")
    assert told[1] == f"participant {person['uuid']}: go on with --participant {person['uuid']}"
    # Only virtual surfaces are put there by hand: real gratings lie in their box.
    shown = [line for line in told if line.startswith("EXPERIMENTER: put '")]
    assert len(shown) == 6
    assert "period 2 mm, 30 % change of friction" in " ".join(shown)


def test_the_experimenter_is_told_in_a_file_or_nowhere(tmp_path: Path) -> None:
    design, told, file = saved(tmp_path, gratings()), list[str](), tmp_path / "now.txt"
    common = {"examiner": Script(), "consent": True, "tell": told.append}
    run_study(design, tmp_path / "a.sqlite", by_hand=str(file), **common)
    lines = file.read_text(encoding="utf-8").splitlines()
    assert lines[0].endswith("a session begins")
    assert sum("put '" in line for line in lines) == 6
    run_study(design, tmp_path / "b.sqlite", by_hand="nowhere", **common)
    assert not any("EXPERIMENTER" in line for line in told)
    with pytest.raises(InputError, match="nobody is told what to present"):
        run_study(design, tmp_path / "c.sqlite", by_hand=str(tmp_path), **common)


def test_a_session_that_was_stopped_goes_on_where_it_was(tmp_path: Path) -> None:
    store, design = tmp_path / "a.sqlite", saved(tmp_path, gratings())
    with pytest.raises(KeyboardInterrupt):
        run_study(design, store, examiner=Script(5), consent=True, seed=3, station=1, stations=2)
    with StudyStore.open(store) as found:
        (person,) = found.participants()
        # The second station numbers its people 1, 3, …
        assert (person["answered"], person["number"]) == (5, 1)
    again = Script()
    ended = run_study(design, store, str(person["uuid"]), examiner=again, consent=True, seed=3)
    assert ended == "4 trials on biet2008-plate recorded"
    # The file has a seed of its own; another one is refused.
    with pytest.raises(InputError, match="leave seed out, or give another store"):
        run_study(design, store, examiner=Script(), consent=True, seed=0)


def test_nobody_is_enrolled_without_consent(tmp_path: Path) -> None:
    store, design = tmp_path / "a.sqlite", saved(tmp_path, gratings())
    with pytest.raises(InputError, match="consent"):
        run_study(design, store, examiner=Script())
    with StudyStore.open(store) as found:
        assert found.participants() == []
    conditions = tmp_path / "room.toml"
    conditions.write_text('consent = true\nroom = "quiet"\n', encoding="utf-8")
    run_study(design, store, examiner=Script(), conditions=conditions)
    with StudyStore.open(store) as found:
        assert "quiet" in str(dict(found.rows("SELECT * FROM session")[0]))


def test_a_drive_that_is_not_known_is_refused(tmp_path: Path) -> None:
    design = saved(tmp_path, gratings())
    with pytest.raises(InputError, match="drive = 'x' is not known"):
        run_study(design, tmp_path / "a.sqlite", examiner=Script(), consent=True, drive="x")


def test_without_an_examiner_this_terminal_asks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("\n12\n"))
    with pytest.raises(KeyboardInterrupt):
        run_study(saved(tmp_path, magnitudes()), tmp_path / "a.sqlite", consent=True)
    said = capsys.readouterr().out
    assert "\nparticipant " in said
    assert f"[2 left] {magnitudes().spoken_question}\nThe reference is 10.\n> " in said
    with StudyStore.open(tmp_path / "a.sqlite") as found:
        (answer,) = found.rows("SELECT * FROM response")
        assert answer["estimate"] == 12.0
