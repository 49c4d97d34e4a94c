"""Checks of numbers where a call is made hundreds of thousands of times: by the outermost alone.

Every public call looks at its numbers, and calls call each other: of a draw's three milliseconds
one went into looks at numbers that this package had made itself a moment before.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from contextvars import ContextVar

ONLY: ContextVar[bool] = ContextVar("only the outermost is checked", default=False)
WITHIN: ContextVar[bool] = ContextVar("within a call that was checked", default=False)


@contextlib.contextmanager
def outermost_checked() -> Iterator[None]:
    """Within it, of functions that call each other only the outermost looks at its numbers.

    It answers for all within it that what comes of them is finite, and what a dataclass takes is
    checked as ever; what a function within another refuses by its annotations alone is not refused.
    """
    token = ONLY.set(True)
    try:
        yield
    finally:
        ONLY.reset(token)
