"""Forces that friction holds: two contactors by hand, and conditions that any number must meet."""

import numpy as np
import pytest

from squeezefilm.actuators.skin_stretch.array import held_forces


def test_two_contactors_by_hand() -> None:
    compliance = np.array([[2.0, 1.0], [1.0, 2.0]])
    both = held_forces(compliance, np.array([3.0, 3.0]), np.array([5.0, 5.0]))
    assert both == pytest.approx([1.0, 1.0])
    # The first is held with 0.5; the second then needs (3 − 0.5)/2.
    one = held_forces(compliance, np.array([3.0, 3.0]), np.array([0.5, 5.0]))
    assert one == pytest.approx([0.5, 1.25])
    # One that touches nothing pulls nothing.
    none = held_forces(compliance, np.array([3.0, 3.0]), np.array([0.0, 5.0]))
    assert none == pytest.approx([0.0, 1.5])
    assert held_forces(compliance, np.array([3.0, 3.0]), np.zeros(2)).tolist() == [0.0, 0.0]


@pytest.mark.parametrize("seed", range(20))
def test_what_is_within_its_limit_sticks_and_what_is_at_it_slips_its_own_way(seed: int) -> None:
    random = np.random.default_rng(seed)
    root = random.standard_normal((30, 30))
    compliance = root @ root.T + 3 * np.eye(30)
    wanted, held = random.standard_normal(30), 0.1 * random.random(30)
    forces = held_forces(compliance, wanted, held)
    way = wanted - compliance @ forces
    slips = np.abs(forces) >= (1 - 1e-9) * held
    assert 0 < np.count_nonzero(slips) < 30
    assert np.all(np.abs(forces) <= held * (1 + 1e-12))
    np.testing.assert_allclose(way[~slips], 0, atol=1e-9)
    assert np.all(way[slips] * forces[slips] >= 0)
