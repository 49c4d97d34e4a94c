"""The whole bench on a simulated clock: texture, loop, link, device, plate, finger, record."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import numpy as np
import pytest
from tests import virtual_play as bench
from tests.virtual_play import virtual_play

from squeezefilm.instruments.bench.played_session import PlayedSession, judge_session
from squeezefilm.instruments.bench.setup import HowToPlay, PlaySetup, play_setup
from squeezefilm.instruments.control.gains import identified_plate
from squeezefilm.instruments.session.play.plan import Ending, KnownDevice
from squeezefilm.instruments.session.play.player import Player
from squeezefilm.instruments.session.play.real_time import PlayOutcome
from squeezefilm.instruments.session.record.trace import read_trace
from squeezefilm.instruments.twin.device import TwinDevice
from squeezefilm.instruments.twin.hand import hand_from
from squeezefilm.instruments.twin.settings import PickupModel, TwinSettings
from squeezefilm.instruments.twin.working_point import WorkingPoint, working_point
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ, TOUCH_PANEL_240_HZ, SensorModel
from squeezefilm.physics.texture_files.texture_file import load_texture


@pytest.fixture(scope="module")
def display() -> Display:
    return load_display("biet2008-plate")


@pytest.fixture(scope="module")
def point(display: Display) -> WorkingPoint:
    return working_point(display, TwinSettings())


def settings(sensor: SensorModel = LVDT_10_KHZ) -> TwinSettings:
    return TwinSettings(sensor=sensor, pickup=PickupModel(kind="sensing_patch"))


def prepared(display: Display, mode: str = "stream", **known: object) -> PlaySetup:
    device = KnownDevice(
        amplitude_per_pickup=1 / settings().pickup.sensitivity,
        **known,  # type: ignore[arg-type]
    )
    return play_setup(display, load_texture("biet2008-square-4mm"), device, HowToPlay(mode=mode))


def played(
    setup: PlaySetup,
    point: WorkingPoint,
    folder: Path,
    duration: float = 1.6,
    sensor: SensorModel = LVDT_10_KHZ,
) -> tuple[PlayOutcome, PlayedSession]:
    folder.mkdir(exist_ok=True)
    device = TwinDevice(
        setup.display,
        settings(sensor),
        hand=hand_from("60 mm/s over 4 cm"),
        truth_file=folder / "truth.csv",
        point=point,
    )
    outcome = virtual_play(setup.plan, device, folder / "trace.sqft", {}, duration=duration)
    device.close()
    return outcome, judge_session(setup, read_trace(outcome.trace), folder / "truth.csv")


@pytest.mark.slow
@pytest.mark.parametrize("swept", [False, True])
def test_loops_hold_what_is_played_and_the_record_says_how(
    display: Display, point: WorkingPoint, tmp_path: Path, swept: bool
) -> None:
    """A grating under a finger: the plate is searched for, locked, and stays so, with gains of the
    plate as predicted and of one that was swept, with noise."""
    known = KnownDevice(amplitude_per_pickup=1 / settings().pickup.sensitivity)
    if swept:
        free = point.identified(settings())
        f = free.frequency + free.half_bandwidth * np.linspace(-4, 4, 81)
        response = free.ratio / (1 + 1j * np.linspace(-4, 4, 81))
        disturbed = response + 0.005 * free.ratio * np.random.default_rng(1).standard_normal(81)
        known = dataclasses.replace(known, identified=identified_plate(f, disturbed))
    setup = play_setup(display, load_texture("biet2008-square-4mm"), known, HowToPlay(hold=True))
    assert setup.plan.hold is not None
    # What is played is compensated for the loops' slowness, and not for the plate's.
    envelope = setup.plan.loop.envelope
    assert envelope.rise_time_constant == envelope.fall_time_constant == 1.5e-3
    outcome, session = played(setup, point, tmp_path, 1.0)
    assert (outcome.ending, outcome.message) == (Ending.DURATION, "")
    assert session.last("loops") == {"held": True, "message": ""}
    trace = session.trace
    locked = trace.column("loops_locked") == 1.0
    assert np.mean(locked[len(locked) // 2 :]) > 0.9
    detuning = trace.column("detuning_half_bandwidths")[locked]
    amplitude = trace.column("amplitude_m")
    strong = amplitude[locked] > 0.5 * np.nanmax(amplitude)
    assert np.median(np.abs(detuning[strong])) < 0.2
    for name in ("drive_reserve_V", "finger_load_share", "plate_temperature_degC"):
        assert np.isfinite(trace.column(name)[locked]).all()
    assert np.median(trace.column("finger_load_share")[locked]) > 0.05


@pytest.mark.slow
def test_a_grating_is_felt_where_it_is(
    display: Display, point: WorkingPoint, tmp_path: Path
) -> None:
    outcome, session = played(prepared(display), point, tmp_path)
    assert outcome.ending is Ending.DURATION
    assert session.trace.damage.whole
    assert session.last("end")["device_at_zero"]
    assert session.last("link")["lost"] == 0
    assert session.last("link")["refused"] == 0
    assert session.last("loop")["lateness"]["lost"] == 0
    assert session.by_truth is not None
    for judged in (session.by_record, session.by_truth):
        found = judged.fidelity
        assert found is not None, judged.unjudged
        print(
            f"{judged.way.source}: kept {found.contrast_kept.round(3)}, lag "
            f"{1e3 * found.lag:.3f} mm, error {found.rms_error:.3f}"
        )
        # The envelope alone keeps 98.9 % of a 4 mm grating at 60 mm/s; 0.56 ms of it are 34 um.
        # A finger takes most at small amplitudes, so that each rise begins slowly. In truth the
        # skin is for a while faster or slower than the finger at each edge, and its friction is
        # that at its own speed.
        assert found.contrast_kept[0] > 0.93
        assert 0.0 < found.lag < 0.1e-3
    assert session.position_error is not None
    assert session.position_error < 50e-6
    summary = session.summary()
    assert summary["by_truth"]["fidelity"]["lag_m"] < 0.1e-3


@pytest.mark.slow
def test_record_and_truth_are_the_same_bit_for_bit(
    display: Display, point: WorkingPoint, tmp_path: Path
) -> None:
    setup = prepared(display)
    played(setup, point, tmp_path / "one", 0.6)
    played(setup, point, tmp_path / "two", 0.6)
    one, two = (read_trace(tmp_path / name / "trace.sqft") for name in ("one", "two"))
    np.testing.assert_array_equal(one.rows, two.rows)
    assert (tmp_path / "one/truth.csv").read_bytes() == (tmp_path / "two/truth.csv").read_bytes()


@pytest.mark.slow
def test_a_device_plays_a_tile_by_itself(
    display: Display, point: WorkingPoint, tmp_path: Path
) -> None:
    setup = prepared(display, mode="tile", way=(-2e-3, 42e-3))
    outcome, session = played(setup, point, tmp_path)
    assert outcome.ending is Ending.DURATION, outcome.message
    assert session.by_truth is not None
    found = session.by_truth.fidelity
    assert found is not None
    print(f"tile: kept {found.contrast_kept.round(3)}, lag {1e3 * found.lag:.3f} mm")
    assert found.contrast_kept[0] > 0.95
    assert 0.0 < found.lag < 0.15e-3


@pytest.mark.slow
def test_a_slow_sensor_costs_contrast_or_place_and_it_shows(
    display: Display, point: WorkingPoint, tmp_path: Path
) -> None:
    setup = prepared(display, sensor=TOUCH_PANEL_240_HZ)
    _, session = played(setup, point, tmp_path, sensor=TOUCH_PANEL_240_HZ)
    assert session.last("end")["repeated_readings"] > 500
    assert session.position_error is not None
    print(f"240 Hz panel: position error {1e6 * session.position_error:.0f} um")
    assert session.position_error < 0.5e-3


@pytest.mark.slow
def test_a_host_that_is_held_up_ends_with_the_devices_watchdog(
    display: Display, point: WorkingPoint, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    held = Player.step

    def step(self: Player) -> None:
        if 0.5 < self.clock() < 0.7:
            return
        held(self)

    monkeypatch.setattr(bench.Player, "step", step)
    outcome, session = played(prepared(display), point, tmp_path)
    assert outcome.ending is Ending.FAULT
    assert "watchdog" in outcome.message
    held_up = re.search(r"this program was held up for (\d+) ms", outcome.message)
    assert held_up is not None
    assert 190 <= int(held_up[1]) <= 210
    assert outcome.failed
    assert session.trace.damage.whole
    assert any(event["fault"] == "watchdog" for event in session.device_events)
    truth = session.by_truth
    assert truth is not None


@pytest.mark.slow
def test_a_session_that_stood_still_is_not_usable_and_its_record_says_so(
    display: Display, point: WorkingPoint, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    setup = prepared(display)
    outcome, session = played(setup, point, tmp_path / "fine", duration=0.8)
    assert outcome.usable
    assert session.summary()["usability"]["usable"] is True
    take = bench.SimulatedLoop.take_rows

    def with_a_hole(self: bench.SimulatedLoop) -> np.ndarray:
        made = take(self)
        return made[(made[:, 1] < 0.3) | (made[:, 1] > 0.5)]

    monkeypatch.setattr(bench.SimulatedLoop, "take_rows", with_a_hole)
    outcome, session = played(setup, point, tmp_path / "held-up", duration=0.8)
    assert outcome.ending is Ending.DURATION
    assert not outcome.failed
    assert not outcome.usable
    assert "nothing was played for 200 ms" in outcome.said
    assert session.summary()["usability"]["sentence"] in outcome.said


@pytest.mark.slow
def test_a_session_without_a_pickup_is_judged_by_the_envelopes_model(
    display: Display, point: WorkingPoint, tmp_path: Path
) -> None:
    setup = play_setup(display, load_texture("biet2008-square-4mm"))
    _, session = played(setup, point, tmp_path)
    assert "no pickup" in session.by_record.way.source
    found = session.by_record.fidelity
    assert found is not None
    assert found.contrast_kept[0] > 0.95


def test_a_session_that_broke_at_once_is_told_and_shown(display: Display, tmp_path: Path) -> None:
    from squeezefilm.instruments.bench.play import PlayResult
    from squeezefilm.instruments.report.page import write_play
    from squeezefilm.instruments.session.loop.rows import COLUMNS
    from squeezefilm.instruments.session.record.trace_file import TraceWriter

    setup = prepared(display)
    with TraceWriter(tmp_path / "trace.sqft", COLUMNS, {"drive": "serial:none"}) as writer:
        writer.event("begin")
    (tmp_path / "truth.csv").write_text("time_s,x_m\n")
    session = judge_session(setup, read_trace(tmp_path / "trace.sqft"), tmp_path / "truth.csv")
    assert session.by_truth is None
    assert session.by_record.fidelity is None
    outcome = PlayOutcome(Ending.LINK, "it was <unplugged>", tmp_path / "trace.sqft", 0)
    page = write_play(PlayResult(outcome, session, tmp_path), tmp_path)
    assert "it was &lt;unplugged&gt;" in page.read_text()
    assert (
        '"ended_because": "the link to the device broke"' in (tmp_path / "summary.json").read_text()
    )


def test_a_loop_that_hangs_stops_the_device(
    display: Display, point: WorkingPoint, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    advance = bench.SimulatedLoop.advance
    monkeypatch.setattr(
        bench.SimulatedLoop, "advance", lambda self, until: advance(self, min(until, 0.5))
    )
    outcome, session = played(prepared(display), point, tmp_path)
    assert outcome.ending is Ending.LOOP
    assert "no command" in outcome.message
    assert session.last("end")["device_at_zero"]
    assert all(event["fault"] == "none" for event in session.device_events)
