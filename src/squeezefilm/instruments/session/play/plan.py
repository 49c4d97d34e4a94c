"""Plan of a session, what it tells while it runs, and a texture as a device's tile.

A tile holds amplitudes over x that a device looks up by itself, without a loop.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from enum import Enum
from typing import Annotated, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import InputError, UnreachableError
from squeezefilm.instruments.control.gains import IdentifiedPlate, LoopAims
from squeezefilm.instruments.control.plate_loop import LOCKED
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Fault, State
from squeezefilm.instruments.device.wire.messages import LONGEST_TILE
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.loop.rows import COLUMNS
from squeezefilm.physics.render.fidelity.rendered_stroke import RelativeFriction
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ, SensorModel
from squeezefilm.physics.render.program.layout import FASTEST
from squeezefilm.physics.render.program.lowering import Program
from squeezefilm.physics.render.program.renderer import MadeForSpeed, render

# record's rows.
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


_MICROMETRE: si.Metre = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class TextureTile:
    """A texture at even places along x, straight lines between, nothing outside.

    Attributes:
        origin, pitch: place of the first amplitude and from each to the next (m), whole µm.
        amplitude: there (m, zero-to-peak), shape (size,).
        made_for: the finger's speed for which friction became amplitude, and the error in friction
            at half and double of it.
    """

    origin: si.Metre
    pitch: si.Metre
    amplitude: si.MetreArray
    made_for: MadeForSpeed


def tile_of(
    program: Program,
    way: tuple[si.Metre, si.Metre],
    speed: si.MetrePerSecond,
    law: RelativeFriction,
) -> TextureTile:
    """A steady texture sampled into a device's tile, as finely as it holds it.

    A tile knows no speed, no time and no y, and the device plays it without compensation. Where
    the friction of the display depends on the finger's speed it is made for one.

    Args:
        program: the lowered texture.
        way: places that it covers, from and to (m).
        speed: of the finger for which friction becomes amplitude (m/s), above 0.
        law: amplitude and speed → relative friction of the display, to state the error at others.

    Raises:
        InputError: a texture that may depend on speed, direction, time or y, or a way to nowhere.
        UnreachableError: a texture that wants what the display cannot reach on the tile.
    """
    si.require("speed", speed, si.Unit("m/s"), above=0.0, at_most=FASTEST)
    first, last = way
    if not last > first:
        raise InputError(f"a tile from {first:g} m to {last:g} m covers nothing; exchange them")
    moving = sorted(program.wanted_depends_on - {"x"})
    if moving:
        raise InputError(
            f"the texture may depend on {', '.join(moving)}, and a tile holds amplitudes over x "
            "alone; play it in mode stream",
            quantity="program",
        )
    # Whole micrometres, which is what the device counts in.
    pitch = max(1, math.ceil((last - first) / ((LONGEST_TILE - 1) * _MICROMETRE)))
    origin = math.floor(first / _MICROMETRE)
    size = min(LONGEST_TILE, math.ceil((last - first) / (pitch * _MICROMETRE)) + 1)
    amplitude = _amplitudes(program, origin + pitch * np.arange(float(size)), speed)
    return TextureTile(
        origin=origin * _MICROMETRE,
        pitch=pitch * _MICROMETRE,
        amplitude=amplitude,
        made_for=MadeForSpeed.of(law, amplitude, speed),
    )


def _amplitudes(program: Program, places: si.FloatArray, speed: si.MetrePerSecond) -> si.FloatArray:
    """The texture's amplitudes at places along x (µm) for a speed (m/s), each by itself."""
    # Divided, not multiplied by 1e-6: so a whole number of µm is the same float as in a texture.
    x = places / 1e6
    amplitudes = render(program, x, 0.0, speed, np.arange(x.size, dtype=float))
    met = amplitudes.counters
    if met.unreachable or met.faults:
        raise UnreachableError(
            f"at {met.unreachable + met.faults} of {x.size} places on the tile the texture wants "
            "what the display cannot reach; change its ends or the tile's place"
        )
    return amplitudes.amplitude


@si.checked_numbers
@dataclass(frozen=True)
class KnownDevice:
    """Facts about the device that plays.

    Attributes:
        sensor: what the finger is seen with.
        amplitude_per_pickup: of its pickup (m/V), if known.
        way: x that a tile covers (m), from and to; 0 to 10 cm, or what 512 amplitudes span.
        twin: whether it is a twin, where an assumed insulation counts.
        identified: its plate by a sweep, and the noise of each quadrature of its pickup (V), where
            that is more than is assumed; as predicted without.
    """

    sensor: SensorModel = LVDT_10_KHZ
    amplitude_per_pickup: si.MetrePerVolt | None = None
    way: tuple[si.Metre, si.Metre] | None = None
    twin: bool = False
    identified: tuple[IdentifiedPlate, si.Volt] | None = None


NOTHING_KNOWN = KnownDevice()

PlayMode = Literal["stream", "tile"]

REPORT_PERIOD: si.Second = 1e-3
"""Of a device's readings."""


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class PlayPlan:
    """Plan of what is to be played, and on what.

    Args:
        loop: texture, rate, estimator, compensation, output delay.
        limits: that the device is given, and holds.
        frequency: of the carrier (Hz), within the limits.
        tile: the texture for mode "tile"; None for mode "stream".
        device: what is known of it. Its places are older than their stamp by its sensor's latency,
            and a twin's watchdog counts its own time.
        hold: the identified plate and what its loops shall do, where the device has loops; None
            for a carrier and levels as they are asked for.

    Raises:
        InputError: a frequency outside the limits, or a loop that commands more than they allow.
    """

    loop: LoopPlan
    limits: Limits
    frequency: Annotated[
        si.Hertz, si.AtLeast("limits.lowest_frequency"), si.AtMost("limits.highest_frequency")
    ]
    tile: TextureTile | None = None
    device: KnownDevice = NOTHING_KNOWN
    hold: tuple[IdentifiedPlate, LoopAims] | None = None

    def __post_init__(self) -> None:
        highest, most = self.loop.voltage_limit, self.limits.voltage
        if highest > most * (1 + 1e-9):
            raise InputError(
                f"the loop may command {highest:.4g} V and the limits allow {most:.4g} V; lower "
                "the loop's",
                quantity="loop",
            )

    @property
    def mode(self) -> PlayMode:
        """ "stream" sends the loop's commands; "tile" gives the device the texture, which it plays
        at its own sensor while the loop only watches."""
        return "stream" if self.tile is None else "tile"

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns of the record: the loop's, and those of a device's loops where these shall
        hold."""
        return COLUMNS if self.hold is None else COLUMNS + HELD_COLUMNS


class Ending(Enum):
    """Reason why a session ended."""

    DURATION = "the time was over"
    INTERRUPTED = "it was interrupted"
    FAULT = "the device faulted"
    LINK = "the link to the device broke"
    LOOP = "the loop died"


@dataclass(frozen=True, slots=True)
class PlayView:
    """A moment of a session, for a live view; NaN where not known.

    Time (s), the finger's place (m) and speed (m/s), wanted amplitude, amplitude by the pickup
    (m), relative friction, the device's level (V), lag (m), lateness of the last tick (s), the
    device's state and fault, readings heard, rows recorded, flags of the last tick, and how the
    device's loops are where they hold the plate.
    """

    time: si.Second
    x: si.Metre
    speed: si.MetrePerSecond
    wanted: si.Metre
    amplitude: si.Metre
    relative_friction: float
    level: si.Volt
    lag: si.Metre
    lateness: si.Second
    state: State
    fault: Fault
    readings: int
    rows: int
    flags: tuple[str, ...]
    held: HeldState | None = None
