"""The process that plays a study's surfaces on a device, told over a pipe by `session_device`.

It is a process of its own so that nothing the study does can hold up what is played. It plays with
the safety of `instruments.session.play.real_time`; where the study's program dies, the pipe breaks
and the output ramps to zero; where this process dies, the device's own watchdog stops it.

Orders in: ("verify",), ("prepare", surface), ("present", surface, seed, name), ("stop",). Answers:
("verified", verification), ("prepared",), ("playing", since), ("ended", failure, exploration),
("failed", sentence); after "playing" comes one of the last two. A stop while nothing plays has no
answer.
"""

from __future__ import annotations

import contextlib
import dataclasses
import math
import signal
import time
from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.core.formats.traces import Table, csv_text
from squeezefilm.core.results import stamp
from squeezefilm.instruments.bench.play import device_stream
from squeezefilm.instruments.bench.resonance_sweep import sweep_resonance
from squeezefilm.instruments.bench.setup import HowToPlay, PlaySetup, play_setup
from squeezefilm.instruments.device.host import DeviceHost
from squeezefilm.instruments.device.ports import SerialDrive, require_safe_drive
from squeezefilm.instruments.device.wire.frames import State
from squeezefilm.instruments.device.wire.link import Link
from squeezefilm.instruments.device.wire.streams import open_stream
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.play.plan import Ending, KnownDevice, PlayView
from squeezefilm.instruments.session.play.real_time import PlayOutcome, run_play
from squeezefilm.instruments.session.record.trace import Trace, read_trace
from squeezefilm.instruments.twin.hand import EXPLORING
from squeezefilm.instruments.twin.settings import PickupModel, TwinSettings
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ
from squeezefilm.physics.texture_files.texture_file import TextureFile
from squeezefilm.study.conduct.study_device import DeviceVerification, TrialMotion
from squeezefilm.study.record.exploration import PATH_PERIOD, explored_table

LONGEST_PRESENTATION: si.Second = 600.0
"""A surface that nobody answers plays no longer; the trial then comes again."""
VERIFICATION_SHARE: si.Dimensionless = 0.25
"""Share of the display's voltage at which its resonance is swept."""
_SPAN = 4.0
"""The carrier is swept over so many bandwidths to either side of the prediction."""
_POINTS = 41
_SETTLE = 10.0
"""Time constants waited at each carrier: e⁻¹⁰ of the change is left."""
_PATH = ("time_s", "x_m", "y_m", "speed_m_per_s", "amplitude_m", "relative_friction")


Surface = Stimulus | TextureFile
"""Something to play: a study's stimulus, or any texture with what it is called."""


TWIN = TwinSettings(sensor=LVDT_10_KHZ, pickup=PickupModel(kind="sensing_patch"))
"""A twin, all assumed. Its pickup hears the amplitude itself: no plate is to be solved for it."""


@dataclass(frozen=True)
class WorkerOrders:
    """Orders to the process: what plays, and on what, as `study.conduct.playback.play` says.

    `target` is the display; raw records go to the folder `traces`. The pickup of a twin (`TWIN`)
    needs no `amplitude_per_pickup`: it is known.
    """

    target: str | Path
    drive: str
    traces: Path
    _: KW_ONLY
    amplitude_per_pickup: si.MetrePerVolt | None = None
    stroke: str = EXPLORING
    rate: si.Hertz = 5e3


def serve(connection: Connection, orders: WorkerOrders) -> None:
    """Take orders until the pipe breaks."""
    # Ctrl-C goes to the whole group. While something plays it stops that; else it is not for us.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with contextlib.suppress(EOFError, OSError), Bench(connection, orders) as bench:
        while True:
            order = connection.recv()
            if order[0] == "stop":
                continue
            try:
                connection.send(bench.done(order))
            except SqueezefilmError as error:
                connection.send(("failed", str(error)))


class Bench:
    """The display, its drive, and a twin's process while one is needed."""

    def __init__(self, connection: Connection, orders: WorkerOrders) -> None:
        self._connection, self._orders = connection, orders
        self._twin = contextlib.ExitStack()
        self._finger: str | None = None
        self._stream = ""

    def __enter__(self) -> Bench:
        return self

    def __exit__(self, *_: object) -> None:
        self._twin.close()

    def done(self, order: tuple[Any, ...]) -> tuple[Any, ...]:
        """Carry out an order; returns the answer. Raises `SqueezefilmError` where it cannot."""
        if order[0] == "verify":
            return ("verified", self.verification())
        if order[0] == "prepare":
            self._setup(surface_of(order[1]))
            self._streaming(self._orders.stroke)
            return ("prepared",)
        return ("ended", *self.presentation(*order[1:]))

    def verification(self) -> DeviceVerification:
        """The carrier swept over the resonance at a quarter of the display's voltage, with no
        finger (a twin's lifts it); the amplitude is judged where the pickup is calibrated. A device
        without a pickup is not measurable."""
        display = self._display
        mode = predict(display).mode
        volts = VERIFICATION_SHARE * display.drive.voltage
        twin = self._orders.drive == "twin"
        limits = display.limits(mode.resonance_frequency, volts, twin=twin)
        half = _SPAN * mode.resonance_frequency / (2 * mode.quality_factor)
        carriers = np.linspace(
            max(limits.lowest_frequency, mode.resonance_frequency - half),
            min(limits.highest_frequency, mode.resonance_frequency + half),
            _POINTS,
        )
        settle = _SETTLE * mode.quality_factor / (math.pi * mode.resonance_frequency)
        with contextlib.closing(open_stream(self._streaming("none"))) as stream:
            host = DeviceHost(Link(stream))
            require_safe_drive(SerialDrive(host, 1 / self._orders.rate), limits, "study")
            swept = sweep_resonance(host, limits, carriers, volts, settle=settle)
        if swept is None:
            return DeviceVerification(
                measurable=False, remark="the device has no pickup: nothing was verified"
            )
        frequency, signal_at_peak = swept.peak
        per_volt = self._amplitude_per_pickup
        said = f"swept at {volts:.3g} V and read at the device's pickup, no finger"
        if per_volt is None:
            said += "; the pickup is not calibrated, so its amplitude was not judged"
        if swept.touched:
            said += "; the plate was touched meanwhile, so it says nothing: do it again"
            frequency = signal_at_peak = math.nan
        return DeviceVerification(
            amplitude=math.nan if per_volt is None else per_volt * signal_at_peak,
            expected_amplitude=math.nan if per_volt is None else mode.amplitude_per_volt * volts,
            resonance_frequency=frequency,
            expected_resonance_frequency=mode.resonance_frequency,
            remark=said,
        )

    def presentation(self, given: Surface, seed: int, name: str) -> tuple[str, TrialMotion]:
        """Play until an order comes; returns what failed (empty: nothing) and the exploration."""
        orders, surface = self._orders, surface_of(given)
        setup = self._setup(surface)
        began = math.nan

        def show(view: PlayView) -> None:
            nonlocal began
            if math.isnan(began) and view.state is State.PLAYING:
                began = time.monotonic()
                # A pipe that broke ends the session by `until`, which is safe.
                with contextlib.suppress(OSError):
                    self._connection.send(("playing", began))

        metadata = {
            **stamp((setup.display, given, orders.rate), seed),
            "display": setup.display.name,
            "drive": orders.drive.partition(":")[0],
            "stimulus": surface.title,
            **({"surface_sha256": given.surface_sha256} if isinstance(given, Stimulus) else {}),
            "assumed_limits": list(setup.assumed_limits),
        }
        outcome = run_play(
            setup.plan,
            self._streaming(orders.stroke),
            orders.traces / name,
            metadata,
            duration=LONGEST_PRESENTATION,
            show=show,
            until=self._connection.poll,
            use="study",
        )
        trace = read_trace(outcome.trace)
        felt = dataclasses.replace(
            explored(trace, name),
            began=began,
            ended=outcome.silent,
            unusable="" if outcome.usability is None else outcome.usability.sentence,
        )
        return _failure(outcome, trace), felt

    @property
    def _amplitude_per_pickup(self) -> si.MetrePerVolt | None:
        twin = self._orders.drive == "twin"
        return 1 / TWIN.pickup.sensitivity if twin else self._orders.amplitude_per_pickup

    @cached_property
    def _display(self) -> Display:
        return load_display(self._orders.target)

    def _setup(self, surface: TextureFile) -> PlaySetup:
        twin = self._orders.drive == "twin"
        device = KnownDevice(LVDT_10_KHZ, self._amplitude_per_pickup, twin=twin)
        return play_setup(self._display, surface, device, HowToPlay(rate=self._orders.rate))

    def _streaming(self, finger: str) -> str:
        """The drive's stream; a twin with that finger is started unless it is there."""
        orders = self._orders
        if not self._stream or (orders.drive == "twin" and self._finger != finger):
            self._twin.close()
            stream = device_stream(orders.drive, orders.target, TWIN, finger, None)
            self._stream = self._twin.enter_context(stream)
            self._finger = finger
        return self._stream


def surface_of(given: Surface) -> TextureFile:
    """The texture that is played, and what it is called."""
    if isinstance(given, TextureFile):
        return given
    return TextureFile(given.surface(), given.name)


def explored(trace: Trace, name: str) -> TrialMotion:
    """Motion of the finger, from a session's record; `name` is that of its file.

    Path and speed are those of the time in which it touched. No force is known.
    """
    table = _path(trace)
    samples = len(table.column("time_s"))
    length = speed = math.nan
    touched = 0.0
    if samples > 1:
        exploration = explored_table(table)
        speed, touched = exploration.mean_speed, exploration.touched
        length = exploration.path_length if touched else math.nan
    return TrialMotion(
        path_length=length,
        mean_speed=speed,
        trace=csv_text(table) if samples else "",
        raw_trace=name,
        touch=_share_touched(trace, touched),
    )


def _share_touched(trace: Trace, touched: si.Second) -> si.Dimensionless:
    times = trace.rows[:, column.TIME]
    whole = float(times[-1] - times[0]) if times.size > 1 else 0.0
    return min(touched / whole, 1.0) if whole else math.nan


def _path(trace: Trace) -> Table:
    rows: si.FloatArray = trace.rows
    flags = rows[:, column.FLAGS].astype(np.int64)
    there = (flags & (column.NOT_TOUCHING | column.NO_FRESH_SAMPLE)) == 0
    there &= np.isfinite(rows[:, column.X]) & np.isfinite(rows[:, column.Y])
    rows = rows[there]
    number = np.floor(rows[:, column.TIME] / PATH_PERIOD)
    first = np.r_[True, np.diff(number) > 0][: len(rows)]
    columns = {name: rows[first, trace.columns.index(name)] for name in _PATH}
    about = {key: value for key, value in trace.metadata.items() if key != "columns"}
    return Table(columns, about)


def _failure(outcome: PlayOutcome, trace: Trace) -> str:
    if outcome.ending is Ending.DURATION:
        return f"nobody answered for {LONGEST_PRESENTATION:g} s, and the device was stopped"
    if outcome.failed:
        return f"{outcome.ending.value}: {outcome.message}"
    for event in trace.events:
        if event.kind == "end" and not event.fields["device_at_zero"]:
            return "the device did not say that its output went to zero"
    return ""
