"""The seams between a session and hardware, each one method wide.

A real device, its twin, a replay and a test's fake differ only below these. Nothing here raises
inside a real-time block: a fault zeroes the drive, and is raised on the caller's side.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from squeezefilm.core import quantities as si


@dataclass(frozen=True, slots=True)
class FingerSample:
    """Where the finger was (m, in the plate's axes), when (s, device clock), if it touched."""

    time: si.Second
    x: si.Metre
    y: si.Metre
    touching: bool


class Sensor(Protocol):
    """A finger's position sensor."""

    def read(self) -> FingerSample | None:
        """The newest sample, or None if none came since the last call. Does not wait."""
        ...


class Drive(Protocol):
    """What turns drive amplitudes into voltage on the plate."""

    @property
    def stops_by_itself(self) -> bool:
        """Whether the output goes to zero on its own within 60 ms when the host falls silent."""
        ...

    def write(self, block: si.FloatArray) -> int:
        """Play the amplitudes (V, zero-to-peak) in `block`, shape (n,); returns how many fitted."""
        ...
