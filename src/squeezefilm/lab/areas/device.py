"""The messages of the Device area: what there is to drive, check, play, stop."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field

from squeezefilm.core import presets
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import write_whole
from squeezefilm.lab import own_process as device_process
from squeezefilm.lab.designing.form import name_of
from squeezefilm.lab.designing.program import require_playable, title_of
from squeezefilm.lab.files import existing
from squeezefilm.lab.own_process import DeviceSession
from squeezefilm.lab.wire import LONGEST_TEXT, Answer, Request

if TYPE_CHECKING:
    from pathlib import Path

    from squeezefilm.lab.server import Lab


DEVICE = "device"
"""The key of the Device area's session in `Lab.playing`."""


class OnDrive(Request):
    """A drive with a display's text."""

    display: str = Field(max_length=LONGEST_TEXT)
    drive: str = Field(max_length=200)


class PlayDevice(OnDrive):
    """A texture to play. `armed` says that the person armed it on the page first."""

    armed: bool
    preset: str | None = Field(None, max_length=100)
    texture: str | None = Field(None, max_length=LONGEST_TEXT)
    mode: Literal["stream", "tile"] = "stream"
    stroke: str = Field("60 mm/s over 4 cm", max_length=200)
    sensor: str = Field("device", max_length=100)
    duration: str = Field("10 s", max_length=50)
    voltage: str | None = Field(None, max_length=50)
    compensation: Literal["none", "inverse"] = "none"
    hold: bool = False
    seed: int = Field(0, ge=0, le=2**53)


class DeviceArea:
    """Answers the Device area's messages; `session` has the process that plays."""

    def __init__(self, lab: Lab) -> None:
        self._lab = lab
        self._loop: asyncio.AbstractEventLoop | None = None
        self.session = DeviceSession(self._tell)
        lab.closing.append(self.session.close)
        add = lab.experimenter.add
        add("drives", self._listing)
        add("play device", self._play, PlayDevice)
        add("check device", self._check, OnDrive)
        add("what plays", self._playing)
        add("stop everything", self._stop)

    def _told(self, message: dict[str, Any]) -> None:
        if message["type"] == "device ended" and not self.session.running:
            self._lab.playing.forget(DEVICE)
        self._lab.tell(message)

    def _tell(self, message: dict[str, Any]) -> None:
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._told, message)

    def _start(self, what: str, work: Callable[..., None], **arguments: Any) -> None:
        self._loop = asyncio.get_running_loop()
        self.session.start(work, **arguments)
        self._lab.playing.note(DEVICE, what, self.session.stop, plays=True)

    async def _listing(self) -> Answer:
        from serial.tools import list_ports

        ports = [
            {
                "drive": f"serial:{port.device}",
                "text": f"{port.device}: {port.description}",
            }
            for port in list_ports.comports()
        ]
        return {"type": "drives", "ports": ports}

    async def _play(self, asked: PlayDevice) -> Answer:
        if not asked.armed:
            raise InputError("the device is not armed; arm it on the page first")
        how = asked.model_dump(include={"mode", "stroke", "sensor", "compensation", "hold", "seed"})
        typed = (asked.display, _drive(asked.drive), asked.duration, asked.voltage, asked.stroke)
        how["duration"], how["voltage"] = await self._lab.quick.do(None, require_playable, *typed)
        name = datetime.now(UTC).strftime("%Y%m%dT%H%M%S")
        display = str(await _display(self._lab, asked.display))
        texture = str(await _texture(self._lab, asked))
        drive, out = _drive(asked.drive), str(self._lab.folder / "sessions" / name)
        # Both go to the process that plays: `files` are its paths as texts, `how` has mode, stroke,
        # sensor, compensation, hold, seed, duration (s) and voltage (V; None: the display's own).
        files = {"display": display, "texture": texture, "out": out}
        self._start(f"a texture on {drive}", device_process.play, drive=drive, **files, **how)
        return {"type": "playing", "folder": f"sessions/{name}"}

    async def _check(self, asked: OnDrive) -> Answer:
        display, drive = await _display(self._lab, asked.display), _drive(asked.drive)
        self._start(
            f"the check of {drive}", device_process.check, drive=drive, display=str(display)
        )
        return {"type": "checking"}

    async def _playing(self) -> Answer:
        return self._lab.playing.message()

    async def _stop(self) -> Answer:
        self._lab.playing.stop()
        return {"type": "stopping"}


def _drive(text: str) -> str:
    if text != "twin" and not text.startswith("serial:"):
        raise InputError(f"drive = '{text[:80]}' is not known; it may be twin or serial:PORT")
    return text


async def _display(lab: Lab, text: str) -> Path:
    await lab.quick.do(None, name_of, text)
    file = lab.folder / "sessions" / ".display.toml"
    file.parent.mkdir(exist_ok=True)
    write_whole(file, text)
    return file


async def _texture(lab: Lab, asked: PlayDevice) -> Path:
    if (asked.preset is None) == (asked.texture is None):
        raise InputError("say which texture: a preset or a text, one of them")
    if asked.preset is not None:
        if asked.preset in presets.texture_names():
            return presets.resolve(asked.preset, "texture")
        return existing(lab.folder / "textures", asked.preset, ".toml")
    folder = lab.folder / "textures"
    folder.mkdir(exist_ok=True)
    file = folder / ".played.toml"
    await lab.quick.do(None, title_of, str(asked.texture), folder)
    write_whole(file, str(asked.texture))
    return file
