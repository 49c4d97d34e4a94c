"""What `play_texture` asks of those that play and judge, all replaced."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.instruments.bench import play as module
from squeezefilm.instruments.bench.play import JUDGING, PlayResult, device_stream, play_texture
from squeezefilm.instruments.bench.setup import HowToPlay
from squeezefilm.instruments.session.play.plan import Ending
from squeezefilm.instruments.session.play.real_time import PlayOutcome
from squeezefilm.instruments.twin.settings import TwinSettings
from squeezefilm.physics.display import load_display
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ, TOUCH_PANEL_240_HZ
from squeezefilm.physics.render.program.renderer import MadeForSpeed

DISPLAY, TEXTURE = "biet2008-plate", "biet2008-square-4mm"


PLAN = SimpleNamespace(tile=SimpleNamespace(made_for=MadeForSpeed(0.08, -0.1, 0.05)))


class Bench:
    """Notes what each part was asked."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.setup: list[dict[str, Any]] = []
        self.streams: list[tuple[Any, ...]] = []
        self.runs: list[tuple[tuple[Any, ...], dict[str, Any]]] = []
        self.judged: list[tuple[Any, ...]] = []
        self.open = False
        for name in ("play_setup", "device_stream", "run_play", "judge_session"):
            monkeypatch.setattr(module, name, getattr(self, f"_{name}"))
        monkeypatch.setattr(module, "read_trace", lambda path: ("read", path))

    def _play_setup(self, display: Any, texture: Any, device: Any, how: Any) -> Any:
        chosen = {field.name: getattr(how, field.name) for field in dataclasses.fields(HowToPlay)}
        self.setup.append({"display": display.name, **chosen, **vars(device)})
        return SimpleNamespace(
            display=display, texture=texture, plan=PLAN, name="a grating",
            assumed_limits=("slew",),
        )  # fmt: skip

    @contextlib.contextmanager
    def _device_stream(self, *given: Any) -> Iterator[str]:
        self.streams.append(given)
        self.open = True
        yield "serial:there"
        self.open = False

    def _run_play(self, *given: Any, **how: Any) -> Any:
        assert self.open
        self.runs.append((given, how))
        return SimpleNamespace(trace=given[2])

    def _judge_session(self, *given: Any) -> str:
        # The device is let go before the record is judged.
        assert not self.open
        self.judged.append(given)
        return "judged"


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Bench:
    return Bench(monkeypatch)


def test_a_twin_is_played_over_the_way_of_its_finger(bench: Bench, tmp_path: Path) -> None:
    steps: list[str] = []
    found = play_texture(
        DISPLAY, TEXTURE, out=tmp_path / "a" / "b", seed=7, stroke="60 mm/s over 4 cm",
        progress=steps.append,
    )  # fmt: skip
    folder = tmp_path / "a" / "b"
    (how,) = bench.setup
    assert how["display"] == DISPLAY
    assert how["twin"] is True
    # 2 mm more than the finger's 40 mm at each end; it is followed at a kilohertz.
    assert how["way"] == (pytest.approx(-2e-3), pytest.approx(42e-3, abs=0.1e-3))
    pickup = TwinSettings().pickup
    assert how["amplitude_per_pickup"] == pytest.approx(1 / pickup.sensitivity)
    assert (how["mode"], how["compensation"], how["rate"]) == ("stream", "none", 5e3)
    ((drive, target, settings, stroke, truth),) = bench.streams
    assert (drive, target, stroke) == ("twin", DISPLAY, "60 mm/s over 4 cm")
    assert truth == folder / "truth.csv"
    assert (settings.seed, settings.sensor, settings.pickup.kind) == (
        7, LVDT_10_KHZ, "sensing_patch",
    )  # fmt: skip
    ((plan, stream, trace, metadata), said) = bench.runs[0]
    assert (plan, stream, trace) == (PLAN, "serial:there", folder / "trace.sqft")
    assert said == {
        "duration": 4.0, "sensor": None, "show": None, "tap": None, "use": "own hand",
    }  # fmt: skip
    expected = {
        "texture": "a grating", "display": DISPLAY, "drive": "twin", "sensor": "device",
        "stroke": "60 mm/s over 4 cm", "mode": "stream", "assumed_limits": ["slew"], "seed": 7,
        "tile": PLAN.tile.made_for.summary(),
    }  # fmt: skip
    assert {key: metadata[key] for key in expected} == expected
    (judged,) = bench.judged
    assert judged[1:] == (("read", trace), truth)
    assert (found.session, found.folder) == ("judged", folder)
    assert steps == [
        "the display at its largest amplitude", "the twin, a process of its own",
        "playing; Ctrl-C stops safely", JUDGING,
    ]  # fmt: skip


def test_a_device_has_its_own_finger_and_pickup(bench: Bench) -> None:
    show: Any = object()
    tap: Any = object()
    found = play_texture(
        DISPLAY, TEXTURE, drive="serial:x", amplitude_per_pickup=3e-6, voltage=9.0, rate=2e3,
        surface="s", compensation="inverse", mode="tile", duration=1.5, bench_only=True,
        show=show, tap=tap,
    )  # fmt: skip
    (how,) = bench.setup
    assert (how["way"], how["twin"], how["amplitude_per_pickup"]) == (None, False, 3e-6)
    assert (how["voltage"], how["rate"], how["surface"]) == (9.0, 2e3, "s")
    assert (how["compensation"], how["mode"]) == ("inverse", "tile")
    assert bench.streams[0][4] is None
    ((_, _, trace, metadata), said) = bench.runs[0]
    assert said == {
        "duration": 1.5, "sensor": None, "show": show, "tap": tap, "use": "bench",
    }  # fmt: skip
    assert metadata["stroke"] is None
    assert bench.judged[0][2] is None
    # Nobody asked to keep it.
    assert found.folder is None
    assert not trace.parent.exists()


def test_a_replayed_motion_is_read_at_a_kilohertz_by_the_clock(
    bench: Bench, tmp_path: Path
) -> None:
    file = tmp_path / "motion.csv"
    file.write_text("time_s,x_m,y_m\n5.0,0.001,0.002\n5.5,0.011,0.004\n")
    play_texture(DISPLAY, TEXTURE, drive="serial:x", sensor=f"replay:{file}")
    assert bench.setup[0]["sensor"] == LVDT_10_KHZ
    made = bench.runs[0][1]["sensor"]
    clock = SimpleNamespace(now=100.0)
    sensor = made(lambda: clock.now)
    seen = []
    for after in (0.0, 0.0005, 0.1, 0.25, 9.0):
        clock.now = 100.0 + after
        one = sensor.read()
        seen.append(None if one is None else (one.time - 100, one.x, one.y))
    assert seen[0] == pytest.approx((0.0, 1e-3, 2e-3))
    assert seen[1] is None
    assert seen[2] == pytest.approx((0.1, 3e-3, 2.4e-3))
    assert seen[3] == pytest.approx((0.25, 6e-3, 3e-3))
    last = seen[4]
    assert last is not None
    assert np.allclose(last, (0.499, 10.98e-3, 3.996e-3), atol=1e-6)


def test_a_named_sensor_is_what_the_finger_is_seen_with(bench: Bench) -> None:
    play_texture(DISPLAY, TEXTURE, sensor=TOUCH_PANEL_240_HZ.name)
    assert bench.setup[0]["sensor"] == TOUCH_PANEL_240_HZ
    assert bench.streams[0][2].sensor == TOUCH_PANEL_240_HZ
    assert bench.runs[0][1]["sensor"] is None


def test_a_summary_says_how_it_ended_before_what_was_judged() -> None:
    outcome = PlayOutcome(Ending.LINK, "unplugged", Path("trace"), 7)
    session: Any = SimpleNamespace(summary=lambda: {"rows": 7, "texture": "a"})
    told = PlayResult(outcome, session, None).summary()
    assert told["ended_because"] == "the link to the device broke"
    assert (told["rows"], told["texture"]) == (7, "a")
    assert "unplugged" in told.values()


def test_a_drive_that_is_none_is_refused_and_a_port_is_passed_on() -> None:
    settings = TwinSettings()
    with device_stream("serial:/dev/x", DISPLAY, settings, "s", None) as stream:
        assert stream == "serial:/dev/x"
    with (
        pytest.raises(InputError, match="the drive 'usb' is not known"),
        device_stream("usb", DISPLAY, settings, "s", None),
    ):
        pass


def test_a_sweep_of_the_pickup_is_what_the_loops_are_told(bench: Bench, tmp_path: Path) -> None:
    """A plate of Q 120 at 29.9 kHz, swept at 2 V, with 1 % of noise."""
    f = np.linspace(29.4e3, 30.4e3, 60)
    random = np.random.default_rng(3)
    noise = 1e-4 * (random.standard_normal(60) + 1j * random.standard_normal(60))
    pickup = 2.0 * (0.005 * np.exp(0.7j) / (1 + 1j * (f - 29.9e3) / (29.9e3 / 240))) + noise
    rows = np.stack([f, np.full(60, 2.0), pickup.real, pickup.imag], axis=1)
    file = tmp_path / "sweep.csv"
    names = "frequency_Hz,drive_V,pickup_in_phase_V,pickup_ahead_V"
    np.savetxt(file, rows, delimiter=",", header=names, comments="")
    play_texture(DISPLAY, TEXTURE, hold=True, sweep=file)
    plate, volts = bench.setup[-1]["identified"]
    assert plate.frequency == pytest.approx(29.9e3, abs=2.0)
    assert plate.quality_factor == pytest.approx(120.0, rel=0.02)
    assert plate.ratio == pytest.approx(0.005, rel=0.02)
    assert plate.phase == pytest.approx(0.7, abs=0.02)
    assert volts == pytest.approx(1e-4, rel=0.2)
    play_texture(DISPLAY, TEXTURE, hold=True)
    assert bench.setup[-1]["identified"] is None
    with pytest.raises(InputError, match="a sweep is for loops"):
        play_texture(DISPLAY, TEXTURE, sweep=file)


def test_a_twins_process_gets_its_settings_by_file(monkeypatch: pytest.MonkeyPatch) -> None:
    from squeezefilm.instruments.twin.settings import load_settings

    asked: list[Any] = []

    @contextlib.contextmanager
    def twin(target: Any, file: Path, **how: Any) -> Iterator[str]:
        asked.append((target, load_settings(file).seed, how))
        yield "/dev/pts/7"

    monkeypatch.setattr(module, "running_twin", twin)
    for strict in (False, True):
        settings = TwinSettings(seed=11)
        with device_stream("twin", DISPLAY, settings, "s", None, strict=strict) as stream:
            assert stream == "serial:/dev/pts/7"
        told = (DISPLAY, 11, {"stroke": "s", "truth": None, "strict": strict, "lift": 0.0})
        assert asked[-1] == told


def test_a_twin_gets_the_display_under_another_finger(monkeypatch: pytest.MonkeyPatch) -> None:
    described = load_display(DISPLAY)
    finger = dataclasses.replace(described.finger, contact_decay_length=3e-6)
    mine = dataclasses.replace(described, finger=finger)

    @contextlib.contextmanager
    def twin(target: Path, _file: Path, **_: Any) -> Iterator[str]:
        assert load_display(target) == mine
        yield "/dev/pts/7"

    monkeypatch.setattr(module, "running_twin", twin)
    with device_stream("twin", mine, TwinSettings(), "s", None) as stream:
        assert stream == "serial:/dev/pts/7"


def test_a_folder_that_cannot_be_made_is_said(bench: Bench, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot make the folder"):
        play_texture(DISPLAY, TEXTURE, out=tmp_path / "file" / "inside")
    assert bench.runs == []


def test_a_twin_that_wrote_no_truth_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_TRUTH_LIMIT", 0.0)
    (tmp_path / "truth.csv").write_text("time_s,x_m\n0.0")
    with pytest.raises(DeviceError, match="did not write where its finger was"):
        module._true_place(tmp_path / "truth.csv", np.array([0.1]))


def test_a_twins_truth_is_waited_for_until_it_reaches_the_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "truth.csv"
    columns = module.COLUMNS
    head = ",".join(columns) + "\n"

    def row(time: float) -> str:
        cells = dict.fromkeys(columns, "0") | {columns[0]: f"{time}", "x_m": f"{0.01 * time}"}
        return ",".join(cells[name] for name in columns) + "\n"

    clock, slept = 0.0, 0

    def sleep(_: float) -> None:
        nonlocal slept
        slept += 1
        # What is written last is half a line.
        more = "".join(row(time) for time in np.arange(slept + 1.0))
        file.write_text(head + more + "9,9")

    file.write_text(head)
    monkeypatch.setattr(module.time, "sleep", sleep)
    monkeypatch.setattr(module.time, "monotonic", lambda: clock)
    place = module._true_place(file, np.array([0.5, 2.25]))
    assert place == pytest.approx([5e-3, 22.5e-3])
    assert slept == 3
    # One that comes to an end before is told as far as it goes; one that never begins is no truth.
    monkeypatch.setattr(module.time, "sleep", lambda _: None)
    times = iter([0.0, module._TRUTH_LIMIT + 1.0])
    monkeypatch.setattr(module.time, "monotonic", lambda: next(times))
    assert module._true_place(file, np.array([1.0, 77.0])) == pytest.approx([0.01, 0.03])
    file.write_text(head)
    times = iter([0.0, module._TRUTH_LIMIT + 1.0])
    with pytest.raises(DeviceError, match="did not write where its finger was"):
        module._true_place(file, np.array([1.0]))


@pytest.mark.parametrize(
    ("drive", "sensor", "excused"),
    [
        ("twin", "device", True),
        ("serial:/dev/ttyACM0", "device", False),
        ("serial:/dev/pts/99", TOUCH_PANEL_240_HZ.name, True),
    ],
)
def test_a_check_knows_the_drives_limits_eyes_and_whether_it_waits_here(
    drive: str, sensor: str, excused: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []
    twin = drive == "twin"

    @contextlib.contextmanager
    def streamed(*given: Any, **how: Any) -> Iterator[str]:
        asked.append((given, how))
        yield "serial:there"

    monkeypatch.setattr(module, "device_stream", streamed)
    stream = SimpleNamespace(close=lambda: asked.append("closed"))
    monkeypatch.setattr(module, "open_stream", lambda name: stream)
    monkeypatch.setattr(module, "predict", lambda _: SimpleNamespace(frequency=33e3))
    monkeypatch.setattr(module, "Conversation", lambda *given: given)
    monkeypatch.setattr(module, "check_loop", lambda rate: ("the loop at", rate))
    monkeypatch.setattr(module, "check_device", lambda *given, **how: (given, how))
    told: list[str] = []
    found: Any = module.check_drive(drive, DISPLAY, rate=4e3, sensor=sensor, progress=told.append)
    (conversation, frequency), how = found
    assert frequency == 33e3
    assert conversation[0] is stream
    assert conversation[3] is (module.waited_time if excused else None)
    (given, more), closed = asked
    assert closed == "closed"
    assert given[:2] == (drive, DISPLAY)
    eyes = LVDT_10_KHZ if sensor == "device" else TOUCH_PANEL_240_HZ
    assert given[2] == TwinSettings(sensor=eyes)
    assert more["strict"] is True
    assert how["sensor"] == eyes
    limits = load_display(DISPLAY).limits(33e3, twin=twin)
    assert how["window"] == (limits.lowest_frequency, limits.highest_frequency)
    assert (how["truth"] is not None) is twin
    assert how["watch"] == (module.WATCHED if twin else module._STROKED)
    assert how["loop"]() == ("the loop at", 4e3)
    assert told == ["the display's resonance"]
