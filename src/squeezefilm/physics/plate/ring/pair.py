"""The two orientations of a ring's mode B(n, m), and what one channel makes of them.

A round body has cos mθ and sin mθ at one frequency. Its imperfections, or electrodes that are not
alike all round, part the two by a little. A channel whose antinodes lie on those of one of them
drives that one only, and the wave stands; one that lies between them drives both, and where these
answer with different phases a part of the wave travels and carries along what rests on the crests.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.plate.ring.modes import AnnularMode, clamped_capacitance
from squeezefilm.physics.plate.ring.section import AnnularSection, SectorDrive


@si.closed_form(positive="split")
def most_travelling(split: si.Dimensionless) -> si.Dimensionless:
    """The largest share that travels of a pair `split` half-bandwidths f/2Q apart, over every
    axis of the imperfection and drive frequency: what a ring of unknown axis does at worst.

    How much larger one of the two waves around the ring is than the other, over the amplitude of
    one orientation driven alone at its resonance: (s/2)/(1 + s²/4) up to s = 2, driven in the
    middle with both orientations alike; 1/s beyond. Two modes of equal mass and Q near resonance,
    others left out; tests compare with a search over their superposition.
    """
    return split / 2 / (1 + split**2 / 4) if split <= 2 else 1 / split


@si.closed_form(positive="split")
def least_standing_wave_ratio(split: si.Dimensionless) -> si.Dimensionless:
    """The smallest standing-wave ratio of a pair `split` half-bandwidths apart, over every axis and
    drive frequency: 2/s, and 1 from s = 2 on, where the wave may travel altogether."""
    return 2 / split if split <= 2 else 1.0


@si.checked_numbers
def electrode_split(
    section: AnnularSection, mode: AnnularMode, drive: SectorDrive
) -> si.Dimensionless:
    """By how much of its frequency a pair is parted if the electrodes outside the channel are left
    open, at most: the channel's are shorted by its source, and open ones stiffen.

    Electrodes as wide as the channel's first sector fill the ring where the channel leaves room,
    each by itself: K grows by F² c cᵀ/C, with c the sector's ∫(cos mθ, sin mθ)dθ and C its clamped
    capacitance; half of the difference of the two eigenvalues, over ω²M. Sectors that follow on
    the channel's part the pair along its own axes. Shorted instead they part nothing.

    Raises `InputError` for a mode without nodal diameters, or a rigid motion.
    """
    m = mode.harmonic
    if m == 0 or mode.is_rigid:
        raise InputError(f"{mode.label} has one orientation only; choose one with nodal diameters")
    starts = sorted((start, end) for start, end, _ in drive.sectors)
    width, first = starts[0][1] - starts[0][0], starts[0][0]
    room = 2 * math.pi - (starts[-1][1] - first)
    rest = [starts[-1][1] + k * width for k in range(int(room / width + 1e-9))]
    added = np.zeros((2, 2))
    for start in rest:
        sector = SectorDrive(((start, start + width, 1),))
        pull = sector.coefficient(m)
        both = np.array([pull.real, -pull.imag]) * mode.modal_force_all_round
        added += np.outer(both, both) / clamped_capacitance(section, sector)
    low, high = np.linalg.eigvalsh(added)
    stiffness = (2 * math.pi * mode.frequency) ** 2 * mode.modal_mass
    return float((high - low) / (2 * stiffness))


@si.checked_numbers
def crest_speed(
    mode: AnnularMode, travelling: Annotated[si.Metre, si.AtLeast(0.0)]
) -> si.MetrePerSecond:
    """How fast the surface itself moves along the ring at a crest (m/s) of a wave of which the
    amplitude `travelling` (m) travels.

    ω times the surface's displacement around it, V, over that across it, W, at the radius where
    the mode moves most: the particles' ellipse, for a wave that travels alone. In a standing wave
    a crest moves straight up and down. Valid without contact; a finger is carried no faster.
    """
    top = np.flatnonzero(mode.node_height > np.max(mode.node_height) - 5e-10)
    at = top[int(np.argmax(np.abs(mode.displacement[top, 2])))]
    ratio = abs(mode.displacement[at, 1] / mode.displacement[at, 2])
    return float(2 * math.pi * mode.frequency * ratio * travelling)
