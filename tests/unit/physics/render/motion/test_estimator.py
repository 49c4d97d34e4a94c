"""The estimator among samples that are late, double, absurd or missing: defined, safe, counted."""

from __future__ import annotations

import dataclasses
import json
import math

import numba
import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.quantities import FloatArray
from squeezefilm.core.results import to_json
from squeezefilm.physics.render.motion import kernel
from squeezefilm.physics.render.motion.estimator import (
    LVDT_10_KHZ,
    TOUCH_PANEL_60_HZ,
    MotionCounts,
    MotionEstimator,
    MotionModel,
    SensorStream,
    estimate_motion,
    sensor_stream,
)
from squeezefilm.physics.render.motion.stroke import MinimumJerkStroke
from squeezefilm.physics.render.resonator import kernel as compensation_kernel
from squeezefilm.physics.render.resonator.envelope import (
    DrivenEnvelope,
    carrier_block,
    preview_work,
)

ESTIMATOR = MotionEstimator(MotionModel(), 2e-5)


def fed(samples: int = 50, interval: float = 0.01, speed: float = 0.1) -> FloatArray:
    state = ESTIMATOR.new_state()
    for k in range(samples):
        kernel.motion_step(state, ESTIMATOR.parameters(), k * interval, speed * k * interval)
    return state


def step(state: FloatArray, stamp: float, position: float) -> int:
    return int(kernel.motion_step(state, ESTIMATOR.parameters(), stamp, position))


def estimate(state: FloatArray) -> FloatArray:
    return state[: kernel.USED].copy()


@pytest.mark.parametrize(("stamp", "position"), [
    (math.nan, 0.05), (0.5, math.nan), (math.inf, 0.05), (0.5, -math.inf),
])  # fmt: skip
def test_what_is_not_finite_changes_nothing_and_is_counted(stamp: float, position: float) -> None:
    state = fed()
    before = estimate(state)
    assert step(state, stamp, position) == kernel.STEP_NOT_FINITE
    assert np.array_equal(estimate(state), before)
    assert MotionCounts.of(state).not_finite == 1
    fresh = ESTIMATOR.new_state()
    assert step(fresh, stamp, position) == kernel.STEP_NOT_FINITE
    assert fresh[kernel.ALIVE] == 0


def test_a_stamp_met_twice_counts_once() -> None:
    state = fed()
    before = estimate(state)
    assert step(state, 0.49, 0.9) == kernel.STEP_DUPLICATE
    assert np.array_equal(estimate(state), before)
    assert MotionCounts.of(state).duplicate == 1


def test_time_that_runs_back_a_little_is_skipped_and_far_is_another_clock() -> None:
    state = fed()
    before = estimate(state)
    assert step(state, 0.45, 0.045) == kernel.STEP_BACKWARDS
    assert np.array_equal(estimate(state), before)
    assert step(state, -7.0, 0.03) == kernel.STEP_STARTED
    assert state[kernel.STAMP] == -7.0
    assert MotionCounts.of(state).backwards == 2
    assert MotionCounts.of(state).restart == 1


def test_one_absurd_stamp_in_the_far_future_does_not_deafen() -> None:
    state = fed()
    assert step(state, 1e9, 0.05) == kernel.STEP_STARTED
    assert step(state, 0.50, 0.05) == kernel.STEP_STARTED
    assert step(state, 0.51, 0.051) == kernel.STEP_USED


def test_an_outlier_is_refused_and_a_finger_put_down_elsewhere_is_found() -> None:
    state = fed()
    before = estimate(state)[: kernel.REJECTED_IN_A_ROW]
    assert step(state, 0.50, 0.09) == kernel.STEP_OUTLIER
    assert np.array_equal(estimate(state)[: kernel.REJECTED_IN_A_ROW], before)
    assert step(state, 0.51, 0.051) == kernel.STEP_USED
    for k in range(2):
        assert step(state, 0.52 + 0.01 * k, 0.09) == kernel.STEP_OUTLIER
    assert step(state, 0.54, 0.09) == kernel.STEP_STARTED
    assert MotionCounts.of(state).outlier == 4
    x, v, *_ = kernel.motion_at(state, ESTIMATOR.parameters(), 0.54)
    assert (x, v) == (0.09, 0.0)


def test_a_lost_finger_rests_and_says_so() -> None:
    state = fed()
    parameters = ESTIMATOR.parameters()
    at_limit = kernel.motion_at(state, parameters, 0.49 + 0.1 - 1e-12)
    assert at_limit[4] == kernel.FRESH
    for late in (0.6, 5.0, 1e12):
        x, v, dx, dv, code = kernel.motion_at(state, parameters, late)
        assert code == kernel.STALLED
        assert x == pytest.approx(at_limit[0], abs=1e-9)
        assert v == 0.0
        assert dx == dv == math.inf
    assert step(state, 5.0, 0.02) == kernel.STEP_STARTED
    assert MotionCounts.of(state).stall == 1


def test_nothing_known_and_bad_times_give_finite_numbers_with_a_code() -> None:
    parameters = ESTIMATOR.parameters()
    x, v, dx, _, code = kernel.motion_at(ESTIMATOR.new_state(), parameters, 1.0)
    assert (x, v, dx, code) == (0.0, 0.0, math.inf, kernel.EMPTY)
    state = fed()
    x, v, _, _, code = kernel.motion_at(state, parameters, math.nan)
    assert (v, code) == (0.0, kernel.BAD_TIME)
    assert math.isfinite(x)
    x, v, dx, _, code = kernel.motion_at(state, parameters, 0.2)
    assert (x, v, dx, code) == (state[kernel.X], 0.0, math.inf, kernel.PAST)


def test_a_time_just_before_the_last_sample_is_carried_back_along_the_way() -> None:
    state = fed(samples=400)
    x, v, _, _, code = kernel.motion_at(state, ESTIMATOR.parameters(), 3.98)
    assert code == kernel.FRESH
    assert (x, v) == pytest.approx((0.398, 0.1), abs=1e-9)


def test_the_interpreted_step_is_the_compiled_one() -> None:
    random = np.random.default_rng(0)
    one, other = ESTIMATOR.new_state(), ESTIMATOR.new_state()
    parameters, t = ESTIMATOR.parameters(), 0.0
    gaps = [0.0, 0.004, 0.02, -0.01, 0.3, math.nan]
    for _ in range(300):
        t += float(random.choice(gaps, p=[0.05, 0.5, 0.4, 0.02, 0.02, 0.01]))
        if math.isnan(t):
            t = 0.0
        z = 0.1 * t + float(random.choice([0.0, 1e-5, 0.5], p=[0.5, 0.45, 0.05]))
        assert kernel.motion_step(one, parameters, t, z) == kernel.motion_step.py_func(
            other, parameters, t, z
        )
    assert one == pytest.approx(other, rel=1e-9, abs=1e-18)
    assert MotionCounts.of(one).restart > 0


def test_arrays_and_single_steps_are_the_same_estimator() -> None:
    hand = MinimumJerkStroke()
    stream = sensor_stream(TOUCH_PANEL_60_HZ, hand.position, hand.duration, seed=2)
    estimator = MotionEstimator.for_sensor(TOUCH_PANEL_60_HZ)
    render = np.linspace(0.0, hand.duration, 301)
    whole = estimate_motion(estimator, stream, render, ahead=1e-3)
    state, parameters, k = estimator.new_state(), estimator.parameters(), 0
    for i, now in enumerate(render):
        while k < stream.stamp.size and stream.arrival[k] <= now:
            kernel.motion_step(state, parameters, stream.stamp[k], stream.position[k])
            k += 1
        x, v, *_ = kernel.motion_at(state, parameters, now + 1e-3)
        assert (whole.position[i], whole.speed[i]) == (x, v)
    assert whole.time == pytest.approx(render + 1e-3)
    assert not whole.fresh[0]
    assert whole.fresh[-1]
    assert whole.counts == MotionCounts.of(state)


def test_settings_and_estimates_become_strict_json() -> None:
    stream = sensor_stream(LVDT_10_KHZ, lambda t: 0.1 * t, 0.01, seed=0)
    found = estimate_motion(MotionEstimator.for_sensor(LVDT_10_KHZ), stream, np.array([0.0, 0.01]))
    data = json.loads(json.dumps(to_json(found), allow_nan=False))
    assert data["position_deviation_m"][0] is None
    assert data["estimator"]["model"]["jerk_density_m2_per_s5"] == 40.0
    assert data["fresh"] == [False, True]


@pytest.mark.parametrize(("build", "word"), [
    (lambda: MotionModel(0.0, 0.0), "both 0"),
    (lambda: MotionModel(0.1, 0.0, 0.1, 1.0), "without jerk"),
    (lambda: MotionModel(jerk_density=-1.0), "jerk_density"),
    (lambda: MotionModel(speed_deviation=0.0), "speed_deviation"),
    (lambda: MotionEstimator(MotionModel(), 0.0), "position_error"),
    (lambda: dataclasses.replace(ESTIMATOR, gate=0.0), "gate"),
    (lambda: dataclasses.replace(ESTIMATOR, most_rejected=0), "most_rejected"),
    (lambda: dataclasses.replace(ESTIMATOR, stall=math.nan), "stall"),
    (lambda: MinimumJerkStroke(passes=0), "passes"),
    (lambda: MinimumJerkStroke(pass_duration=0.0), "pass_duration"),
    (lambda: MinimumJerkStroke().position(-1.0), "t = -1 s"),
])  # fmt: skip
def test_senseless_settings_are_refused(build: object, word: str) -> None:
    with pytest.raises(InputError, match=word):
        build()  # type: ignore[operator]


@pytest.mark.parametrize("times", [[], [1.0, 0.5], [math.nan], [[0.0, 1.0]]])
def test_senseless_render_times_are_refused(times: list[float]) -> None:
    stream = SensorStream(LVDT_10_KHZ, 0, *np.zeros((4, 1)))
    with pytest.raises(InputError, match="render"):
        estimate_motion(ESTIMATOR, stream, np.array(times))


def test_a_minimum_jerk_pass_has_its_length_speed_and_jerk() -> None:
    hand = MinimumJerkStroke(0.04, 0.4, 3, start=0.01)
    t = np.linspace(0.0, hand.duration, 120_001)
    x = hand.position(t)
    assert x[[0, 40_000, 80_000, -1]] == pytest.approx([0.01, 0.05, 0.01, 0.05], abs=1e-15)
    # 15/8 of the mean speed in the middle of each pass.
    assert np.max(np.abs(np.gradient(x, t))) == pytest.approx(1.875 * 0.04 / 0.4, rel=1e-6)
    one = np.linspace(0.0, 0.4, 2001)
    jerk = np.diff(hand.position(one), 3) / (one[1] - one[0]) ** 3
    # 720 L²/T⁶, on which the default of the motion model rests.
    assert np.mean(jerk**2) == pytest.approx(720 * 0.04**2 / 0.4**6, rel=0.01)


def allocations(count: int) -> int:
    """Allocations that numba's own runtime counts over `count` steps of every kind."""
    from numba.core.runtime import _nrt_python, rtsys

    stamps = np.arange(count) * 1e-3
    out, code = np.empty((4, count)), np.empty(count, dtype=np.int64)
    envelope = DrivenEnvelope(1e-3, 2e-3, 1e-6, braking=True)
    wanted = np.abs(np.sin(stamps * 700)) * 1e-6
    windows, work = np.tile(wanted[:20], (count, 1)), preview_work(20)
    states = ESTIMATOR.new_state(), envelope.new_state()
    settings = ESTIMATOR.parameters(), envelope.parameters(1e-4)
    seen = 0.1 * stamps
    _nrt_python.memsys_enable_stats()
    try:
        before = rtsys.get_allocation_stats().alloc
        kernel.motion_march(states[0], settings[0], stamps, stamps, seen, stamps, 1e-3, out, code)
        compensation_kernel.compensated_march(states[1], settings[1], wanted, out[0], code)
        compensation_kernel.previewed_windows(states[1], settings[1], windows, work, out[0], code)
        carrier_block(0.0, 1.0, wanted[: count // 4], 4, 1.0, out[1])
        handed_over = int(rtsys.get_allocation_stats().alloc - before)
        allocating(count)
        assert rtsys.get_allocation_stats().alloc >= before + handed_over + count
    finally:
        _nrt_python.memsys_disable_stats()
    return handed_over


def test_no_compiled_step_allocates() -> None:
    """Each array handed over from Python costs one, whatever the number of steps."""
    allocations(100)
    assert allocations(2000) == allocations(100) < 40


@numba.njit  # type: ignore[untyped-decorator]
def allocating(count: int) -> float:
    """An array per step, allocated inside compiled code: what the test must be able to see."""
    total = 0.0
    for k in range(count):
        total += np.full(k + 1, 1.0)[k]
    return total
