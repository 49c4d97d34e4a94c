"""The process that plays a study's surfaces, without a process, a device or a plate."""

from __future__ import annotations

import contextlib
import dataclasses
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.instruments.device.wire.frames import State
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.play.plan import Ending
from squeezefilm.instruments.session.play.real_time import PlayOutcome
from squeezefilm.instruments.session.record.trace import Damage, Trace, TraceEvent
from squeezefilm.physics.display import load_display
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.physics.texture_files.texture_file import TextureFile
from squeezefilm.study.conduct import playing_process
from squeezefilm.study.conduct.playing_process import (
    LONGEST_PRESENTATION,
    PATH_PERIOD,
    TWIN,
    Bench,
    WorkerOrders,
    explored,
    serve,
)

DISPLAY = load_display("biet2008-plate")
GRATING = Stimulus("4 mm", 4e-3, "period")
NAME = f"{'0f' * 16}.sqft"


def record(events: tuple[TraceEvent, ...] = ()) -> Trace:
    """A second along x at 50 mm/s, every millisecond."""
    time = np.arange(0.0, 1.0, 1e-3)
    rows = np.full((time.size, len(column.COLUMNS)), math.nan)
    rows[:, column.TIME], rows[:, column.X], rows[:, column.Y] = time, 0.05 * time, 0.0
    rows[:, column.FLAGS] = 0
    about = {"display": "plate", "columns": list(column.COLUMNS)}
    return Trace(column.COLUMNS, rows, events, about, Damage(0, 0, True, ()))


class Pipe:
    """The process's end: orders come, answers go."""

    def __init__(self, *orders: Any) -> None:
        self.orders, self.sent = list(orders), list[tuple[Any, ...]]()

    def recv(self) -> Any:
        """The next order; the pipe breaks after the last."""
        if not self.orders:
            raise EOFError
        return self.orders.pop(0)

    def send(self, answer: tuple[Any, ...]) -> None:
        """Keep it."""
        self.sent.append(answer)

    def poll(self) -> bool:
        """Whether an order waits."""
        return bool(self.orders)


class Around:
    """All that the process uses, made up; what it was asked for is kept."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
        self.folder = folder
        self.loaded: list[str] = []
        self.streams: list[tuple[Any, ...]] = []
        self.ended: list[str] = []
        self.setups: list[tuple[tuple[Any, ...], dict[str, Any]]] = []
        self.plays: list[tuple[tuple[Any, ...], dict[str, Any]]] = []
        self.swept: Any = None
        self.sweeps: list[tuple[Any, ...]] = []
        self.safe: list[tuple[Any, bool]] = []
        self.views: list[State] = [State.PLAYING]
        self.ending, self.message = Ending.INTERRUPTED, ""
        self.trace = record()
        mode = SimpleNamespace(
            resonance_frequency=30e3, quality_factor=150.0, amplitude_per_volt=1e-7
        )
        put: dict[str, Callable[..., Any]] = {
            "load_display": lambda name: (self.loaded.append(name), DISPLAY)[1],
            "device_stream": self._stream,
            "play_setup": self._setup,
            "run_play": self._play,
            "read_trace": lambda _: self.trace,
            "predict": lambda _: SimpleNamespace(mode=mode),
            "open_stream": lambda name: contextlib.nullcontext(name),
            "Link": lambda stream: stream,
            "DeviceHost": lambda link: link,
            "SerialDrive": lambda host, tick: (host, tick),
            "require_safe_drive": lambda drive, limits, use: self.safe.append((drive, use)),
            "sweep_resonance": self._sweep,
        }
        for name, made in put.items():
            monkeypatch.setattr(playing_process, name, made)
        monkeypatch.setattr(playing_process.contextlib, "closing", lambda stream: stream)

    @contextlib.contextmanager
    def _stream(self, *how: Any) -> Iterator[str]:
        self.streams.append(how)
        name = f"stream {len(self.streams)}"
        yield name
        self.ended.append(name)

    def _setup(self, display: Any, surface: Any, device: Any, how: Any) -> Any:
        self.setups.append(((display, surface), {"rate": how.rate, **vars(device)}))
        return SimpleNamespace(plan="the plan", display=DISPLAY, assumed_limits=("slew",))

    def _play(self, *how: Any, **more: Any) -> PlayOutcome:
        self.plays.append((how, more))
        for state in self.views:
            more["show"](SimpleNamespace(state=state))
        return PlayOutcome(self.ending, self.message, how[2], 1000, 12.5)

    def _sweep(self, *how: Any, **more: Any) -> Any:
        self.sweeps.append((how, more))
        return self.swept

    def orders(
        self, drive: str = "serial:/dev/ttyACM0", pickup: float | None = 2e-6
    ) -> WorkerOrders:
        """Of a display by name, to a folder."""
        how: dict[str, Any] = {"stroke": "a stroke", "rate": 4e3}
        return WorkerOrders(
            "biet2008-plate", drive, self.folder, amplitude_per_pickup=pickup, **how
        )


@pytest.fixture
def around(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Around:
    """Everything well."""
    return Around(monkeypatch, tmp_path)


def test_orders_are_answered_until_the_pipe_breaks(
    around: Around, monkeypatch: pytest.MonkeyPatch
) -> None:
    ignored: list[tuple[Any, Any]] = []
    monkeypatch.setattr(
        playing_process.signal, "signal", lambda what, how: ignored.append((what, how))
    )
    around.swept = SimpleNamespace(peak=(29e3, 0.1), touched=False)
    pipe = Pipe(("stop",), ("verify",), ("stop",), ("present", GRATING, 5, NAME), ("verify",))
    serve(pipe, around.orders())  # type: ignore[arg-type]
    # A stop while nothing plays has no answer.
    assert [one[0] for one in pipe.sent] == ["verified", "playing", "ended", "verified"]
    assert pipe.sent[2][1] == ""
    assert pipe.sent[2][2].raw_trace == NAME
    signals = playing_process.signal
    assert ignored == [(signals.SIGINT, signals.SIG_IGN)]
    # The display is read once, the port opened once, and closed in the end.
    assert around.loaded == ["biet2008-plate"]
    assert len(around.streams) == len(around.ended) == 1


def test_what_cannot_be_done_is_a_sentence_and_the_next_order_is_taken(
    around: Around, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(playing_process.signal, "signal", lambda *_: None)

    def refused(*_: Any, **__: Any) -> None:
        raise DeviceError("nobody is there")

    monkeypatch.setattr(playing_process, "sweep_resonance", refused)
    pipe = Pipe(("verify",), ("present", GRATING, 5, NAME))
    serve(pipe, around.orders())  # type: ignore[arg-type]
    assert pipe.sent[0] == ("failed", "nobody is there")
    assert [one[0] for one in pipe.sent[1:]] == ["playing", "ended"]


def test_a_surface_is_played_until_an_order_comes(around: Around) -> None:
    pipe = Pipe()
    # Shown often; told once, as soon as it plays.
    around.views = [State.ARMED, State.PLAYING, State.PLAYING]
    with Bench(pipe, around.orders()) as bench:  # type: ignore[arg-type]
        kind, failure, found = bench.done(("present", GRATING, 5, NAME))
    assert (kind, failure) == ("ended", "")
    ((word, since),) = pipe.sent
    assert word == "playing"
    # From the onset that was told to the silence that the session knew of.
    assert (found.began, found.ended) == (since, 12.5)
    known = dataclasses.replace(found, began=math.nan, ended=math.nan)
    assert repr(known) == repr(explored(record(), NAME))
    ((plan, stream, path, metadata), how) = around.plays[0]
    assert (plan, stream, path) == ("the plan", "stream 1", around.folder / NAME)
    assert how["use"] == "study"
    assert how["duration"] == LONGEST_PRESENTATION == 600.0
    assert how["until"] == pipe.poll
    assert (metadata["display"], metadata["drive"]) == ("biet2008-plate", "serial")
    assert (metadata["stimulus"], metadata["assumed_limits"]) == ("4 mm", ["slew"])
    assert metadata["seed"] == 5
    # Neither the port nor a person is in a record.
    assert "ttyACM0" not in str(metadata)
    ((display, texture), settings) = around.setups[0]
    assert display is DISPLAY
    assert texture.texture == GRATING.surface()
    assert (settings["rate"], settings["amplitude_per_pickup"]) == (4e3, 2e-6)
    assert settings["twin"] is False
    assert around.streams == [("serial:/dev/ttyACM0", "biet2008-plate", TWIN, "a stroke", None)]


def test_what_is_prepared_needs_no_solving_when_it_is_played(around: Around) -> None:
    texture = TextureFile(GRATING.surface(), "a grating")
    with Bench(Pipe(), around.orders("twin")) as bench:  # type: ignore[arg-type]
        assert bench.done(("prepare", texture)) == ("prepared",)
        assert [one[0][1] for one in around.setups] == [texture]
        assert len(around.streams) == 1
        bench.done(("present", texture, 0, NAME))
    # The twin that was started for it is the one that plays; the record says what by its title.
    assert len(around.streams) == 1
    assert around.plays[0][0][3]["stimulus"] == "a grating"


def test_what_never_played_is_not_said_to(around: Around) -> None:
    pipe = Pipe()
    around.views = [State.ARMED]
    with Bench(pipe, around.orders()) as bench:  # type: ignore[arg-type]
        bench.done(("present", GRATING, 5, NAME))
    assert pipe.sent == []


def test_a_pipe_that_broke_does_not_end_what_plays_here(around: Around) -> None:
    class Broken(Pipe):
        def send(self, answer: tuple[Any, ...]) -> None:
            raise BrokenPipeError

    with Bench(Broken(), around.orders()) as bench:  # type: ignore[arg-type]
        assert bench.done(("present", GRATING, 5, NAME))[:2] == ("ended", "")


@pytest.mark.parametrize(
    ("ending", "message", "at_zero", "says"),
    [
        (Ending.INTERRUPTED, "", True, ""),
        (Ending.INTERRUPTED, "", False, "did not say that its output went to zero"),
        (Ending.DURATION, "", True, "nobody answered for 600 s, and the device was stopped"),
        (Ending.FAULT, "too hot", True, "the device faulted: too hot"),
        (Ending.LINK, "no answer", False, "the link to the device broke: no answer"),
    ],
)
def test_what_failed_is_told(
    around: Around, ending: Ending, message: str, at_zero: bool, says: str
) -> None:
    around.ending, around.message = ending, message
    around.trace = record(
        (TraceEvent("begin", {}, 0), TraceEvent("end", {"device_at_zero": at_zero}, 1000))
    )
    with Bench(Pipe(), around.orders()) as bench:  # type: ignore[arg-type]
        failure, found = bench.presentation(GRATING, 5, NAME)
    assert says in failure
    assert bool(failure) is bool(says)
    # How the finger went is known all the same.
    assert found.path_length == pytest.approx(0.05, rel=0.02)


def test_a_twin_has_a_finger_for_each_work_and_a_port_has_none(around: Around) -> None:
    around.swept = SimpleNamespace(peak=(29e3, 0.1), touched=False)
    with Bench(Pipe(), around.orders("twin")) as bench:  # type: ignore[arg-type]
        for order in (("verify",), ("verify",), ("present", GRATING, 5, NAME), ("verify",)):
            bench.done(order)
        # To verify it is lifted; a twin with another finger is another twin.
        assert [how[3] for how in around.streams] == ["none", "a stroke", "none"]
        assert around.ended == ["stream 1", "stream 2"]
        assert around.setups[0][1]["twin"] is True
        assert TWIN.pickup.kind == "sensing_patch"
        per_pickup = around.setups[0][1]["amplitude_per_pickup"]
        assert per_pickup == pytest.approx(1 / TWIN.pickup.sensitivity)
    assert around.ended[-1] == "stream 3"
    around.streams.clear()
    with Bench(Pipe(), around.orders()) as bench:  # type: ignore[arg-type]
        bench.done(("verify",))
        bench.done(("present", GRATING, 5, NAME))
    assert len(around.streams) == 1


def test_the_carrier_is_swept_about_the_prediction_at_a_quarter_of_the_voltage(
    around: Around,
) -> None:
    around.swept = SimpleNamespace(peak=(29.9e3, 0.5), touched=False)
    with Bench(Pipe(), around.orders()) as bench:  # type: ignore[arg-type]
        found = bench.verification()
    ((_, limits, carriers, volts), how) = around.sweeps[0]
    assert volts == pytest.approx(0.25 * DISPLAY.drive.voltage)
    # Four bandwidths of 200 Hz, half to either side, within what the drive may do.
    assert carriers.size == 41
    assert carriers[0] == pytest.approx(max(limits.lowest_frequency, 29.6e3))
    assert carriers[-1] == pytest.approx(min(limits.highest_frequency, 30.4e3))
    # Ten time constants of Q/(π f).
    assert how["settle"] == pytest.approx(10 * 150 / (math.pi * 30e3))
    assert around.safe == [(("stream 1", 1 / 4e3), "study")]
    assert found.resonance_frequency == 29.9e3
    assert found.expected_resonance_frequency == 30e3
    assert found.amplitude == pytest.approx(2e-6 * 0.5)
    assert found.expected_amplitude == pytest.approx(1e-7 * volts)
    assert found.measurable
    assert found.remark == f"swept at {volts:.3g} V and read at the device's pickup, no finger"


def test_a_pickup_that_is_not_there_not_calibrated_or_touched_is_said_to_be(around: Around) -> None:
    with Bench(Pipe(), around.orders(pickup=None)) as bench:  # type: ignore[arg-type]
        around.swept = None
        found = bench.verification()
        assert not found.measurable
        assert "no pickup" in found.remark
        around.swept = SimpleNamespace(peak=(30e3, 0.5), touched=False)
        found = bench.verification()
        assert math.isnan(found.amplitude)
        assert math.isnan(found.expected_amplitude)
        assert found.passed
        assert "not calibrated, so its amplitude was not judged" in found.remark
        around.swept = SimpleNamespace(peak=(30e3, 0.5), touched=True)
        found = bench.verification()
        assert math.isnan(found.resonance_frequency)
        assert not found.passed
        assert "was touched meanwhile" in found.remark
    with Bench(Pipe(), around.orders()) as bench:  # type: ignore[arg-type]
        assert math.isnan(bench.verification().amplitude)


def test_a_path_has_one_sample_in_each_period_and_leaves_out_what_is_not_known() -> None:
    trace = record()
    found = explored(trace, NAME)
    times = [float(line.split(",")[0]) for line in found.trace.splitlines()[2:]]
    assert PATH_PERIOD == 10e-3
    # To a tick: a tenth of a millionth may round a row into the next period.
    assert times == pytest.approx(np.arange(100) * 10e-3, abs=1.1e-3)
    # A tenth of a second without a fresh sample, another without a place.
    trace.rows[200:300, column.FLAGS] = column.NO_FRESH_SAMPLE
    trace.rows[500:600, column.Y] = math.nan
    less = explored(trace, NAME)
    times = [float(line.split(",")[0]) for line in less.trace.splitlines()[2:]]
    assert len(times) == 80
    assert less.mean_speed == pytest.approx(0.05, rel=1e-6)
    # Steps over what is left out count neither as way nor as time.
    assert less.path_length == pytest.approx(0.05 * 0.77, rel=0.01)


def test_what_is_not_a_display_is_refused_when_it_is_first_needed(
    around: Around, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(_: str) -> None:
        raise InputError("there is no such display")

    monkeypatch.setattr(playing_process, "load_display", refused)
    with (
        Bench(Pipe(), around.orders()) as bench,  # type: ignore[arg-type]
        pytest.raises(InputError, match="no such display"),
    ):
        bench.verification()
