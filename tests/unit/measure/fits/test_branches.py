"""Circuits of several branches: admittance, derivatives, starts."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.measure.fits.circuit.branches import Layout, circuit_curve, poles, start_at
from squeezefilm.physics.plate.circuit import EquivalentCircuit

FREQUENCY = np.linspace(35e3, 46e3, 240)
LAYOUT = Layout(2, coupling_loss=True, softening=True, drift=True)
MOTION = np.linspace(0, 1, FREQUENCY.size)
P = np.concatenate(
    [
        np.log([3e-9]),
        [0.01],
        np.log([38e3, 80, 2e-10]),
        np.log([41e3, 120, 1e-10]),
        [0.015, 0.01, 0.2, 0.03, -0.02],
    ]
)


def test_one_branch_is_the_circuit_of_butterworth_and_van_dyke() -> None:
    f, quality, capacitance, static = 40e3, 75.0, 2e-10, 3e-9
    omega = 2 * np.pi * f
    circuit = EquivalentCircuit(
        f,
        quality,
        static,
        1 / (omega * capacitance * quality),
        1 / (omega**2 * capacitance),
        capacitance,
    )
    p = np.array([np.log(static), 0.0, np.log(f), np.log(quality), np.log(capacitance)])
    assert circuit_curve(Layout(1), p, FREQUENCY)[0] == pytest.approx(
        circuit.admittance(FREQUENCY), rel=1e-12
    )


def test_derivatives_are_those_of_differences() -> None:
    slopes = circuit_curve(LAYOUT, P, FREQUENCY, MOTION)[1]
    for k in range(LAYOUT.size):
        step = 1e-6 * np.eye(LAYOUT.size)[k]
        rise = circuit_curve(LAYOUT, P + step, FREQUENCY, MOTION)[0]
        rise = rise - circuit_curve(LAYOUT, P - step, FREQUENCY, MOTION)[0]
        assert np.abs(rise / 2e-6 - slopes[k]).max() < 1e-6 * np.abs(slopes[k]).max(), k


def test_poles_are_found_without_a_start() -> None:
    plain = Layout(2)
    own, quality = poles(FREQUENCY, circuit_curve(plain, P[:8], FREQUENCY)[0], 2)
    assert own == pytest.approx([38e3, 41e3], rel=2e-4)
    assert quality == pytest.approx([80, 120], rel=0.02)


def test_the_wrong_sign_of_the_phase_gives_poles_that_grow() -> None:
    quality = poles(FREQUENCY, np.conj(circuit_curve(Layout(2), P[:8], FREQUENCY)[0]), 2)[1]
    assert np.all(quality < 0)


def test_a_start_is_near_the_truth() -> None:
    layout = Layout(2)
    curve = circuit_curve(layout, P[:8], FREQUENCY)[0]
    start = start_at(layout, FREQUENCY, curve, np.array([38e3, 41e3]), np.array([80.0, 120.0]))
    assert start == pytest.approx(P[:8], abs=0.02)


def test_whatever_a_fit_tries_is_finite() -> None:
    curve, slopes = circuit_curve(Layout(1), np.array([900.0, 9.0, 50.0, -900.0, 1e4]), FREQUENCY)
    assert np.all(np.isfinite(curve))
    assert np.all(np.isfinite(slopes))
