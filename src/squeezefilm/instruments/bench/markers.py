"""Markers for the lab streaming layer: what happened when, told to recorders on the network.

pylsl (MIT) is optional; `squeezefilm[lsl]` has it. A marker is a line of text with the moment of
what it says, not the moment at which it was sent.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import optional

NAME = "squeezefilm"
"""Name of the stream, unless another is given."""


class Markers:
    """A stream of text markers, type "Markers", one channel, without a fixed rate.

    Args:
        name: of the stream, by which recorders find it.
        clock: whose moments are told (s); the same as that of whoever tells them.

    Raises:
        InputError: pylsl is not installed, or finds no library of its own.
    """

    def __init__(
        self, name: str = NAME, *, clock: Callable[[], si.Second] = time.monotonic
    ) -> None:
        self._clock = clock
        self._lsl = lsl = _pylsl()
        info = lsl.StreamInfo(name, "Markers", 1, lsl.IRREGULAR_RATE, "string", f"{name}-markers")
        self._outlet = lsl.StreamOutlet(info)

    def push(self, text: str, at: si.Second | None = None) -> None:
        """Tell what happened `at` a moment of the clock (s); now, without one."""
        now = self._clock()
        ago = 0.0 if at is None else now - at
        self._outlet.push_sample([text], self._lsl.local_clock() - ago)


def markers_if(asked: bool | str) -> Markers | None:
    """Markers where they are asked for, or a name for their stream is given; raises as they do."""
    if asked is False:
        return None
    return Markers() if asked is True else Markers(asked)


def _pylsl() -> Any:
    # What is installed without its library says so by an error of its own.
    with optional("lsl", "a stream of markers"):
        import pylsl
    return pylsl
