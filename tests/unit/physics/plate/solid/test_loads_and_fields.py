"""What is put together of a solved plate's classes: loads on its face, and fields in its volume."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.physics.plate.solid import response
from squeezefilm.physics.plate.solid.volume import harmonic_fields

RANDOM = np.random.default_rng(6)


def part(count: int) -> Any:
    """A class with so many coordinates."""
    return SimpleNamespace(basis=RANDOM.random((7, count)), solved=f"mesh of {count}")


def test_a_load_adds_its_stiffness_damping_and_mass_where_the_face_moves(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """By the sum over its places, one pair of coordinates at a time."""
    parts = [part(2), part(1)]
    w = RANDOM.random((3, 4, 5))
    asked: list[Any] = []

    def values(of: Any, x: Any, y: Any, z: float) -> Any:
        asked.append((of, x, y, z))
        return w

    monkeypatch.setattr(response, "surface_values", values)
    area = RANDOM.random((4, 5))
    load: Any = SimpleNamespace(
        points=lambda: ("x", "y", area), stiffness=3.0, damping=0.5, mass=0.2
    )
    plate: Any = SimpleNamespace(thickness=2e-3)
    omega = np.array([1.0, 4.0])
    found = response._load_stiffness(plate, parts, [load, load], omega)
    assert asked[0] == (parts, "x", "y", 2e-3)
    assert found.shape == (2, 3, 3)
    for k, frequency in enumerate(omega):
        dynamic = 3.0 + 0.5j * frequency - 0.2 * frequency**2
        for i in range(3):
            for j in range(3):
                expected = 2 * dynamic * np.sum(area * w[i] * w[j])
                assert found[k, i, j] == pytest.approx(expected)
    assert not np.any(response._load_stiffness(plate, parts, [], omega))


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
