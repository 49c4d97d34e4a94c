"""The devices that sittings use: one sitting at a time on each, every call on a thread of its own.

A device takes seconds to be measured and a second to begin a surface. Neither the server's loop nor
the thread on which the studies live waits for it.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.conduct.study_device import (
    DeviceIdentity,
    DeviceVerification,
    NoDevice,
    StudyDevice,
    TrialMotion,
)

if TYPE_CHECKING:
    from squeezefilm.lab.connections import NowPlaying
    from squeezefilm.study.conduct.playing_process import WorkerOrders

T = TypeVar("T")


@dataclass(frozen=True)
class MeasuredDevice(StudyDevice):
    """A device that was identified and verified already; it plays nothing."""

    who: DeviceIdentity
    verification: DeviceVerification

    def identity(self) -> DeviceIdentity:
        """Identity of the device."""
        return self.who

    def verify_device(self) -> DeviceVerification:
        """Verification that was measured just now."""
        return self.verification


@dataclass
class _HeldDevice:
    """A device in the hands of a sitting: what it presents, and what was felt of it so far."""

    sitting: str
    kind: str
    device: StudyDevice
    thread: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(1, "device"))
    token: str = ""
    playing: int | None = None
    felt: dict[int, TrialMotion] = field(default_factory=dict)
    halted: bool = False

    def forget(self) -> None:
        """Forget what was felt of a trial: it comes again."""
        self.token, self.playing, self.felt, self.halted = "", None, {}, False


class StudyDevices:
    """Devices by the sittings that use them. Its methods are called on the server's loop.

    `playing`, where there is one, is kept up to date on which of them play.
    """

    def __init__(self, make: Callable[[WorkerOrders], StudyDevice] | None = None) -> None:
        self.playing: NowPlaying | None = None
        self._make = make or _session_device
        self._held: dict[str, _HeldDevice] = {}
        self._busy: dict[str, asyncio.Lock] = {}

    async def measure(self, sitting: str, orders: WorkerOrders) -> StudyDevice:
        """The device of a sitting, identified and verified; takes seconds.

        Raises:
            InputError: a device that another sitting uses.
            DeviceError: one that is not there, refuses or faults.
        """
        if orders.drive == "none":
            return NoDevice()
        async with self._turn(sitting):
            held = self._taken(sitting, orders)
            await self._silence(held)
            held.forget()
            verification = await self._on(held, held.device.verify_device)
            return MeasuredDevice(await self._on(held, held.device.identity), verification)

    async def present(
        self,
        sitting: str,
        orders: WorkerOrders,
        surface: tuple[Stimulus, int],
        token: str,
        place: int,
    ) -> None:
        """Play surface number `place` of a trial; returns when it plays.

        Raises:
            InputError: a device that another sitting uses, a surface it cannot play, or the
                surfaces of a trial out of their order.
            DeviceError: a device that failed, now or with the surface before; the trial begins
                again with its first surface.
        """
        async with self._turn(sitting):
            held = self._taken(sitting, orders)
            if place == 0:
                await self._silence(held)
                held.forget()
                held.token = token
            elif held.token != token or held.halted:
                raise InputError("the surface before was not presented; begin the trial again")
            else:
                await self._felt(held)
            if place != len(held.felt):
                raise InputError(f"surface {len(held.felt) + 1} comes next, not {place + 1}")
            self._shown(held, plays=True)
            try:
                await self._on(held, held.device.present, *surface)
            except BaseException:
                held.forget()
                self._shown(held, plays=False)
                raise
            held.playing = place

    async def felt(self, sitting: str, token: str) -> tuple[TrialMotion, ...]:
        """Silence the device and say how the trial's surfaces were explored.

        Asked again before `answered` it says the same again.

        Raises:
            DeviceError: a surface that failed, was stopped, or that this lab did not present: the
                trial has no answer, and comes again.
        """
        held = self._held.get(sitting)
        if held is None or held.token != token or held.halted:
            if held is not None:
                async with self._turn(sitting):
                    await self._silence(held)
                    held.forget()
            raise DeviceError(
                "this surface was stopped or interrupted before the answer; nothing was "
                "recorded, and the trial comes again"
            )
        async with self._turn(sitting):
            await self._felt(held)
            return tuple(held.felt[place] for place in sorted(held.felt))

    def answered(self, sitting: str, token: str) -> None:
        """Forget what was felt of a trial: its answer is on the disk."""
        held = self._held.get(sitting)
        if held is not None and held.token == token:
            held.forget()

    def halt(self, sitting: str) -> None:
        """Silence a sitting's device at once; its trial comes again. Never waits."""
        if (held := self._held.get(sitting)) is not None:
            held.halted = True
            held.device.halt()
            self._shown(held, plays=False)

    async def release(self, sitting: str) -> None:
        """Let a sitting's device go; nothing where it has none."""
        if (held := self._held.get(sitting)) is not None:
            held.device.halt()
            async with self._turn(sitting):
                await self._on(held, held.device.close)
                self._held.pop(sitting, None)
                held.thread.shutdown(wait=False)
            if self.playing is not None:
                self.playing.forget(sitting)

    def holders(self) -> list[str]:
        """The sittings that have a device."""
        return list(self._held)

    def close(self) -> None:
        """Silence and let go of every device."""
        for held in self._held.values():
            held.device.halt()
        for held in self._held.values():
            held.thread.submit(held.device.close)
            held.thread.shutdown(wait=True)
        self._held.clear()

    def _turn(self, sitting: str) -> asyncio.Lock:
        return self._busy.setdefault(sitting, asyncio.Lock())

    def _taken(self, sitting: str, orders: WorkerOrders) -> _HeldDevice:
        for other, held in self._held.items():
            if other != sitting and held.kind == orders.drive:
                raise InputError(
                    f"the device '{held.kind}' is in use by another sitting; end that one first"
                )
        if sitting not in self._held:
            self._held[sitting] = _HeldDevice(sitting, orders.drive, self._make(orders))
            self._shown(self._held[sitting], plays=False)
        return self._held[sitting]

    def _shown(self, held: _HeldDevice, *, plays: bool) -> None:
        """Let every page's stop bar know."""
        if self.playing is not None:
            what = f"a participant's surface on {held.kind}"
            self.playing.note(held.sitting, what, partial(self.halt, held.sitting), plays=plays)

    async def _felt(self, held: _HeldDevice) -> None:
        """Stop what plays and keep how it was explored; what failed ends the trial."""
        if held.playing is None:
            return
        place, held.playing = held.playing, None
        try:
            held.felt[place] = await self._on(held, held.device.stop)
        except BaseException:
            held.forget()
            raise
        finally:
            self._shown(held, plays=False)

    async def _silence(self, held: _HeldDevice) -> None:
        """Stop what plays, whatever it says: the trial comes again anyway."""
        held.playing = None
        # A device that failed has let go by itself; a new presentation begins anew.
        with contextlib.suppress(DeviceError):
            await self._on(held, held.device.stop)
        self._shown(held, plays=False)

    async def _on(self, held: _HeldDevice, work: Callable[..., T], *arguments: Any) -> T:
        done = asyncio.get_running_loop().run_in_executor(held.thread, work, *arguments)
        try:
            return await asyncio.shield(done)
        except asyncio.CancelledError:
            # The page went away while the device was at work: silence is next in its turn.
            held.halted = True
            held.thread.submit(held.device.stop)
            raise


def _session_device(orders: WorkerOrders) -> StudyDevice:
    from squeezefilm.study.conduct.played_device import SessionDevice

    return SessionDevice(orders)
