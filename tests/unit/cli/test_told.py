"""What the program says of warnings and errors, and with which code it ends."""

from __future__ import annotations

import os
import signal
import sys
import warnings
from typing import NoReturn

import pytest

from squeezefilm import __main__, cli
from squeezefilm.core.errors import InputError, SqueezefilmWarning


def test_a_warning_of_ours_is_one_line_and_others_are_not_said(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(warnings, "showwarning", lambda *_: None)
    monkeypatch.setattr(sys, "warnoptions", ["error"])
    before = warnings.showwarning
    cli._say_warnings()
    # Whoever asks Python for warnings has them.
    assert warnings.showwarning is before
    monkeypatch.setattr(sys, "warnoptions", [])
    cli._say_warnings()
    warnings.showwarning("it is hot", SqueezefilmWarning, "a.py", 3)
    warnings.showwarning("it is old", DeprecationWarning, "a.py", 3)
    said = capsys.readouterr()
    assert (said.out, said.err) == ("", "warning: it is hot\n")


@pytest.mark.parametrize(
    ("error", "code", "says"),
    [
        (InputError("no such display"), 2, "error: no such display\n"),
        (
            OSError(28, "No space left on device", "out/page.html"),
            2,
            "error: out/page.html: No space left on device; give another file or folder, or free "
            "space\n",
        ),
        (OSError("it broke"), 2, "error: it broke; give another file or folder, or free space\n"),
        (BrokenPipeError(), 0, ""),
    ],
)
def test_an_error_is_one_line_and_its_code(
    error: Exception,
    code: int,
    says: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def verb() -> NoReturn:
        raise error

    forgotten: list[bool] = []
    monkeypatch.setattr(cli, "app", verb)
    monkeypatch.setattr(cli, "_forget_output", lambda: forgotten.append(True))
    monkeypatch.setattr(cli, "_say_warnings", lambda: None)
    monkeypatch.setattr(cli, "_show_announcements", lambda: None)
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == code
    assert capsys.readouterr().err == says
    # What is left to be printed would trip the interpreter where it goes nowhere.
    assert bool(forgotten) is isinstance(error, OSError)


def test_linear_algebra_has_one_thread_unless_asked_otherwise(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(cli, "app", lambda: None)
    monkeypatch.setattr(cli, "_say_warnings", lambda: None)
    monkeypatch.setattr(cli, "_show_announcements", lambda: None)
    names = [f"{library}_NUM_THREADS" for library in ("OMP", "OPENBLAS", "MKL")]
    for name in names:
        monkeypatch.setenv(name, "7")
    cli.main()
    assert [os.environ[name] for name in names] == ["7"] * 3
    for name in names:
        monkeypatch.delenv(name)
    cli.main()
    assert [os.environ[name] for name in names] == ["1"] * 3


@pytest.mark.parametrize("ignored", [False, True])
def test_ctrl_c_while_it_loads_ends_it_unless_a_shell_has_it_ignored(
    ignored: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = signal.SIG_IGN if ignored else signal.default_int_handler
    handlers: list[object] = []
    ran: list[object] = []
    monkeypatch.setattr(__main__.signal, "getsignal", lambda _: before)
    monkeypatch.setattr(
        __main__.signal, "signal", lambda number, how: handlers.append((number, how))
    )
    monkeypatch.setattr(cli, "main", lambda: ran.append(list(handlers)))
    __main__.main()
    loading = [] if ignored else [(signal.SIGINT, __main__._end_at_once)]
    assert ran == [[*loading, (signal.SIGINT, before)]]


def test_ctrl_c_while_it_loads_is_one_line_and_code_130(monkeypatch: pytest.MonkeyPatch) -> None:
    did: list[object] = []
    monkeypatch.setattr(__main__.os, "write", lambda *said: did.append(said))
    monkeypatch.setattr(__main__.os, "_exit", did.append)
    __main__._end_at_once()
    assert did == [(2, b"interrupted; nothing half-written was left\n"), 130]
