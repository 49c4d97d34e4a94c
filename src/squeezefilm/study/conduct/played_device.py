"""A study's device that is a real session: a display on a port, or its twin behind one.

Everything goes through the loop, the link and the device's own state machine, as in `squeezefilm
play`, with a record of every tick; the drive must stop by itself. What fails on the way is told by
`stop`: the trial has then no answer, and comes again.
"""

from __future__ import annotations

import contextlib
import math
import multiprocessing
import secrets
import sys
import threading
import types
from collections.abc import Iterator
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, Self

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.core.interrupts import interrupts_held
from squeezefilm.core.results import config_hash
from squeezefilm.physics.display import Display, load_display
from squeezefilm.study.conduct.playing_process import TWIN, Surface, WorkerOrders, serve
from squeezefilm.study.conduct.study_device import (
    DeviceIdentity,
    DeviceVerification,
    StudyDevice,
    TrialMotion,
)

START_LIMIT: si.Second = 300.0
"""A first start solves the plate and compiles, which may take a minute on a busy computer."""
STOP_LIMIT: si.Second = 20.0


def require_study_drive(drive: str, target: str | Path) -> Display:
    """The display of a target, where a study may drive it by a drive. Raises `InputError` for what
    no study may be driven by, and as `Display.require_insulation`; `ConfigError` as `load_display`.
    """
    if drive != "twin" and not (drive.startswith("serial:") and drive[7:].strip()):
        raise InputError(
            f"drive = '{drive[:80]}' is not known; it may be none, twin, or "
            "serial:PORT like serial:/dev/ttyACM0. A drive that does not stop by itself, such as a "
            "sound card, is not allowed in a study",
            quantity="drive",
        )
    display = load_display(target)
    display.require_insulation(twin=drive == "twin")
    return display


class SessionDevice(StudyDevice):
    """A device that plays each surface in a session of its own. Close it in the end.

    One thread at a time, except `halt`, which any thread may call at any moment.

    Attributes:
        presenting: whether a surface was presented and not stopped yet.
        began: when the device said that it plays what was presented (s, `time.monotonic`); NaN
            before.

    Raises:
        InputError, ConfigError: as `require_study_drive`.
    """

    def __init__(self, orders: WorkerOrders) -> None:
        # Now, and not when the first surface is to be felt.
        self._display = require_study_drive(orders.drive, orders.target)
        self._orders = orders
        self._process: Any = None
        self._connection: Connection | None = None
        self._speaking = threading.Lock()
        self.presenting, self.began = False, math.nan

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def over(self) -> bool:
        """True where what was presented ended by itself, which is a failure; `stop` tells which."""
        connection = self._connection
        return self.presenting and (connection is None or connection.poll(0.0))

    def identity(self) -> DeviceIdentity:
        """ "twin" or "serial", the display's hash, and that of the pickup's calibration (of the
        twin's settings); no port, which is this computer's business."""
        orders = self._orders
        calibration = ""
        if orders.drive == "twin":
            calibration = config_hash(TWIN)
        elif orders.amplitude_per_pickup is not None:
            calibration = config_hash({"amplitude_per_pickup": orders.amplitude_per_pickup})
        kind = orders.drive.partition(":")[0]
        return DeviceIdentity(kind, config_hash(self._display), calibration)

    def verify_device(self) -> DeviceVerification:
        """Sweep the carrier over the resonance at a quarter of the display's voltage, without a
        finger, read at the device's pickup; one without a pickup is not measurable.

        Takes seconds. A twin is measured without its hand, in a process of its own.

        Raises:
            DeviceError: a device that is not there, refuses or faults, or a finger that stays.
        """
        self._require_silence()
        verification: DeviceVerification = self._asked(("verify",), "verified")[1]
        return verification

    def prepare(self, surface: Surface) -> None:
        """Solve, compile and start what a surface needs, so that `present` need not.

        Raises what `present` raises.
        """
        self._require_silence()
        self._asked(("prepare", surface), "prepared")

    def present(self, stimulus: Surface, seed: int) -> None:
        """Play a surface; returns when it plays, so that a response time runs from its onset.

        Raises:
            InputError: a surface that the display cannot play.
            DeviceError: a device that is not there, refuses, or was halted before it played.
        """
        self._require_silence()
        order = ("present", stimulus, seed, f"{secrets.token_hex(16)}.sqft")
        answer = self._asked(order, "playing")
        if answer[0] == "ended":
            why = answer[1] or "it was stopped before it played"
            raise DeviceError(f"the surface could not be presented: {why}. It comes again")
        self.presenting, self.began = True, float(answer[1])

    def stop(self) -> TrialMotion:
        """Ramp to zero, disarm, close the record; returns how the finger explored.

        Raises:
            DeviceError: the device, its link or its loop failed since `present`: what was felt
                is not known, so the trial must not be answered.
        """
        failure, found = self.ended()
        if failure:
            raise DeviceError(
                f"the device failed while the surface was presented: {failure.rstrip('.')}. This "
                "trial was not answered and comes again; look at the device, then go on"
            )
        return found

    def ended(self) -> tuple[str, TrialMotion]:
        """Stop as `stop` does, and return a failure: what failed (empty: nothing) and the
        exploration, of which nothing is known where the process that plays failed."""
        if not self.presenting:
            return "", TrialMotion()
        self.presenting = False
        self.halt()
        try:
            answer = self._heard(STOP_LIMIT)
        except DeviceError as error:
            answer = ("failed", str(error))
        if answer[1]:
            # The next surface begins with a new process, and a new twin.
            self.close()
        return answer[1], answer[2] if answer[0] == "ended" else TrialMotion()

    def halt(self) -> None:
        """Let the output ramp to zero now; returns at once, from any thread.

        `stop` is still to be called. Nothing where nothing plays.
        """
        with self._speaking:
            connection = self._connection
            if connection is not None:
                try:
                    connection.send(("stop",))
                except OSError:
                    # The process is gone, and its device stops by its watchdog; `stop` tells it.
                    return

    def close(self) -> None:
        """Stop what plays and end the process; more than once is allowed."""
        with self._speaking:
            process, connection = self._process, self._connection
            self._process = self._connection = None
        self.presenting = False
        if connection is not None:
            # The broken pipe ends what plays, safely.
            connection.close()
        if process is not None:
            process.join(STOP_LIMIT)
            if process.is_alive():
                process.kill()
                process.join()

    def _require_silence(self) -> None:
        if self.presenting:
            raise InputError("a surface is being presented; stop it first")

    def _asked(self, order: tuple[Any, ...], expected: str) -> tuple[Any, ...]:
        """The answer to an order: the expected one, or "ended"; what failed is raised."""
        connection = self._running()
        try:
            with self._speaking:
                connection.send(order)
            answer = self._heard(START_LIMIT)
        except (DeviceError, OSError) as error:
            self.close()
            if isinstance(error, DeviceError):
                raise
            raise DeviceError(f"the process that plays is gone ({error}); try again") from error
        if answer[0] == "failed":
            self.close()
            raise DeviceError(str(answer[1]))
        assert answer[0] in (expected, "ended"), answer[0]
        return answer

    def _heard(self, limit: si.Second) -> tuple[Any, ...]:
        connection = self._connection
        if connection is None:
            raise DeviceError("the process that plays was closed; present the surface again")
        try:
            if not connection.poll(limit):
                raise DeviceError(
                    f"the process that plays said nothing for {limit:g} s and is ended; the "
                    "device stops by its own watchdog"
                )
            message: tuple[Any, ...] = connection.recv()
        except (EOFError, OSError) as error:
            raise DeviceError(
                "the process that plays ended without a word; the device stops by its own watchdog"
            ) from error
        return message

    def _running(self) -> Connection:
        if self._connection is None or not self._process.is_alive():
            self.close()
            context = multiprocessing.get_context("spawn")
            ours, theirs = context.Pipe()
            process = context.Process(target=serve, args=(theirs, self._orders), daemon=True)
            with _without_main(), interrupts_held():
                process.start()
            theirs.close()
            with self._speaking:
                self._process, self._connection = process, ours
        assert self._connection is not None
        return self._connection


@contextlib.contextmanager
def _without_main() -> Iterator[None]:
    """A process started within does not run the user's script again, which may open windows and
    has no `if __name__ == "__main__"` where another program wrote it."""
    main = sys.modules["__main__"]
    sys.modules["__main__"] = types.ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = main
