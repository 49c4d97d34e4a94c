"""A ring's response from modes made by hand: superposition, powers, and the circuit behind it."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.plate.circuit import EquivalentCircuit
from squeezefilm.physics.plate.ring import body
from squeezefilm.physics.plate.ring.body import (
    RingResponse,
    ring_circuit,
    ring_response,
    static_capacitance,
)
from squeezefilm.physics.plate.ring.modes import AnnularMode
from squeezefilm.physics.plate.ring.section import SectorDrive, alternate_sectors

SURFACE = np.linspace(10e-3, 20e-3, 30)
DRIVE = SectorDrive(((0.0, 0.5, 1), (0.5, 0.8, -1)))


def mode(frequency: float, quality: float, mass: float, force: float, tilt: float) -> AnnularMode:
    return AnnularMode(
        harmonic=3, label="rigid" if frequency == 0 else "B(0,3)", frequency=frequency,
        frequency_error=0.0, quality_factor=quality, modal_mass=mass,
        modal_force_all_round=force, half_wavelength=None, axial_share=1.0,
        node_radius=SURFACE, node_height=SURFACE,
        displacement=np.zeros((30, 3)), surface_radius=SURFACE,
        surface_shape=1 + tilt * (SURFACE - 10e-3),
    )  # fmt: skip


MODES = (
    mode(0.0, math.inf, 9e-3, 0.02, 0.0), mode(30e3, 50.0, 2e-3, 0.3, 20.0),
    mode(34e3, 80.0, 1e-3, -0.1, -60.0),
)  # fmt: skip
BODY: Any = SimpleNamespace(section="a section", drive=DRIVE, quality_factor=60.0)


def test_motion_is_the_sum_of_the_modes_nearby(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: dict[str, Any] = {}
    f = np.array([29e3, 30e3, 33e3])
    admittance = np.array([1e-3, 2e-3j, 3.0])

    def modes(section: object, harmonic: int, **rest: Any) -> tuple[AnnularMode, ...]:
        asked["modes"] = (section, harmonic, rest)
        return MODES

    def admitted(section: object, drive: object, frequencies: object, **rest: Any) -> Any:
        asked["admittance"] = (section, drive, frequencies, rest)
        return admittance

    monkeypatch.setattr(body, "annular_modes", modes)
    monkeypatch.setattr(body, "annular_admittance", admitted)
    found = ring_response(BODY, MODES[1], f, [1, 3], terms=3)
    assert asked["modes"] == (
        "a section", 3, {"near": 30e3, "count": 3, "quality_factor": 60.0}
    )  # fmt: skip
    assert asked["admittance"][:3] == ("a section", DRIVE, f)
    assert asked["admittance"][3] == {"harmonics": (1, 3), "quality_factor": 60.0, "modes": 3}
    assert found.admittance is admittance
    assert (found.harmonics, found.terms) == ((1, 3), 3)
    assert found.radius == pytest.approx(np.linspace(10e-3, 20e-3, 121))
    # ∫ s exp(−3iθ) dθ of the two sectors.
    reach = abs((1 - 2 * np.exp(-1.5j) + np.exp(-2.4j)) / 3j)
    expected = np.zeros((3, 121), dtype=complex)
    for one, loss, tilt in zip(MODES, (0.0, 1 / 50, 1 / 80), (0.0, 20.0, -60.0), strict=True):
        force = one.modal_force_all_round * reach
        own = (2 * np.pi * one.frequency) ** 2
        each = force / one.modal_mass / (own * (1 + 1j * loss) - (2 * np.pi * f) ** 2)
        expected += each[:, None] * (1 + tilt * (found.radius - 10e-3))
    assert found.motion == pytest.approx(expected, rel=1e-9)
    with pytest.raises(InputError, match="frequencies"):
        ring_response(BODY, MODES[1], np.array([0.0]), [3])


def test_the_resonance_is_at_the_largest_amplitude() -> None:
    one = RingResponse(
        np.array([1e3, 2e3, 3e3]), SURFACE[:2], np.array([[1.0, 2j], [-3j, 4.0], [3.0, 3.0]]),
        np.array([9.0, 3e-3 + 4e-3j, 9.0]), (3,), 1,
    )  # fmt: skip
    assert one.maximum == pytest.approx([2.0, 4.0, 3.0])
    assert one.resonance == 1


def test_the_circuit_has_the_modes_branch_and_what_is_beside_it() -> None:
    drive = alternate_sectors(4, math.pi / 3)
    body: Any = SimpleNamespace(section="a section", drive=drive, quality_factor=60.0)
    one = MODES[1]
    # Four of six sectors of alternate polarity: 2/3 each on cos 3θ.
    force = 0.3 * 8 / 3
    omega = 2 * math.pi * 30e3
    f = np.linspace(29e3, 31e3, 41)
    true = EquivalentCircuit(
        30e3, 50.0, 5e-9, omega * 2e-3 / 50 / force**2, 2e-3 / force**2,
        force**2 / omega**2 / 2e-3,
    )  # fmt: skip
    answer = RingResponse(f, SURFACE, np.zeros((41, 30)), true.admittance(f), (3,), 1)
    found = ring_circuit(body, one, answer)
    assert found.motional_resistance == pytest.approx(true.motional_resistance)
    assert found.motional_inductance == pytest.approx(true.motional_inductance)
    assert found.motional_capacitance == pytest.approx(true.motional_capacitance)
    assert found.static_capacitance == pytest.approx(5e-9)
    assert (found.frequency, found.quality_factor) == (30e3, 50.0)
    assert static_capacitance(body, found) == found.static_capacitance


def test_without_a_circuit_the_held_ceramic_is_the_capacitance(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(body, "clamped_capacitance", lambda section, drive: (section, drive))
    assert static_capacitance(BODY, None) == ("a section", DRIVE)
