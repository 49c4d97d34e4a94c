"""What holds up a twin's host on a busy computer, and is no fault of the host's: the way of what it
says through a pseudo-terminal, and its processes' waiting for a processor."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

_LOOKS_APART = 12_000
"""µs between looks: the system counts the time of a thread that runs by its own clock, whose ticks
are up to 10 ms apart."""


class Way:
    """How long the system takes to carry a byte through a pseudo-terminal: one is sent again and
    again. Linux carries them in a worker of ordinary priority, which a busy machine holds up for
    hundreds of milliseconds while both programs run before ordinary work.
    """

    def __init__(self) -> None:
        import tty

        self._near, self._far = os.openpty()
        tty.setraw(self._far)
        os.set_blocking(self._near, False)
        self._sent_at: int | None = None

    def held_up_since(self, wall: int) -> int:
        """When the byte was sent that is still on its way, or now."""
        if self._sent_at is not None:
            try:
                os.read(self._near, 1)
            except BlockingIOError:
                return self._sent_at
        os.write(self._far, bytes(1))
        self._sent_at = wall
        return wall

    def close(self) -> None:
        """Close both ends."""
        os.close(self._near)
        os.close(self._far)


class _Seen(NamedTuple):
    ran: int
    waited: int
    """Both in ns, since the thread began."""
    ready: bool
    """Whether it runs or waits for a processor, rather than for anything else."""


class Waiting:
    """How long a host waits for a processor: any thread of the process `host` and of those it
    started, but not of this one. Linux counts it; elsewhere nobody is found to wait.

    A host that is stopped, that sleeps, that computes or that is silent on purpose does not wait.
    """

    def __init__(self, host: int) -> None:
        self._host = host
        self._seen: dict[Path, _Seen] = {}
        self._looked_at = 0

    def waited_since(self, begin: int, now: int) -> int:
        """µs up to `now` that a thread waited, of those since the last look and since `begin`: the
        longest of any. A silence's first look, and one too soon after another, finds none."""
        if now - self._looked_at < _LOOKS_APART:
            return 0
        first, elapsed = self._looked_at < begin, now - self._looked_at
        before, self._seen = self._seen, dict(self._threads())
        self._looked_at = now
        if first:
            return 0
        longest = 0
        for thread, is_now in self._seen.items():
            was = before.get(thread)
            if was is None:
                continue
            # The system adds up a wait when it ends: who has not run at all waits still.
            waits_still = was.ready and is_now.ready and is_now.ran == was.ran
            longest = max(longest, elapsed if waits_still else (is_now.waited - was.waited) // 1000)
        return min(longest, elapsed)

    def _threads(self) -> Iterator[tuple[Path, _Seen]]:
        processes = [self._host]
        while processes:
            process = processes.pop()
            try:
                threads = list(Path(f"/proc/{process}/task").iterdir())
            except OSError:
                continue
            for thread in threads:
                try:
                    ran, waited, _ = (thread / "schedstat").read_text().split()
                    # The name before the state may have brackets and blanks of its own.
                    state = (thread / "stat").read_text().rpartition(")")[2].split()[0]
                    children = (thread / "children").read_text().split()
                except (OSError, ValueError, IndexError):
                    # It has just ended, or the system does not count this.
                    continue
                yield thread, _Seen(int(ran), int(waited), state == "R")
                processes += [int(one) for one in children if int(one) != os.getpid()]
