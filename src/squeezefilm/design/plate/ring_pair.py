"""Sentences on what a ring's one channel makes of the two orientations of its working mode.

A round body has cos mθ and sin mθ at one frequency. Its imperfections, or electrodes that are not
alike all round, part the two by a little. A channel whose antinodes lie on those of one of them
drives that one only, and the wave stands; one that lies between them drives both, and where these
answer with different phases a part of the wave travels and carries along what rests on the crests.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.kit.numbers import HZ, SPEED, shown
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import AnnularStator
from squeezefilm.physics.plate.ring.body import RingBody
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
    """Share of its frequency by which a pair is parted, at most, if the electrodes outside the
    channel are left open: the channel's are shorted by its source, and open ones stiffen.

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
    """Speed of the surface itself along the ring at a crest (m/s) of a wave of which the amplitude
    `travelling` (m) travels.

    ω times the surface's displacement around it, V, over that across it, W, at the radius where
    the mode moves most: the particles' ellipse, for a wave that travels alone. In a standing wave
    a crest moves straight up and down. Valid without contact; a finger is carried no faster.
    """
    top = np.flatnonzero(mode.node_height > np.max(mode.node_height) - 5e-10)
    at = top[int(np.argmax(np.abs(mode.displacement[top, 2])))]
    ratio = abs(mode.displacement[at, 1] / mode.displacement[at, 2])
    return float(2 * math.pi * mode.frequency * ratio * travelling)


# In half-bandwidths: what good rings have, what is common, and the worst there is.
_SPLITS = (0.1, 0.5, 2.0)


@dataclass(frozen=True)
class PairAtSplit:
    """The worst that a pair does which is `split` (Hz) apart, `half_bandwidths` of f/2Q: the
    smallest standing-wave ratio, the share of the amplitude that travels, and how fast the surface
    moves along the ring at its crests."""

    split: si.Hertz
    half_bandwidths: si.Dimensionless
    standing_wave_ratio: si.Dimensionless
    travelling: si.Dimensionless
    crest_speed: si.MetrePerSecond


@dataclass(frozen=True)
class RingPair:
    """A ring's mode B(n, m) as a pair, driven by one channel at the display's voltage.

    `amplitude` (m) is that at resonance without a finger. `two_channels` is the speed of the
    surface at the crests of the travelling wave that two channels in quadrature would make of the
    same amplitude. `electrode_split` (Hz) parts the pair at most if the electrodes outside the
    channel are left open. `splits` lists what imperfections would do.
    """

    label: str
    frequency: si.Hertz
    quality_factor: si.Dimensionless
    amplitude: si.Metre
    two_channels: si.MetrePerSecond
    electrode_split: si.Hertz
    splits: tuple[PairAtSplit, ...]

    @property
    def sentences(self) -> tuple[str, ...]:
        """Sentences on what that means, with its numbers."""
        half = self.frequency / (2 * self.quality_factor)
        open_in_halves = self.electrode_split / half
        amplitude = f"{self.amplitude * 1e6:.3g} µm"
        two = shown(self.two_channels, SPEED, 2)
        return (
            f"{self.label} is a pair: the same wave in two places around the ring, a quarter of a "
            "wave apart, at one frequency on a perfect ring. The one channel drives the one whose "
            "antinodes lie on its sectors and not the other, so that the wave stands: its crests "
            "move straight up and down, 0 m/s along the ring, and carry no finger along. Two "
            f"channels in quadrature would make a travelling wave of it, whose crests move along "
            f"the ring at {two} at the same {amplitude}: that is the motor.",
            f"If the electrodes outside the channel are left open, they part the pair by at most "
            f"{shown(self.electrode_split, HZ, 2)} ({open_in_halves:.2g} "
            "half-bandwidths; computed for sectors that go on as the channel's), along the "
            "channel's own axes: the wave still stands. Shorted to ground they part nothing.",
            "What is uneven around the ring (mass, glue, teeth, how it is held) parts the pair "
            "too, along axes of its own. By how much, its description does not say; the table has "
            "the worst over all axes and drive frequencies.",
        )


def ring_pair(display: Display, body: RingBody, mode: AnnularMode) -> RingPair:
    """The pair of a mode with nodal diameters at the display's voltage. Raises `InputError` for a
    mode without nodal diameters."""
    actuator, volts = display.actuator, display.drive.voltage
    if isinstance(actuator, AnnularStator):
        amplitude = volts * actuator.reference_amplitude / actuator.reference_voltage
    else:
        amplitude = volts * mode.amplitude_per_volt(body.drive)
    half = mode.frequency / (2 * mode.quality_factor)

    def at(apart: si.Dimensionless) -> PairAtSplit:
        share = most_travelling(apart)
        return PairAtSplit(
            apart * half,
            apart,
            least_standing_wave_ratio(apart),
            share,
            crest_speed(mode, share * amplitude),
        )

    return RingPair(
        label=mode.label,
        frequency=mode.frequency,
        quality_factor=mode.quality_factor,
        amplitude=amplitude,
        two_channels=crest_speed(mode, amplitude),
        electrode_split=mode.frequency * electrode_split(body.section, mode, body.drive),
        splits=tuple(at(apart) for apart in _SPLITS),
    )
