"""Priority of what has deadlines (loop, player, a twin): before ordinary work, never paused."""

from __future__ import annotations

import gc
import os

PLAYERS_PRIORITY = 10
"""Of SCHED_FIFO, for a player and a twin: below the loop's."""


def real_time_granted(priority: int) -> bool:
    """Ask for SCHED_FIFO at `priority` (1 to 99) for the calling thread; whether it was given."""
    if not hasattr(os, "sched_setscheduler"):
        return False
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except OSError:
        return False
    return True


def collect_garbage_first() -> None:
    """Collect garbage now, and from now on only what is made from now on (until `gc.unfreeze`).

    A full collection of all that the solvers have loaded takes 50 to 100 ms: as long as a device
    waits before it stops.
    """
    gc.collect()
    gc.freeze()
