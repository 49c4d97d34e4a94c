"""One tick: what it plays, and what it flags instead of raising."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys
from tests.friction_tables import inverse_over_speeds
from tests.loop_runs import run_ticks
from tests.simulated_loop import SimulatedLoop

from squeezefilm.core.errors import InputError
from squeezefilm.core.quantities import FloatArray
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.loop.shared import COMMANDS, ROWS
from squeezefilm.instruments.session.loop.tick import interpolated
from squeezefilm.physics.render.program import layout
from squeezefilm.physics.render.program.inverse import FrictionTable
from squeezefilm.physics.render.program.lowering import lower
from squeezefilm.physics.render.resonator import kernel as compensation_kernel
from squeezefilm.physics.render.resonator.envelope import DrivenEnvelope
from squeezefilm.physics.render.texture.levels import Amplitude, RelativeFriction

PlanOf = Callable[..., LoopPlan]
RATE, SPEED = 5e3, 0.06
GROOVE, RIDGE = 0.8e-6, 0.1e-6


def _sample(time: float, **changes: float) -> FloatArray:
    """A finger at 60 mm/s along x, in the middle of a groove at time 0."""
    fields = {
        "stamp": time, "x": 0.5e-3 + SPEED * time, "y": 0.0, "touching": 1.0, "level": math.nan,
        "amplitude": math.nan,
    }  # fmt: skip
    return np.array([list({**fields, **changes}.values())])


def _led(loop: SimulatedLoop, ticks: int) -> FloatArray:
    """Rows of ticks that each have a new sample."""
    for _ in range(ticks):
        loop.feed(_sample(loop.time))
        loop.make_tick()
    return loop.take_rows()


def _flags(rows: FloatArray) -> int:
    return int(rows[-1, column.FLAGS])


def test_a_finger_in_a_groove_is_played_the_groove(plan_of: PlanOf) -> None:
    loop = SimulatedLoop(plan_of())
    row = _led(loop, 20)[-1]
    assert row[column.TICK] == 19
    assert row[column.WANTED] == GROOVE
    assert row[column.VOLTAGE] == pytest.approx(80.0)
    assert row[column.SPEED] == pytest.approx(SPEED, rel=0.05)
    # From the newest sample, taken as the tick was due, to the middle of the step.
    assert row[column.LAG] == pytest.approx(row[column.SPEED] * 0.5 / RATE)
    assert int(row[column.FLAGS]) == column.NEW_SAMPLE
    commands = loop.take_commands()
    assert commands.shape == (20, 4)
    assert commands[-1, column.COMMAND_VOLTAGE] == row[column.VOLTAGE]
    assert commands[-1, column.COMMAND_TIME] == pytest.approx(19 / RATE)


def _slow_and_fast() -> FrictionTable:
    """Friction that falls with amplitude, and less so under a faster finger."""
    return FrictionTable(
        np.array([0.0, 2e-6]), np.array([0.02, 0.1, 0.2]),
        np.array([[1.0, 0.0], [1.0, 0.4], [1.0, 0.6]]), 0.1,
    )  # fmt: skip


@pytest.mark.parametrize("speed", [0.01, 0.02, 0.06, 0.15, 0.3])
def test_friction_is_written_down_for_the_estimated_speed(plan_of: PlanOf, speed: float) -> None:
    texture = Amplitude.constant(0.8e-6)
    plan = plan_of(
        program=lower(texture, largest_amplitude=2e-6), relative_friction=_slow_and_fast()
    )
    loop = SimulatedLoop(plan)
    for _ in range(400):
        loop.feed(_sample(loop.time, x=speed * loop.time))
        loop.make_tick()
    row = loop.take_rows()[-1]
    assert row[column.SPEED] == pytest.approx(speed, rel=0.02)
    held = np.clip(row[column.SPEED], 0.02, 0.2)
    expected = _slow_and_fast()(np.array([0.8e-6]), held)
    assert row[column.FRICTION] == pytest.approx(expected[0], rel=1e-9)


def test_a_wanted_friction_is_played_with_the_amplitude_for_the_estimated_speed(
    plan_of: PlanOf,
) -> None:
    known = _slow_and_fast()

    def law(amplitude: FloatArray, speed: FloatArray) -> FloatArray:
        return np.asarray(known(amplitude[None, :], speed[:, None]))

    inverse = inverse_over_speeds(law, np.linspace(0, 2e-6, 5), known.speed, 0.1)
    plan = plan_of(
        program=lower(RelativeFriction.constant(0.8), inverse=inverse), relative_friction=known
    )
    loop = SimulatedLoop(plan)
    for _ in range(400):
        loop.feed(_sample(loop.time))
        loop.make_tick()
    row = loop.take_rows()[-1]
    # At 60 mm/s halfway between the rows: 0.8 at 0.5 of the amplitude's swing by 0.8.
    assert row[column.WANTED] == pytest.approx(0.5e-6, rel=0.01)
    assert row[column.FRICTION] == pytest.approx(0.8, abs=1e-3)


def test_without_a_finger_no_friction_of_a_speed_is_claimed(plan_of: PlanOf) -> None:
    loop = SimulatedLoop(plan_of(relative_friction=_slow_and_fast()))
    loop.make_tick()
    assert math.isnan(loop.take_rows()[0, column.FRICTION])


def test_without_a_sample_nothing_is_played_and_no_place_is_claimed(plan_of: PlanOf) -> None:
    loop = SimulatedLoop(plan_of())
    loop.make_tick()
    rows = loop.take_rows()
    assert rows[0, column.VOLTAGE] == 0.0
    assert _flags(rows) == column.NOT_TOUCHING
    assert np.all(np.isnan(rows[0, [column.X, column.Y, column.SPEED, column.LAG]]))


def test_when_samples_stop_the_drive_does(plan_of: PlanOf) -> None:
    plan = plan_of()
    loop = SimulatedLoop(plan)
    _led(loop, 20)
    last = loop.time - 1 / RATE
    loop.advance(last + plan.estimator.stall - plan.lead)
    assert np.all(loop.take_rows()[:, column.VOLTAGE] > 0.0)
    loop.advance(last + plan.estimator.stall + 0.1)
    rows = loop.take_rows()[1:]
    assert np.all(rows[:, column.VOLTAGE] == 0.0)
    assert np.all(rows[:, column.FLAGS] == column.NO_FRESH_SAMPLE)


@pytest.mark.parametrize(
    "lifted", [{"touching": 0.0}, {"touching": math.nan}, {"touching": 0.0, "x": math.nan}]
)
def test_a_lifted_finger_is_forgotten_at_once(plan_of: PlanOf, lifted: dict[str, float]) -> None:
    loop = SimulatedLoop(plan_of())
    _led(loop, 20)
    loop.feed(_sample(loop.time, **lifted))
    loop.make_tick()
    rows = loop.take_rows()
    assert rows[-1, column.VOLTAGE] == 0.0
    assert _flags(rows) == column.NEW_SAMPLE | column.NOT_TOUCHING
    rows = _led(loop, 1)
    assert rows[-1, column.VOLTAGE] > 0.0
    assert rows[-1, column.SPEED] == 0.0


@pytest.mark.parametrize("broken", [{"x": math.nan}, {"y": math.inf}, {"stamp": math.nan}])
def test_a_broken_sample_is_flagged_and_changes_nothing(
    plan_of: PlanOf, broken: dict[str, float]
) -> None:
    one, other = SimulatedLoop(plan_of()), SimulatedLoop(plan_of())
    for loop in (one, other):
        _led(loop, 20)
    one.feed(_sample(one.time, **broken))
    one.make_tick()
    other.make_tick()
    hit, clean = one.take_rows()[0], other.take_rows()[0]
    assert int(hit[column.FLAGS]) == column.NEW_SAMPLE | column.REJECTED_SAMPLE
    np.testing.assert_array_equal(hit[: column.FLAGS], clean[: column.FLAGS])


def test_muted_plays_nothing_until_it_is_not(plan_of: PlanOf) -> None:
    loop = SimulatedLoop(plan_of(compensation="inverse"))
    _led(loop, 20)
    loop.mute()
    rows = _led(loop, 3)
    assert np.all(rows[:, column.VOLTAGE] == 0.0)
    assert _flags(rows) & column.MUTED
    loop.mute(False)
    assert _led(loop, 1)[-1, column.VOLTAGE] > 0.0


def test_a_poisoned_state_is_refused_zeroed_and_counted(plan_of: PlanOf) -> None:
    loop = SimulatedLoop(plan_of(compensation="inverse"))
    _led(loop, 20)
    loop._arrays.compensator[compensation_kernel.AMPLITUDE] = math.nan
    rows = _led(loop, 1)
    assert rows[-1, column.VOLTAGE] == 0.0
    assert _flags(rows) & column.REFUSED_COMMAND
    assert _led(loop, 5)[-1, column.VOLTAGE] > 0.0


def test_rings_that_nobody_empties_drop_and_say_so(plan_of: PlanOf) -> None:
    loop = SimulatedLoop(plan_of())
    loop.advance((ROWS + 10.5) / RATE)
    rows, commands = loop.take_rows(), loop.take_commands()
    assert (len(rows), len(commands)) == (ROWS, COMMANDS)
    assert int(rows[COMMANDS, column.FLAGS]) & column.COMMAND_DROPPED
    loop.make_tick()
    assert _flags(loop.take_rows()) & column.ROW_DROPPED


def test_what_the_device_reports_is_kept_until_it_reports_again(plan_of: PlanOf) -> None:
    loop = SimulatedLoop(plan_of())
    loop.feed(_sample(0.0, level=12.0, amplitude=0.5e-6))
    loop.make_tick()
    row = _led(loop, 1)[-1]
    assert (row[column.LEVEL], row[column.AMPLITUDE]) == (12.0, 0.5e-6)
    # The friction follows the pickup, not the model of the envelope.
    assert row[column.FRICTION] == pytest.approx(0.75)


def test_a_brake_inverts_the_voltage(plan_of: PlanOf) -> None:
    plan = plan_of(
        compensation="inverse", envelope=DrivenEnvelope(0.5e-3, 0.5e-3, 1e-6, braking=True)
    )
    samples = np.concatenate([_sample(k / RATE) for k in range(200)])
    run = run_ticks(plan, samples, samples[:, 0], 200)
    assert run.commands[:, column.COMMAND_VOLTAGE].min() < -50.0
    flags = run.rows[:, column.FLAGS].astype(int)
    assert np.any(flags & column.AT_TOP)
    assert np.any(flags & column.AT_BOTTOM) or run.commands[:, 2].min() > -1e-6


def test_every_flag_of_the_renderer_is_explained() -> None:
    theirs = {value for name, value in vars(layout).items() if name.startswith("F_")}
    assert theirs <= column.FLAG_MEANINGS.keys()
    assert len(column.flag_meanings(sum(column.FLAG_MEANINGS))) == len(column.FLAG_MEANINGS)
    assert column.flag_meanings(0.0) == []


def test_friction_is_read_as_numpy_reads_a_table() -> None:
    amplitude, friction = np.array([0.0, 0.2e-6, 1e-6]), np.array([0.0, 10.0, 90.0])
    for place in np.linspace(0.0, 1.2e-6, 41):
        found = interpolated(amplitude, friction, place)
        assert found == pytest.approx(np.interp(place, amplitude, friction))
    assert math.isnan(interpolated(amplitude, friction, math.nan))
    assert math.isnan(interpolated(np.zeros(0), np.zeros(0), 1.0))


def test_a_tick_takes_no_memory(plan_of: PlanOf) -> None:
    plan = plan_of(compensation="inverse")
    samples = np.concatenate([_sample(k / RATE) for k in range(100)])

    def allocated(ticks: int) -> tuple[int, int]:
        before = rtsys.get_allocation_stats()
        run_ticks(plan, samples, samples[:, 0], ticks)
        after = rtsys.get_allocation_stats()
        return after.alloc - before.alloc, after.mi_alloc - before.mi_alloc

    run_ticks(plan, samples, samples[:, 0], 10)
    _nrt_python.memsys_enable_stats()
    try:
        assert allocated(20_000) == allocated(10)
    finally:
        _nrt_python.memsys_disable_stats()


def test_samples_and_times_of_other_shapes_are_refused(plan_of: PlanOf) -> None:
    plan, samples = plan_of(), _sample(0.0)
    with pytest.raises(InputError, match="sample_time_s, x_m"):
        SimulatedLoop(plan).feed(samples[:, :5])
    with pytest.raises(InputError, match="delay"):
        SimulatedLoop(plan).make_tick(-1.0)
