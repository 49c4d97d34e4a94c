"""What a session is to do, and what it tells while it runs."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import InputError
from squeezefilm.instruments.device.wire.states import Fault, State
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.play.tile import TextureTile

PlayMode = Literal["stream", "tile"]


REPORT_PERIOD: si.Second = 1e-3


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class PlayPlan:
    """What is to be played, and on what.

    Args:
        loop: texture, rate, estimator, compensation, output delay.
        limits: that the device is given, and holds.
        frequency: of the carrier (Hz), within the limits.
        mode: "stream" sends the loop's commands; "tile" gives the device the texture, which it
            plays at its own sensor while the loop only watches.
        tile: the texture for mode "tile".
        report_period: of the device's readings (s); at least 0.2 ms.
        sensor_latency: of the device's sensor (s), by which its places are older than their stamp.
        amplitude_per_pickup: vibration amplitude per signal of the pickup (m/V); None if unknown.
        twin: whether the device is a twin, whose watchdog counts its own time.

    Raises:
        InputError: a value outside its range, a tile without its mode, or the other way round.
    """

    loop: LoopPlan
    limits: Limits
    frequency: si.Hertz
    mode: PlayMode = "stream"
    tile: TextureTile | None = None
    report_period: Annotated[si.Second, si.AtLeast(0.0002), si.AtMost(0.02)] = REPORT_PERIOD
    sensor_latency: Annotated[si.Second, si.AtLeast(0.0), si.AtMost(1.0)] = 0.0
    amplitude_per_pickup: si.MetrePerVolt | None = None
    twin: bool = False

    def __post_init__(self) -> None:
        limits = self.limits
        si.require(
            "frequency",
            self.frequency,
            si.Unit("Hz"),
            at_least=limits.lowest_frequency,
            at_most=limits.highest_frequency,
        )
        if (self.mode == "tile") != (self.tile is not None):
            raise InputError("mode tile needs a tile, and mode stream has none")
        highest = float(self.loop.drive.voltage[-1])
        if highest > limits.voltage * (1 + 1e-9):
            raise InputError(
                f"the loop may command {highest:.4g} V and the limits allow {limits.voltage:.4g} "
                "V; lower the loop's drive table",
                quantity="loop",
            )


class Ending(Enum):
    """Why a session ended."""

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
    device's state and fault, readings heard, rows recorded, flags of the last tick.
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
