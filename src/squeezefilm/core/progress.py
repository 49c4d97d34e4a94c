"""Progress of long work, and how long it may take: handed down to what works."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

SayProgress = Callable[[str], None]
"""Function that is told in words what is being done."""

CountProgress = Callable[[int, int], None]
"""Function that is told how many of how many are done."""

ShareProgress = Callable[[str, float], None]
"""Function that is told in words what is being done, and which share of it is done (0 to 1)."""


@dataclass(frozen=True, slots=True)
class Deadline:
    """A time (s, of `clock`) by which work must have ended, with `reserved` (s) for what comes
    after it; `slowness` is how many times longer than expected work takes here."""

    ends: float
    clock: Callable[[], float] = field(default=time.monotonic, compare=False, repr=False)
    reserved: float = 0.0
    slowness: float = 1.0

    def allows(self, seconds: float) -> bool:
        """True where work that is expected to take so long (s) would end in time."""
        return self.clock() + self.slowness * (seconds + self.reserved) <= self.ends

    def earlier(self, seconds: float) -> Deadline:
        """The same with time (s) reserved for what comes after."""
        return replace(self, reserved=self.reserved + seconds)

    def slower(self, slowness: float) -> Deadline:
        """The same where work takes this many times as long as is expected of it."""
        return replace(self, slowness=slowness)


@dataclass(frozen=True, slots=True)
class Pace:
    """The pace of a long solve: `budget` (s; None: as long as it takes) and whom it tells.

    The budget is a part of what is asked, since the answer depends on it; who is told is not, so
    that a cache sees one key.
    """

    budget: float | None = None
    tell: ShareProgress | None = field(default=None, compare=False)
    clock: Callable[[], float] = field(default=time.monotonic, compare=False, repr=False)

    def deadline(self) -> Deadline | None:
        """The time at which the budget, begun now, is used up."""
        return None if self.budget is None else Deadline(self.clock() + self.budget, self.clock)

    def share(self, first: float, last: float) -> ShareProgress | None:
        """Function that a part of the work tells, from one fraction of the whole to another."""
        return None if self.tell is None else within(self.tell, first, last)


def within(tell: ShareProgress, first: float, last: float) -> ShareProgress:
    """A listener to a part of some work, which goes from one fraction of the whole to another."""
    return lambda text, fraction: tell(text, first + (last - first) * fraction)


NO_HURRY = Pace()
"""Pace of work without a budget, whose progress nobody is told."""


def said_with_time_left(
    say: SayProgress, clock: Callable[[], float] = time.monotonic
) -> ShareProgress:
    """A listener to shares that tells them in words, with the time that is left by what they took
    so far: ``"fine mesh (40 %, about 12 s left)"``."""
    begun = clock()

    def tell(text: str, fraction: float) -> None:
        say(text + _left(clock() - begun, fraction))

    return tell


_TOO_EARLY, _TOO_SHORT = 0.05, 1.0


def _left(passed: float, fraction: float) -> str:
    """The time that is left in words: nothing while nobody knows, or before a second."""
    if not _TOO_EARLY <= fraction < 1:
        return ""
    left = passed * (1 - fraction) / fraction
    share = f"{100 * fraction:.0f} %"
    return f" ({share})" if left < _TOO_SHORT else f" ({share}, {about(left)} left)"


def about(seconds: float) -> str:
    """An estimated time for people: ``"about 12 s"``, ``"about 3 min"``, ``"about 2 h"``."""
    for unit, size in (("h", 3600.0), ("min", 60.0)):
        if seconds >= 2 * size:
            return f"about {seconds / size:.0f} {unit}"
    return f"about {seconds:.0f} s" if seconds >= 1 else "less than 1 s"
