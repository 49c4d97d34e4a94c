"""Body of `squeezefilm play` and `device check`: a device or its twin, a session, a judgement.

texture → loop process → link → the device's state machine → plate → friction → record → fidelity.
"""

from __future__ import annotations

import contextlib
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import KW_ONLY, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.called_with import called_with
from squeezefilm.core.config.schema import text_of
from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.core.formats.traces import table_from_csv
from squeezefilm.core.hard_limits import TABLE_BYTES
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.regular_file import read_regular_text
from squeezefilm.core.results import Result, stamp
from squeezefilm.instruments.bench.check import WATCHED, check_device
from squeezefilm.instruments.bench.conversation import Conversation
from squeezefilm.instruments.bench.played_session import PlayedSession, judge_session, tile_summary
from squeezefilm.instruments.bench.setup import HowToPlay, PlaySetup, play_setup
from squeezefilm.instruments.bench.timing_checks import DeviceCheck, check_loop, waited_time
from squeezefilm.instruments.control.gains import IdentifiedPlate, identified_plate
from squeezefilm.instruments.device.ports import ReplaySensor
from squeezefilm.instruments.device.wire.streams import open_stream
from squeezefilm.instruments.session.play.plan import KnownDevice, PlayView
from squeezefilm.instruments.session.play.real_time import PlayOutcome, run_play
from squeezefilm.instruments.session.record.trace import read_trace
from squeezefilm.instruments.twin.plant_kernel import COLUMNS
from squeezefilm.instruments.twin.pty_server import running_twin
from squeezefilm.instruments.twin.settings import PickupModel, TwinSettings
from squeezefilm.physics.chain.played_texture import FingerMotion, require_on_display
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ, SensorModel, sensor_named
from squeezefilm.physics.texture_files.texture_file import NamedTexture, TextureFile
from squeezefilm.physics.texture_files.trajectories import motion_from, read_trajectory

TRACE_NAME = "trace.sqft"
TRUTH_NAME = "truth.csv"
JUDGING = "the record"
"""The step told of after playing; until then nothing of it can be shown."""
STROKE = "60 mm/s over 4 cm"
DURATION: si.Second = 4.0
_MARGIN: si.Metre = 2e-3
_LIFT: si.Second = 0.2
_STROKED: si.Second = 6.0
"""For which a person strokes a real device's sensor."""
_TRUTH_LIMIT: si.Second = 5.0


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PlayResult(Result):
    """A session: how it ended, its record judged, and the folder that keeps it (None: none)."""

    outcome: PlayOutcome
    session: PlayedSession
    folder: Path | None
    _shown: ClassVar[str] = (
        "session.setup.display.name session.setup.name outcome.ending.value outcome.usable "
        "outcome.said folder"
    )

    def summary(self) -> dict[str, Any]:
        """Mapping of plain JSON values, which summary.json holds."""
        outcome = self.outcome
        return {
            "ended_because": outcome.ending.value,
            "message": outcome.said,
            "usable": outcome.usable,
            **self.session.summary(),
        }


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class PlayRequest(HowToPlay):
    """Arguments of `play_texture`."""

    target: str | Path | Display
    texture: NamedTexture
    _: KW_ONLY
    drive: str = "twin"
    sensor: str = "device"
    stroke: str = STROKE
    duration: si.Second = DURATION
    amplitude_per_pickup: si.MetrePerVolt | None = None
    bench_only: bool = False
    sweep: str | Path | None = None
    out: str | Path | None = None
    seed: int = 0
    show: Callable[[PlayView], None] | None = None
    tap: Callable[[si.FloatArray], None] | None = None
    progress: SayProgress | None = None


@reads_text
@called_with(PlayRequest)
def play_texture(asked: PlayRequest) -> PlayResult:
    """Play a texture on a device or on a twin of the display, in real time, and judge the record.

    Args:
        target: the display, or its preset's name or file.
        texture: what is to be felt.
        drive: "twin", or a device's stream such as "serial:/dev/ttyACM0".
        sensor: "device" for the device's own, "replay:FILE" for a recorded motion, or a sensor's
            name: what the device's own is (or the twin's is to be) like.
        mode: "stream": the host's loop renders; "tile": the device does, by itself.
        stroke: the twin's finger, as `motion_from` reads it, again and again.
        duration: for which to play (s).
        rate: of the loop (Hz).
        voltage: the most to use (V).
        surface: of the display.
        compensation: of the resonator's slowness, "none" or "inverse".
        amplitude_per_pickup: of a device's pickup (m/V); a twin's is known.
        bench_only: whether a drive that does not stop by itself may be used.
        hold: whether the device's loops shall hold resonance and amplitude; one that has none
            plays without, and the outcome says so.
        sweep: a CSV of what its free plate's pickup shows, for `hold`: frequency_Hz, drive_V,
            pickup_in_phase_V, pickup_ahead_V; without, the plate is held as predicted.
        out: where the record (trace.sqft) and a twin's truth (truth.csv) go; thrown away without.
        seed: of the twin's noise.
        show: is told what there is to see.
        tap: is given the rows as they are recorded; must be quick.
        progress: is told each step.

    Raises:
        InputError: what cannot be played, or not safely.
        DeviceError, LoopError, RecordError: what failed before anything was played.
    """
    tell = asked.progress or (lambda _: None)
    texture = TextureFile.of(asked.texture)
    si.require("duration", asked.duration, si.Unit("s"), above=0.0, at_most=86_400.0)
    display = asked.target
    if not isinstance(display, Display):
        display = load_display(display)
    eyes, pickup = _eyes(asked.sensor), PickupModel(kind="sensing_patch")
    settings = TwinSettings(seed=asked.seed, sensor=eyes, pickup=pickup)
    device = KnownDevice(eyes, asked.amplitude_per_pickup)
    if asked.drive == "twin":
        device = KnownDevice(eyes, 1 / pickup.sensitivity, _way(display, asked.stroke), twin=True)
    if asked.sweep is not None:
        if not asked.hold:
            raise InputError("a sweep is for loops that hold the plate; add hold", quantity="sweep")
        device = replace(device, identified=_identified(asked.sweep))
    kept = None if asked.out is None else Path(asked.out)
    if kept is not None and (kept / TRACE_NAME).exists():
        raise InputError(
            f"{kept / TRACE_NAME} exists; a record is never written over: give another folder"
        )
    tell("the display at its largest amplitude")
    setup = play_setup(display, texture, device, asked)
    with folder_for_records(kept) as folder:
        truth = folder / TRUTH_NAME if device.twin else None
        outcome = _played(asked, setup, settings, folder / TRACE_NAME, truth)
        tell(JUDGING)
        judged = judge_session(setup, read_trace(outcome.trace), truth)
    return PlayResult(outcome, judged, kept)


def _identified(sweep: str | Path) -> tuple[IdentifiedPlate, si.Volt]:
    """The plate by a sweep's file, and the noise of each quadrature of its pickup (V)."""
    table = table_from_csv(Path(sweep))
    names = ("drive_V", "pickup_in_phase_V", "pickup_ahead_V")
    drive, in_phase, ahead = (table.column(name) for name in names)
    response = np.asarray((in_phase + 1j * ahead) / drive, dtype=np.complex128)
    plate, noise = identified_plate(table.column("frequency_Hz"), response)
    return plate, noise * float(np.sqrt(np.mean(drive**2)))


def _way(display: Display, stroke: str) -> tuple[si.Metre, si.Metre]:
    """Ends of the way of a twin's finger (m); it must stay on the display."""
    finger = FingerMotion.of(motion_from(stroke), 1e3)
    require_on_display(display.actuator, finger)
    # The arm swings a little beyond where it turns.
    return float(np.min(finger.x)) - _MARGIN, float(np.max(finger.x)) + _MARGIN


def _played(
    asked: PlayRequest, setup: PlaySetup, settings: TwinSettings, trace: Path, truth: Path | None
) -> PlayOutcome:
    """Play on the drive and record it; a twin's process, with its `truth`, lives as long."""
    tell = asked.progress or (lambda _: None)
    config = (setup.display, setup.texture, asked.stroke, asked.mode, asked.rate)
    metadata = {
        **stamp((*config, asked.compensation, asked.sensor), asked.seed),
        "texture": setup.name,
        "display": setup.display.name,
        "drive": asked.drive,
        "sensor": asked.sensor,
        "stroke": None if truth is None else asked.stroke,
        "mode": asked.mode,
        "tile": tile_summary(setup.plan),
        "assumed_limits": list(setup.assumed_limits),
    }
    if truth is not None:
        tell("the twin, a process of its own")
    with device_stream(asked.drive, asked.target, settings, asked.stroke, truth) as stream:
        tell("playing; Ctrl-C stops safely")
        return run_play(
            setup.plan,
            stream,
            trace,
            metadata,
            duration=asked.duration,
            sensor=_replay(asked.sensor),
            show=asked.show,
            tap=asked.tap,
            use="bench" if asked.bench_only else "own hand",
        )


def check_drive(
    drive: str,
    target: str | Path,
    *,
    rate: si.Hertz = 5e3,
    sensor: str = "device",
    progress: SayProgress | None = None,
) -> DeviceCheck:
    """Check a device, or a twin of a display, and this computer's loop at a rate (Hz).

    `sensor` is what its own is like (or the twin's is to be), as of `play_texture`. A twin's hand
    lifts its finger between strokes, and its truth says where that is.

    Raises:
        InputError: a drive, display or sensor that cannot be used.
        DeviceError: a device that does not answer.
    """
    tell = progress or (lambda _: None)
    display = load_display(target)
    tell("the display's resonance")
    prediction = predict(display)
    frequency = prediction.frequency
    limits = display.limits(frequency, twin=drive == "twin")
    eyes, twin = LVDT_10_KHZ if sensor == "device" else sensor_named(sensor), drive == "twin"
    settings = TwinSettings(sensor=eyes)
    with (
        tempfile.TemporaryDirectory() as folder,
        device_stream(
            drive, target, settings, STROKE, Path(folder) / TRUTH_NAME, strict=True, lift=_LIFT
        ) as name,
        contextlib.closing(open_stream(name)) as stream,
    ):
        here = twin or Path(drive.removeprefix("serial:")).resolve().is_relative_to("/dev/pts")
        return check_device(
            Conversation(stream, time.monotonic, time.sleep, waited_time if here else None),
            frequency,
            drive=drive,
            window=(limits.lowest_frequency, limits.highest_frequency),
            sensor=eyes,
            watch=WATCHED if twin else _STROKED,
            truth=partial(_true_place, Path(folder) / TRUTH_NAME) if twin else None,
            loop=lambda: check_loop(rate),
            progress=tell,
        )


def _true_place(file: Path, when: si.SecondArray) -> si.MetreArray:
    """Places of the finger (m) at times of a running twin (s), by the truth that it writes in
    blocks of seconds; waits for them to be written."""
    end = time.monotonic() + _TRUTH_LIMIT
    while True:
        text = read_regular_text(file, TABLE_BYTES, "the twin's truth")
        lines = text[: text.rfind("\n")].splitlines()[1:]
        rows = np.array([line.split(",") for line in lines], dtype=float, ndmin=2)
        late = time.monotonic() > end
        if late and not lines:
            raise DeviceError("the twin did not write where its finger was; check it again")
        if lines and (late or rows[-1, 0] >= when.max()):
            place: si.MetreArray = np.interp(when, rows[:, 0], rows[:, COLUMNS.index("x_m")])
            return place
        time.sleep(0.1)


@contextlib.contextmanager
def device_stream(
    drive: str,
    target: str | Path | Display,
    settings: TwinSettings,
    stroke: str,
    truth: Path | None,
    *,
    strict: bool = False,
    lift: si.Second = 0.0,
) -> Iterator[str]:
    """The stream of a drive as `open_stream` reads it; a twin's process lives as long.

    `strict`: a twin's watchdog counts all time, as a real device's does. `lift`: for how long its
    finger is in the air between strokes (s).

    Raises `InputError` for a drive that is none, and for a twin that does not start.
    """
    if drive != "twin":
        if not drive.startswith("serial:"):
            raise InputError(
                f"the drive '{drive}' is not known; write twin, or serial:PORT like "
                "serial:/dev/ttyACM0"
            )
        yield drive
        return
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "twin.toml"
        file.write_text(text_of(settings), encoding="utf-8")
        if isinstance(target, Display):
            described = Path(folder) / f"{target.name}.toml"
            described.write_text(text_of(target), encoding="utf-8")
            target = described
        with running_twin(
            target, file, stroke=stroke, truth=truth, strict=strict, lift=lift
        ) as port:
            yield f"serial:{port}"


def _eyes(sensor: str) -> SensorModel:
    if sensor == "device" or sensor.startswith("replay:"):
        return LVDT_10_KHZ
    return sensor_named(sensor)


def _replay(sensor: str) -> Callable[[Callable[[], si.Second]], ReplaySensor] | None:
    """Make the sensor that plays a recorded motion by the loop's clock."""
    if not sensor.startswith("replay:"):
        return None
    path = read_trajectory(sensor.removeprefix("replay:"))
    return lambda clock: ReplaySensor(path.place, path.duration, clock)


@contextlib.contextmanager
def folder_for_records(out: Path | None) -> Iterator[Path]:
    """The folder `out`, made if it is not there; without one a temporary one.

    Raises `InputError` for one that cannot be made.
    """
    if out is not None:
        try:
            out.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"cannot make the folder {out}: {error.strerror}; give another"
            ) from error
        yield out
        return
    with tempfile.TemporaryDirectory() as folder:
        yield Path(folder)
