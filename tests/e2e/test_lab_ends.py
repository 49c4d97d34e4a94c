"""Ctrl-C in the lab's terminal, at any moment: a clean end, nothing on the screen, no key left."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from squeezefilm.core.presets import resolve

from .conftest import RunningLab
from .test_lab_lan import experimenters_page

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform == "win32", reason="signals to groups need POSIX"),
]


def ended(process: subprocess.Popen[str]) -> str:
    """What a lab said to its error output after Ctrl-C, which reaches all of its processes."""
    os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 0, errors
    return errors


def begun(folder: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [
            sys.executable, "-m", "squeezefilm", "lab", "--no-browser", "--folder", str(folder),
        ],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip


@pytest.mark.parametrize("wait", [0.0, 2e-3, 5e-3, 0.02])
def test_as_soon_as_the_link_is_there(tmp_path: Path, wait: float) -> None:
    process = begun(tmp_path)
    assert process.stdout is not None
    assert "http://127.0.0.1" in process.stdout.readline()
    time.sleep(wait)
    assert ended(process) == ""
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("wait", [0.05, 0.2, 0.5])
def test_while_the_process_loads_that_is_to_compute(tmp_path: Path, wait: float) -> None:
    """It is started for the first page."""
    process = begun(tmp_path)
    with experimenters_page(RunningLab.of(process, tmp_path)):
        time.sleep(wait)
        assert ended(process) == ""


def test_while_it_computes(tmp_path: Path) -> None:
    process = begun(tmp_path)
    lab = RunningLab.of(process, tmp_path)
    with experimenters_page(lab) as page:

        def answered(seconds: float) -> dict[str, Any]:
            while (answer := json.loads(page.recv(seconds)))["type"] == "alive":
                pass  # Said to every page that the lab is there.
            return dict(answer)

        page.send(json.dumps({"id": 1, "type": "open display", "preset": "biet2008-plate"}))
        text = answered(30)["text"]
        for quality in ("screening", "solved"):
            page.send(
                json.dumps({"id": 2, "type": "compute design", "text": text, "quality": quality})
            )
        assert answered(120)["type"] == "design"
        assert ended(process) == ""
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("jobs", [pytest.param(1, marks=pytest.mark.nightly), 2])
def test_while_it_searches(tmp_path: Path, jobs: int) -> None:
    text = resolve("biet2008-plate", "requirements").read_text(encoding="utf-8")
    process = begun(tmp_path)
    lab = RunningLab.of(process, tmp_path)
    with experimenters_page(lab) as page:
        start = {"id": 1, "type": "start search", "text": text, "screened": 3000, "jobs": jobs}
        page.send(json.dumps(start))
        said: dict[str, Any] = {}
        while not (said.get("search") or {}).get("screened"):
            said = json.loads(page.recv(120))
        assert ended(process) == ""
    # What was screened is kept, and no key.
    assert [one.name for one in tmp_path.iterdir()] == ["searches"]
    assert list(tmp_path.glob("searches/*/designs.jsonl"))
