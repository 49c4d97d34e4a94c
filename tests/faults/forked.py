"""Processes forked off one that has imported and compiled what they run: 200 begin in no time.

Each is a process of its own, with its own memory, signals and end, as one that is started is.
"""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable
from typing import Any

IMPORTED = ["tests.faults.compiled_host", "tests.faults.program_child", "tests.faults.study_child"]


class Forked:
    """A function in a process of its own; its first argument is the pipe on which it tells."""

    def __init__(self, function: Callable[..., None], *arguments: Any) -> None:
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(IMPORTED)  # Heard once, before the server is started.
        self.told, tells = context.Pipe(duplex=False)
        self.process = context.Process(target=function, args=(tells, *arguments))
        self.process.start()
        tells.close()  # What is told then ends with the process.

    def hear(self, patience: float = 120.0) -> Any:
        """What it tells next; None once it has ended and told all."""
        assert self.told.poll(patience), f"nothing was told for {patience:g} s"
        try:
            return self.told.recv()
        except EOFError:
            return None

    def has_ended(self) -> bool:
        """Whether it does not run any more."""
        return self.process.exitcode is not None

    def kill(self) -> None:
        """End it by kill -9 if it runs, and wait until it has ended."""
        self.process.kill()
        self.process.join()
