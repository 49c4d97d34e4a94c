"""What is put together of a solved plate's classes: the motion of its volume."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.physics.plate.solid.volume import harmonic_motion

RANDOM = np.random.default_rng(6)


def part(count: int) -> Any:
    """A class with so many coordinates."""
    return SimpleNamespace(basis=RANDOM.random((7, count)), solved=f"mesh of {count}")


def test_a_motion_is_the_sum_over_classes_of_their_own_coordinates() -> None:
    parts = [part(2), part(1)]
    coordinates = RANDOM.random((3, 3)) + 1j * RANDOM.random((3, 3))
    moving = {one.solved: RANDOM.random((4, 3, 7)) for one in parts}

    def displacement(mesh: str, vector: Any) -> Any:
        return moving[mesh] @ vector

    volume: Any = SimpleNamespace(points=np.zeros((4, 3)), displacement=displacement)
    solved: Any = SimpleNamespace(_parts=parts, _coordinates=coordinates)
    first = moving["mesh of 2"] @ (parts[0].basis @ coordinates[1, :2])
    second = moving["mesh of 1"] @ (parts[1].basis @ coordinates[1, 2:])
    assert harmonic_motion(volume, solved, 1) == pytest.approx(first + second)
