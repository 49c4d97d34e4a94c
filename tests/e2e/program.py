"""The command line for tests: the program in a process of its own, or its `main` in this one.

A process of its own takes seconds to import what the physics needs. What a verb answers is the same
without; what a process is for (its exit code, its streams, its signals) has tests with one.
"""

from __future__ import annotations

import contextlib
import functools
import io
import logging
import os
import subprocess
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from unittest import mock

import typer

PROGRAM = [sys.executable, "-c", "from squeezefilm.cli import main; main()"]
# The tree of verbs is the same for every command line; a process builds it once.
_command = functools.cache(typer.main.get_command)
_PLAIN = {"NO_COLOR": "1", "COLUMNS": "100"}

Done = subprocess.CompletedProcess[str]


def run(*arguments: str | Path, cwd: Path | None = None, keys: str = "") -> Done:
    """What a command line does, run in this process."""
    from squeezefilm.cli import main

    words = [*map(str, arguments)]
    out, err = io.StringIO(), io.StringIO()
    with (
        contextlib.chdir(cwd or Path.cwd()),
        mock.patch.dict(os.environ, _PLAIN),
        mock.patch.object(sys, "argv", ["squeezefilm", *words]),
        mock.patch.object(typer.main, "get_command", _command),
        mock.patch.object(sys, "stdin", io.StringIO(keys)),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
        _as_at_a_start(),
    ):
        try:
            main()
            code: object = 0
        except SystemExit as end:
            code = end.code or 0
    return subprocess.CompletedProcess(words, code, out.getvalue(), err.getvalue())  # type: ignore[arg-type]


def run_program(*arguments: str | Path, cwd: Path | None = None, keys: str = "") -> Done:
    """What the program does, in a process of its own."""
    return subprocess.run(
        [*PROGRAM, *map(str, arguments)],
        capture_output=True,
        text=True,
        input=keys,
        cwd=cwd,
        env={**os.environ, **_PLAIN},
        timeout=300,
        check=False,
    )


@contextlib.contextmanager
def _as_at_a_start() -> Iterator[None]:
    """Warnings are printed, as by a program; what it says while it works goes to its own end."""
    logger = logging.getLogger("squeezefilm")
    before, level = list(logger.handlers), logger.level
    with warnings.catch_warnings():
        warnings.resetwarnings()
        warnings.showwarning = _shown
        try:
            yield
        finally:
            logger.handlers[:] = before
            logger.setLevel(level)


def _shown(message: object, category: type[Warning], *where: object, **_: object) -> None:
    print(f"{category.__name__}: {message}", file=sys.stderr)
