"""What a process does while it loads: it looks for no garbage, and one that another process started
hears no Ctrl-C.

Loading makes hundreds of thousands of objects that stay. Python's collector of garbage goes through
all of them again each time that there are a quarter more, which is a tenth of the time that an
analysis takes to load, and nearly a third of that of matplotlib; later it would go through them
whenever it looks for what a solve has left.

A terminal sends Ctrl-C (SIGINT) to every process of a program, and a new Python would meet it with
a traceback for as long as it loads. So a process is started with SIGINT held back
(`interrupts_held`), which it inherits; one that means to act on SIGINT asks for it once it can
(`hear_interrupts`), and then gets what came meanwhile. Windows holds no signals back.
"""

from __future__ import annotations

import atexit
import gc
import signal
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def loading() -> Iterator[None]:
    """Within, nothing is collected; what is there afterwards is taken to stay. For programs of
    their own only: a library has no say in this."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        # When the program ends, a third of a second of garbage would be looked for a last time.
        atexit.register(gc.freeze)
        if was_on:
            gc.enable()


@contextmanager
def interrupts_held() -> Iterator[None]:
    """What this thread starts within hears no SIGINT; the thread hears it afterwards."""
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
