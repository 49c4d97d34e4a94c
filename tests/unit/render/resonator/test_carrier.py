"""The carrier and its resonator: phases sample by sample, and an exact step against scipy's."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.signal import cont2discrete

from squeezefilm.errors import InputError
from squeezefilm.render.resonator.carrier import (
    DAC_RATE,
    carrier_block,
    carrier_trace,
    hold_gain,
    resonator_response,
    samples_per_command,
)


def test_a_hold_weakens_by_its_sinc() -> None:
    assert hold_gain(40e3, 192e3) == pytest.approx(float(np.sinc(40 / 192)))
    assert hold_gain(96e3, 192e3) == pytest.approx(2 / math.pi)
    assert np.asarray(hold_gain(np.array([1.0, 30e3]), DAC_RATE)) == pytest.approx(
        np.sinc([1 / 192e3, 30 / 192])
    )
    with pytest.raises(InputError, match="frequency"):
        hold_gain(0.0, 192e3)


def test_a_block_goes_on_where_the_last_one_ended() -> None:
    command, advance = np.array([2.0, -1.0, 0.5]), 2.3
    whole = np.empty(12)
    last = carrier_block.py_func(0.4, advance, command, 4, 1.5, whole)
    turns = 0.4 + advance * np.arange(12)
    assert whole == pytest.approx(1.5 * np.repeat(command, 4) * np.sin(turns))
    assert last == pytest.approx(math.fmod(0.4 + 12 * advance, 2 * math.pi))
    assert 0 <= last < 2 * math.pi
    one, two = np.empty(4), np.empty(8)
    phase = carrier_block.py_func(0.4, advance, command[:1], 4, 1.5, one)
    assert carrier_block.py_func(phase, advance, command[1:], 4, 1.5, two) == pytest.approx(last)
    assert np.concatenate([one, two]) == pytest.approx(whole)


@pytest.mark.parametrize("quality", [0.6, 30.0])
def test_a_resonator_is_stepped_exactly(quality: float) -> None:
    drive = np.random.default_rng(2).standard_normal(40)
    frequency, rate = 31e3, 192e3
    w = 2 * math.pi * frequency
    # x'' + (w/Q) x' + w² x = (w²/Q) u in x and x'/w.
    A = w * np.array([[0.0, 1.0], [-1.0, -1 / quality]])
    B = w * np.array([[0.0], [1 / quality]])
    step, push, *_ = cont2discrete((A, B, np.eye(2), np.zeros((2, 1))), 1 / rate)
    state, expected = np.zeros(2), np.empty((40, 2))
    for k, u in enumerate(drive):
        expected[k] = state
        state = step @ state + push[:, 0] * u
    place, quadrature = resonator_response(drive, rate, frequency, quality)
    assert place == pytest.approx(expected[:, 0], rel=1e-10, abs=1e-13)
    assert quadrature == pytest.approx(expected[:, 1], rel=1e-10, abs=1e-13)


def test_a_carrier_held_reaches_the_amplitude_commanded() -> None:
    trace = carrier_trace(np.array([1e-6]), 6000, 30e3, 40.0)
    # 6000 samples are 24 times the time constant Q/πf.
    assert trace.amplitude[-50:] == pytest.approx(np.full(50, 1e-6), rel=0.02)
    weak = carrier_trace(np.array([1e-6]), 6000, 30e3, 40.0, hold_compensated=False)
    assert weak.displacement == pytest.approx(
        trace.displacement * float(hold_gain(30e3, DAC_RATE)), rel=1e-9, abs=1e-20
    )
    assert trace.time == pytest.approx(np.arange(6000) / 192e3)
    assert trace.command == pytest.approx(np.full(6000, 1e-6))
    assert trace.resonance_frequency == trace.frequency == 30e3
    assert trace.envelope_error == pytest.approx(
        np.abs(trace.amplitude - trace.amplitude_modelled).max()
    )
    # The envelope of the first order, with 2Q/ω.
    tau = 40.0 / (math.pi * 30e3)
    assert trace.amplitude_modelled == pytest.approx(
        1e-6 * -np.expm1(-trace.time / tau), rel=1e-9, abs=1e-20
    )
    aside = carrier_trace(np.array([1e-6]), 6000, 30e3, 40.0, resonance_frequency=29e3)
    detuned = 40 * (30 / 29 - 29 / 30)
    expected = 1e-6 * (29 / 30) / math.hypot(1, detuned)
    assert np.ptp(aside.displacement[-500:]) / 2 == pytest.approx(expected, rel=0.02)


def test_the_phase_turns_the_carrier_and_a_negative_command_inverts_it() -> None:
    common: dict[str, Any] = {"samples_per_command": 50, "frequency": 30e3, "quality_factor": 9.0}
    plain = carrier_trace(np.array([1e-6, 2e-6]), **common)
    for other in (
        carrier_trace(np.array([1e-6, 2e-6]), **common, phase=math.pi),
        carrier_trace(np.array([-1e-6, -2e-6]), **common),
        carrier_trace(np.array([1e-6, 2e-6]), **common, phase=7 * math.pi),
    ):
        assert other.displacement == pytest.approx(-plain.displacement, rel=1e-9, abs=1e-18)
        assert other.amplitude_modelled == pytest.approx(plain.amplitude_modelled)
    assert plain.command == pytest.approx(np.repeat([1e-6, 2e-6], 50))


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"command": np.zeros((2, 2))}, "makes no carrier"),
        ({"command": np.zeros(0)}, "command is empty"),
        ({"samples_per_command": 0}, "makes no carrier"),
        ({"frequency": 96e3}, "frequency"),
        ({"sample_rate": 0.0}, "sample_rate"),
        ({"quality_factor": 0.5}, "quality_factor"),
    ],
)
def test_what_makes_no_carrier_is_refused(changes: dict[str, Any], says: str) -> None:
    good: dict[str, Any] = {
        "command": np.ones(2), "samples_per_command": 1, "frequency": 95e3, "quality_factor": 0.51,
    }  # fmt: skip
    carrier_trace(**good)
    with pytest.raises(InputError, match=says):
        carrier_trace(**{**good, **changes})


def test_a_drive_that_is_no_row_is_refused() -> None:
    with pytest.raises(InputError, match="one row of at least one sample"):
        resonator_response(np.zeros((2, 2)), 192e3, 30e3, 9.0)


def test_commands_last_whole_numbers_of_samples() -> None:
    assert samples_per_command(1e3) == 192
    assert samples_per_command(192e3) == 1
    assert samples_per_command(7.0, 21.0) == 3
    with pytest.raises(InputError, match=r"does not divide 192 kHz; take 1\.005 kHz"):
        samples_per_command(1003.0)
    with pytest.raises(InputError, match="command_rate"):
        samples_per_command(193e3)
