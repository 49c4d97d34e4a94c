"""The verbs of the command line. Each gathers its arguments, calls one function and shows the
result; physics, plots and pydantic are imported only by the verb that needs them."""

from __future__ import annotations

import gc
import os
import sys
from typing import Any

import typer

# In the order in which `--help` lists them.
from squeezefilm.cli import describe  # noqa: F401 # isort: skip
from squeezefilm.cli import design  # noqa: F401 # isort: skip
from squeezefilm.cli import textures  # noqa: F401 # isort: skip
from squeezefilm.cli import claims  # noqa: F401 # isort: skip
from squeezefilm.cli import measure  # noqa: F401 # isort: skip
from squeezefilm.cli import study  # noqa: F401 # isort: skip
from squeezefilm.cli import study_file  # noqa: F401 # isort: skip
from squeezefilm.cli import cache  # noqa: F401 # isort: skip
from squeezefilm.cli.app import app
from squeezefilm.core.errors import SqueezefilmError, SqueezefilmWarning

# What a shell expects of a program that Ctrl-C ended.
_INTERRUPTED = 130


def _show_announcements() -> None:
    """Show what the library says while it works (that it compiles, once), on standard error."""
    import logging

    handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter("  %(message)s"))
    logger = logging.getLogger("squeezefilm")
    logger.addHandler(handler)
    logger.setLevel(logging.INFO)


def _say_warnings() -> None:
    """Show warnings of the library as one line on standard error, without the place in the code. Of
    other packages' warnings nothing that a person could do anything about is said; ``-W`` or
    PYTHONWARNINGS bring them back.
    """
    import warnings

    if sys.warnoptions:
        return

    def say(message: Warning | str, category: type[Warning], *_: Any, **__: Any) -> None:
        if issubclass(category, SqueezefilmWarning):
            typer.echo(f"warning: {message}", err=True)

    warnings.showwarning = say


def main() -> None:
    """Run the command line: a person's mistake is one message and exit code 2, no traceback."""
    # Before NumPy loads: its linear algebra on our small blocks is slower with threads, by far.
    for library in ("OMP", "OPENBLAS", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    # Loading makes hundreds of thousands of objects that stay: no use to go through them often.
    gc.set_threshold(50_000)
    _show_announcements()
    _say_warnings()
    try:
        try:
            app()
        finally:
            gc.freeze()
            # What was printed may not fit where it goes; later the interpreter would trip over it.
            sys.stdout.flush()
    except SqueezefilmError as error:
        typer.echo(f"error: {error}", err=True)
        sys.exit(2)
    except KeyboardInterrupt:
        _say_interrupted()
        sys.exit(_INTERRUPTED)
    except SystemExit as ended:
        # typer ends so, without a word, where Ctrl-C met a verb at work.
        if ended.code == _INTERRUPTED:
            _say_interrupted()
        raise
    except BrokenPipeError:
        _forget_output()
        sys.exit(0)
    except OSError as error:
        _forget_output()
        where = f"{error.filename!s:.200}: " if error.filename else ""
        typer.echo(
            f"error: {where}{error.strerror or error}; give another file or folder, or free space",
            err=True,
        )
        sys.exit(2)


def _say_interrupted() -> None:
    typer.echo("interrupted; nothing half-written was left", err=True)


def _forget_output() -> None:
    """Drop what is left to be printed; the interpreter would fail to print it at exit."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)
