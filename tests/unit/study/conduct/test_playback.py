"""The handle by which another program starts and stops a surface: states, moments, faults."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import squeezefilm as sf
from squeezefilm.core.errors import ConfigError, DeviceError, InputError
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.physics.texture_files.texture_file import TextureFile, load_texture
from squeezefilm.study.conduct import playback
from squeezefilm.study.conduct.playback import Playback, named, play, utc_of
from squeezefilm.study.conduct.playing_process import WorkerOrders
from squeezefilm.study.conduct.study_device import TrialMotion

GRATING = Stimulus("4 mm", 4e-3, "period")


class Device:
    """A device that plays nothing: what it is asked for is kept, what it does is set."""

    def __init__(self, orders: WorkerOrders) -> None:
        self.orders = orders
        self.did: list[Any] = []
        self.over, self.failure, self.began = False, "", float("nan")
        self.refusal: Exception | None = None

    def prepare(self, surface: Any) -> None:
        """Keep it."""
        if self.refusal is not None:
            raise self.refusal
        self.did.append(("prepare", surface))

    def present(self, surface: Any, seed: int) -> None:
        """From now on it plays."""
        if self.refusal is not None:
            raise self.refusal
        self.did.append(surface)
        self.over, self.began = False, time.monotonic()

    def ended(self) -> tuple[str, TrialMotion]:
        """As set."""
        if self.failure:
            return self.failure, TrialMotion()
        return "", TrialMotion(
            0.1, 0.08, raw_trace="a.sqft", began=self.began, ended=self.began + 1
        )

    def close(self) -> None:
        """Keep it."""
        self.did.append("close")


class Told:
    """Markers that are kept."""

    def __init__(self) -> None:
        self.said: list[tuple[str, float | None]] = []

    def push(self, text: str, at: float | None = None) -> None:
        """Keep it."""
        self.said.append((text, at))


Handle = Callable[..., tuple[Playback, Device]]


@pytest.fixture
def handle(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Handle:
    """A handle on a device that plays nothing."""

    def made(surface: Any = GRATING, **more: Any) -> tuple[Playback, Device]:
        devices: list[Device] = []

        def device(orders: WorkerOrders) -> Device:
            devices.append(Device(orders))
            return devices[-1]

        monkeypatch.setattr(playback, "SessionDevice", device)
        found = play("biet2008-plate", surface, **{"out": tmp_path / "kept", **more})
        return found, devices[0]

    return made


def test_a_surface_is_started_stopped_and_started_with_another(
    handle: Handle, tmp_path: Path
) -> None:
    surface, device = handle(drive="serial:X", rate="4 kHz", amplitude_per_pickup=2e-6)
    assert device.orders == WorkerOrders(
        "biet2008-plate", "serial:X", tmp_path / "kept", rate=4e3, amplitude_per_pickup=2e-6
    )
    # Solved and compiled before it is handed out.
    assert device.did == [("prepare", GRATING)]
    assert surface.state == "ready"
    with pytest.raises(InputError, match="nothing plays; start it first"):
        surface.stop()
    assert surface.start() == surface.started == device.began
    assert surface.state == "playing"
    with pytest.raises(InputError, match="'4 mm' is being played; stop it first"):
        surface.start()
    played = surface.stop()
    assert (played.surface, played.started, played.ended) == (
        "4 mm",
        device.began,
        device.began + 1,
    )
    assert played.record == tmp_path / "kept" / "a.sqft"
    assert played.exploration.mean_speed == 0.08
    began, ended = map(datetime.fromisoformat, (played.started_utc, played.ended_utc))
    assert (ended - began).total_seconds() == pytest.approx(1.0, abs=0.01)
    surface.start("sine-3mm")
    assert device.did[-1] == load_texture("sine-3mm")
    surface.stop()
    # What was named last stays.
    surface.start()
    assert device.did[-1] == load_texture("sine-3mm")
    surface.close()
    surface.close()
    assert surface.state == "closed"
    with pytest.raises(InputError, match="this handle was closed"):
        surface.start()


def test_a_fault_is_a_state_and_is_raised_where_it_is_stopped(handle: Handle) -> None:
    surface, device = handle()
    surface.start()
    device.over, device.failure = True, "the amplifier tripped"
    assert surface.state == "failed"
    assert surface.failure == "the amplifier tripped"
    with pytest.raises(
        DeviceError, match="'4 mm' was not played to the end: the amplifier tripped"
    ):
        surface.stop()
    # It stays until it is started anew.
    assert surface.state == "failed"
    device.failure = ""
    surface.start()
    assert (surface.state, surface.failure) == ("playing", "")
    # A fault that nobody looked for is raised all the same.
    device.failure = "the link broke"
    with pytest.raises(DeviceError, match="the link broke"):
        surface.stop()


def test_what_does_not_start_is_raised_and_is_a_state(handle: Handle) -> None:
    surface, device = handle()
    device.refusal = DeviceError("the port is not there")
    with pytest.raises(DeviceError, match="the port is not there"):
        surface.start()
    assert (surface.state, surface.failure) == ("failed", "the port is not there")
    device.refusal = InputError("the display cannot play it")
    with pytest.raises(InputError):
        surface.start()
    device.refusal = None
    surface.start()
    assert surface.state == "playing"


def test_markers_have_the_moments_that_are_returned(
    handle: Handle, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = Told()
    monkeypatch.setattr(playback, "markers_if", lambda asked: told if asked == "touch" else None)
    surface, device = handle(lsl="touch")
    with surface:
        began = surface.start()
        surface.mark("answer left", 12.5)
        played = surface.stop()
        surface.start()
        device.failure = "gone"
    assert told.said == [
        ("start 4 mm", began),
        ("answer left", 12.5),
        ("stop 4 mm", played.ended),
        ("start 4 mm", device.began),
        ("failed 4 mm", None),
    ]
    assert device.did[-1] == "close"


def test_without_a_folder_records_are_thrown_away(handle: Handle, tmp_path: Path) -> None:
    surface, device = handle(out=None)
    folder = device.orders.traces
    assert folder.is_dir()
    surface.start()
    assert surface.stop().record is None
    surface.close()
    assert not folder.exists()


def test_what_cannot_be_named_or_kept_is_refused_before_anything_is_solved(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="sine-3mm"):
        play("biet2008-plate", "sine-4mm")
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="cannot make the folder"):
        play("biet2008-plate", GRATING, out=tmp_path / "file" / "in")
    with pytest.raises(InputError, match="drive = 'sound' is not known"):
        play("biet2008-plate", GRATING, drive="sound")


def test_a_texture_without_a_title_is_called_by_its_quantity() -> None:
    bare = sf.RelativeFriction(sf.SquareWave("2 mm"), 0.7, 1.0)
    assert named(bare) == TextureFile(bare, "relative_friction")
    assert named(TextureFile(bare, "mine")).title == "mine"  # type: ignore[union-attr]
    assert named(GRATING) is GRATING


def test_a_moment_on_the_wall_clock() -> None:
    now = datetime.now(UTC)
    then = datetime.fromisoformat(utc_of(time.monotonic() - 60.0))
    assert (now - then).total_seconds() == pytest.approx(60.0, abs=1.0)
    assert utc_of(float("nan")) == ""


@pytest.mark.realtime
@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="there are no ptys on Windows")
def test_a_twin_is_started_and_stopped_and_its_record_has_the_same_moments(tmp_path: Path) -> None:
    for _ in range(4):
        with play("biet2008-plate", "biet2008-square-4mm", out=tmp_path) as surface:
            before = time.monotonic()
            began = surface.start()
            assert before < began <= time.monotonic()
            assert surface.state == "playing"
            time.sleep(0.5)
            asked = time.monotonic()
            try:
                played = surface.stop()
            except DeviceError as error:
                # A machine that holds a process up for 50 ms is stopped, as it must be.
                if "heard nothing for 50 ms" not in str(error):
                    raise
                continue
        break
    assert played.started == began
    assert asked < played.ended
    assert played.record is not None
    trace = sf.read_trace(played.record)
    events = {one.fields["state"]: one.fields for one in trace.events if one.kind == "device"}
    # The loop's clock has another beginning, but runs as fast.
    lasted = events["off"]["time_s"] - events["playing"]["time_s"]
    assert played.ended - played.started == pytest.approx(lasted, abs=0.05)
    friction = trace.rows[:, column.FRICTION]
    assert np.nanmin(friction) < 0.9 < np.nanmax(friction)
