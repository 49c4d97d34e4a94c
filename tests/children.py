"""Processes that a test started, looked for after they should have ended."""

from __future__ import annotations

import multiprocessing
import time
from multiprocessing.process import BaseProcess


def children_left(before: set[BaseProcess], patience: float = 30.0) -> set[BaseProcess]:
    """Processes of this one that were not there before and have not ended within `patience`.

    A pool's own thread waits for them too. Which of the two learns of an end, the other learns it a
    moment later (`multiprocessing` is not made for that): a `join` may return before it is known.
    """
    until = time.monotonic() + patience
    while (left := set(multiprocessing.active_children()) - before) and time.monotonic() < until:
        time.sleep(0.01)
    return left
