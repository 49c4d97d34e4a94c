"""The closed form of 2016 against its balance, its limits, and what was read of three people."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.contact.sharing.levitation import levitation_friction
from squeezefilm.errors import InputError


@pytest.mark.parametrize("rest_gap", [0.0, 0.3, 4.0])
def test_film_and_contact_carry_the_finger_between_them(rest_gap: float) -> None:
    amplitude = np.geomspace(1e-4, 30.0, 50)
    friction = levitation_friction(amplitude, rest_gap)
    lift = (rest_gap - np.log(friction)) ** 2 * (1 - friction)
    # A friction near one has lost the digits of what is lifted.
    assert lift == pytest.approx(amplitude**2, rel=1e-6, abs=1e-13)
    assert np.all(np.diff(friction) < 0)


def test_at_rest_it_is_that_of_dry_contact() -> None:
    assert levitation_friction(np.zeros(2), 1.0) == pytest.approx(1.0, abs=1e-12)


def test_a_small_amplitude_lifts_a_finger_with_a_gap_at_rest_as_a_gaussian_says() -> None:
    amplitude = np.array([0.01, 0.03])
    assert 1 - levitation_friction(amplitude, 2.0) == pytest.approx(amplitude**2 / 4, rel=2e-3)


def test_without_a_gap_at_rest_the_fall_is_steepest_at_the_smallest_amplitudes() -> None:
    amplitude = np.array([1e-4, 1e-3])
    assert 1 - levitation_friction(amplitude) == pytest.approx(amplitude ** (2 / 3), rel=1e-2)


def test_what_is_no_amplitude_is_refused() -> None:
    with pytest.raises(InputError):
        levitation_friction(np.array([-1.0]))
