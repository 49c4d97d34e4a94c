"""A loop on a simulated clock: which ticks it makes, what it hears, what its plate does."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from tests.loop_runs import run_ticks, stream_samples
from tests.simulated_loop import SimulatedLoop

from squeezefilm.core.errors import InputError
from squeezefilm.core.quantities import FloatArray
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.physics.render.motion.estimator import SensorModel, sensor_stream

PlanOf = Callable[..., LoopPlan]
RATE = 5e3
PERIOD = 1 / RATE
# The plate's own, and the amplitude of a groove, in the plan of the tests.
RISE, GROOVE, REACH = 0.5e-3, 0.8e-6, 2e-6


def held(time: float) -> FloatArray:
    """A finger that lies in the middle of a groove."""
    return np.array([[time, 0.5e-3, 0.0, 1.0, math.nan, math.nan]])


def friction_at(number: int) -> float:
    """Of a plate that has risen towards the groove since tick 0."""
    return 1 - GROOVE * (1 - math.exp(-number * PERIOD / RISE)) / REACH


def test_ticks_are_made_before_a_time_and_not_at_it(plan_of: PlanOf) -> None:
    loop = SimulatedLoop(plan_of())
    assert loop.time == 0.0
    loop.advance(3 * PERIOD)
    assert loop.time == pytest.approx(3 * PERIOD)
    assert loop.take_rows()[:, column.TICK].tolist() == [0, 1, 2]
    loop.advance(3 * PERIOD + 1e-9)
    assert loop.take_rows()[:, column.TICK].tolist() == [3]
    loop.advance(0.0)
    assert loop.take_rows().shape == (0, len(column.COLUMNS))
    assert loop.take_commands().shape == (4, len(column.COMMAND_COLUMNS))
    assert loop.take_commands().shape == (0, len(column.COMMAND_COLUMNS))
    assert (loop.lateness.made, loop.lateness.lost, loop.lateness.longest) == (4, 0, 0.0)
    assert loop.lateness.rate == RATE
    with pytest.raises(InputError, match="until"):
        loop.advance(math.inf)


def test_a_late_tick_says_how_late_and_what_was_lost(plan_of: PlanOf) -> None:
    loop = SimulatedLoop(plan_of())
    for delay in (0.0, 0.4 * PERIOD, PERIOD, 3.5 * PERIOD):
        loop.make_tick(delay)
    rows = loop.take_rows()
    assert rows[:, column.TICK].tolist() == [0, 1, 3, 7]
    late = [0.0, 0.4 * PERIOD, 0.0, 0.5 * PERIOD]
    np.testing.assert_allclose(rows[:, column.LATENESS], late, atol=2e-9)
    lost = (rows[:, column.FLAGS].astype(int) & column.AFTER_LOST_TICKS) != 0
    assert lost.tolist() == [False, False, True, True]
    assert loop.time == pytest.approx(8 * PERIOD)
    found = loop.lateness
    assert (found.made, found.lost) == (4, 4)
    assert found.longest == pytest.approx(3.5 * PERIOD)


def test_feeding_says_how_many_samples_fitted(plan_of: PlanOf) -> None:
    loop = SimulatedLoop(plan_of())
    assert loop.feed(np.repeat(held(0.0), 7, axis=0)) == 7
    assert loop.feed(np.repeat(held(0.0), 9_000, axis=0)) == 8192 - 7
    assert loop.feed(held(0.0)) == 0


@pytest.mark.parametrize("lost", [0, 1, 4])
def test_while_ticks_are_lost_the_plate_follows_the_last_command(
    plan_of: PlanOf, lost: int
) -> None:
    loop = SimulatedLoop(plan_of())
    for number in range(6):
        loop.feed(held(loop.time))
        loop.make_tick()
        row = loop.take_rows()[-1]
        assert row[column.FRICTION] == pytest.approx(friction_at(number), rel=1e-9)
    loop.make_tick(lost * PERIOD)
    row = loop.take_rows()[-1]
    assert row[column.TICK] == 6 + lost
    assert row[column.FRICTION] == pytest.approx(friction_at(6 + lost), rel=1e-9)


def test_a_plate_that_was_left_alone_for_too_long_is_at_rest(plan_of: PlanOf) -> None:
    for timeout, rests in ((3.5 * PERIOD, True), (4.5 * PERIOD, False)):
        loop = SimulatedLoop(plan_of(host_timeout=timeout))
        for _ in range(6):
            loop.feed(held(loop.time))
            loop.make_tick()
        loop.make_tick(4 * PERIOD)
        friction = loop.take_rows()[-1][column.FRICTION]
        assert friction == pytest.approx(1.0 if rests else friction_at(10), rel=1e-9)


def test_a_plate_falls_with_its_own_time_while_ticks_are_lost(plan_of: PlanOf) -> None:
    loop = SimulatedLoop(plan_of())
    for _ in range(6):
        loop.feed(held(loop.time))
        loop.make_tick()
    loop.mute()
    loop.make_tick()
    loop.take_rows()
    loop.make_tick(2 * PERIOD)
    row = loop.take_rows()[-1]
    # At tick 6 it was muted: three periods of falling, by the envelope's other time constant.
    amplitude = REACH * (1 - friction_at(6)) * math.exp(-3 * PERIOD / 0.7e-3)
    assert row[column.TICK] == 9
    assert row[column.FRICTION] == pytest.approx(1 - amplitude / REACH, rel=1e-9)


def woken(delays: list[float], ticks: int) -> list[tuple[int, float]]:
    """The ticks that a loop makes which wakes so late (in periods), and how late each is (s)."""
    made: list[tuple[int, float]] = []
    now, following, wakes = 0.0, 0, 0
    while following < ticks:
        delay = delays[wakes] if wakes < len(delays) else 0.0
        now = min(max(now, following * PERIOD) + delay * PERIOD, ticks * PERIOD - 1e-9)
        wakes += 1
        number = math.floor(now / PERIOD + 1e-6)
        made.append((number, now - number * PERIOD))
        following = number + 1
    return made


@pytest.mark.parametrize(
    "delays", [[], [0.0, 0.3, 1.2, 0.0, 2.7], [0.5] * 30, [7.3, 0.1], [25.0], [0.1, 100.0]]
)
def test_a_run_makes_the_ticks_that_its_delays_leave(plan_of: PlanOf, delays: list[float]) -> None:
    late = np.array(delays) * PERIOD if delays else None
    run = run_ticks(plan_of(), held(0.0), np.zeros(1), 20, late)
    expected = woken(delays, 20)
    assert run.rows[:, column.TICK].tolist() == [number for number, _ in expected]
    np.testing.assert_allclose(
        run.rows[:, column.LATENESS], [one for _, one in expected], atol=3e-9
    )
    assert run.commands[:, column.COMMAND_TICK].tolist() == run.rows[:, column.TICK].tolist()
    assert run.lateness.made == len(expected)
    assert run.lateness.lost == expected[-1][0] + 1 - len(expected)


def test_a_sample_is_heard_by_the_first_tick_after_it_came(plan_of: PlanOf) -> None:
    arrival = np.array([0.0, 2.0, 2.5, 2.9, 7.1]) * PERIOD
    samples = np.concatenate([held(float(one)) for one in arrival])

    def heard(delays: FloatArray | None) -> list[int]:
        run = run_ticks(plan_of(), samples, arrival, 10, delays)
        new = (run.rows[:, column.FLAGS].astype(int) & column.NEW_SAMPLE) != 0
        return [int(one) for one in run.rows[new, column.TICK]]

    assert heard(None) == [0, 2, 3, 8]
    # A tick that is made late has heard what came meanwhile.
    late = np.zeros(10)
    late[7] = 0.2 * PERIOD
    assert heard(late) == [0, 2, 3, 7]


def test_a_sensors_stream_is_a_finger_that_touches() -> None:
    sensor = SensorModel("a sensor", 1000.0, 2e-3, jitter=0.0, noise=1e-6)
    stream = sensor_stream(sensor, lambda t: 0.05 * t, 0.02, seed=1)
    samples = stream_samples(stream, 3e-3)
    assert samples.shape == (stream.stamp.size, 6)
    np.testing.assert_array_equal(samples[:, column.SAMPLE_TIME], stream.stamp)
    np.testing.assert_array_equal(samples[:, column.SAMPLE_X], stream.position)
    assert np.all(samples[:, column.SAMPLE_Y] == 3e-3)
    assert np.all(samples[:, column.SAMPLE_TOUCHING] == 1.0)
    assert np.all(np.isnan(samples[:, [column.SAMPLE_LEVEL, column.SAMPLE_AMPLITUDE]]))
    across = np.linspace(0.0, 1e-3, stream.stamp.size)
    np.testing.assert_array_equal(stream_samples(stream, across)[:, column.SAMPLE_Y], across)
