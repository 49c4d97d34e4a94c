"""A surface that another program starts and stops: PsychoPy's script, or any of one's own.

A handle that never waits for what plays: that goes on in a process of its own, with the safety and
the record of a study's session. `instruments.bench.play.play_texture` is for one session of a given
length that is judged afterwards.
"""

from __future__ import annotations

import contextlib
import time
from dataclasses import KW_ONLY, dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Annotated, Literal, Self

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import ReadBy, reads_text
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.instruments.bench.markers import Markers, markers_if
from squeezefilm.instruments.bench.play import folder_for_records
from squeezefilm.instruments.twin.hand import EXPLORING
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.physics.render.texture.composition import Composable
from squeezefilm.physics.texture_files.texture_file import TextureFile, load_texture
from squeezefilm.study.conduct.played_device import SessionDevice
from squeezefilm.study.conduct.playing_process import Surface, WorkerOrders, surface_of
from squeezefilm.study.conduct.study_device import TrialMotion

PlaybackState = Literal["ready", "playing", "failed", "closed"]
Playable = Annotated[Stimulus | TextureFile | Composable, ReadBy(load_texture)]
"""A surface: a study's stimulus, a texture, or in its place a preset's name or a file's path."""


@dataclass(frozen=True, slots=True)
class Played:
    """A surface that was played.

    Attributes:
        surface: what it is called.
        started, ended: when the device said that it plays, and that its output is at zero (s,
            `time.monotonic`).
        started_utc, ended_utc: the same moments on this computer's wall clock.
        exploration: how the finger went; NaN where the device does not know.
        record: every tick of it, for `read_trace`; None unless a folder was given.
    """

    surface: str
    started: si.Second
    ended: si.Second
    started_utc: str
    ended_utc: str
    exploration: TrialMotion
    record: Path | None


class Playback:
    """A display that plays one surface at a time; `play` makes it. A context manager.

    For one thread. Where the program that has it ends, the output ramps to zero all the same.
    """

    def __init__(
        self,
        device: SessionDevice,
        surface: Surface,
        *,
        keep: Path | None,
        folder: contextlib.ExitStack,
        markers: Markers | None = None,
    ) -> None:
        self._device, self._surface = device, surface
        self._keep, self._folder, self._markers = keep, folder, markers
        self._state: PlaybackState = "ready"
        self._failure = ""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"Playback({self._name!r}, state={self.state!r})"

    @property
    def state(self) -> PlaybackState:
        """ "ready", "playing", "failed" (`failure` says why, and `start` begins anew) or "closed";
        asked of the process that plays, without waiting."""
        if self._state == "playing" and self._device.over:
            self._end()
        return self._state

    @property
    def failure(self) -> str:
        """Reason why the device or its process failed; empty where nothing did."""
        return self._failure if self.state == "failed" else ""

    @property
    def started(self) -> si.Second:
        """Time at which the device said that it plays what was started last (s, `time.monotonic`);
        NaN before. On the twin the output rises 11 to 14 ms later."""
        return self._device.began

    @reads_text
    def start(self, surface: Playable | None = None) -> si.Second:
        """Play, and return when the device says that it plays: `started`, after about a second.

        Args:
            surface: another one than before, from now on.

        Raises:
            InputError: a surface that plays already, that the display cannot play, or a handle
                that was closed.
            DeviceError: a device that is not there, refuses, or failed before it played.
        """
        if self._state == "closed":
            raise InputError("this handle was closed; make another with play")
        if self.state == "playing":
            raise InputError(f"'{self._name}' is being played; stop it first")
        if surface is not None:
            self._surface = named(surface)
        self._failure = ""
        self._state = "failed"
        try:
            self._device.present(self._surface, 0)
        except DeviceError as error:
            self._failure = str(error)
            raise
        self._state = "playing"
        self.mark(f"start {self._name}", self._device.began)
        return self._device.began

    def stop(self) -> Played:
        """Ramp to zero within 30 ms, disarm, close the record.

        Raises:
            InputError: nothing was started.
            DeviceError: the device, its link or its process failed since `start`: what was felt is
                not known.
        """
        if self._state in ("ready", "closed"):
            raise InputError("nothing plays; start it first")
        felt = self._end() if self._state == "playing" else TrialMotion()
        if self._state == "failed":
            raise DeviceError(f"'{self._name}' was not played to the end: {self._failure}")
        record = None if self._keep is None else self._keep / felt.raw_trace
        started, ended = felt.began, felt.ended
        return Played(self._name, started, ended, utc_of(started), utc_of(ended), felt, record)

    def mark(self, text: str, at: si.Second | None = None) -> None:
        """Send a marker of one's own, such as an answer, to the lab streaming layer.

        `at` is its moment (s, `time.monotonic`), now without one. Nothing without markers.
        """
        if self._markers is not None:
            self._markers.push(text, at)

    def close(self) -> None:
        """Stop what plays and end the process; more than once is allowed."""
        if self._state == "playing":
            self._end()
        self._device.close()
        self._state = "closed"
        self._folder.close()

    @property
    def _name(self) -> str:
        return surface_of(self._surface).title

    def _end(self) -> TrialMotion:
        self._failure, felt = self._device.ended()
        self._state = "failed" if self._failure else "ready"
        word = "failed" if self._failure else "stop"
        self.mark(f"{word} {self._name}", None if felt.ended != felt.ended else felt.ended)
        return felt


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class PlayingOptions:
    """Options of `play`."""

    display: str | Path
    surface: Playable
    _: KW_ONLY
    drive: str = "twin"
    amplitude_per_pickup: si.MetrePerVolt | None = None
    stroke: str = EXPLORING
    rate: si.Hertz = 5e3
    out: str | Path | None = None
    lsl: bool | str = False


@reads_text
@called_with(PlayingOptions)
def play(asked: PlayingOptions) -> Playback:
    """A handle on a surface that is started and stopped while a program goes on.

    Returns when all is solved, compiled and ready, a minute the first time; what plays does so in a
    process of its own.

    Args:
        display: a preset's name or a file.
        surface: what is to be felt first; `Playback.start` takes others.
        drive: "twin" (a simulated device behind a port, in real time) or "serial:PORT".
        amplitude_per_pickup: of the device's pickup (m/V), if it was calibrated.
        stroke: of a twin's finger, as `motion_from` reads it, to and fro for ever.
        rate: of the loop (Hz).
        out: where the records of what was played are kept; thrown away without.
        lsl: whether markers go to the lab streaming layer, or the name of their stream.

    Raises:
        InputError: a display, surface or drive that cannot be played or used; markers without
            pylsl.
        DeviceError: what failed before anything was played.
    """
    surface = named(asked.surface)
    markers = markers_if(asked.lsl)
    keep = None if asked.out is None else Path(asked.out)
    with contextlib.ExitStack() as folder:
        records = folder.enter_context(folder_for_records(keep))
        orders = WorkerOrders(
            asked.display,
            asked.drive,
            records,
            amplitude_per_pickup=asked.amplitude_per_pickup,
            stroke=asked.stroke,
            rate=asked.rate,
        )
        device = SessionDevice(orders)
        device.prepare(surface)
        return Playback(device, surface, keep=keep, folder=folder.pop_all(), markers=markers)


def named(surface: Playable) -> Surface:
    """A surface with what it is called, in records and markers."""
    if isinstance(surface, Stimulus):
        return surface
    texture = TextureFile.of(surface)
    return texture if texture.title else TextureFile(texture.texture, texture.texture.quantity)


def utc_of(moment: si.Second) -> str:
    """The wall clock (UTC, milliseconds) at a moment of `time.monotonic` (s); empty for NaN."""
    if moment != moment:
        return ""
    ago = timedelta(seconds=time.monotonic() - moment)
    return (datetime.now(UTC) - ago).isoformat(timespec="milliseconds")
