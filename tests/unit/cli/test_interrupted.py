"""Ctrl-C ends a verb with a plain sentence and the code that shells expect."""

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import NoReturn

import pytest

from squeezefilm import cli

SAID = "interrupted; nothing half-written was left\n"


@pytest.mark.parametrize("how", [KeyboardInterrupt(), SystemExit(130)])
def test_an_interrupted_verb_says_so(
    how: BaseException, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def verb() -> NoReturn:
        raise how

    monkeypatch.setattr(cli, "app", verb)
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 130
    assert capsys.readouterr().err == SAID


@pytest.mark.parametrize("code", [0, 2])
def test_a_verb_that_ends_by_itself_does_not(
    code: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def verb() -> NoReturn:
        raise SystemExit(code)

    monkeypatch.setattr(cli, "app", verb)
    with pytest.raises(SystemExit):
        cli.main()
    assert capsys.readouterr().err == ""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="there Ctrl-C is sent to a whole group")
def test_a_solve_that_is_interrupted_leaves_a_sentence_and_no_file(tmp_path: Path) -> None:
    verb = [sys.executable, "-m", "squeezefilm", "plate", "basdogan2020-glass", "--out"]
    # Nothing kept: a plate that another test has solved is there before the signal is.
    alone = os.environ | {"SQUEEZEFILM_CACHE": "off"}
    with subprocess.Popen(
        [*verb, tmp_path / "out"], stderr=subprocess.PIPE, text=True, env=alone
    ) as running:
        assert running.stderr is not None
        said = [running.stderr.readline() for _ in range(2)]
        running.send_signal(signal.SIGINT)
        left = running.stderr.read()
    assert said[0].startswith("expected about ")
    assert running.returncode == 130
    assert left.endswith(SAID)
    assert "Traceback" not in left
    assert not (tmp_path / "out").exists()
