"""One step of the estimator: a Kalman filter with matrices says the same, and every refusal."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import expm

from squeezefilm.physics.render.motion import kernel
from squeezefilm.physics.render.motion.kernel import motion_at, motion_march, motion_step

# qa, qj, position and stamp variance, speed and acceleration variance, gate², stall, rejected.
PARAMETERS = np.array([0.3, 40.0, 4e-10, 1e-8, 0.0225, 4.0, 25.0, 0.05, 3.0])
COVARIANCE = [kernel.XX, kernel.XV, kernel.XA, kernel.XV, kernel.VV, kernel.VA,
              kernel.XA, kernel.VA, kernel.AA]  # fmt: skip


def split(state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    mean = state[[kernel.X, kernel.V, kernel.A]]
    return mean, state[COVARIANCE].reshape(3, 3)


def carried(mean: np.ndarray, P: np.ndarray, h: float) -> tuple[np.ndarray, np.ndarray]:
    """Over h: jerk and acceleration driven by white noise; Van Loan's integral of the noise."""
    F = np.diag([1.0, 1.0], 1)
    noise = np.diag([0.0, PARAMETERS[0], PARAMETERS[1]])
    block = np.zeros((6, 6))
    block[:3, :3], block[:3, 3:], block[3:, 3:] = -F, noise, F.T
    whole = expm(block * h)
    Phi = whole[3:, 3:].T
    return Phi @ mean, Phi @ P @ Phi.T + Phi @ whole[:3, 3:]


def begun() -> np.ndarray:
    state = np.zeros(kernel.STATE_SIZE)
    assert motion_step.py_func(state, PARAMETERS, 1.0, 0.02) == kernel.STEP_STARTED
    return state


def test_it_begins_at_rest_where_the_first_sample_is() -> None:
    mean, P = split(begun())
    assert mean == pytest.approx([0.02, 0.0, 0.0])
    assert pytest.approx(np.diag([4e-10, 0.0225, 4.0])) == P


def test_steps_are_those_of_a_kalman_filter() -> None:
    state = begun()
    mean, P = split(state)
    stamp = 1.0
    for k, h in enumerate((0.001, 0.004, 0.02, 0.0005, 0.03)):
        stamp += h
        mean, P = carried(mean, P, stamp - state[kernel.STAMP])
        position = mean[0] + 2e-5 * (-1) ** k
        # A stamp that is off by δ shifts the place by vδ.
        spread = P[0, 0] + 4e-10 + 1e-8 * (mean[1] ** 2 + P[1, 1])
        gain = P[:, 0] / spread
        assert motion_step.py_func(state, PARAMETERS, stamp, position) == kernel.STEP_USED
        mean, P = mean + gain * (position - mean[0]), P - np.outer(gain, P[0])
        found, covariance = split(state)
        assert found == pytest.approx(mean, rel=1e-9, abs=1e-15)
        assert covariance == pytest.approx(P, rel=1e-6, abs=1e-16)
        mean, P = found, covariance
    assert state[kernel.USED] == 6


def test_a_look_ahead_carries_the_mean_and_its_doubt() -> None:
    state = begun()
    motion_step.py_func(state, PARAMETERS, 1.01, 0.021)
    mean, P = split(state)
    for h in (0.0, 0.004, 0.0499):
        there, around = carried(mean, P, h)
        x, v, dx, dv, code = motion_at.py_func(state, PARAMETERS, 1.01 + h)
        assert (x, v) == (pytest.approx(there[0]), pytest.approx(there[1]))
        assert (dx, dv) == pytest.approx(np.sqrt(np.diag(around)[:2]), rel=1e-6)
        assert code == kernel.FRESH
    # A little before the last sample it is carried back at the speed that it has there.
    x, v, dx, _, code = motion_at.py_func(state, PARAMETERS, 1.008)
    assert (x, v) == (pytest.approx(mean[0] - 0.002 * mean[1]), mean[1])
    assert (dx, code) == (pytest.approx(math.sqrt(P[0, 0])), kernel.FRESH)


def test_a_time_too_far_off_or_none_lets_the_finger_rest() -> None:
    state = begun()
    assert motion_at.py_func(np.zeros(kernel.STATE_SIZE), PARAMETERS, 1.0) == (
        0.0, 0.0, math.inf, math.inf, kernel.EMPTY,
    )  # fmt: skip
    motion_step.py_func(state, PARAMETERS, 1.01, 0.021)
    mean, _ = split(state)
    rest = mean[0] + 0.05 * mean[1] + 0.05**2 / 2 * mean[2]
    for t, x, code in (
        (1.0601, rest, kernel.STALLED), (99.0, rest, kernel.STALLED),
        (0.9599, mean[0], kernel.PAST),
        (math.nan, mean[0], kernel.BAD_TIME), (math.inf, mean[0], kernel.BAD_TIME),
    ):  # fmt: skip
        found = motion_at.py_func(state, PARAMETERS, t)
        assert found == (pytest.approx(x), 0.0, math.inf, math.inf, code)


@pytest.mark.parametrize(
    ("stamp", "position", "code", "counted"),
    [
        (math.nan, 0.02, kernel.STEP_NOT_FINITE, [kernel.NOT_FINITE]),
        (1.001, math.inf, kernel.STEP_NOT_FINITE, [kernel.NOT_FINITE]),
        (1.0, 0.5, kernel.STEP_DUPLICATE, [kernel.DUPLICATE]),
        (0.951, 0.5, kernel.STEP_BACKWARDS, [kernel.BACKWARDS]),
        (0.9, 0.5, kernel.STEP_STARTED, [kernel.BACKWARDS, kernel.RESTART, kernel.USED]),
        (1.051, 0.5, kernel.STEP_STARTED, [kernel.STALL, kernel.RESTART, kernel.USED]),
        (1.001, 0.5, kernel.STEP_OUTLIER, [kernel.OUTLIER]),
    ],
)
def test_a_sample_that_is_not_taken_is_counted_and_leaves_the_estimate(
    stamp: float, position: float, code: int, counted: list[int]
) -> None:
    state = begun()
    before = state.copy()
    assert motion_step.py_func(state, PARAMETERS, stamp, position) == code
    counters = slice(kernel.USED, kernel.RESTART + 1)
    changed = state[counters] - before[counters]
    expected = np.zeros(changed.size)
    expected[np.array(counted) - kernel.USED] = 1
    assert changed == pytest.approx(expected)
    if code == kernel.STEP_STARTED:
        assert state[[kernel.STAMP, kernel.X]] == pytest.approx([stamp, position])
        assert split(state)[1] == pytest.approx(np.diag([4e-10, 0.0225, 4.0]))
    else:
        assert state[: kernel.REJECTED_IN_A_ROW] == pytest.approx(
            before[: kernel.REJECTED_IN_A_ROW]
        )


def test_the_gate_is_five_deviations_wide() -> None:
    P = carried(*split(begun()), 0.001)[1]
    deviation = math.sqrt(P[0, 0] + 4e-10 + 1e-8 * P[1, 1])
    for misses, code in ((4.999, kernel.STEP_USED), (5.001, kernel.STEP_OUTLIER)):
        for sign in (1, -1):
            state = begun()
            place = 0.02 + sign * misses * deviation
            assert motion_step.py_func(state, PARAMETERS, 1.001, place) == code


def test_the_third_outlier_in_a_row_is_where_the_finger_is() -> None:
    state = begun()
    for k, code in enumerate([kernel.STEP_OUTLIER, kernel.STEP_OUTLIER, kernel.STEP_STARTED]):
        assert motion_step.py_func(state, PARAMETERS, 1.001 + 0.001 * k, 0.5) == code
    assert state[[kernel.OUTLIER, kernel.RESTART, kernel.REJECTED_IN_A_ROW]] == pytest.approx(
        [3, 1, 0]
    )
    # A sample that fits between them begins the count anew.
    state = begun()
    for stamp, place, code in (
        (1.001, 0.5, kernel.STEP_OUTLIER), (1.002, 0.5, kernel.STEP_OUTLIER),
        (1.003, 0.02, kernel.STEP_USED), (1.004, 0.5, kernel.STEP_OUTLIER),
    ):  # fmt: skip
        assert motion_step.py_func(state, PARAMETERS, stamp, place) == code


def test_a_march_takes_what_has_arrived_and_looks_ahead() -> None:
    stamp = np.array([1.0, 1.002, 1.004, 1.006])
    arrival = stamp + np.array([0.001, 0.004, 0.002, 0.002])  # two together, at 1.006
    position = 0.02 + 0.1 * (stamp - 1.0)
    render = np.array([0.9, 1.001, 1.005, 1.006, 1.008, 1.1])
    out = np.empty((4, 6))
    code = np.empty(6, dtype=np.int64)
    state = np.zeros(kernel.STATE_SIZE)
    motion_march.py_func(state, PARAMETERS, stamp, arrival, position, render, 0.003, out, code)
    other, taken = np.zeros(kernel.STATE_SIZE), 0
    for i, has in enumerate((0, 1, 1, 3, 4, 4)):
        for k in range(taken, has):
            motion_step.py_func(other, PARAMETERS, stamp[k], position[k])
        taken = has
        expected = motion_at.py_func(other, PARAMETERS, render[i] + 0.003)
        assert (*out[:, i], code[i]) == pytest.approx(expected)
    assert list(code) == [kernel.EMPTY] + [kernel.FRESH] * 4 + [kernel.STALLED]
    assert state == pytest.approx(other)
