"""A design search in a process of its own, told to the server over a pipe.

Stopped by SIGINT, from the page or from the terminal, it answers with what it found until then.
"""

from __future__ import annotations

import contextlib
import signal
import time
from collections.abc import Iterator
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.core.interrupts import hear_interrupts
from squeezefilm.core.progress import about
from squeezefilm.lab.told_process import Tell, ToldProcess, telling
from squeezefilm.lab.worker import LARGEST_MEMORY, prepare

if TYPE_CHECKING:
    from squeezefilm.design.search.run import Glimpse

TELL_EVERY: si.Second = 0.25
"""Between two glimpses that the pages get; a new stage and the end are told at once."""
_SLOWER = 100
"""Plates of a front for which it is twice as long, since each has a row."""


class SearchProcess(ToldProcess):
    """At most one search at a time."""

    ended = "search ended"
    in_use = "this lab searches already; stop that search first"
    stopped = "stopped; what is shown is what was found until then"
    died = (
        "the process that searched ended without a word, as one does that runs out of memory; what "
        "it knew is kept, and the same requirements go on from there"
    )
    patience = 1.0


class Pace:
    """How long the screening or the solving goes on, by how fast its stage went until now."""

    def __init__(self, screened: int, solved: int) -> None:
        self._every = screened, solved
        self._stage, self._began, self._first = "", 0.0, 0

    def left(self, seen: Glimpse) -> str:
        """How long it takes until all designs are screened, or as many are solved as may be, in
        words; "" while nobody knows."""
        screens = seen.stage.startswith("screening")
        every, done = self._every[not screens], seen.screened if screens else seen.solved
        now = time.monotonic()
        if seen.stage != self._stage:
            self._stage, self._began, self._first = seen.stage, now, done
        if done <= self._first or done >= every:
            return ""
        return about((now - self._began) / (done - self._first) * (every - done))


class _Stop:
    """SIGINT as `KeyboardInterrupt`, once, and not in the middle of a message on the pipe."""

    def __init__(self) -> None:
        self._asked, self._held, self._late = False, False, False
        signal.signal(signal.SIGINT, self._hear)

    def _hear(self, *_: object) -> None:
        if self._asked:
            return
        self._asked = True
        if self._held:
            self._late = True
        else:
            raise KeyboardInterrupt

    @contextlib.contextmanager
    def held(self) -> Iterator[None]:
        """What is done here is done whole; a stop comes after it."""
        self._held = True
        try:
            yield
        finally:
            self._held = False
        if self._late:
            self._late = False
            raise KeyboardInterrupt


def search(connection: Connection, text: str, folder: Path, out: Path, **how: Any) -> None:
    """Search for the plates that a text's requirements ask for, and tell of it.

    `folder` is the lab's, `out` keeps every design; `how` has screened, solved, seed and jobs.
    """
    prepare()
    stop = _Stop()
    tell = telling(connection)
    try:
        hear_interrupts()
        found = _found(stop, tell, text, folder, out, how)
    except KeyboardInterrupt:
        # Before the first design, or a second time while it was counted what there is.
        found = {"failed": False, "message": "stopped"}
    except SqueezefilmError as error:
        found = {"failed": True, "message": str(error)}
    except MemoryError:
        found = {
            "failed": True,
            "message": f"the search needs more than {LARGEST_MEMORY / 1024**3:g} GiB of memory and "
            "was ended; screen or solve fewer designs",
        }
    except Exception as error:
        # A mistake of ours: the page says it, and not that the search died.
        found = {"failed": True, "message": f"not foreseen: {type(error).__name__}: {error}"}
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    tell({"type": SearchProcess.ended, **found})


def _found(
    stop: _Stop, tell: Tell, text: str, folder: Path, out: Path, how: dict[str, Any]
) -> dict[str, Any]:
    from squeezefilm.design.search.run import SearchRequest, search_until_stopped
    from squeezefilm.lab.searching import shown
    from squeezefilm.lab.searching.asked import requirements_of

    requirements = requirements_of(text, folder)
    last: tuple[str, float] | None = None
    pace = Pace(how["screened"], how["solved"])

    def say(words: str) -> None:
        with stop.held():
            tell({"type": "search says", "text": words})

    def watch(seen: Glimpse) -> None:
        nonlocal last
        now, left = time.monotonic(), pace.left(seen)
        every = TELL_EVERY * (1 + len(seen.front) / _SLOWER)
        if last is not None and last[0] == seen.stage and now - last[1] < every:
            return
        last = seen.stage, now
        with stop.held():
            tell({"type": "search found", "left": left, **shown.glimpse(requirements, seen)})

    found, stopped = search_until_stopped(
        SearchRequest(requirements, out=out, progress=say, watch=watch, **how)
    )
    return {"failed": False, "message": _ending(stopped), "result": shown.result(found)}


def _ending(stopped: str) -> str:
    return SearchProcess.stopped if stopped else "finished"
