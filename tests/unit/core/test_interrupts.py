"""What is started while interrupts are held hears none, until it asks for them."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
from multiprocessing.connection import Connection

import pytest

from squeezefilm.core.interrupts import hear_interrupts, interrupts_held

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows holds no signals back")


def _told(line: Connection) -> None:
    """Wait while interrupts come, then hear them."""
    line.recv()
    try:
        hear_interrupts()
        line.send("heard nothing")
    except KeyboardInterrupt:
        line.send("heard it")


@pytest.mark.parametrize("comes", [True, False])
def test_a_process_hears_what_came_before_it_could(comes: bool) -> None:
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_told, args=(theirs,), daemon=True)
    with interrupts_held():
        process.start()
    if comes:
        # It has not begun to load.
        assert process.pid is not None
        os.kill(process.pid, signal.SIGINT)
    ours.send(None)
    assert ours.recv() == ("heard it" if comes else "heard nothing")
    process.join()
    assert process.exitcode == 0


def test_who_starts_it_hears_it_afterwards() -> None:
    with pytest.raises(KeyboardInterrupt), interrupts_held():
        os.kill(os.getpid(), signal.SIGINT)
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())
