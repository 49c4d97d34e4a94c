"""One renderer, one truth: the loop's tick gives what the offline renderer gives, to the bit.

And the account of late and lost ticks on a simulated clock, exactly.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from tests.loop_runs import SimulatedRun, run_ticks, stream_samples
from tests.simulated_loop import SimulatedLoop

from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.loop.shared import CLASSES, lateness_class
from squeezefilm.physics.render.fidelity.rendered_stroke import RenderedStroke, rendered_stroke
from squeezefilm.physics.render.motion.estimator import (
    LVDT_10_KHZ,
    TOUCH_PANEL_60_HZ,
    TOUCH_PANEL_240_HZ,
    MotionEstimator,
    SensorModel,
    sensor_stream,
)
from squeezefilm.physics.render.motion.stroke import MinimumJerkStroke
from squeezefilm.physics.render.program.inverse import FrictionTable
from squeezefilm.physics.render.program.lowering import lower
from squeezefilm.physics.render.resonator.envelope import DrivenEnvelope
from squeezefilm.physics.render.texture.composition import Composable
from squeezefilm.physics.render.texture.image import Noise
from squeezefilm.physics.render.texture.levels import Amplitude
from squeezefilm.physics.render.texture.shapes import Periodic, SineWave, SpeedGate, SquareWave

LIMIT, PER_VOLT = 1e-6, 1e-8
TEXTURES: dict[str, Composable] = {
    "square": Amplitude(SquareWave(2e-3), 0.1e-6, 0.8e-6),
    "sine": Amplitude(SineWave(1e-3), 0.0, 0.7e-6),
    "moving": Amplitude(
        Noise(0.7e-3, 5, 3) * Periodic(40.0, "sine") * SpeedGate(above=0.02), 0.1e-6, 0.9e-6
    ),
}
SENSORS = (LVDT_10_KHZ, TOUCH_PANEL_240_HZ, TOUCH_PANEL_60_HZ)


def _friction(amplitude: np.ndarray, speed: object) -> np.ndarray:
    return 1.0 - 0.4 * amplitude / LIMIT


def _both(
    texture: Composable,
    sensor: SensorModel,
    compensation: Literal["none", "inverse"],
    *,
    rate: float = 5e3,
    braking: bool = False,
) -> tuple[RenderedStroke, SimulatedRun]:
    """The same stroke by the offline renderer and by the loop, to and fro at changing speed."""
    envelope = DrivenEnvelope(0.5e-3, 0.8e-3, LIMIT, braking)
    stroke = MinimumJerkStroke(40e-3, 0.4, passes=2)
    offline = rendered_stroke(
        texture, stroke, envelope, _friction, compensation=compensation, sensor=sensor,
        control_rate=rate, seed=11,
    )  # fmt: skip
    stream = sensor_stream(sensor, stroke.position, stroke.duration, 11)
    plan = LoopPlan(
        program=lower(texture, largest_amplitude=LIMIT),
        rate=rate,
        envelope=envelope,
        amplitude_per_volt=PER_VOLT,
        estimator=MotionEstimator.for_sensor(sensor),
        compensation=compensation,
        relative_friction=FrictionTable(
            np.array([0.0, LIMIT]), np.zeros(1), np.array([[1.0, 0.6]]), 0.0
        ),
    )
    run = run_ticks(plan, stream_samples(stream), stream.arrival, offline.time.size)
    return offline, run


@pytest.mark.parametrize("compensation", ["none", "inverse"])
@pytest.mark.parametrize("sensor", SENSORS, ids=lambda one: one.name)
@pytest.mark.parametrize("texture", TEXTURES)
def test_the_loop_commands_what_the_offline_renderer_commands(
    texture: str, sensor: SensorModel, compensation: Literal["none", "inverse"]
) -> None:
    offline, run = _both(TEXTURES[texture], sensor, compensation, braking=True)
    # Offline, the last sample of a compensated drive holds; a loop does not know of an end.
    known = slice(0, -1)
    apart = np.max(np.abs(run.commands[known, column.COMMAND_AMPLITUDE] - offline.command[known]))
    friction = run.rows[known, column.FRICTION] - offline.relative_friction_rendered[known]
    print(f"{texture}, {sensor.name}, {compensation}: commands apart {apart / LIMIT:.1g} of limit")
    assert apart <= 1e-12 * LIMIT
    assert np.max(np.abs(friction)) <= 1e-12
    volts = run.rows[known, column.VOLTAGE] * PER_VOLT
    np.testing.assert_allclose(volts, offline.command[known], rtol=0, atol=1e-12 * LIMIT)
    assert np.std(offline.command) > 0.05 * LIMIT


@pytest.mark.parametrize("rate", [1e3, 3e3, 20e3])
def test_and_estimates_the_finger_where_it_does_at_any_rate(rate: float) -> None:
    offline, run = _both(TEXTURES["square"], LVDT_10_KHZ, "inverse", rate=rate)
    assert offline.estimate is not None
    seen = offline.estimate.fresh
    np.testing.assert_array_equal(run.rows[seen, column.X], offline.estimate.position[seen])
    np.testing.assert_array_equal(run.rows[:, column.TIME], offline.time)
    np.testing.assert_allclose(
        run.commands[:-1, column.COMMAND_AMPLITUDE], offline.command[:-1], atol=1e-12 * LIMIT
    )
    assert run.lateness.lost == 0
    assert run.lateness.longest == 0.0


def test_a_loop_moved_step_by_step_is_the_same_loop_to_the_bit() -> None:
    stroke = MinimumJerkStroke(40e-3, 0.2)
    stream = sensor_stream(TOUCH_PANEL_240_HZ, stroke.position, stroke.duration, 5)
    plan = LoopPlan(
        lower(TEXTURES["moving"], largest_amplitude=LIMIT), 2e3, DrivenEnvelope(1e-3, 1e-3, LIMIT),
        PER_VOLT, MotionEstimator.for_sensor(TOUCH_PANEL_240_HZ),
        "inverse", output_delay=2e-3,
    )  # fmt: skip
    samples = stream_samples(stream)
    at_once = run_ticks(plan, samples, stream.arrival, 400)
    loop, heard = SimulatedLoop(plan), 0
    for tick in range(400):
        ready = int(np.searchsorted(stream.arrival, tick / plan.rate, side="right"))
        loop.feed(samples[heard:ready])
        heard = ready
        loop.make_tick()
    np.testing.assert_array_equal(loop.take_rows(), at_once.rows)
    np.testing.assert_array_equal(loop.take_commands(), at_once.commands)


INTERPRETED = """
import sys
import numpy as np
sys.path.insert(0, sys.argv[1])
from test_loop import LVDT_10_KHZ, TEXTURES, _both
np.save(sys.argv[2], _both(TEXTURES["square"], LVDT_10_KHZ, "inverse", rate=1e3)[1].rows)
"""


@pytest.mark.nightly
def test_the_loop_interpreted_is_the_loop_compiled(tmp_path: Path) -> None:
    # Also what a person sees who steps through it in a debugger.
    there = tmp_path / "rows.npy"
    subprocess.run(
        [sys.executable, "-c", INTERPRETED, str(Path(__file__).parent), str(there)],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        check=True,
    )
    _, run = _both(TEXTURES["square"], LVDT_10_KHZ, "inverse", rate=1e3)
    np.testing.assert_allclose(np.load(there), run.rows, rtol=1e-12, atol=1e-15)


# --- late and lost ticks ---


def _plan(rate: float) -> LoopPlan:
    return LoopPlan(
        lower(TEXTURES["square"], largest_amplitude=LIMIT), rate, DrivenEnvelope(1e-3, 1e-3, LIMIT),
        PER_VOLT, MotionEstimator.for_sensor(LVDT_10_KHZ),
    )  # fmt: skip


def _delayed(rate: float, ticks: int, delays: np.ndarray) -> SimulatedRun:
    samples = np.array([[0.0, 0.0, 0.0, 1.0, np.nan, np.nan]])
    return run_ticks(_plan(rate), samples, np.zeros(1), ticks, delays)


def test_delays_are_counted_exactly() -> None:
    # Of wakes at 1 kHz: 0.3 ms late; 2.5 ms late (ticks 2 and 3 lost); on time; 1 ms late to the
    # nanosecond (its own tick lost).
    delays = np.array([0.0, 0.3e-3, 2.5e-3, 0.0, 1e-3, 0.0])
    run = _delayed(1e3, 10, delays)
    assert run.rows[:, column.TICK].tolist() == [0, 1, 4, 5, 7, 8, 9]
    np.testing.assert_allclose(
        run.rows[:, column.LATENESS], [0, 0.3e-3, 0.5e-3, 0, 0, 0, 0], atol=1e-9
    )
    after = run.rows[:, column.FLAGS].astype(int) & column.AFTER_LOST_TICKS
    assert (after > 0).tolist() == [False, False, True, False, True, False, False]
    lateness = run.lateness
    assert (lateness.made, lateness.lost) == (7, 3)
    assert lateness.longest == pytest.approx(2.5e-3, abs=1e-9)
    expected = np.zeros(CLASSES, dtype=int)
    for late in (0.0, 0.3e6, 0.5e6, 0.0, 0.0, 0.0, 0.0):
        expected[lateness_class(late)] += 1
    assert lateness.counts.tolist() == expected.tolist()


def test_after_a_stop_of_a_second_one_tick_is_made_and_no_burst() -> None:
    delays = np.zeros(100)
    delays[50] = 1.0
    run = _delayed(5e3, 6000, delays)
    assert (run.lateness.made, run.lateness.lost) == (1000, 5000)
    gaps = np.diff(run.rows[:, column.TICK])
    assert sorted(gaps)[-2:] == [1, 5001]
    # The drive was silent for longer than the host's timeout: the envelope is taken to be at rest.
    assert np.all(run.rows[:, column.LATENESS] < 1 / 5e3)


def test_random_delays_never_lose_or_double_a_tick() -> None:
    rng = np.random.default_rng(3)
    for rate in (10.0, 997.0, 3e3, 50e3):
        delays = np.where(rng.random(20_000) < 0.2, rng.exponential(2 / rate, 20_000), 0.0)
        run = _delayed(rate, 20_000, delays)
        ticks = run.rows[:, column.TICK]
        assert np.all(np.diff(ticks) >= 1)
        assert ticks[-1] == 19_999
        assert run.lateness.made == ticks.size
        assert run.lateness.made + run.lateness.lost == 20_000
        assert np.all(
            (run.rows[:, column.LATENESS] >= 0) & (run.rows[:, column.LATENESS] < 1 / rate)
        )


def test_lost_ticks_leave_the_compensator_where_the_resonator_is() -> None:
    # What the resonator does under the commands held over the gap, against what the loop believes.
    envelope = DrivenEnvelope(2e-3, 3e-3, LIMIT, braking=True)
    plan = LoopPlan(
        lower(Amplitude(SineWave(1e-3), 0.1e-6, 0.9e-6), largest_amplitude=LIMIT), 5e3, envelope,
        PER_VOLT, MotionEstimator.for_sensor(LVDT_10_KHZ), "inverse",
        FrictionTable(np.array([0.0, LIMIT]), np.zeros(1), np.array([[1.0, 0.0]]), 0.0),
    )  # fmt: skip
    rng = np.random.default_rng(8)
    delays = np.where(rng.random(2000) < 0.1, rng.exponential(1e-3, 2000), 0.0)
    time = np.arange(2000) / 10e3
    samples = np.column_stack(
        [time, 0.03 * time, 0 * time, 0 * time + 1, 0 * time + np.nan, 0 * time + np.nan]
    )
    run = run_ticks(plan, samples, time, 1000, delays)
    assert run.lateness.lost > 50
    ticks = run.commands[:, column.COMMAND_TICK].astype(int)
    held = run.commands[np.searchsorted(ticks, np.arange(1000), side="right") - 1, 2]
    truth = np.abs(envelope.response(held, plan.period))[ticks]
    np.testing.assert_allclose(1.0 - run.rows[:, column.FRICTION], truth / LIMIT, atol=1e-12)
