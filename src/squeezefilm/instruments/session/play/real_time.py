"""A session in real time: the loop in its own process, the link on a port, a record on the disk.

Ctrl-C is no accident: the output ramps to zero, the device is disarmed, the record closed. What
breaks on the way is told in the outcome, and the record kept.
"""

from __future__ import annotations

import contextlib
import gc
import math
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import DeviceError, LoopError
from squeezefilm.core.results import to_json
from squeezefilm.instruments.device.host import DeviceHost
from squeezefilm.instruments.device.ports import Sensor, SerialDrive, Use, require_safe_drive
from squeezefilm.instruments.device.priority import (
    PLAYERS_PRIORITY,
    collect_garbage_first,
    real_time_granted,
)
from squeezefilm.instruments.device.wire.frames import Fault
from squeezefilm.instruments.device.wire.link import Link
from squeezefilm.instruments.device.wire.streams import open_stream
from squeezefilm.instruments.session.loop.process import LoopProcess
from squeezefilm.instruments.session.loop.rows import SAMPLE_COLUMNS
from squeezefilm.instruments.session.loop.shared import private_views, ring_put_all, taken
from squeezefilm.instruments.session.play.plan import Ending, PlayPlan, PlayView
from squeezefilm.instruments.session.play.player import FADE, Player
from squeezefilm.instruments.session.play.usability import Usability
from squeezefilm.instruments.session.record.trace_file import TraceWriter

PAUSE: si.Second = 1e-3
"""Time between two looks of the player at its device."""
SHOW_PERIOD: si.Second = 0.1
LONGEST_SILENCE: si.Second = 35e-3
"""Longest time between two steps of the player, which feed a device's watchdog."""


@dataclass(frozen=True, slots=True)
class PlayOutcome:
    """End of a session: why, what there is to say of it, and where its record is.

    `usability` is what its ticks say of it; None where they were not counted. `silent` is when the
    device said that its output is at zero, or was given up (s, `time.monotonic`).
    """

    ending: Ending
    message: str
    trace: Path
    rows: int
    silent: si.Second = math.nan
    usability: Usability | None = None

    @property
    def failed(self) -> bool:
        """True where it ended for another reason than its time or its user."""
        return self.ending not in (Ending.DURATION, Ending.INTERRUPTED)

    @property
    def usable(self) -> bool:
        """True where it did not fail and played as planned, see `Usability`."""
        return not self.failed and (self.usability is None or self.usability.usable)

    @property
    def said(self) -> str:
        """Sentence on how it ended, also of one that ended as it should and cannot be used."""
        if self.message or self.usability is None or self.usability.usable:
            return self.message
        return f"not usable: {self.usability.sentence}"


def run_play(
    plan: PlayPlan,
    drive: str,
    trace: Path,
    metadata: Mapping[str, Any],
    *,
    duration: si.Second,
    sensor: Callable[[Callable[[], si.Second]], Sensor] | None = None,
    show: Callable[[PlayView], None] | None = None,
    tap: Callable[[si.FloatArray], None] | None = None,
    until: Callable[[], bool] | None = None,
    use: Use = "own hand",
) -> PlayOutcome:
    """Play for a time, or until Ctrl-C, and record it.

    Args:
        plan: what to play.
        drive: the device's stream, such as "serial:/dev/ttyACM0".
        trace: the record to write, which must not exist.
        metadata: of the record.
        duration: for which to play (s).
        sensor: makes the sensor from the loop's clock, where it is not the device's own.
        show: is told what there is to see, ten times a second and when the device's state changes.
        tap: is given the rows as they are recorded; must be quick.
        until: is asked every millisecond whether to end as on Ctrl-C; must be quick.
        use: whose hand touches the plate, see `require_safe_drive`.

    Raises:
        InputError: a drive that is not safe, see `require_safe_drive`.
        DeviceError, LoopError, RecordError: what fails before anything was played.
    """
    with (
        contextlib.closing(open_stream(drive)) as stream,
        TraceWriter(trace, plan.columns, metadata) as writer,
        _interruptible(until) as interrupted,
    ):
        loop = LoopProcess(plan.loop)

        def clock() -> si.Second:
            return loop.time

        link = Link(stream, clock)
        host = DeviceHost(link)
        drives = SerialDrive(host, plan.loop.period)
        require_safe_drive(drives, plan.limits, use)
        eyes = None if sensor is None else sensor(clock)
        player = Player(plan, loop, host, writer, clock, eyes, tap)
        _compile()
        collect_garbage_first()
        try:
            with loop:
                with contextlib.nullcontext() if plan.device.twin else _preferred():
                    with _stopping(host):
                        ending, message = played(
                            player, lambda: time.sleep(PAUSE), duration, interrupted, show
                        )
                    player.end(ending, time.sleep, message)
                silent = time.monotonic()
        finally:
            gc.unfreeze()
        report = loop.report()
        player.drain()
        writer.event("loop", {**to_json(report), "lateness": report.lateness.to_json()})
        writer.event("link", to_json(link.statistics))
        verdict = player.judge()
        return PlayOutcome(ending, message, trace, writer.acknowledged, silent, verdict)


def _compile() -> None:
    """Compile what the player calls, which would hold it up for longer than a watchdog waits."""
    spare = private_views()
    ring_put_all(spare.sample_counters, spare.samples, np.zeros((1, len(SAMPLE_COLUMNS))))
    taken(spare.command_counters, spare.commands)
    taken(spare.row_counters, spare.rows)


def played(
    player: Player,
    wait: Callable[[], None],
    duration: si.Second,
    interrupted: Callable[[], bool] = lambda: False,
    show: Callable[[PlayView], None] | None = None,
) -> tuple[Ending, str]:
    """Begin, step until something ends it, and fade; returns what ended it, and what to say.

    `wait` lets time pass on the player's clock between two of its steps.
    """
    clock = player.clock
    player.begin()
    began = clock()
    shown, state = 0.0, player.state
    try:
        while player.ending is None:
            now = clock()
            if now - began >= duration or interrupted():
                break
            wait()
            player.step()
            if show is not None and (now - shown >= SHOW_PERIOD or player.state is not state):
                shown, state = now, player.state
                show(player.view())
        if player.ending is None:
            player.fade()
        faded = clock()
        while player.ending is None and clock() < faded + FADE:
            wait()
            player.step()
    except DeviceError as error:
        return Ending.LINK, str(error)
    except LoopError as error:
        return Ending.LOOP, str(error)
    if player.ending is not None:
        return Ending.FAULT, fault_sentence(player)
    return (Ending.INTERRUPTED if interrupted() else Ending.DURATION), player.unheld


def fault_sentence(player: Player) -> str:
    """Sentence for a person on what its device's fault means."""
    fault = player.fault
    if fault is not Fault.WATCHDOG:
        return _FAULTS.get(fault, f"the device faulted: {fault.name.lower()}")
    heard = "the device heard nothing for 50 ms"
    if player.plan.device.twin:
        heard = "the twin heard nothing for 50 ms of its own time"
    why = (
        f"this program was held up for {1e3 * player.held_up:.0f} ms. Close other programs, or "
        "allow real-time priority"
        if player.held_up > LONGEST_SILENCE
        else "this program was not held up, so what it sent was lost or late on the way; look at "
        "the cable, and at what else the computer does"
    )
    return f"{heard}, took its output to zero and latched (watchdog): {why}"


_FAULTS: dict[Fault, str] = {
    Fault.HEAT: "the device's heat limit was reached; lower the voltage or give it pauses",
    Fault.DUTY: "the device's duty limit was reached; give it pauses",
    Fault.LATE_TICK: "the device's own loop was late and could not vouch for its output",
    Fault.TRIPPED: "the amplifier tripped, or its enable line was opened",
}


@contextlib.contextmanager
def _stopping(host: DeviceHost) -> Iterator[None]:
    """Stop the device where something nobody expected ends what plays."""
    try:
        yield
    except BaseException:
        # A full disk, say; should the device not hear it, its watchdog is left.
        with contextlib.suppress(DeviceError):
            host.stop()
        raise


@contextlib.contextmanager
def _preferred() -> Iterator[None]:
    """Run before ordinary work, where the system grants it, and after the loop.

    The player works a quarter of the time and sleeps in every millisecond; held up for 50 ms it
    would cost the session. The loop has said already where priority is not granted. Not with a
    twin, which needs as much again: on two processors both would leave nothing to the kernel's
    worker that carries what they say to each other, nor to the browser that shows it.
    """
    ordinary = hasattr(os, "sched_getscheduler") and os.sched_getscheduler(0) == os.SCHED_OTHER
    granted = ordinary and real_time_granted(PLAYERS_PRIORITY)
    try:
        yield
    finally:
        if granted:
            os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))


@contextlib.contextmanager
def _interruptible(until: Callable[[], bool] | None) -> Iterator[Callable[[], bool]]:
    """True where Ctrl-C was pressed (no exception amid something), or `until` is true."""
    pressed = threading.Event()

    def interrupted() -> bool:
        return pressed.is_set() or (until is not None and until())

    if threading.current_thread() is not threading.main_thread():
        yield interrupted
        return

    def note(_: int, __: FrameType | None) -> None:
        pressed.set()

    before = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield interrupted
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
