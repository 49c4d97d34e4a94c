"""Compensation against closed forms, a general solver, and the carrier-level resonator."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import minimize
from tests.verification.second_order import carried
from tests.verification.square_swing import Way, fastest_compensated_speed, square_swing_compensated

from squeezefilm.physics.render.resonator import kernel
from squeezefilm.physics.render.resonator.envelope import (
    DrivenEnvelope,
    compensated_drive,
    envelope_time_constant,
    finest_period,
    preview_work,
)

# The paper's plate: solved resonance and assumed Q (page of models); limits in units of a_max.
FREQUENCY, Q = 33.583e3, 60.0
TAU = float(envelope_time_constant(Q, FREQUENCY))
LIMIT = 1e-6
PERIOD = 0.4e-3


def plate(braking: bool) -> DrivenEnvelope:
    return DrivenEnvelope(TAU, TAU, LIMIT, braking)


# Rest is reached only with phase inversion; without, the closed form refuses it.
@pytest.mark.parametrize(
    ("start", "target", "braking"),
    [(0.0, 0.8, False), (0.2, 0.95, True), (0.8, 0.1, False), (0.8, 0.1, True), (1.0, 0.0, True)],
)
def test_a_saturated_step_takes_the_time_of_the_closed_form(
    start: float, target: float, braking: bool
) -> None:
    step = TAU / 2000
    wanted = np.full(12_000, target * LIMIT)
    wanted[0] = start * LIMIT
    envelope = plate(braking)
    amplitude = envelope.response(
        compensated_drive(wanted, step, envelope).command, step, float(wanted[0])
    )
    limit = LIMIT if target > start else envelope.lowest_command
    law = TAU * math.log((limit - start * LIMIT) / (limit - target * LIMIT))
    reached = np.flatnonzero(np.abs(amplitude - target * LIMIT) < 1e-12 * LIMIT)[0] * step
    assert law - 1e-9 * TAU <= reached <= law + step
    # On the way the amplitude is the exponential towards the limit, afterwards exactly the target.
    t = np.arange(wanted.size) * step
    exact = np.where(t < law, limit + (start * LIMIT - limit) * np.exp(-t / TAU), target * LIMIT)
    away = np.abs(t - law) > 2 * step
    np.testing.assert_allclose(amplitude[away], exact[away], rtol=0, atol=1e-12 * LIMIT)


def test_the_paper_plate_at_twice_the_speed() -> None:
    """0.4 mm, swing to 0.8 of full amplitude, 90 % kept: with phase inversion twice the speed."""
    bare = fastest_compensated_speed(PERIOD, plate(True), 0.0, 0.8 * LIMIT, "none")
    assert bare == pytest.approx(PERIOD / (TAU * 2 * math.log(19)), rel=1e-9)
    assert bare == pytest.approx(PERIOD / float(finest_period(1.0, TAU)), rel=1e-9)
    braked = fastest_compensated_speed(PERIOD, plate(True), 0.0, 0.8 * LIMIT)
    # Half a period has to rise from 0 to 0.72: ln(1/0.28) time constants.
    assert braked == pytest.approx(PERIOD / (2 * TAU * math.log(1 / 0.28)), rel=1e-9)
    assert braked / bare >= 2.0
    # Without inversion the fall is the resonator's own: half a period for ln 10.
    own = fastest_compensated_speed(PERIOD, plate(False), 0.0, 0.8 * LIMIT)
    assert own == pytest.approx(PERIOD / (2 * TAU * math.log(10)), rel=1e-9)
    assert own / bare < 1.3


def test_what_is_possible_at_full_amplitude() -> None:
    bare = fastest_compensated_speed(PERIOD, plate(True), 0.0, LIMIT, "none")
    own = fastest_compensated_speed(PERIOD, plate(False), 0.0, LIMIT)
    braked = fastest_compensated_speed(PERIOD, plate(True), 0.0, LIMIT)
    assert own == pytest.approx(bare, rel=1e-9)  # the plain command is already at both limits
    assert braked / bare == pytest.approx(math.log(19) / math.log(10), rel=1e-9)


@pytest.mark.parametrize("braking", [False, True])
@pytest.mark.parametrize(("low", "high"), [(0.0, 0.8), (0.2, 0.8), (0.0, 1.0), (0.5, 0.55)])
@pytest.mark.parametrize("ratio", [0.3, 1.5, 2.6, 4.7, 12.0])
@pytest.mark.parametrize("taus", [(1.0, 1.0), (1.0, 2.5)])
def test_a_simulated_square_keeps_what_the_closed_form_says(
    braking: bool, low: float, high: float, ratio: float, taus: tuple[float, float]
) -> None:
    envelope = DrivenEnvelope(taus[0] * TAU, taus[1] * TAU, LIMIT, braking)
    samples, step = 2000, ratio * TAU / 2000
    cycles = math.ceil(60 / ratio)
    # The command over a step leads to the sample after it: the edge lies on samples.
    wanted = np.where(np.arange(cycles * samples) % samples < samples // 2, high, low) * LIMIT
    ways: tuple[Way, ...] = ("none", "inverse")
    for compensation in ways:
        drive = compensated_drive(wanted, step, envelope, compensation)
        amplitude = envelope.response(drive.command, step, float(wanted[0]))
        kept = np.ptp(amplitude[-2 * samples :]) / ((high - low) * LIMIT)
        law = square_swing_compensated(
            ratio * TAU, 1.0, envelope, low * LIMIT, high * LIMIT, compensation
        )
        assert kept == pytest.approx(law, abs=2e-3 * ratio)
    if taus[0] == taus[1]:
        bare = square_swing_compensated(
            ratio * TAU, 1.0, envelope, low * LIMIT, high * LIMIT, "none"
        )
        assert bare == pytest.approx(math.tanh(ratio / 4), rel=1e-12)


@pytest.mark.parametrize("braking", [False, True])
@pytest.mark.parametrize(
    "taus",
    [(1.0, 2.0), *(pytest.param(one, marks=pytest.mark.slow) for one in ((1.0, 1.0), (3.0, 1.0)))],
)
def test_the_previewed_plan_is_the_least_squares_of_a_general_solver(
    braking: bool, taus: tuple[float, float]
) -> None:
    random, count = np.random.default_rng(7), 12
    envelope = DrivenEnvelope(*taus, 1.0, braking)
    rise, fall, bottom, top = parameters = envelope.parameters(0.15)
    solved = 0
    for trial in range(12):
        wanted = random.uniform(0, 1.2, count) if trial % 2 else (random.random(count) > 0.5) * 1.0
        start = float(random.uniform(0, 1))

        def room(a: np.ndarray, start: float = start) -> np.ndarray:
            before = np.concatenate([[start], a[:-1]])
            up, down = rise * before + (1 - rise) * top, fall * before + (1 - fall) * bottom
            return np.concatenate([up - a, a - down, a])

        found = minimize(
            lambda a, w=wanted: np.sum((a - w) ** 2), np.full(count, start),
            jac=lambda a, w=wanted: 2 * (a - w), method="SLSQP",
            constraints={"type": "ineq", "fun": room}, options={"ftol": 1e-14, "maxiter": 500},
        )  # fmt: skip
        # Step by step over what is left of the window the plan unfolds whole.
        state, plan = envelope.new_state(start), np.empty(count)
        for k in range(count):
            kernel.previewed_step(state, parameters, wanted[k:], preview_work(count))
            plan[k] = state[kernel.AMPLITUDE]
        cost = float(np.sum((plan - wanted) ** 2))
        # The general solver stops short of its optimum now and then, but is never below it.
        assert cost <= found.fun + 1e-9
        if found.success:
            solved += 1
            assert plan == pytest.approx(found.x, abs=1e-4)
    assert solved >= 6


def test_preview_never_errs_more_than_the_inverse_and_less_at_a_fast_grating() -> None:
    step = TAU / 40
    wanted = np.where((np.arange(4000) * step / (2.6 * TAU)) % 1 < 0.5, 0.8, 0.0) * LIMIT
    rms = {}
    for compensation in ("none", "inverse", "preview"):
        command = compensated_drive(wanted, step, plate(True), compensation).command
        amplitude = plate(True).response(command, step, float(wanted[0]))
        rms[compensation] = float(np.sqrt(np.mean((amplitude - wanted) ** 2)))
    assert rms["preview"] < 0.75 * rms["inverse"] < 0.75 * rms["none"]


@pytest.mark.parametrize("error", [-0.2, 0.1, 0.2])
def test_a_wrong_time_constant_leaves_its_share_of_a_step(error: float) -> None:
    """Unsaturated: the true envelope jumps to w(1 − exp(−Δt/τ'))/(1 − E), then decays to w."""
    believed = DrivenEnvelope(TAU, TAU, 100 * LIMIT, braking=True)
    step = TAU / 20
    wanted = np.full(400, 0.5 * LIMIT)
    wanted[0] = 0.0
    command = compensated_drive(wanted, step, believed).command
    true = DrivenEnvelope(TAU * (1 + error), TAU * (1 + error), LIMIT).response(command, step)
    off = true[1:] / (0.5 * LIMIT) - 1
    first = math.expm1(-step / (TAU * (1 + error))) / math.expm1(-step / TAU) - 1
    assert off[0] == pytest.approx(first, rel=1e-9)
    assert first == pytest.approx(-error / (1 + error), rel=0.1)
    assert off[20] == pytest.approx(first * math.exp(-1 / (1 + error)), rel=1e-9)


def test_a_held_carrier_settles_at_the_amplitude_commanded() -> None:
    """The hold takes sinc(f/f_s) of it, 5 % at 33.6 kHz and 192 kHz, unless made up for."""
    settled = 20 * round(TAU * 192e3)
    command = np.full(settled, LIMIT)
    for compensated, level in ((True, 1.0), (False, float(np.sinc(FREQUENCY / 192e3)))):
        trace = carried(command, 1, FREQUENCY, Q, made_up=compensated)
        assert np.mean(trace.amplitude[-300:]) == pytest.approx(level * LIMIT, rel=2e-3)
    assert np.sinc(FREQUENCY / 192e3) == pytest.approx(0.95, abs=0.001)


def test_off_resonance_the_carrier_holds_the_amplitude_of_the_second_order_response() -> None:
    detuned = FREQUENCY * (1 + 1 / (2 * Q))
    trace = carried(np.full(6000, LIMIT), 1, detuned, Q, resonance=FREQUENCY)
    r = detuned / FREQUENCY
    gain = 1 / (Q * math.hypot(1 - r**2, r / Q))
    assert np.max(np.abs(trace.displacement[-1000:])) == pytest.approx(gain * LIMIT, rel=3e-3)
    assert gain == pytest.approx(1 / math.sqrt(2), rel=0.01)


def test_the_envelope_model_errs_by_the_order_of_one_over_q() -> None:
    """A step up and one down; under a percent of the step on the paper's plate."""
    errors = []
    for quality in (15.0, 60.0, 240.0):
        count = round(8 * quality / (math.pi * FREQUENCY) * 192e3)
        command = np.concatenate([np.full(count, LIMIT), np.zeros(count)])
        tau = float(envelope_time_constant(quality, FREQUENCY))
        modelled = DrivenEnvelope(tau, tau, LIMIT).response(command, 1 / 192e3)
        worst = max(
            np.max(
                np.abs(carried(command, 1, FREQUENCY, quality, phase=phase).amplitude - modelled)
            )
            for phase in (0.0, 0.8, 1.6, 2.4)
        )
        errors.append(worst / LIMIT)
    assert errors[1] < 0.01
    orders = np.log(np.array(errors[:-1]) / errors[1:]) / math.log(4)
    assert orders == pytest.approx([1.0, 1.0], abs=0.1)


def test_the_doubled_speed_holds_at_the_carrier_and_within_the_voltage() -> None:
    """The claim again, on the second-order resonator fed by a converter at 192 kHz."""
    speed = 2 * fastest_compensated_speed(PERIOD, plate(True), 0.0, 0.8 * LIMIT, "none")
    step, period = 4 / 192e3, PERIOD / speed
    t = np.arange(math.floor(12 * period / step)) * step
    wanted = np.where((t / period) % 1 < 0.5, 0.8 * LIMIT, 0.0)
    drive = compensated_drive(wanted, step, plate(True))
    assert np.max(np.abs(drive.command)) <= LIMIT * (1 + 1e-12)
    trace = carried(drive.command, 4, FREQUENCY, Q)
    late = trace.time > 6 * period
    assert np.ptp(trace.amplitude[late]) > 0.9 * 0.8 * LIMIT
    bare = carried(wanted, 4, FREQUENCY, Q)
    assert np.ptp(bare.amplitude[late]) < 0.65 * 0.8 * LIMIT


def kept_with(quality: float, detuning: float) -> float:
    """Swing kept at the doubled speed by a command made for Q and resonance, of another device."""
    speed = 2 * fastest_compensated_speed(PERIOD, plate(True), 0.0, 0.8 * LIMIT, "none")
    step, period = 4 / 192e3, PERIOD / speed
    t = np.arange(math.floor(30 * period / step)) * step
    wanted = np.where((t / period) % 1 < 0.5, 0.8 * LIMIT, 0.0)
    drive = compensated_drive(wanted, step, plate(True))
    # The force per volt is the device's own: what it holds at resonance grows with its Q.
    trace = carried(
        drive.command * quality / Q, 4, FREQUENCY * (1 + detuning), quality,
        resonance=FREQUENCY,
    )  # fmt: skip
    return float(np.ptp(trace.amplitude[trace.time > 12 * period]) / (0.8 * LIMIT))


def test_how_well_the_resonator_must_be_known_for_the_doubled_speed() -> None:
    """It bears Q 5 % low or detuning of a quarter of a half bandwidth, not 20 % or half of one."""
    half_bandwidth = 1 / (2 * Q)
    assert kept_with(0.95 * Q, 0.0) > 0.9
    assert kept_with(Q, 0.25 * half_bandwidth) > 0.9
    assert kept_with(0.8 * Q, 0.0) < 0.87
    assert kept_with(Q, 0.5 * half_bandwidth) < 0.9
    # A drive that knows too little Q still swings enough, but leaves some of it where rest belongs.
    assert kept_with(1.2 * Q, 0.0) > 1.0
