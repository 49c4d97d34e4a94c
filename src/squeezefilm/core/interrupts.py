"""Ctrl-C and the processes that another one started, and their end with it.

A terminal sends Ctrl-C (SIGINT) to every process of a program, and a new Python would meet it with
a traceback for as long as it loads. So a process is started with SIGINT held back
(`interrupts_held`), which it inherits; one that means to act on SIGINT asks for it once it can
(`hear_interrupts`), and then gets what came meanwhile. Windows holds no signals back.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Hold SIGINT back: processes started within hear none, this thread hears it afterwards."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    from multiprocessing import resource_tracker

    # multiprocessing starts its own process before the first, and lets SIGINT through after that.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def hear_interrupts() -> None:
    """Let SIGINT through, one that came since this process was started too."""
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def end_with_parent() -> None:
    """End this process with the one that started it, however that ends: work for
    nobody would go on otherwise."""
    threading.Thread(target=_wait_for_parent, daemon=True).start()


def _wait_for_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
