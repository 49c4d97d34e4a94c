"""The script for PsychoPy's users, on the twin, with a window and keys that are made up."""

from __future__ import annotations

import csv
import importlib.util
import sys
import time
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

import squeezefilm as sf
from squeezefilm.study.design.study_design import load_design
from squeezefilm.study.record.exports import write_orders
from squeezefilm.study.record.foreign import read_answers

SCRIPT = Path(__file__).parents[2] / "docs" / "how-to" / "two_surfaces.py"
TRIALS = 3


class Window:
    """PsychoPy's window: it shows nothing."""

    def flip(self) -> None:
        """A frame of 60 Hz."""
        time.sleep(1 / 60)

    def close(self) -> None:
        """Nothing."""


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The script, with PsychoPy made up; its participant always takes the first surface."""
    modules: dict[str, Any] = {
        "core": SimpleNamespace(wait=time.sleep),
        "event": SimpleNamespace(waitKeys=lambda keyList: [keyList[0]]),
        "visual": SimpleNamespace(
            Window=lambda **_: Window(),
            TextStim=lambda *_, **__: SimpleNamespace(draw=lambda: None),
        ),
    }
    monkeypatch.setitem(sys.modules, "psychopy", SimpleNamespace(**modules))
    spec = importlib.util.spec_from_file_location("two_surfaces", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    found.FELT = 0.3  # type: ignore[attr-defined]
    return found


@pytest.fixture
def order(tmp_path: Path) -> Path:
    """The first main trials of the first participant's order, as PsychoPy reads them."""
    paths = write_orders(sf.plan_study("friction-jnd", participants=1), tmp_path / "orders")
    lines = paths[0].read_text(encoding="utf-8").splitlines(keepends=True)
    main = [line for line in lines if ",main," in line][:TRIALS]
    short = tmp_path / "order.csv"
    short.write_text("".join([lines[0], *main]), encoding="utf-8")
    return short


@pytest.mark.realtime
@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="there are no ptys on Windows")
def test_a_psychopy_script_plays_asks_and_is_analysed(
    script: Any, order: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    script.main(str(order), "answers.csv")
    with Path("answers.csv").open(newline="", encoding="utf-8") as file:
        kept = list(csv.DictReader(file))
    with order.open(newline="", encoding="utf-8") as file:
        planned = list(csv.DictReader(file))
    # A trial that a busy machine spoiled came again at the end.
    assert sorted(one["trial"] for one in kept) == sorted(one["trial"] for one in planned)
    for row in kept:
        first, second, ended = (
            float(row[name])
            for name in ("started_monotonic_s", "second_started_monotonic_s", "ended_monotonic_s")
        )
        assert first + script.FELT < second < ended - script.FELT
    # Two records a trial, and two more of a trial that came again after its second surface.
    assert len(list(Path("records").glob("*.sqft"))) >= 2 * TRIALS
    answers = read_answers("answers.csv", load_design("friction-jnd"))
    assert answers.trials == TRIALS
    right = {int(one["trial"]): one["answer"] for one in planned}
    assert [("first", "second")[one] for one in answers.right] == [
        right[int(number)] for number in answers.number
    ]
