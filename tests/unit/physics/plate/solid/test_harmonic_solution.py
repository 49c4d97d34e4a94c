"""Forced motion with open electrodes: what is solved satisfies every equation by itself."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.physics.plate.solid.reduced import class_slices, harmonic_solution

OMEGA = np.array([0.7, 1.3, 2.9])


def reduced(rng: np.random.Generator, size: int, opened: Any, drive: Any) -> Any:
    def symmetric(count: int) -> np.ndarray:
        half = rng.standard_normal((count, count))
        return half @ half.T

    return SimpleNamespace(
        basis=np.zeros((9, size)),
        mass=symmetric(size),
        stiffness=symmetric(size) + 3 * np.eye(size),
        loss=0.1 * symmetric(size),
        coupling=rng.standard_normal((size, len(drive))),
        capacitance=-symmetric(len(drive)),
        drive=np.array(drive),
        opened=opened,
    )


def test_forces_balance_and_no_charge_flows_from_an_open_electrode() -> None:
    rng = np.random.default_rng(4)
    parts = [
        reduced(rng, 3, (1, 2), [1.0, 0.0, 0.0]),
        reduced(rng, 2, (0,), [0.0, -1.0]),
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
            for number in set(range(one.drive.size)) - set(one.opened):
                assert volts[i, number] == pytest.approx(one.drive[number])
            assert drawn[list(one.opened)] == pytest.approx(0.0, abs=1e-12)
        assert left == pytest.approx(np.zeros(5), abs=1e-11)
        assert charge[i] == pytest.approx(flown)
