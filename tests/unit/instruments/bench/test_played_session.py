"""A session's record made by hand: what the finger met, what of it is judged, what is summed up."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.instruments.bench import played_session as played
from squeezefilm.instruments.bench.played_session import PlayedWay, judge_session, recorded_way
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.record.trace import Damage, Trace, TraceEvent
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ, MotionEstimator
from squeezefilm.physics.render.program.inverse import FrictionInverse
from squeezefilm.physics.render.program.lowering import lower
from squeezefilm.physics.render.resonator.envelope import DrivenEnvelope
from squeezefilm.physics.render.texture.levels import Amplitude
from squeezefilm.physics.render.texture.shapes import SquareWave

SQUARE = Amplitude(SquareWave(2e-3), 0.1e-6, 0.8e-6)
REACH = 2e-6
LATENCY = 4e-3
SENSOR = dataclasses.replace(LVDT_10_KHZ, latency=LATENCY)


def friction_of(amplitude: Any, speed: Any = None) -> Any:
    """Of a display whose friction falls linearly to nothing at its reach."""
    return 1 - np.asarray(amplitude) / REACH


@pytest.fixture(scope="module")
def setup() -> Any:
    plan = LoopPlan(
        program=lower(SQUARE, largest_amplitude=REACH), rate=1e3,
        envelope=DrivenEnvelope(0.5e-3, 0.7e-3, 1e-6), amplitude_per_volt=1e-8,
        estimator=MotionEstimator.for_sensor(LVDT_10_KHZ),
    )  # fmt: skip
    return SimpleNamespace(
        plan=SimpleNamespace(
            loop=plan, device=SimpleNamespace(sensor=SENSOR), mode="stream", tile=None
        ),
        friction=friction_of, name="a grating",
        prediction=SimpleNamespace(inverse=FrictionInverse.from_function(friction_of, REACH)),
        texture=SimpleNamespace(texture=SQUARE),
    )  # fmt: skip


def rows_of(count: int, **columns: Any) -> si.FloatArray:
    """Rows 1 ms apart of a finger at 50 mm/s from 0.5 mm on."""
    rows = np.full((count, len(column.COLUMNS)), math.nan)
    time = np.arange(count) * 1e-3
    filled = {"TICK": np.arange(count), "TIME": time, "X": 0.5e-3 + 0.05 * time, "SPEED": 0.05,
              "FLAGS": 0, **columns}  # fmt: skip
    for name, values in filled.items():
        rows[:, getattr(column, name)] = values
    return rows


def trace_of(rows: si.FloatArray, *events: TraceEvent) -> Trace:
    return Trace(column.COLUMNS, rows, events, {"display": "one"}, Damage(0, 0, True, ()))


def end(**fields: Any) -> TraceEvent:
    return TraceEvent("end", fields, 0)


def test_with_a_pickup_an_amplitude_belongs_to_the_moment_of_its_reading(setup: Any) -> None:
    # A reading each 5 ms, which the ticks until the next one carry; its place is 4 ms old.
    stamps = np.repeat(np.arange(20) * 5e-3, 5)
    amplitude = np.repeat(np.linspace(0.1, 2.0, 20) * 1e-6, 5)
    stamps[:3] = math.nan
    way = recorded_way(
        setup, trace_of(rows_of(100, ROW_SAMPLE_TIME=stamps, AMPLITUDE=amplitude))
    )  # fmt: skip
    # The first reading is seen from tick 3 on.
    np.testing.assert_allclose(way.time, np.arange(20) * 5e-3 + LATENCY)
    np.testing.assert_allclose(way.x[:-1], 0.5e-3 + 0.05 * way.time[:-1])
    np.testing.assert_allclose(way.amplitude, np.linspace(0.1, 2.0, 20) * 1e-6)
    np.testing.assert_allclose(way.relative_friction_rendered, friction_of(way.amplitude))
    # 2 mm of period: 0.8 um in the first half of each.
    wanted = np.where(np.mod(way.x, 2e-3) < 1e-3, 0.8e-6, 0.1e-6)
    np.testing.assert_allclose(way.wanted, wanted)
    np.testing.assert_allclose(way.relative_friction_wanted, friction_of(wanted))
    assert way.source == "the loop's estimate of the finger and the pickup's amplitude"


def test_readings_from_before_the_last_one_and_unseen_fingers_are_passed_over(setup: Any) -> None:
    stamps = np.array([1e-3, 2e-3, 2e-3, 1.5e-3, 4e-3, 5e-3])
    rows = rows_of(6, ROW_SAMPLE_TIME=stamps, AMPLITUDE=np.arange(6) * 1e-7)
    rows[4, column.X] = math.nan
    way = recorded_way(setup, trace_of(rows))
    np.testing.assert_allclose(way.time - LATENCY, [1e-3, 2e-3, 5e-3])
    np.testing.assert_allclose(way.amplitude, [0.0, 1e-7, 5e-7])


def test_without_a_pickup_it_is_the_envelopes_model(setup: Any) -> None:
    friction = np.linspace(1.0, 0.2, 50)
    rows = rows_of(50, FRICTION=friction)
    rows[:10, column.X] = math.nan
    way = recorded_way(setup, trace_of(rows))
    np.testing.assert_allclose(way.time, np.arange(10, 50) * 1e-3)
    np.testing.assert_allclose(way.relative_friction_rendered, friction[10:])
    np.testing.assert_allclose(way.amplitude, REACH * (1 - friction[10:]), atol=1e-15)
    assert "no pickup" in way.source
    # Above rest there is no amplitude.
    above = recorded_way(setup, trace_of(rows_of(5, FRICTION=1.2)))
    assert np.all(above.amplitude == 0.0)


def test_a_finger_that_was_never_seen_met_nothing(setup: Any) -> None:
    way = recorded_way(setup, trace_of(rows_of(20, X=math.nan)))
    assert way.time.size == way.wanted.size == way.relative_friction_rendered.size == 0
    assert way.source == "nobody: the finger was not seen"
    judged = played._judge(setup, way)
    assert judged.fidelity is None
    assert judged.unjudged == "the finger did not move far enough along x to judge anything"


TRUTH = ("time_s", "x_m", "speed_m_per_s", "amplitude_m", "relative_friction", "normal_force_N")


def truth_file(folder: Path, rows: si.FloatArray) -> Path:
    file = folder / "truth.csv"
    lines = [",".join(repr(float(one)) for one in row) for row in rows]
    file.write_text("\n".join([",".join(TRUTH), *lines]) + "\n")
    return file


def test_the_truth_is_taken_while_the_finger_touched_and_the_session_played(
    setup: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(played, "fidelity_report", lambda stroke: None)
    time = np.arange(-30, 120) * 1e-3
    rows = np.column_stack([
        time - 7.0, 0.5e-3 + 0.05 * time + 2e-6, np.full(150, -0.05), np.full(150, 0.4e-6),
        np.full(150, 0.8), np.full(150, 0.5),
    ])  # fmt: skip
    rows[35:38, 5] = 0.0
    rows[38, 4] = math.nan
    file = truth_file(tmp_path, rows)
    trace = trace_of(
        rows_of(100, LAG=np.nan), end(device_clock_offset_s=7.0, faded_at_s=0.0805)
    )  # fmt: skip
    session = judge_session(setup, trace, file)
    assert session.by_truth is not None
    way = session.by_truth.way
    expected = np.setdiff1d(np.arange(0, 81), [5, 6, 7, 8]) * 1e-3
    np.testing.assert_allclose(way.time, expected, atol=1e-12)
    np.testing.assert_allclose(way.x, 0.5e-3 + 0.05 * expected + 2e-6, atol=1e-12)
    assert np.all(way.amplitude == 0.4e-6)
    assert np.all(way.relative_friction_rendered == 0.8)
    assert way.source == "what really happened in the twin"
    # The estimate is 2 um off, everywhere.
    assert session.position_error == pytest.approx(2e-6, rel=1e-6)
    assert session.lag is None
    # Without the clocks' offset nobody knows what was when.
    blind = judge_session(setup, trace_of(rows_of(100), end()), file)
    assert (blind.by_truth, blind.position_error) == (None, None)
    assert judge_session(setup, trace).by_truth is None


def test_a_session_ends_for_its_judges_when_it_faded_or_with_its_last_row() -> None:
    rows = rows_of(100)
    for events, expected in (
        ((), 0.099),
        ((end(faded_at_s=None),), 0.099),
        ((end(faded_at_s=0.05),), 0.05),
        ((end(faded_at_s=3.0),), 0.099),
        ((end(faded_at_s=0.05), end(faded_at_s=0.06), TraceEvent("loop", {}, 0)), 0.06),
    ):
        assert played._played_until(trace_of(rows, *events)) == pytest.approx(expected)
    assert played._played_until(trace_of(rows[:0])) == 0.0


def test_flags_lags_and_events_are_summed_up(setup: Any) -> None:
    flags = np.zeros(200, dtype=int)
    flags[:50] |= column.AT_TOP
    flags[40:60] |= column.MUTED
    flags[:] |= column.NEW_SAMPLE
    lag = np.linspace(0.0, 1.0, 101)[np.arange(200) % 101] * 1e-3
    lag[101:] = math.nan
    events = (
        TraceEvent("device", {"state": "armed"}, 0), TraceEvent("link", {"sent": 1}, 0),
        TraceEvent("device", {"state": "playing"}, 0), TraceEvent("link", {"sent": 2}, 0),
        TraceEvent("loop", {"made": 3}, 0), end(why="over"),
    )  # fmt: skip
    session = judge_session(setup, trace_of(rows_of(200, FLAGS=flags, LAG=lag), *events))
    assert session.flags == {
        column.FLAG_MEANINGS[column.AT_TOP]: 50, column.FLAG_MEANINGS[column.MUTED]: 20,
    }  # fmt: skip
    assert session.lag is not None
    assert (session.lag.median, session.lag.p99) == (pytest.approx(0.5e-3), pytest.approx(0.99e-3))
    assert session.device_events == ({"state": "armed"}, {"state": "playing"})
    assert tuple(session.last(kind) for kind in ("end", "loop", "link")) == (
        {"why": "over"}, {"made": 3}, {"sent": 2},
    )  # fmt: skip
    nothing = judge_session(setup, trace_of(rows_of(20)))
    assert all(nothing.last(kind) == {} for kind in ("end", "loop", "link"))
    other = Trace(("time_s", "x_m"), np.zeros((1, 2)), (), {}, Damage(0, 0, True, ()))
    with pytest.raises(InputError, match="the record has no tick, sample_time_s"):
        judge_session(setup, other)


def way_of(time: si.FloatArray, x: si.FloatArray) -> PlayedWay:
    ones = np.ones(time.size)
    wanted = np.asarray(SQUARE(x, 0.0, 0.05, 0.0))
    return PlayedWay(time, x, wanted, ones * 0.3e-6, friction_of(wanted), ones * 0.85, "somebody")


TIME = np.arange(2000) * 1e-3
# There, back and there again over 30 mm, 0.6 s each, and 0.2 s of rest.
TURNS = np.interp(TIME, [0, 0.6, 1.2, 1.8, 2.0], [0, 0.03, 0, 0.03, 0.03])


def test_only_steady_passes_are_kept_each_strictly_one_way() -> None:
    noisy = TURNS + np.random.default_rng(3).normal(size=2000) * 1e-6
    for x in (TURNS, noisy):
        kept = played._moving(way_of(TIME, x))
        assert np.all(np.diff(kept) > 0)
        parts = np.split(kept, np.flatnonzero(np.diff(TIME[kept]) > 1.5e-3) + 1)
        # While the smoothed place turns it is in no pass, and the rest at the end is in none, but
        # for noise that still goes on.
        assert all(part.size == 1 for part in parts[3:])
        assert TIME[kept[-1]] < 1.81
        for part, (begin, over, way) in zip(
            parts[:3], ((0.0, 0.6, 1), (0.6, 1.2, -1), (1.2, 1.8, 1)), strict=True
        ):
            assert begin - 1e-3 <= TIME[part[0]] < begin + 25e-3
            assert over - 25e-3 < TIME[part[-1]] <= over + 5e-3
            assert np.all(np.diff(way * x[part]) > 0)
    exact = played._moving(way_of(TIME, TURNS))
    # Nothing of a clean pass is left out but its ends.
    assert exact.size > 3 * 560


def test_a_pass_of_less_than_three_millimetres_says_nothing() -> None:
    for length, kept in ((2.8e-3, False), (3.4e-3, True)):
        x = np.interp(TIME, [0, 1.0, 2.0], [0, length, 0])
        assert (played._moving(way_of(TIME, x)).size > 0) == kept
    few = TIME[:15]
    assert played._moving(way_of(few, few)).size == 0
    assert played._moving(way_of(TIME[:16] * 10, TIME[:16])).size > 0


def test_a_hole_in_the_record_ends_a_pass() -> None:
    x = 0.05 * TIME[:400]
    whole = played._moving(way_of(TIME[:400], x))
    assert np.array_equal(whole, np.arange(whole[0], whole[-1] + 1))
    # Two stretches of 2.5 mm each, with a hole of 0.1 s between them: too short both.
    some = np.r_[0:50, 150:200]
    assert played._moving(way_of(TIME[some], 0.05 * TIME[some])).size == 0
    long = np.r_[0:150, 250:400]
    assert played._moving(way_of(TIME[long], 0.05 * TIME[long])).size > 250


Stroke = Callable[[Any], Any]


def judged_stroke(setup: Any, way: PlayedWay, monkeypatch: pytest.MonkeyPatch) -> Any:
    seen: list[Any] = []

    def noted(stroke: Any) -> Any:
        seen.append(stroke)
        return "a report"

    monkeypatch.setattr(played, "fidelity_report", noted)
    judged = played._judge(setup, way)
    assert (judged.fidelity, judged.unjudged) == ("a report", None)
    assert judged.way is way
    return seen[0]


def test_what_is_judged_is_the_way_as_it_was_made(
    setup: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    x = 0.5e-3 + 0.05 * TIME[:400]
    way = way_of(TIME[:400] + 3.0, x)
    way.amplitude[100:200] = 0.0
    stroke = judged_stroke(setup, way, monkeypatch)
    kept = played._moving(way)
    assert stroke.time[0] == 0.0
    np.testing.assert_allclose(stroke.time, way.time[kept] - way.time[kept[0]])
    np.testing.assert_array_equal(stroke.position, x[kept])
    np.testing.assert_allclose(stroke.speed, 0.05, rtol=1e-6)
    np.testing.assert_array_equal(stroke.wanted, way.wanted[kept])
    np.testing.assert_array_equal(stroke.amplitude, way.amplitude[kept])
    np.testing.assert_array_equal(
        stroke.relative_friction_rendered, way.relative_friction_rendered[kept]
    )
    np.testing.assert_array_equal(
        stroke.relative_friction_wanted, way.relative_friction_wanted[kept]
    )
    assert stroke.silent == pytest.approx(100 / kept.size)
    assert stroke.model == "a session, by somebody"
    assert stroke.control_rate == 1e3
    assert stroke.saturated_top == stroke.saturated_bottom == 0.0
    assert (repr(stroke.texture), repr(stroke.trajectory)) == (
        "a grating", "a finger as recorded",
    )  # fmt: skip
    # 20 mm are ten periods of 2 mm.
    assert stroke.texture.spatial_period == 2e-3


@pytest.mark.parametrize(("length", "has"), [(9.9e-3, False), (10.1e-3, True)])
def test_fewer_than_five_periods_are_no_grating(
    setup: Any, monkeypatch: pytest.MonkeyPatch, length: float, has: bool
) -> None:
    stroke = judged_stroke(setup, way_of(TIME, TIME / TIME[-1] * length), monkeypatch)
    assert (stroke.texture.spatial_period is not None) == has


def test_what_no_report_can_be_made_of_is_told(setup: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(_: Any) -> None:
        raise InputError("it holds still")

    monkeypatch.setattr(played, "fidelity_report", refused)
    judged = played._judge(setup, way_of(TIME, 0.05 * TIME))
    assert (judged.fidelity, judged.unjudged) == (None, "it holds still")


def test_a_position_error_needs_both_at_the_same_time() -> None:
    rows = rows_of(100)
    rows[60:, column.X] = math.nan
    true = way_of(TIME[10:90], 0.5e-3 + 0.05 * TIME[10:90])
    until = way_of(TIME[10:60], 0.5e-3 + 0.05 * TIME[10:60])
    # One of fifty ticks is 20 um off: the first, one in their midst or the last.
    for off in (10, 50, 59):
        moved = rows.copy()
        moved[off, column.X] += 20e-6
        for way in (true, until):
            found = played._position_error(trace_of(moved), way)
            assert found == pytest.approx(20e-6 / math.sqrt(50))
    assert played._position_error(trace_of(rows), way_of(TIME[:1], TIME[:1])) is None
    later = way_of(TIME[200:300], TIME[200:300])
    assert played._position_error(trace_of(rows), later) is None


def test_the_json_of_what_was_judged_leaves_out_what_is_no_number() -> None:
    way = way_of(TIME[:4], 0.05 * TIME[:4])
    off = np.array([0.1, -0.1, 0.1, math.nan])
    way.relative_friction_rendered[:] = way.relative_friction_wanted + off
    told = played._judged_json(played.Judged(way, None, "too short"))
    assert told == {
        "source": "somebody", "samples": 4, "friction_rms_error": pytest.approx(0.1),
        "fidelity": None, "not_judged_because": "too short",
    }  # fmt: skip
    none = way_of(TIME[:0], TIME[:0])
    assert played._judged_json(played.Judged(none, None, ""))["friction_rms_error"] is None


@dataclasses.dataclass
class Predicted:
    """A prediction, as far as a summary asks: its keys take their units from annotations."""

    surface: Any
    voltage: si.Volt
    warnings: tuple[str, ...]


@dataclasses.dataclass
class Planned:
    """A plan, as far as a summary asks."""

    mode: str
    frequency: si.Hertz
    loop: Any
    limits: Any
    tile: Any
    device: Any


def test_a_summary_says_what_was_to_be_played_and_what_became_of_it(
    monkeypatch: pytest.MonkeyPatch, setup: Any
) -> None:
    trace = trace_of(rows_of(20), end(why="over", faded_at_s=math.nan))
    session = judge_session(setup, trace)
    prediction = Predicted(SimpleNamespace(name="bare"), 15.0, ("careful",))
    plan = Planned(
        mode="stream",
        frequency=40e3,
        loop=setup.plan.loop,
        limits={"voltage_V": 20.0},
        tile=None,
        device=SimpleNamespace(sensor={"name": "LVDT"}),
    )
    said = SimpleNamespace(
        name="a grating", display=SimpleNamespace(name="one", whose_finger="mine"),
        prediction=prediction, plan=plan,
        assumed_limits=("slew",),
    )  # fmt: skip
    object.__setattr__(session, "setup", said)
    found = session.summary()
    expected = {
        "texture": "a grating", "display": "one", "finger": "mine", "surface": "bare",
        "mode": "stream",
        "voltage_V": 15.0, "frequency_Hz": 40e3, "rate_Hz": 1e3, "compensation": "none",
        "output_delay_s": 0.0, "largest_amplitude_m": pytest.approx(1e-6),
        "envelope_time_constant_s": 0.5e-3, "limits": {"voltage_V": 20.0},
        "assumed_limits": ["slew"], "sensor": {"name": "LVDT"}, "rows": 20, "loop": {}, "link": {},
        "lag": None, "position_error_m": None, "flags": {}, "device": [], "by_truth": None,
        "damage": [], "provenance": {"display": "one"}, "warnings": ["careful"],
        "end": {"why": "over", "faded_at_s": None}, "tile": None,
    }  # fmt: skip
    assert {key: found[key] for key in expected} == expected
    assert set(found) - set(expected) == {"by_record", "usability"}
    assert found["by_record"]["not_judged_because"]
