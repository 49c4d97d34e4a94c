"""Priority before ordinary work, for what has deadlines: the loop, the player, a device's twin."""

from __future__ import annotations

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
