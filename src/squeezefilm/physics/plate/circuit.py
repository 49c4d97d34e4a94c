"""Circuit of a vibrating body: its admittance, and a circuit near one resonance."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si

LEAST_SHARE: si.Dimensionless = 0.01
"""A mode with less than this share of the conductance at its resonance has no circuit: what the
terminals show there is its neighbours' and the losses of the materials."""

# A circuit that has less of the conductance is told of with its share.
_MOST_OF_IT = 0.8


class DrivenResponse:
    """The response of a body to one volt (zero to peak) on its drive, at `frequencies` (Hz).

    `admittance` in siemens, time factor e^{iωt}; `maximum` is the largest amplitude per volt
    anywhere on the touched face (m/V). All have the shape (frequencies,).
    """

    frequencies: si.HertzArray
    admittance: si.ComplexArray

    @property
    def maximum(self) -> si.FloatArray:
        """The largest amplitude per volt (m/V) on the touched face, for every frequency."""
        raise NotImplementedError

    @property
    def resonance(self) -> int:
        """The number of the frequency with the largest amplitude."""
        return int(np.argmax(self.maximum))


@si.checked_numbers
@dataclass(frozen=True)
class EquivalentCircuit:
    """Butterworth–Van Dyke: C0 parallel to a series of R1, L1 and C1, near one resonance."""

    frequency: si.Hertz
    quality_factor: si.Dimensionless
    static_capacitance: si.Farad
    motional_resistance: si.Ohm
    motional_inductance: si.Henry
    motional_capacitance: si.Farad

    @si.checked_numbers
    def admittance(self, frequency: si.HertzArray) -> si.ComplexArray:
        """Y (S) of the circuit at frequencies (Hz)."""
        omega = 2 * np.pi * np.asarray(frequency, dtype=float)
        series = (
            self.motional_resistance
            + 1j * omega * self.motional_inductance
            + 1 / (1j * omega * self.motional_capacitance)
        )
        return np.asarray(1j * omega * self.static_capacitance + 1 / series)


@si.checked_numbers
def motional_branch(
    frequency: Annotated[si.Hertz, si.Above(0.0)],
    quality_factor: Annotated[si.Dimensionless, si.Above(0.0)],
    modal_mass: Annotated[si.Kilogram, si.Above(0.0)],
    force: Annotated[si.NewtonPerVolt, si.Above(0.0)],
) -> EquivalentCircuit:
    """The series branch of one mode that one volt pushes with a modal `force` (N/V), without a
    static capacitance.

    L1 = M/F², C1 = F²/(ω² M), R1 = ω M/(Q F²): by reciprocity the charge of an amplitude is the
    force of a volt. All elements are positive and the branch has the mode's own Q, however strong
    its neighbours are. Raises `OutOfRangeError` for a force so small that no number holds L1.
    """
    omega = 2 * np.pi * frequency
    return EquivalentCircuit(
        frequency=frequency,
        quality_factor=quality_factor,
        static_capacitance=0.0,
        motional_resistance=omega * modal_mass / (quality_factor * force**2),
        motional_inductance=modal_mass / force**2,
        motional_capacitance=force**2 / (omega**2 * modal_mass),
    )


def with_static_capacitance(
    branch: EquivalentCircuit, response: DrivenResponse
) -> EquivalentCircuit:
    """A motional branch with the static capacitance (F) that a response's admittance has beside it,
    the median over its frequencies."""
    omega = 2 * np.pi * response.frequencies
    rest = (response.admittance - branch.admittance(response.frequencies)) / (1j * omega)
    return replace(branch, static_capacitance=float(np.median(rest.real)))


def conductance_share(branch: EquivalentCircuit, response: DrivenResponse) -> si.Dimensionless:
    """The share that a motional branch has of a response's conductance at the branch's resonance:
    near 1 for a mode by itself, little for one whose neighbours move more."""
    there = np.interp(branch.frequency, response.frequencies, response.admittance.real)
    return float(1 / (branch.motional_resistance * there))


def resolved_circuit(
    branch: EquivalentCircuit, response: DrivenResponse
) -> tuple[EquivalentCircuit | None, str]:
    """A mode's circuit, its motional branch and the static capacitance that a response has beside
    it, and a sentence where its neighbours draw most of the power.

    None, and why, for a branch with less than `LEAST_SHARE` of the conductance at its resonance.
    """
    share = conductance_share(branch, response)
    if share < LEAST_SHARE:
        return None, (
            f"none: of the conductance at {si.format_quantity(branch.frequency, si.Unit('Hz'))} "
            f"the mode has {100 * share:.1g} %, less than {100 * LEAST_SHARE:g} %: the rest is of "
            "other modes and of losses, so that no circuit describes this one"
        )
    said = f"the mode has {si.percent(share)} of the conductance at its resonance"
    return with_static_capacitance(branch, response), said if share < _MOST_OF_IT else ""
