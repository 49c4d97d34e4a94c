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
    moved, charge = harmonic_solution(parts, OMEGA)
    for i, omega in enumerate(OMEGA):
        flown = 0.0
        for part, own in zip(parts, class_slices(parts), strict=True):
            x, opened = moved[i, own], list(part.opened)
            volts = part.drive.astype(complex)
            # What an open electrode must have to hold no charge.
            volts[opened] = 0.0
            drawn = part.coupling.T @ x + part.capacitance @ volts
            volts[opened] = -np.linalg.solve(
                part.capacitance[np.ix_(opened, opened)], drawn[opened]
            )
            dynamic = part.stiffness + 1j * part.loss - omega**2 * part.mass
            assert dynamic @ x + part.coupling @ volts == pytest.approx(0.0, abs=1e-11)
            flown -= part.drive @ (part.coupling.T @ x + part.capacitance @ volts)
        assert charge[i] == pytest.approx(flown)
