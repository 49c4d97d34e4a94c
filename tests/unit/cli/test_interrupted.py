"""Ctrl-C ends a verb with a plain sentence and the code that shells expect."""

import os
import signal
import subprocess
import sys
import time
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


# Says when it can meet Ctrl-C: what comes before that is Python's own to print.
BEGIN = """
import signal
from squeezefilm.__main__ import main

def first(*how):
    signal.signal = handle
    before = handle(*how)
    print("begun", flush=True)
    return before

handle, signal.signal = signal.signal, first
main()
"""
VERBS = {
    "lab": "lab --no-browser --port 0",
    "design": "design biet2008-plate --screened 20000 --jobs 2",
    "sweep": "sweep biet2008-stator --vary voltage=1V..20V:9000 --ask relative_friction --jobs 2",
    "analyze": "analyze touchpad-glass --out out",
}


@pytest.mark.skipif(sys.platform == "win32", reason="there Ctrl-C is sent to a whole group")
@pytest.mark.parametrize(
    ("verb", "wait"),
    [
        *(pytest.param("lab", wait, marks=pytest.mark.slow) for wait in (0.0, 0.5, 2.0)),
        *(
            pytest.param(verb, 2.0, marks=pytest.mark.slow)
            for verb in ("design", "sweep", "analyze")
        ),
        *(pytest.param("lab", wait, marks=pytest.mark.nightly) for wait in (0.2, 1.0, 4.0)),
        *(
            pytest.param(verb, 4.0, marks=pytest.mark.nightly)
            for verb in ("design", "sweep", "analyze")
        ),
    ],
)
def test_ctrl_c_at_any_moment_leaves_no_traceback(verb: str, wait: float, tmp_path: Path) -> None:
    """In a terminal it reaches the processes of the program too, while they load as well."""
    with subprocess.Popen(
        [sys.executable, "-c", BEGIN, *VERBS[verb].split()],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path,
        env=os.environ | {"SQUEEZEFILM_CACHE": "off"}, start_new_session=True,
    ) as running:  # fmt: skip
        assert running.stdout is not None
        assert running.stdout.readline() == "begun\n"
        time.sleep(wait)
        os.killpg(running.pid, signal.SIGINT)
        _, errors = running.communicate(timeout=120)
    assert "Traceback" not in errors
    # Python ends so itself where the signal met an import: shells show 130 for either.
    ended_by_it = (130, -signal.SIGINT)
    assert running.returncode in (0, *ended_by_it)
    assert errors.endswith(SAID) or running.returncode == 0


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
