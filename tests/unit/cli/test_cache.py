"""The verb that shows and clears what is kept on disk."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from squeezefilm.cli import app
from squeezefilm.core import quantities as si
from squeezefilm.core.kept.store import Kept, clear_kept, kept_sizes


def test_what_is_kept_is_shown_and_cleared_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SQUEEZEFILM_CACHE", str(tmp_path))
    kept: Kept[si.FloatArray] = Kept("some-kind", si.FloatArray)
    kept.put("a", np.arange(4.0))
    mine = tmp_path / "some-kind" / "notes.txt"
    mine.write_text("my own file")
    assert kept_sizes()["some-kind"][0] == 1
    said = CliRunner().invoke(app, ["cache"]).stdout
    assert "some-kind: 1 files" in said
    data = json.loads(CliRunner().invoke(app, ["cache", "--json"]).stdout)
    assert data["kept"]["some-kind"]["files"] == 1
    assert "1 files deleted" in CliRunner().invoke(app, ["cache", "--clear"]).stdout
    assert kept.get("a") is None
    assert mine.read_text() == "my own file"
    assert clear_kept() == 0


def test_nothing_is_kept_where_it_is_off(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SQUEEZEFILM_CACHE", "off")
    assert "off" in CliRunner().invoke(app, ["cache"]).stdout
