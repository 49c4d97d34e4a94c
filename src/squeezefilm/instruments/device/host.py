"""A device as a host uses it: SI in, messages out, and the ports of a session on top of it.

One thread owns a `DeviceHost` and the drive, sensor and pickup that share it. **Who feeds the
watchdog**: the host, by calling `pump` more often than every 35 ms, in every state; it sends
a keep alive only where nothing else was sent for 15 ms. A host that does not come round in time
is just what the watchdog is for, so no thread here does it behind its back. The commands that wait
for an answer feed it while they wait.
"""

from __future__ import annotations

import math
import secrets
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.drive_limits import HIGHEST_VOLTAGE, Limits
from squeezefilm.core.errors import DeviceError, InputError, RefusedError
from squeezefilm.instruments.control.gains import IdentifiedPlate, LoopAims, loop_gains
from squeezefilm.instruments.device.machine.limits import level_of
from squeezefilm.instruments.device.machine.playing import CLOCK, LONGEST_REPORT, SHORTEST_REPORT
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import (
    Fault,
    Reason,
    State,
    amplitudes,
    binary32_below,
    number,
    whole_number,
)
from squeezefilm.instruments.device.wire.link import DeviceClock, Link, refusal

MOST_READINGS = 10_000
"""Readings kept for those who have not read them yet."""
LOOPS_PERIOD: si.Second = 20e-3
"""Between two questions for the loops' state, while they hold."""
_ZERO_LIMIT: si.Second = 0.2
_HARMLESS = (Reason.STATE, Reason.SEQUENCE, Reason.FULL)
_MICRO = 1e6
# The limits that have a most, and by how much an info's numbers are larger than SI's.
_ON_THE_WIRE: dict[str, float] = {
    "voltage": _MICRO,
    "slew": 1.0,
    "continuous_voltage": _MICRO,
    "heat": 1e3,
    "highest_frequency": 1e3,
    "duty": 1e3,
    "duty_window": 1e3,
}


class DeviceHost:
    """Commands to one device. Not thread-safe.

    Those that change its state wait for the answer and raise `DeviceError` where it refuses or is
    silent; `play`, `play_at`, `pump` and `poll` never wait.

    Args:
        link: to the device.
        session: number of the session (32 bits); a random one if None.
    """

    def __init__(self, link: Link, session: int | None = None) -> None:
        self.link = link
        self.session = secrets.randbits(32) if session is None else session
        self.info: m.Info | None = None
        self.capabilities: m.Capabilities | None = None
        self.loops: m.Loops | None = None
        self._holds, self._asked_loops = False, -math.inf
        self._unread: deque[m.Reading] = deque(maxlen=MOST_READINGS)
        self._opened = False
        self._limits: Limits | None = None

    @property
    def clock(self) -> DeviceClock:
        """The device's clock against the host's."""
        return self.link.device_clock

    @property
    def state(self) -> State | None:
        """The device's state by its newest word, or None before the first."""
        newest = self.link.status
        return None if newest is None else State(newest.state)

    def open(self, limits: Limits) -> m.Info:
        """Stop the device, begin a session and set its limits; returns what the device is.

        A fault that a silent host has left behind (watchdog) is cleared: this is that host's next
        word. Any other fault stays.

        Raises:
            DeviceError: a device that is silent, refuses, has another fault, or whose firmware
                does not allow the limits.
        """
        self.link.drop()
        self._opened = self._holds = False
        self.loops = None
        self.link.request(m.Stop())
        status = self.link.request(m.Hello(self.session))
        if status.session != self.session:
            raise DeviceError(
                f"the device answers for session {status.session} and {self.session} was opened; "
                "another program uses it: end that one"
            )
        self.link.poll()
        self._opened = True
        self._wait_for_zero()
        if status.state == State.FAULT:
            if status.fault != Fault.WATCHDOG:
                raise DeviceError(
                    f"the device has the fault '{_fault_name(status.fault)}' of an earlier "
                    "session; find its cause, then clear it with clear()"
                )
            self.clear()
        self.info = None
        self._ask(m.AskInfo(), lambda: self.info)
        if self.info is None:
            raise DeviceError(
                "the device answers and does not say what it is (info); its firmware is older than "
                "this program: update it"
            )
        self._set_limits(limits, self.info)
        self._limits = limits
        return self.info

    def hold(self, plate: IdentifiedPlate, aims: LoopAims) -> str:
        """Give the device's loops their gains and switch them on; after `open` and before `arm`.

        Steps are the device's ticks; frequencies and voltage stay within the limits. Levels are
        then those that the free plate would need. Returns why the device cannot, in words, or "";
        one that cannot plays without loops.

        Raises `OutOfRangeError` where a loop would be faster than the device's ticks or the
        resonance is outside the limits, and `DeviceError`.
        """
        self.capabilities = None
        try:
            self._ask(m.Negotiate(m.REVISION), lambda: self.capabilities)
        except RefusedError as error:
            if error.reason != Reason.TYPE:
                raise
        if self.capabilities is None:
            return (
                "the device's firmware knows no loops (it speaks revision 1 of the messages), so "
                "it plays without; update it to hold the resonance"
            )
        if self.info is None or self._limits is None or not self.capabilities.has_loops:
            return "the device has no loops, which need a pickup with a phase; it plays without"
        gains = loop_gains(plate, replace(aims, interval=self.info.tick_period / _MICRO))
        limits = m.limits_message(self._limits)
        most = min(gains.highest_level, level_of(limits.voltage))
        gains = gains._replace(
            lowest_frequency=max(gains.lowest_frequency, limits.lowest_frequency),
            highest_frequency=min(gains.highest_frequency, limits.highest_frequency),
            highest_level=most,
            search_level=min(gains.search_level, most),
        )
        self.link.request(m.SetLoops(gains))
        self.search()
        return ""

    def search(self) -> None:
        """Switch the loops on with a new search, also where one found nothing. Raises
        `DeviceError` for a device without loops or gains."""
        self.link.request(m.SwitchLoops(1))
        self._holds = True

    def release(self) -> None:
        """Switch the loops off; the carrier stays where they left it. Raises as `search`."""
        self.link.request(m.SwitchLoops(0))
        self._holds, self.loops = False, None

    def arm(self) -> None:
        """OFF → ARMED, with the newest token. Raises `DeviceError`."""
        self.link.request(m.Arm(self.link.request(m.KeepAlive()).token))

    def start(self, frequency: si.Hertz) -> None:
        """ARMED → PLAYING at a carrier frequency (Hz), silent.

        Raises `InputError` for one outside the limits, and `DeviceError`.
        """
        self.link.request(m.Start(self._carrier(frequency)))

    def set_frequency(self, frequency: si.Hertz) -> None:
        """Move the carrier (Hz). Raises as `start`."""
        self.link.request(m.SetFrequency(self._carrier(frequency)))

    def play(
        self, levels: Sequence[si.Volt] | si.FloatArray, period: si.Second, start: int | None = None
    ) -> None:
        """Play amplitudes (V), shape (n ≤ 56,), one every `period` (s); does not wait.

        Args:
            levels: the amplitudes; the last one holds.
            period: 1 µs to 65 ms, in whole µs on the wire.
            start: when the first one is due on the device's clock (32 bits of µs). Blocks with a
                start queue up without gaps; without one they play from the moment they arrive, in
                place of what was playing.

        Raises:
            InputError: amplitudes below zero, above the limits or too many, or a period or a
                start that the wire cannot carry; nothing is sent.
            DeviceError: the device is gone.
        """
        values = self._volts(levels)
        microseconds = round(_MICRO * number("period", period, si.Unit("s"), 1e-6, 65.535e-3))
        if start is None:
            self.link.send(m.Envelope(microseconds, values))
        else:
            first = whole_number("start", start) & CLOCK
            self.link.send(m.TimedEnvelope(first, microseconds, values))

    def play_at(self, x: si.Metre) -> None:
        """Play the tile at `x` (m); does not wait.

        Raises `InputError` for a place beyond 2147 m, and `DeviceError` if the device is gone.
        """
        self.link.send(m.Position(round(_MICRO * number("x", x, si.Unit("m"), -2147.0, 2147.0))))

    def load_tile(
        self, origin: si.Metre, pitch: si.Metre, levels: Sequence[si.Volt] | si.FloatArray
    ) -> None:
        """Load amplitudes (V), shape (n,), from `origin` (m), `pitch` (m) apart, in whole µm.

        Raises:
            InputError: more than 512 amplitudes, or none, or one below zero or above the limits,
                or a pitch below 1 µm.
            DeviceError: the device refused or did not answer; the tile is then not complete.
        """
        values = self._volts(levels)
        first_place = round(_MICRO * number("origin", origin, si.Unit("m"), -2147.0, 2147.0))
        apart = round(_MICRO * number("pitch", pitch, si.Unit("m"), 1e-6, 2147.0))
        if not 1 <= len(values) <= m.LONGEST_TILE:
            raise InputError(
                f"a tile of {len(values)} amplitudes; 1 to {m.LONGEST_TILE} fit; use a wider pitch",
                quantity="levels",
            )
        self.link.request(m.TileBegin(first_place, apart, len(values)))
        for first in range(0, len(values), m.MOST_LEVELS):
            self.link.request(m.TileData(first, values[first : first + m.MOST_LEVELS]))

    def follow(self) -> None:
        """Play the tile at the device's own sensor. Raises `DeviceError`."""
        self.link.request(m.Follow())

    def report(self, period: si.Second) -> None:
        """A reading every `period` (s), at least 200 µs; none for 0.

        Raises `InputError` for another period, and `DeviceError`.
        """
        seconds = number("period", period, si.Unit("s"), 0.0, LONGEST_REPORT / _MICRO)
        if 0.0 < seconds < SHORTEST_REPORT / _MICRO:
            si.require("period", seconds, si.Unit("s"), at_least=SHORTEST_REPORT / _MICRO)
        self.link.request(m.Report(round(_MICRO * seconds)))

    def pump(self) -> None:
        """Hear the device and feed its watchdog if nothing was said for 15 ms; never waits.

        Raises:
            DeviceError: as `poll`.
        """
        self._hear()
        if self._holds and self.link.clock() - self._asked_loops >= LOOPS_PERIOD:
            self._asked_loops = self.link.clock()
            self.link.send(m.AskLoops())
        self.link.keep_alive()

    def poll(self) -> list[m.Reading]:
        """The readings since the last call, in order; never waits.

        A fault shows in `state` and in readings and raises nothing.

        Raises:
            DeviceError: the device is gone or was restarted, or refused something sent without
                waiting for a reason that asking later does not mend.
        """
        self._hear()
        came = list(self._unread)
        self._unread.clear()
        return came

    def stop(self) -> None:
        """Ramp to zero and disarm; allowed in every state. Raises `DeviceError` if it is gone."""
        self.link.request(m.Stop())

    def clear(self) -> None:
        """Clear the device's fault, once its output is at zero. Raises `DeviceError`."""
        status = self.link.request(m.KeepAlive())
        if status.state != State.FAULT:
            return
        self._wait_for_zero()
        self.link.request(m.ClearFault(status.fault))

    def _hear(self) -> None:
        for message in self.link.poll():
            if isinstance(message, m.Reading):
                self._unread.append(message)
            elif isinstance(message, m.Info):
                self.info = message
            elif isinstance(message, m.Capabilities):
                self.capabilities = message
            elif isinstance(message, m.Loops):
                self.loops = message
        newest = self.link.status
        if self._opened and newest is not None and newest.session != self.session:
            raise DeviceError(
                "the device was restarted, or another program opened it: it answers for session "
                f"{newest.session} and not {self.session}; open it again"
            )
        while self.link.refusals:
            name, status = self.link.refusals.popleft()
            if self._opened and name in _ASYNCHRONOUS and status.reason not in _HARMLESS:
                raise refusal(name, status)

    def _volts(self, levels: Any) -> tuple[si.Volt, ...]:
        """Amplitudes within the limits, once those are set, and within the wire's before."""
        highest = HIGHEST_VOLTAGE if self._limits is None else self._limits.voltage
        # What was computed from a limit, and the limit itself as binary32, may be above it by a
        # rounding: the device, whose limit was rounded down, would refuse the frame.
        volts = amplitudes(levels, highest * (1 + 1e-9)).astype(np.float32)
        return tuple(np.minimum(volts, binary32_below(highest)).tolist())

    def _carrier(self, frequency: si.Hertz) -> int:
        limits = self._limits
        lowest = 1.0 if limits is None else limits.lowest_frequency
        highest = 1e6 if limits is None else limits.highest_frequency
        return round(1e3 * number("frequency", frequency, si.Unit("Hz"), lowest, highest))

    def _ask(self, question: m.Message, answer: Callable[[], m.Answer | None]) -> None:
        """Ask what the device is or can, and wait for the `answer` that follows the status."""
        for _ in range(3):
            self.link.request(question)
            end = self.link.clock() + _ZERO_LIMIT
            while answer() is None and self.link.clock() < end:
                self._hear()
                self.link.wait(1e-3)
            if answer() is not None:
                return

    def _set_limits(self, limits: Limits, info: m.Info) -> None:
        asked = m.limits_message(limits)
        hints = si.hints_of(Limits)
        for what, scale in _ON_THE_WIRE.items():
            wanted, allowed = getattr(limits, what), getattr(info, what) / scale
            if wanted > allowed * (1 + 1e-9):
                unit = si.unit_of(hints[what])
                symbol = "" if unit is None or unit.symbol == "1" else unit.symbol
                raise DeviceError(
                    f"{what} is {wanted:g} {symbol} and this device's firmware allows at most "
                    f"{allowed:g} {symbol}; lower it"
                )
        if limits.lowest_frequency * 1e3 < info.lowest_frequency:
            raise DeviceError(
                f"lowest_frequency is {limits.lowest_frequency:g} Hz and this device's firmware "
                f"allows at least {info.lowest_frequency / 1e3:g} Hz; raise it"
            )
        self.link.request(asked)

    def _wait_for_zero(self) -> None:
        end = self.link.clock() + _ZERO_LIMIT
        while (level := self.link.request(m.KeepAlive()).level) > 0:
            if self.link.clock() > end:
                raise DeviceError(
                    f"the device was stopped and its output is still {level / _MICRO:g} V after "
                    f"{_ZERO_LIMIT:g} s; switch its amplifier off"
                )
            self.link.wait(1e-3)


_ASYNCHRONOUS = (m.Envelope.__name__, m.TimedEnvelope.__name__, m.Position.__name__)


def _fault_name(fault: int) -> str:
    return Fault(fault).name.lower().replace("_", " ") if fault <= Fault.TRIPPED else str(fault)
