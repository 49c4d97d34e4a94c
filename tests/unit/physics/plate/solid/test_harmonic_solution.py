"""Forced motion with circuits at electrodes: what is solved satisfies every equation by itself."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.physics.plate.solid.reduced import class_slices, harmonic_solution

OMEGA = np.array([0.7, 1.3, 2.9])
# (electrode, resistance, share): two of the first class are in a circuit, one of the second.
CIRCUITS = (((1, np.inf, 1.0), (2, 0.4, 0.5)), ((0, 2.5, 1.0),))


def reduced(rng: np.random.Generator, size: int, copies: int, circuit: Any, drive: Any) -> Any:
    def symmetric(count: int) -> np.ndarray:
        half = rng.standard_normal((count, count))
        return half @ half.T

    return SimpleNamespace(
        basis=np.zeros((9, size)),
        solved=SimpleNamespace(copies=copies),
        mass=symmetric(size),
        stiffness=symmetric(size) + 3 * np.eye(size),
        loss=0.1 * symmetric(size),
        coupling=rng.standard_normal((size, len(drive))),
        capacitance=-symmetric(len(drive)),
        drive=np.array(drive),
        circuit=circuit,
    )


def test_forces_balance_and_each_electrode_obeys_its_circuit() -> None:
    rng = np.random.default_rng(4)
    parts = [
        reduced(rng, 3, 2, CIRCUITS[0], [1.0, 0.0, 0.0]),
        reduced(rng, 2, 4, CIRCUITS[1], [0.0, -1.0]),
    ]
    moved, potentials, charge = harmonic_solution(parts, OMEGA)
    for i, omega in enumerate(OMEGA):
        left = np.zeros(5, dtype=complex)
        flown = 0.0
        for one, own, volts in zip(parts, class_slices(parts), potentials, strict=True):
            dynamic = one.stiffness + 1j * one.loss - omega**2 * one.mass
            left[own] += dynamic @ moved[i, own] + one.coupling @ volts[i]
            drawn = -(one.coupling.T @ moved[i, own] + one.capacitance @ volts[i])
            flown += one.drive @ drawn
            driven = set(range(one.drive.size)) - {number for number, *_ in one.circuit}
            for number in driven:
                assert volts[i, number] == pytest.approx(one.drive[number])
            for number, resistance, share in one.circuit:
                part = share / one.solved.copies
                current = 1j * omega * part * drawn[number]
                if np.isinf(resistance):
                    assert current == pytest.approx(0.0, abs=1e-12)
                else:
                    assert volts[i, number] == pytest.approx(-resistance * current)
        assert left == pytest.approx(np.zeros(5), abs=1e-11)
        assert charge[i] == pytest.approx(flown)
