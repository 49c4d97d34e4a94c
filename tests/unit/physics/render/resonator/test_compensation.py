"""Compensation's inputs, its counters, and what it does with what it cannot use."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.results import to_json
from squeezefilm.physics.render.resonator import envelope, kernel
from squeezefilm.physics.render.resonator.envelope import (
    DrivenEnvelope,
    carrier_block,
    compensated_drive,
    preview_samples,
    preview_work,
    samples_per_command,
)

ENVELOPE = DrivenEnvelope(1e-3, 1e-3, 1e-6)


def test_the_inverse_is_exact_where_the_limits_allow_it_and_counts_where_not() -> None:
    wanted = np.array([0.0, 1e-7, 2e-7, 9e-7, 9e-7, 0.0])
    drive = compensated_drive(wanted, 1e-3, ENVELOPE)
    assert ENVELOPE.response(drive.command, 1e-3)[:3] == pytest.approx(wanted[:3], abs=1e-20)
    assert drive.saturated_top == pytest.approx(2 / 6)  # towards 0.9 and again, out of reach
    assert drive.saturated_bottom == pytest.approx(2 / 6)  # the fall, and the last sample held
    assert np.all((drive.command >= 0) & (drive.command <= 1e-6))


def test_what_is_not_finite_silences_the_drive_and_is_counted() -> None:
    state, parameters = ENVELOPE.new_state(5e-7), ENVELOPE.parameters(1e-4)
    work = preview_work(3)
    for bad in (math.nan, math.inf, -math.inf):
        assert kernel.compensated_step(state, parameters, bad) == (0.0, kernel.SILENT)
        window = np.array([1e-7, bad, 1e-7])
        assert kernel.previewed_step(state, parameters, window, work) == (0.0, kernel.SILENT)
    assert state[kernel.NOT_FINITE] == state[kernel.SAMPLES] == 6
    assert state[kernel.AMPLITUDE] == pytest.approx(5e-7 * math.exp(-0.6))


def test_a_negative_wish_is_no_vibration() -> None:
    state, parameters = ENVELOPE.new_state(0.0), ENVELOPE.parameters(1e-4)
    assert kernel.compensated_step(state, parameters, -1e-6) == (0.0, kernel.FOLLOWS)


def test_without_compensation_the_command_is_the_wish_within_the_limit() -> None:
    drive = compensated_drive(np.array([0.0, 5e-7, 2e-6]), 1e-4, ENVELOPE, "none")
    assert list(drive.command) == [0.0, 5e-7, 1e-6]
    assert drive.saturated_top == pytest.approx(1 / 3)


def test_preview_without_a_future_is_the_inverse(monkeypatch: pytest.MonkeyPatch) -> None:
    assert preview_samples(ENVELOPE, 2e-4) == 15
    monkeypatch.setattr(envelope, "preview_samples", lambda *_: 1)
    random = np.random.default_rng(3)
    wanted = random.uniform(0, 1.5e-6, 200)
    one = compensated_drive(wanted, 2e-4, ENVELOPE, "inverse")
    other = compensated_drive(wanted, 2e-4, ENVELOPE, "preview")
    assert other.command == pytest.approx(one.command, abs=1e-18)


def test_a_limit_is_met_to_rounding() -> None:
    held = np.full(5, 1e-6)
    for way in ("none", "inverse", "preview"):
        # What a limit holds is wanted; what lies beyond it is not to be had.
        for share, counted in ((5e-10, 0.0), (2e-9, 1.0 if way != "preview" else 0.0)):
            drive = compensated_drive(held * (1 + share), 1e-3, ENVELOPE, way, 1e-6)  # type: ignore[arg-type]
            assert drive.saturated_top == counted, way
            assert np.all(drive.command <= 1e-6)
    # A plan stays within the limits, and is at one all the same as long as it moves.
    drive = compensated_drive(np.append(0.0, 0.9 * held), 1e-4, ENVELOPE, "preview")
    assert drive.saturated_top == np.mean(drive.command > 1e-6 * (1 - 1e-9)) == 1.0
    drive = compensated_drive(np.append(1e-6, 0.0 * held), 1e-4, ENVELOPE, "preview")
    assert (drive.saturated_top, drive.saturated_bottom) == (0.0, 1.0)


def test_an_envelope_becomes_strict_json() -> None:
    data = json.loads(json.dumps(to_json(ENVELOPE), allow_nan=False))
    assert data == {
        "rise_time_constant_s": 1e-3,
        "fall_time_constant_s": 1e-3,
        "amplitude_limit_m": 1e-6,
        "braking": False,
    }


def test_the_carrier_goes_on_in_phase_over_blocks() -> None:
    command = np.linspace(0.0, 1.0, 8)
    whole, parts = np.empty(32), np.empty(32)
    carrier_block(0.3, 1.1, command, 4, 1.0, whole)
    phase = carrier_block(0.3, 1.1, command[:5], 4, 1.0, parts[:20])
    carrier_block(phase, 1.1, command[5:], 4, 1.0, parts[20:])
    assert parts == pytest.approx(whole, abs=1e-12)
    assert whole == pytest.approx(np.repeat(command, 4) * np.sin(0.3 + 1.1 * np.arange(32)))


def test_rates_that_divide_give_a_number_of_samples() -> None:
    assert samples_per_command(48e3) == 4
    with pytest.raises(InputError, match="does not divide"):
        samples_per_command(50e3)


@pytest.mark.parametrize(("ask", "word"), [
    (lambda: DrivenEnvelope(0.0, 1e-3, 1e-6), "rise_time_constant"),
    (lambda: DrivenEnvelope(1e-3, math.nan, 1e-6), "fall_time_constant"),
    (lambda: DrivenEnvelope(1e-3, 1e-3, 0.0), "amplitude_limit"),
    (lambda: ENVELOPE.new_state(2e-6), "amplitude"),
    (lambda: ENVELOPE.parameters(0.0), "time_step"),
    (lambda: ENVELOPE.response(np.array([]), 1e-4), "command is empty"),
    (lambda: compensated_drive(np.array([-1e-9]), 1e-4, ENVELOPE), "wanted"),
    (lambda: compensated_drive(np.array([[1e-9]]), 1e-4, ENVELOPE), "wanted of shape"),
    (lambda: compensated_drive(np.array([0.0]), 1e-4, ENVELOPE, "magic"), "magic"),  # type: ignore[arg-type]
])  # fmt: skip
def test_senseless_requests_are_refused(ask: object, word: str) -> None:
    with pytest.raises(InputError, match=word):
        ask()  # type: ignore[operator]
