"""A mode's equivalent circuit from its modal mass and force, against a closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.plate.circuit import (
    LEAST_SHARE,
    DrivenResponse,
    conductance_share,
    motional_branch,
    resolved_circuit,
)

F0, Q, MASS, STATIC = 30e3, 80.0, 2e-3, 5e-9
FREQUENCIES = F0 * (1 + np.linspace(-4, 4, 801) / Q)


class Oscillator(DrivenResponse):
    """A mass on a lossy spring that a volt pushes, beside a capacitor and a conductance."""

    def __init__(self, force: float, conductance: float = 0.0) -> None:
        self.frequencies = FREQUENCIES
        omega, own = 2 * np.pi * FREQUENCIES, 2 * np.pi * F0
        # Viscous damping, as a series circuit of R, L and C has it.
        amplitude = force / (MASS * (own**2 - omega**2 + 1j * own * omega / Q))
        # A volt's force is an amplitude's charge.
        self.admittance = 1j * omega * (STATIC + force * amplitude) + conductance


@pytest.mark.parametrize("force", [1e-3, 0.3])
def test_the_circuit_is_the_oscillator(force: float) -> None:
    branch = motional_branch(F0, Q, MASS, force)
    response = Oscillator(force)
    circuit, said = resolved_circuit(branch, response)
    assert circuit is not None
    assert said == ""
    assert circuit.static_capacitance == pytest.approx(STATIC, rel=1e-9)
    assert circuit.admittance(FREQUENCIES) == pytest.approx(response.admittance, rel=1e-9)
    omega = 2 * math.pi * circuit.frequency
    assert circuit.motional_inductance * circuit.motional_capacitance == pytest.approx(omega**-2)
    own = omega * circuit.motional_inductance / circuit.motional_resistance
    assert own == pytest.approx(circuit.quality_factor) == pytest.approx(Q)
    assert conductance_share(branch, response) == pytest.approx(1, rel=1e-9)


def test_a_background_is_no_part_of_the_circuit_and_hides_a_weak_mode() -> None:
    branch = motional_branch(F0, Q, MASS, 0.01)
    own = 1 / branch.motional_resistance
    beside = Oscillator(0.01, 3 * own)
    assert conductance_share(branch, beside) == pytest.approx(0.25, rel=1e-6)
    circuit, said = resolved_circuit(branch, beside)
    assert circuit is not None
    assert circuit.motional_resistance == branch.motional_resistance
    assert said == "the mode has 25 % of the conductance at its resonance"
    circuit, said = resolved_circuit(branch, Oscillator(0.01, 1.1 * own / LEAST_SHARE))
    assert circuit is None
    assert "at 30 kHz the mode has 0.9 %, less than 1 %" in said


def test_a_mode_that_nothing_pushes_has_no_branch() -> None:
    with pytest.raises(InputError, match="force"):
        motional_branch(F0, Q, MASS, 0.0)
