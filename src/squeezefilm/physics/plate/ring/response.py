"""The harmonic response of a ring or a disc around one mode: amplitude, admittance, circuit."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.circuit import (
    DrivenResponse,
    EquivalentCircuit,
    motional_branch,
    with_static_capacitance,
)
from squeezefilm.physics.plate.ring.body import RingBody, surface_profile
from squeezefilm.physics.plate.ring.modes import (
    AnnularMode,
    annular_admittance,
    annular_modes,
    clamped_capacitance,
)

_RADII = 121


@dataclass(frozen=True, eq=False)
class RingResponse(DrivenResponse):
    """The response to one volt (zero to peak) on the channel, at `frequencies` (Hz).

    `motion` is u_z per volt (m/V, complex) on the surface at θ of an antinode, shape (frequencies,
    radii), by superposition of `terms` modes of one harmonic; it varies as cos mθ around.
    `admittance` (S), time factor e^{iωt}, of the harmonics `harmonics`.
    """

    frequencies: si.HertzArray
    radius: si.MetreArray
    motion: si.ComplexArray
    admittance: si.ComplexArray
    harmonics: tuple[int, ...]
    terms: int
    model: str = "annular_3d"

    @functools.cached_property
    def maximum(self) -> si.FloatArray:
        """The largest |u_z| per volt (m/V) on the surface, for every frequency."""
        return np.asarray(np.max(np.abs(self.motion), axis=1))


@si.checked_numbers
def ring_response(
    body: RingBody,
    mode: AnnularMode,
    frequencies: si.HertzArray,
    harmonics: Sequence[int],
    terms: int = 6,
) -> RingResponse:
    """The response around `mode` at `frequencies` (Hz).

    Motion comes from the `terms` modes of the mode's harmonic nearest to it; the admittance from
    all of `harmonics`. Structural damping. Linear; sectors' fringes and the ceramic's dielectric
    loss are left out. Raises `InputError` for frequencies that are not positive.
    """
    si.require("frequencies", frequencies, si.Unit("Hz"), above=0, axes=1)
    m, quality = mode.harmonic, body.quality_factor
    near = annular_modes(body.section, m, near=mode.frequency, count=terms, quality_factor=quality)
    omega2 = (2 * np.pi * frequencies) ** 2
    radius = np.linspace(mode.surface_radius[0], mode.surface_radius[-1], _RADII)
    motion = np.zeros((frequencies.size, radius.size), dtype=complex)
    polarity = body.drive.coefficient(m)
    for one in near:
        own = (2 * math.pi * one.frequency) ** 2
        loss = 0.0 if one.is_rigid else 1 / one.quality_factor
        force = one.modal_force_all_round * abs(polarity)
        receptance = force / (one.modal_mass * (own * (1 + 1j * loss) - omega2))
        motion += receptance[:, None] * surface_profile(one, radius)[None, :]
    admittance = annular_admittance(
        body.section,
        body.drive,
        frequencies,
        harmonics=tuple(harmonics),
        quality_factor=quality,
        modes=terms,
    )
    return RingResponse(frequencies, radius, motion, admittance, tuple(harmonics), len(near))


def modal_circuit(body: RingBody, mode: AnnularMode) -> EquivalentCircuit:
    """The motional branch of a mode from its modal mass and force, without a static capacitance.

    Raises `InputError` for a mode that the channel does not drive.
    """
    force = abs(mode.modal_force(body.drive))
    return motional_branch(mode.frequency, mode.quality_factor, mode.modal_mass, force)


def ring_circuit(body: RingBody, mode: AnnularMode, response: RingResponse) -> EquivalentCircuit:
    """Butterworth-Van Dyke around the mode: the motional branch of `modal_circuit`, the static
    capacitance from what the sweep's admittance has beside it. Raises as `modal_circuit`."""
    return with_static_capacitance(modal_circuit(body, mode), response)


def static_capacitance(body: RingBody, circuit: EquivalentCircuit | None) -> si.Farad:
    """The capacitance beside a mode (F): that of the circuit, which other modes add to, or of the
    held ceramic where no circuit is known."""
    if circuit is not None:
        return circuit.static_capacitance
    return clamped_capacitance(body.section, body.drive)
