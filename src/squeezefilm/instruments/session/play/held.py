"""Words and columns of a session for the loops that hold its plate: in its view, and in the
record's rows."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.instruments.control.plate_loop import LOCKED
from squeezefilm.instruments.device.wire import messages as m

_MODES = ("searching", "probing", "locked", "not found", "wrong sign")

HELD_COLUMNS = (
    "loops_locked",
    "detuning_half_bandwidths",
    "amplitude_error_share",
    "drive_reserve_V",
    "finger_load_share",
    "plate_temperature_degC",
)
"""Columns of a record behind those of the loop, where a device's loops hold the plate; as last
reported, NaN before, and where not known. See `HeldState`."""


@dataclass(frozen=True, slots=True)
class HeldState:
    """State of a device's loops.

    Args:
        mode: in words: searching, probing, locked, not found, wrong sign.
        detuning: of the carrier against the resonance (half-bandwidths).
        amplitude_error: of the pickup's amplitude, over the one asked for; NaN where that is 0.
        drive_reserve: how much more the drive may give (V).
        finger_load: the finger's loss over the plate's own.
        temperature: of the plate (°C); NaN where not known.
    """

    mode: str
    detuning: float
    amplitude_error: float
    drive_reserve: si.Volt
    finger_load: float
    temperature: float

    @classmethod
    def of(cls, said: m.Loops) -> HeldState:
        """State by a device's answer, in SI."""
        known = said.flags & m.TEMPERATURE_KNOWN
        return cls(
            mode=_MODES[said.mode] if said.mode < len(_MODES) else str(said.mode),
            detuning=said.detuning / 65536,
            amplitude_error=said.error / said.target if said.target > 0 else math.nan,
            drive_reserve=said.reserve * 1e-6,
            finger_load=said.load / 65536,
            temperature=said.temperature * 1e-3 if known else math.nan,
        )

    @property
    def locked(self) -> bool:
        """True where the plate is held."""
        return self.mode == _MODES[LOCKED]

    @property
    def words(self) -> str:
        """All of it in one line."""
        parts = [
            f"loops {self.mode}",
            f"detuning {self.detuning:+.2f} half-bandwidths",
            f"amplitude {_percent(self.amplitude_error)}",
            f"reserve {self.drive_reserve:.1f} V",
            f"finger {self.finger_load:.2f}",
        ]
        if math.isfinite(self.temperature):
            parts.append(f"{self.temperature:.1f} °C")
        return ", ".join(parts)


def held_columns(state: HeldState | None, rows: int) -> si.FloatArray:
    """`HELD_COLUMNS` for so many rows, shape (rows, 6)."""
    if state is None:
        return np.full((rows, len(HELD_COLUMNS)), math.nan)
    numbers = [getattr(state, field.name) for field in fields(state)[1:]]
    return np.tile(np.array([float(state.locked), *numbers]), (rows, 1))


def _percent(share: float) -> str:
    return f"{100 * share:+.1f} %" if math.isfinite(share) else "–"
