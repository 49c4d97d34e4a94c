"""The plate's loops inside a device's tick: what they want on the plate, and what they say of it.

The twin of `firmware/squeezefilm_held.c`. The machine counts limits, slew, heat and duty of what
comes of it, as of any other level.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from squeezefilm.instruments.control.gains import within_bounds
from squeezefilm.instruments.control.plate_loop import (
    LOCKED,
    MOST_PICKUP,
    SEARCHING,
    LoopCommand,
    LoopGains,
    LoopState,
    first_state,
    plate_step,
    quotient,
    scaled,
)
from squeezefilm.instruments.device.machine.limits import DeviceLimits
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Reason

_NO_COMMAND = LoopCommand(0, 0, 0)
_NO_STATE = LoopState(SEARCHING, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0)


@dataclass(slots=True)
class HeldPlate:
    """The loops of a device, without gains until a host sends them. Not thread-safe.

    `phases` gives what the pickup showed over the last tick (µV: in phase with the drive, and 90°
    ahead), `temperature` that of the plate (1/1000 °C); None where a device lacks it. `revision`
    is that of the session's messages.
    """

    phases: Callable[[], tuple[int, int]] | None = None
    temperature: Callable[[], int] | None = None
    revision: int = 1
    gains: LoopGains | None = None
    on: bool = False
    state: LoopState = _NO_STATE
    command: LoopCommand = _NO_COMMAND
    wanted: int = 0

    def negotiate(self, revision: int) -> Reason:
        """The lower of what both sides speak."""
        if revision == 0:
            return Reason.VALUE
        self.revision = min(revision, m.REVISION)
        return Reason.ACCEPTED

    def drop(self) -> None:
        """Forget the gains."""
        self.gains, self.on = None, False

    def set(self, gains: LoopGains, limits: DeviceLimits, *, at_rest: bool) -> Reason:
        """Take gains that stay within the limits, switched off; at rest only."""
        if self.phases is None:
            return Reason.NO_LOOPS
        if not at_rest:
            return Reason.STATE
        if not within_bounds(
            gains, limits.lowest_frequency, limits.highest_frequency, limits.voltage
        ):
            return Reason.VALUE
        self.gains, self.on = gains, False
        self.begin(anew=True)
        return Reason.ACCEPTED

    def switch(self, on: int, *, faulted: bool) -> Reason:
        """Off for 0; for 1 on, with a new search."""
        if self.gains is None:
            return Reason.NO_LOOPS
        if faulted:
            return Reason.STATE
        if on > 1:
            return Reason.VALUE
        self.on = bool(on)
        if on:
            self.begin(anew=True)
        return Reason.ACCEPTED

    def begin(self, anew: bool) -> None:
        """Search anew, or go on after a pause: a lock, and a verdict, outlast it; what the plate
        did before it says nothing after it."""
        if anew or self.state.mode < LOCKED:
            assert self.gains is not None
            self.state = first_state(self.gains)
        self.state = self.state._replace(re=0, im=0, rate=0, wrong=0)
        self.command = LoopCommand(0, scaled(self.state.frequency, 8), 0)

    def skip(self) -> None:
        """Leave out a step of another length, which says nothing of the plate."""
        if self.on:
            self.state = self.state._replace(re=0, im=0)

    def level(self, asked: int, applied: int, ticked: bool) -> int:
        """The level (µV) that they want on the plate for one `asked` of a free plate.

        They step with ticks alone, since their gains know no other interval; `applied` was on the
        plate since the last. A plate that is not found yet rests while nothing is asked for.
        """
        self.wanted = asked
        if asked == 0 and self.state.mode != LOCKED:
            return 0
        if ticked:
            assert self.gains is not None
            assert self.phases is not None
            self.state, self.command = plate_step(
                self.gains, self.state, self.phases(), asked, applied
            )
        return self.command.level

    def capabilities(self) -> m.Capabilities:
        """Capabilities of the device that not every device has."""
        return m.Capabilities(self.revision, int(self.phases is not None))

    def report(self, now: int) -> m.Loops:
        """Report of the loops."""
        assert self.gains is not None
        state, command = self.state, self.command
        target = min(self.gains.ratio * self.wanted >> 24, MOST_PICKUP)
        known = self.temperature is not None
        return m.Loops(
            time=now,
            mode=state.mode,
            flags=m.LOOPS_ON * self.on | command.flags << 1 | m.TEMPERATURE_KNOWN * known,
            lost=state.lost & 0xFF,
            false_locks=state.false & 0xFF,
            frequency=command.frequency,
            detuning=state.detuning,
            target=target,
            error=quotient(state.re, 16) - target,
            reserve=self.gains.highest_level - command.level,
            load=quotient(state.load, 16),
            temperature=0 if self.temperature is None else self.temperature(),
        )
