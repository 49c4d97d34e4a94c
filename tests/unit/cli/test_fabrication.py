"""`squeezefilm fabricate` at the command line: what it writes, and what it refuses before work."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from squeezefilm.cli import main


def run(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr("sys.argv", ["squeezefilm", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(ended.value.code or 0)


@pytest.mark.slow
def test_a_disc_in_seconds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "new" / "folder"
    words = ("fabricate", "winfield2007-tpad", "--out", str(out), "--quick")
    assert run(monkeypatch, *words) == 0
    told = capsys.readouterr().out
    assert f"page: {out / 'index.html'}" in told
    assert not (out / "prediction.json").exists()
    # A folder that is there is written again.
    assert run(monkeypatch, *words, "--json") == 0
    assert json.loads(capsys.readouterr().out)["display"] == "winfield2007-tpad"


@pytest.mark.parametrize(
    ("target", "said"),
    [
        ("biet2008-motor", "fabricate takes a display"),
        ("biet2008-skin-stretch", "fabricate takes a display"),
        ("no-such-display", "neither a file nor a preset"),
    ],
)
def test_what_is_no_display_is_refused(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    target: str,
    said: str,
) -> None:
    assert run(monkeypatch, "fabricate", target, "--out", str(tmp_path / "a")) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "a").exists()


def test_where_nothing_can_be_written_it_says_so_before_any_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "file"
    file.write_text("mine")
    assert run(monkeypatch, "fabricate", "winfield2007-tpad", "--out", str(file)) == 2
    assert "is a file, not a folder" in capsys.readouterr().err
    assert file.read_text() == "mine"
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "prediction.json").write_text("{}")
    assert run(monkeypatch, "fabricate", "winfield2007-tpad", "--out", str(folder)) == 2
    assert "is no prediction of squeezefilm" in capsys.readouterr().err
    assert [one.name for one in folder.iterdir()] == ["prediction.json"]
