"""A device with a plate and a finger on it: the wire protocol on one side, the truth on the other.

The state machine is the device's own (`instruments.device.machine`), ticked as firmware is; the
plate, the film and the hand follow it on the same clock. Time is passed in: on a virtual clock it
is as fast as the computer, and the same bytes at the same times give the same truth, bit for bit,
in whatever pieces time is advanced. The twin's time is a whole number of µs that never wraps; the
device sees 32 bits of it.
"""

from __future__ import annotations

from pathlib import Path

from squeezefilm.core.errors import InputError
from squeezefilm.instruments.device.machine.device import Machine
from squeezefilm.instruments.device.machine.held import HeldPlate
from squeezefilm.instruments.device.machine.limits import DeviceLimits
from squeezefilm.instruments.device.machine.playing import CLOCK, until
from squeezefilm.instruments.device.wire.frames import State
from squeezefilm.instruments.twin.hand import Hand
from squeezefilm.instruments.twin.plant import Plant, TruthRecord
from squeezefilm.instruments.twin.settings import TwinSettings
from squeezefilm.instruments.twin.working_point import WorkingPoint, working_point
from squeezefilm.physics.display import Display

_QUIET_STRIDE = 5_000
"""µs between ticks of an armed device without output: half of what it may be late."""
_LONGEST_STRIDE = 1_000_000_000
"""µs that 32 bits of µs tell apart for certain."""
_PATIENCE = 1_000_000
"""µs that the watchdog may be told to wait longer: a host that hangs is stopped all the same."""


class TwinDevice:
    """A display's twin. Not thread-safe. Give it bytes and the time; it gives bytes back.

    Args:
        display: the display it is of.
        settings: what is assumed beyond the display; all defaults are assumed.
        hand: the finger on it; None for none.
        own: the firmware's own limits; as wide as the wire where None.
        truth_file: a CSV for every row of the truth.
        point: the display's working point where it has been computed before (`working_point`
            solves a plate in seconds).
    """

    def __init__(
        self,
        display: Display,
        settings: TwinSettings | None = None,
        *,
        hand: Hand | None = None,
        own: DeviceLimits | None = None,
        truth_file: Path | None = None,
        point: WorkingPoint | None = None,
    ) -> None:
        self.settings = settings or TwinSettings()
        self.display = display
        point = point or working_point(display, self.settings)
        self._plant = Plant(point, self.settings, hand, truth_file)
        self._tick = self.settings.tick_us
        heard = self.settings.pickup.kind != "none"
        self.machine = Machine(
            self.settings.seed,
            own or DeviceLimits(),
            lambda: self.plant.sensed(),
            (lambda: self.plant.pickup_level()) if heard else None,
            self._tick,
            HeldPlate(lambda: self.plant.phases(), lambda: self.plant.millidegrees())
            if heard
            else HeldPlate(),
        )
        self.ticks = 0
        self._now = 0
        self._outgoing = bytearray()
        self._held = (0, 0, 0)

    @property
    def plant(self) -> Plant:
        """Plate, finger, sensor and pickup, at the device's last tick."""
        self._follow()
        return self._plant

    @property
    def now(self) -> int:
        """The twin's time (µs)."""
        return self._now

    @property
    def truth(self) -> TruthRecord:
        """True motion and output up to now."""
        self.plant.drain()
        return self.plant.truth

    def receive(self, data: bytes, now_us: int) -> None:
        """Take bytes that arrived at `now_us`; answers wait for `advance`.

        Raises `InputError` for a time that has passed.
        """
        self._go_to(now_us)
        if not data:
            return
        self._hold(now_us)
        # Between ticks: a step ends here, whether or not the output changes.
        self._follow()
        self._outgoing += self.machine.receive(data, now_us & CLOCK)

    def advance(self, now_us: int) -> bytes:
        """Advance to `now_us`; returns the bytes for the host since the last call.

        The plate follows up to the last tick. Raises `InputError` for a time that has passed.
        """
        self._go_to(now_us)
        self._follow()
        out = bytes(self._outgoing + self.machine.outgoing())
        self._outgoing.clear()
        return out

    def excuse(self, duration: int) -> None:
        """Leave so many µs out of the time that the watchdog counts, one second in all for each
        silence: the computer, and not the host, was to blame. A real device knows no such thing.
        """
        self.machine.excused = min(_PATIENCE, self.machine.excused + duration)

    def close(self) -> None:
        """Write the truth out and close its file."""
        self.plant.close()

    def _go_to(self, now: int) -> None:
        if now < self._now:
            raise InputError(
                f"the twin is at {self._now} us and was asked for {now} us; its time only rises"
            )
        self._now = now
        last = now // self._tick * self._tick
        while True:
            at = self._next_tick(last)
            if at > last:
                return
            self._hold(at)
            self.machine.tick(at & CLOCK)
            self.ticks += 1
            if self.machine.reading_due is not None:
                # The machine itself keeps few readings; a host may ask for hours at once.
                self._outgoing += self.machine.outgoing()

    def _next_tick(self, last: int) -> int:
        """Time of the machine's next tick: the next tick, or, where it gives no output and
        a later one finds the same state, as late as that is so."""
        now = self._held[0]
        soon = (now // self._tick + 1) * self._tick
        if soon > last or self.machine.level > 0 or self.machine.state is State.PLAYING:
            return soon
        stride = _QUIET_STRIDE if self.machine.state is State.ARMED else _LONGEST_STRIDE
        late = min(last, now + stride) // self._tick
        due = self.machine.reading_due
        if due is not None:
            late = min(late, -(-(now + until(due, now & CLOCK)) // self._tick))
        return max(soon, late * self._tick)

    def _hold(self, until: int) -> None:
        """Hold the machine's output until then; the plate follows when it must."""
        at, level, frequency = self._held
        if (level, frequency) != (self.machine.level, self.machine.frequency):
            # One call for all ticks of equal output: most of a call's cost is its being made.
            self._plant.advance(at, level, frequency)
        self._held = (until, self.machine.level, self.machine.frequency)

    def _follow(self) -> None:
        self._plant.advance(*self._held)
