"""The verb that opens the lab: its defaults are the lab's own."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.e2e.program import run

from squeezefilm.cli.study import lab
from squeezefilm.lab.serve import PORT

StandsIn = Callable[..., Any]


def test_the_lab_is_served_here_and_opened(
    stands_in: StandsIn, capsys: pytest.CaptureFixture[str]
) -> None:
    served = stands_in("lab.serve:serve")
    assert run(lab.__name__).returncode == 0
    assert served.given == (Path("squeezefilm-lab"),)
    named = dict(served.named)
    named.pop("say")("http://127.0.0.1:8631/")
    assert capsys.readouterr().out == "http://127.0.0.1:8631/\n"
    assert named == {"port": 8631, "browser": True, "lan": None}
    assert PORT == 8631


def test_every_option_of_the_lab_arrives(stands_in: StandsIn, tmp_path: Path) -> None:
    served = stands_in("lab.serve:serve")
    run("lab", "--folder", tmp_path, "--port", "9000", "--no-browser", "--lan", "192.168.1.2")
    assert served.given == (tmp_path,)
    named = dict(served.named)
    named.pop("say")
    assert named == {"port": 9000, "browser": False, "lan": "192.168.1.2"}


def test_a_port_is_a_number(stands_in: StandsIn) -> None:
    served = stands_in("lab.serve:serve")
    done = run("lab", "--port", "http")
    assert done.returncode == 2
    assert "--port" in done.stderr
    assert served.calls == []
