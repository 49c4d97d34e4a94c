"""What a function prints on a terminal of some width, as lines to compare."""

from __future__ import annotations

import contextlib
import io
import os
from collections.abc import Callable
from unittest import mock


def printed(show: Callable[[], object], columns: int = 220) -> list[str]:
    """The lines that hold text, runs of blanks as one, without the rules of tables."""
    out = io.StringIO()
    plain = {"COLUMNS": str(columns), "NO_COLOR": "1"}
    with mock.patch.dict(os.environ, plain), contextlib.redirect_stdout(out):
        os.environ.pop("FORCE_COLOR", None)
        show()
    lines = [" ".join(line.split()) for line in out.getvalue().splitlines()]
    return [line for line in lines if line.strip("─ ")]
