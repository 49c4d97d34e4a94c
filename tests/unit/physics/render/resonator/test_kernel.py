"""The compiled steps of the compensation: a least plan against scipy, envelopes by hand."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize

from squeezefilm.physics.render.resonator.envelope import (
    DrivenEnvelope,
    compensated_drive,
    preview_samples,
)
from squeezefilm.physics.render.resonator.kernel import (
    AMPLITUDE,
    AT_BOTTOM,
    AT_TOP,
    BOTTOMED,
    FOLLOWS,
    NOT_FINITE,
    PARAMETERS_SIZE,
    SAMPLES,
    SILENT,
    STATE_SIZE,
    TOPPED,
    compensated_march,
    compensated_step,
    envelope_march,
    envelope_step,
    previewed_step,
    previewed_windows,
)

RISE, FALL = 0.7, 0.85


def start(amplitude: float) -> np.ndarray:
    state = np.zeros(STATE_SIZE)
    state[AMPLITUDE] = amplitude
    return state


def limits(bottom: float, top: float, rise: float = RISE, fall: float = FALL) -> np.ndarray:
    parameters = np.array([rise, fall, bottom, top])
    assert parameters.size == PARAMETERS_SIZE
    return parameters


def test_an_envelope_closes_in_faster_or_slower_by_its_way() -> None:
    assert envelope_step(1.0, 3.0, RISE, FALL) == pytest.approx(3.0 - 2.0 * RISE)
    assert envelope_step(3.0, 1.0, RISE, FALL) == pytest.approx(1.0 + 2.0 * FALL)
    assert envelope_step(2.0, 2.0, RISE, FALL) == 2.0
    amplitude = np.empty(4)
    envelope_march(np.array([1.0, 0.0, 0.0, 9.0]), 0.5, RISE, FALL, amplitude)
    after = 1.0 - 0.5 * RISE
    assert amplitude == pytest.approx([0.5, after, after * FALL, after * FALL**2])


@pytest.mark.parametrize(
    ("wanted", "command", "code", "reached"),
    [
        (2.2, 2 + 0.2 / (1 - RISE), FOLLOWS, 2.2),
        (1.9, 2 - 0.1 / (1 - FALL), FOLLOWS, 1.9),
        (2.0, 2.0, FOLLOWS, 2.0),
        (2.4, 3.0, TOPPED, 3.0 - RISE),
        (1.4, -1.0, BOTTOMED, -1 + 3 * FALL),
        (-5.0, -1.0, BOTTOMED, -1 + 3 * FALL),
    ],
)
def test_a_command_brings_the_amplitude_to_what_is_wanted_or_nearest(
    wanted: float, command: float, code: int, reached: float
) -> None:
    state = start(2.0)
    assert compensated_step(state, limits(-1.0, 3.0), wanted) == (pytest.approx(command), code)
    assert state[AMPLITUDE] == pytest.approx(reached)
    assert state[[SAMPLES, AT_TOP, AT_BOTTOM, NOT_FINITE]] == pytest.approx(
        [1, int(code == TOPPED), int(code == BOTTOMED), 0]
    )


@pytest.mark.parametrize("wanted", [math.nan, math.inf, -math.inf])
def test_what_is_no_number_silences_the_drive_and_is_counted(wanted: float) -> None:
    state, work = start(2.0), np.empty((5, 8))
    assert compensated_step(state, limits(-1.0, 3.0), wanted) == (0.0, SILENT)
    assert previewed_step(state, limits(-1.0, 3.0), np.array([1.0, wanted]), work) == (0.0, SILENT)
    assert state[AMPLITUDE] == pytest.approx(2.0 * FALL**2)
    assert state[[SAMPLES, AT_TOP, AT_BOTTOM, NOT_FINITE]] == pytest.approx([2, 0, 0, 2])


def test_a_block_looks_one_sample_ahead_and_holds_the_last() -> None:
    wanted, parameters = np.array([9.0, 1.1, 1.2, 1.0]), limits(-9.0, 9.0)
    command, code, state = np.empty(4), np.empty(4, dtype=np.int64), start(1.0)
    compensated_march(state, parameters, wanted, command, code)
    amplitude = np.empty(4)
    envelope_march(command, 1.0, RISE, FALL, amplitude)
    assert amplitude == pytest.approx([1.0, 1.1, 1.2, 1.0])
    assert (state[AMPLITUDE], state[SAMPLES]) == (pytest.approx(1.0), 4)
    assert list(code) == [FOLLOWS] * 4


def least_plan(amplitude: float, parameters: np.ndarray, wanted: np.ndarray) -> float:
    """The first amplitude of the plan with the least squared error, by scipy."""
    rise, fall, bottom, top = parameters

    def span(a: float) -> tuple[float, float]:
        return max(fall * a + (1 - fall) * bottom, 0.0), rise * a + (1 - rise) * top

    low, high = span(amplitude)
    constraints: list[dict[str, Any]] = []
    for j in range(1, wanted.size):
        constraints += [
            {"type": "ineq",
             "fun": lambda a, j=j: a[j] - (fall * a[j - 1] + (1 - fall) * bottom)},
            {"type": "ineq",
             "fun": lambda a, j=j: rise * a[j - 1] + (1 - rise) * top - a[j]},
        ]  # fmt: skip
    begin = [low + 0.5 * (high - low)]
    for _ in range(1, wanted.size):
        ends = span(begin[-1])
        begin.append(0.5 * (ends[0] + ends[1]))
    found = minimize(
        lambda a: np.sum((a - wanted) ** 2), begin, jac=lambda a: 2 * (a - wanted),
        bounds=[(low, high)] + [(0.0, None)] * (wanted.size - 1), constraints=constraints,
        method="SLSQP", options={"ftol": 1e-13, "maxiter": 500},
    )  # fmt: skip
    # 8: no better place along the line, to rounding.
    assert found.status in (0, 8)
    return float(found.x[0])


@pytest.mark.parametrize("bottom", [0.0, -1.5])
def test_the_first_step_of_a_plan_is_that_of_the_least_error(bottom: float) -> None:
    for seed in range(12):
        random = np.random.default_rng(seed)
        parameters = limits(bottom, 2.0, *(0.4 + 0.5 * random.random(2)))
        amplitude = 2.0 * random.random()
        wanted = random.choice([0.0, 0.3, 1.0, 1.9], 6) + 0.1 * random.random(6)
        state = start(amplitude)
        command, _ = previewed_step(state, parameters, wanted, np.empty((5, 14)))
        assert bottom <= command <= 2.0
        least = least_plan(amplitude, parameters, wanted)
        assert state[AMPLITUDE] == pytest.approx(least, abs=1e-5), seed


def test_a_plan_of_one_sample_is_the_step_without_a_view() -> None:
    for wanted in (0.0, 0.6, 0.9, 1.4):
        plain, planned = start(0.8), start(0.8)
        one = compensated_step(plain, limits(-0.5, 2.0), wanted)
        two = previewed_step(planned, limits(-0.5, 2.0), np.array([wanted]), np.empty((5, 4)))
        assert two[0] == pytest.approx(one[0])
        assert planned[AMPLITUDE] == pytest.approx(plain[AMPLITUDE])


def test_only_what_rises_ahead_makes_it_rise_early() -> None:
    # A view of a far step up: without it the amplitude would stay at what is wanted now.
    wanted = np.array([0.2, 0.2, 1.8, 1.8])
    state = start(0.2)
    previewed_step(state, limits(0.0, 2.0), wanted, np.empty((5, 10)))
    assert 0.2 < state[AMPLITUDE] < 2.0 - 1.8 * RISE
    flat = start(0.2)
    assert previewed_step(flat, limits(0.0, 2.0), np.full(4, 0.2), np.empty((5, 10)))[0] == (
        pytest.approx(0.2)
    )


def test_each_window_is_seen_by_its_own_step() -> None:
    wanted = np.array([0.0, 0.2, 1.5, 1.5, 0.1, 0.9])
    work, ahead = np.empty((5, 8)), 3
    parameters = limits(-0.5, 2.0)
    windows = np.array([[wanted[min(k + 1 + j, 5)] for j in range(ahead)] for k in range(6)])
    command, code, state = np.empty(6), np.empty(6, dtype=np.int64), start(0.4)
    previewed_windows(state, parameters, windows, work, command, code)
    other = start(0.4)
    each = [previewed_step(other, parameters, row, work) for row in windows]
    assert list(code) == [c for _, c in each]
    assert [c for c, _ in each] == pytest.approx(list(command), abs=0)
    assert other == pytest.approx(state, abs=0)


@pytest.mark.parametrize("wanted", [[0.3], [0.0, 0.2, 1.5, 1.5, 0.1, 0.9]])
def test_a_preview_sees_the_last_sample_hold(wanted: list[float]) -> None:
    envelope, step = DrivenEnvelope(2e-3, 3e-3, 1.2, braking=True), 1e-3
    ahead, last = preview_samples(envelope, step), len(wanted) - 1
    state, parameters = envelope.new_state(wanted[0]), envelope.parameters(step)
    work = np.empty((5, 2 * ahead + 2))
    each = [
        previewed_step(
            state,
            parameters,
            np.array([wanted[min(k + 1 + j, last)] for j in range(ahead)]),
            work,
        )[0]
        for k in range(len(wanted))
    ]
    found = compensated_drive(np.array(wanted), step, envelope, "preview").command
    assert found == pytest.approx(each, abs=0)
