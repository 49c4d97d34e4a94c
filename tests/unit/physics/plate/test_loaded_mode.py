"""One mode with a load: what it becomes, against its own equation of motion."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.plate.loaded_mode import LoadedMode, loaded_mode, mean_square_wave

GOOD: dict[str, Any] = {
    "frequency": 30e3, "quality_factor": 60.0, "modal_mass": 4e-3,
    "stiffness_per_area": 2e10 + 3e9j, "area": 1e-4, "mean_square": 0.4,
}  # fmt: skip


def test_a_load_adds_its_stiffness_to_the_modes_own() -> None:
    found = loaded_mode(**GOOD)
    own = 4e-3 * (2 * math.pi * 30e3) ** 2
    whole = own * (1 + 1j / 60) + (2e10 + 3e9j) * 1e-4 * 0.4
    assert found.load_ratio == pytest.approx((2e10 + 3e9j) * 4e-5 / own)
    assert found.resonance_frequency == pytest.approx(math.sqrt(whole.real / 4e-3) / 2 / math.pi)
    assert found.quality_factor == pytest.approx(whole.real / whole.imag)
    for f in (28e3, 30e3, 33e3):
        moved = abs(1 / (whole - 4e-3 * (2 * math.pi * f) ** 2))
        free = abs(1 / (own * 1j / 60))
        assert found.amplitude_ratio(f) == pytest.approx(moved / free)


def test_the_power_is_what_a_force_does_on_the_motion() -> None:
    """½ Re(F v*) of the force that moves the mode so far, on resonance and off it."""
    found = loaded_mode(**GOOD)
    own = 4e-3 * (2 * math.pi * 30e3) ** 2
    whole = own * (1 + 1j / 60) + (2e10 + 3e9j) * 1e-4 * 0.4
    for f in (28e3, 30e3, found.resonance_frequency):
        omega, moved = 2 * math.pi * f, 1.5e-6
        force = (whole - 4e-3 * omega**2) * moved
        velocity = 1j * omega * moved
        assert found.power(4e-3, f, moved) == pytest.approx(0.5 * (force * np.conj(velocity)).real)
    # A force that stands still does less on a mode that its load keeps from moving.
    alone = LoadedMode(30e3, 60.0, 0j)
    damped = LoadedMode(30e3, 60.0, 1j / 60)
    assert damped.power(4e-3, 30e3, 0.5e-6) == pytest.approx(0.5 * alone.power(4e-3, 30e3, 1e-6))


def test_without_a_load_it_is_the_mode_itself() -> None:
    free = LoadedMode(30e3, 60.0, 0j)
    assert free.resonance_frequency == 30e3
    assert free.quality_factor == pytest.approx(60.0)
    assert free.amplitude_ratio(30e3) == pytest.approx(1.0)
    with pytest.raises(InputError, match="frequency"):
        free.amplitude_ratio(0.0)


@pytest.mark.parametrize("position", [0.0, 1.3e-3, 4e-3])
def test_the_wave_is_averaged_over_the_contact(position: float) -> None:
    x = position + 6e-3 * ((np.arange(10_000) + 0.5) / 10_000 - 0.5)
    expected = np.mean(np.cos(np.pi * x / 5e-3) ** 2)
    assert mean_square_wave(5e-3, 6e-3, position) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"frequency": 0.0}, "frequency"), ({"quality_factor": 0.0}, "quality_factor"),
        ({"modal_mass": 0.0}, "modal_mass"), ({"area": 0.0}, "area"),
        ({"mean_square": -0.01}, "mean_square"), ({"mean_square": 1.2e4}, "mean_square"),
        ({"stiffness_per_area": 1e9 - 1.0j}, "the load's loss"),
    ],
)  # fmt: skip
def test_a_load_that_cannot_be_is_refused(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says):
        loaded_mode(**{**GOOD, **changes})
    for half, side in ((0.0, 1e-3), (1e-3, 0.0)):
        with pytest.raises(InputError, match=r"half_wavelength|contact_length"):
            mean_square_wave(half, side)
