"""What is put together of a solved plate's classes: fields in its volume."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.physics.plate.solid.volume import harmonic_fields

RANDOM = np.random.default_rng(6)


def part(count: int) -> Any:
    """A class with so many coordinates."""
    return SimpleNamespace(basis=RANDOM.random((7, count)), solved=f"mesh of {count}")


def test_a_field_is_the_sum_over_classes_of_their_own_coordinates() -> None:
    parts = [part(2), part(1)]
    coordinates = RANDOM.random((3, 3)) + 1j * RANDOM.random((3, 3))
    potentials = [RANDOM.random((3, 2)), RANDOM.random((3, 2))]
    moving = {one.solved: RANDOM.random((4, 3, 7)) for one in parts}

    def displacement(mesh: str, vector: Any) -> Any:
        return moving[mesh] @ vector

    def potential(mesh: str, vector: Any, electrodes: Any) -> Any:
        return displacement(mesh, vector)[:, 0] * electrodes.sum()

    volume: Any = SimpleNamespace(
        points=np.zeros((4, 3)), displacement=displacement, potential=potential
    )
    solved: Any = SimpleNamespace(_parts=parts, _coordinates=coordinates, _potentials=potentials)
    moved, charged = harmonic_fields(volume, solved, 1)
    first = moving["mesh of 2"] @ (parts[0].basis @ coordinates[1, :2])
    second = moving["mesh of 1"] @ (parts[1].basis @ coordinates[1, 2:])
    assert moved == pytest.approx(first + second)
    expected = first[:, 0] * potentials[0][1].sum() + second[:, 0] * potentials[1][1].sum()
    assert charged == pytest.approx(expected)
